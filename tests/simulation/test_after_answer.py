"""Whatever fails once the last load step is solved is said in a sentence: the answer stays."""

import json
from dataclasses import replace

import pytest
from mpi4py import MPI

from fenics_contact import Modes, Run, run
from fenics_contact.analyses.derivatives import task as derivatives
from fenics_contact.analyses.derivatives.table import DerivativeRequest
from fenics_contact.cli import commands
from fenics_contact.common.errors import MachineError, NotConvergedError, StoppedError
from fenics_contact.common.failures import attempt
from fenics_contact.simulation import end_of_run, verdict
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.simulation.step_history import LinearRange
from fenics_contact.trust import run_checks
from fenics_contact.trust.error_estimates import budget, estimates
from tests.common.test_failures import on_two_ranks, pressed
from tests.simulation.studies.cases import ON_A_FLOOR, square

COMM = MPI.COMM_WORLD
BY = "contact.0.friction_coefficient"
FAULT = "a fault of the program (ZeroDivisionError: two and two are five)"


def _raising(error):
    def fail(*arguments):
        raise error

    return fail


fail = _raising(ZeroDivisionError("two and two are five"))


def found_of(folder):
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def solved(folder):
    """A block whose derivatives are asked for, too, by files."""
    scene, comm, body = pressed()
    scene = replace(scene, derivatives=DerivativeRequest(("strain_energy",), (BY,)))
    result = files.solve_and_write(Run(scene, comm, body), folder)
    comm.Barrier()
    written = found_of(folder)
    assert written["verdict"] == result.verdict
    assert (folder / "contact.csv").exists() and (folder / "steps.csv").exists()
    return result, written


# Where it fails → what the result says that it lacks.
PIECES = {
    "mesh": (estimates, "mesh_errors", "The error by the mesh was not estimated: "),
    "iterations": (estimates, "iteration_errors", "The error by the iterations was not "),
    "corners": (budget, "Unbounded", "Errors were not estimated: "),
    "others": (end_of_run, "search_other_solutions", "It was not found whether the answer is "),
    "strains": (LinearRange, "of", "The range of linear theory was not checked: "),
    "derivatives": (derivatives, "asked_derivatives", "No derivatives: "),
    "tolerances": (derivatives, "uncertainties", "No uncertainties: "),
    "remarks": (verdict, "slid_far", "Some of what limits the answer was not looked at: "),
    "cycles": (end_of_run, "cycles_record", "Losses of cycles were not found: "),
    "fields": (files.FieldSeries, "write", "Fields were not written: "),
}


ASKED = {
    "derivatives": {"derivatives": DerivativeRequest(("normal_force",), (BY,))},
    "modes": {"modes": Modes(number=2)},
}
OF_ROUND_OFF = ("checks", "iteration", "outer_contraction", "residual_history")
NOT_OF_ANSWER = ("derivatives", "uncertainty", "modes", "damping", "timings", "verdict")


def _rounded(found):
    """What is found, without costs and values below 1e-10, to five digits."""
    if isinstance(found, dict):
        return {key: _rounded(one) for key, one in found.items() if key not in OF_ROUND_OFF}
    if isinstance(found, list | tuple):
        return [_rounded(one) for one in found]
    if isinstance(found, float):
        return float(f"{found:.5g}") if abs(found) > 1e-10 else 0.0
    return found


@pytest.mark.errors
@pytest.mark.parametrize("asked", ASKED)
def test_what_is_asked_besides_does_not_change_the_answer(asked):
    """Quantities, errors, checks, the way to them, the solver's reason: by nothing but round-off.

    Two equal runs differ by it, too: on several ranks a factorisation adds what arrives in the
    order in which it arrives, and sums of vectors depend on where these lie in the memory.
    """
    material = tuple(replace(one, density=1e-3) for one in ON_A_FLOOR.material)
    contact = (replace(ON_A_FLOOR.contact[0], law="incremental"),)
    scene = replace(ON_A_FLOOR, material=material, contact=contact)
    alone, asking = (
        run(replace(scene, **more), COMM, square()).as_dict() for more in ({}, ASKED[asked])
    )
    assert asking[asked]
    for one in (alone, asking):
        for key in NOT_OF_ANSWER:
            one.pop(key, None)
    for name, value in alone["quantities"].items():
        assert asking["quantities"][name] == pytest.approx(value, rel=1e-10, abs=1e-12)
    assert _rounded(asking) == _rounded(alone)


@pytest.mark.errors
@pytest.mark.parametrize("piece", PIECES)
def test_an_answer_stands_whatever_fails_after_it(piece, folder, monkeypatch):
    of, name, words = PIECES[piece]
    with monkeypatch.context() as patch:
        patch.setattr(of, name, fail)
        result, written = solved(folder)
    assert result.converged and result.passed and result.exit_code == 0
    said = " ".join([written["verdict"], *written["error_notes"]])
    assert words in said and f"{FAULT}." in said and said.count(FAULT) == 1
    energy = written["errors"]["strain_energy"]
    estimated = piece not in ("mesh", "iterations", "corners")
    assert (energy["total"] is not None) is estimated
    slope = written["derivatives"]["strain_energy"][BY]
    assert (slope["value"] is None) is (piece == "derivatives")
    sound = run(*pressed()).quantities["strain_energy"]
    assert written["quantities"]["strain_energy"] == pytest.approx(sound, rel=1e-9)


@pytest.mark.errors
def test_an_estimate_that_does_not_converge_says_that_it_is_one(monkeypatch, caplog):
    why = "not converged after 24 Newton steps"
    monkeypatch.setattr(estimates, "mesh_errors", _raising(NotConvergedError(why)))
    with caplog.at_level("INFO", "fenics_contact"):
        result = run(*pressed())
    assert result.passed and "not converged" not in result.verdict
    assert f"The error by the mesh was not estimated: {why}." in result.error_notes
    assert "not converged" not in caplog.text


def test_a_check_that_cannot_be_made_is_one_that_fails(folder, monkeypatch):
    monkeypatch.setitem(run_checks.OF_LAWS, "dissipation", fail)
    result, written = solved(folder)
    assert result.converged and not result.passed and result.exit_code == 4
    assert f"failed dissipation: it could not be made: {FAULT}." in result.verdict
    assert written["checks"]["dissipation"] == {"value": None, "limit": 0.0, "passed": False}
    assert written["checks"]["equilibrium"]["passed"]


@pytest.mark.errors
@pytest.mark.parametrize(
    "error", [MemoryError(), MachineError("too little memory"), OSError("no room"), SystemExit(3)]
)
def test_faults_of_the_machine_end_the_run_and_leave_the_answer(error, folder, monkeypatch):
    monkeypatch.setattr(estimates, "mesh_errors", _raising(error))
    with pytest.raises(type(error)):
        solved(folder)
    COMM.Barrier()
    written = found_of(folder)
    assert written["converged"] and written["passed"] and (folder / "contact.csv").exists()
    assert "such as its error bars, was not done to its end" in written["verdict"]
    assert set(written["errors"]["strain_energy"].values()) == {None}
    assert written["contacts"][0]["errors"]["contact_area"]["total"] is None


@pytest.mark.errors
def test_who_interrupts_an_estimate_has_the_answer(folder, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(estimates, "mesh_errors", _raising(StoppedError("stopped")))
        result, written = solved(folder)
    assert result.exit_code == 130 and result.converged
    assert "Interrupted after the last load step" in written["verdict"]
    assert written["checks"]["equilibrium"]["passed"]
    assert "not converged" not in written["verdict"].lower()


@pytest.mark.errors
def test_resuming_after_an_interrupted_estimate_makes_it(folder, monkeypatch):
    scene, comm, body = pressed()
    first = Run(scene, comm, body)
    with monkeypatch.context() as patch:
        patch.setattr(estimates, "mesh_errors", _raising(StoppedError("stopped")))
        stopped = files.solve_and_write(first, folder, StateFile(folder, first.problem, scene))
    again = Run(scene, comm, body)
    state = StateFile(folder, again.problem, scene)
    result = files.solve_and_write(again, folder, state, state.load())
    assert stopped.exit_code == 130 and result.exit_code == 0
    for name in ("strain_energy", "slip_area"):
        assert result.errors[name]["total"] is not None
        assert result.quantities[name] == pytest.approx(stopped.quantities[name], rel=1e-9)
    assert len(result.steps) == 1


def test_one_rank_that_fails_while_all_meet_is_no_end():
    """They all come to the error, whichever they have; what the lowest one says is said."""

    def act():
        COMM.Barrier()
        raise [ValueError, KeyError][COMM.rank % 2]("of a rank")

    notes = []
    assert attempt(COMM, "There is none", act, 5, notes) == 5
    assert attempt(COMM, "There is none", act, 5, notes) == 5
    assert notes == ["There is none: a fault of the program (ValueError: of a rank)."]


@pytest.mark.serial
def test_a_rank_that_fails_alone_leaves_the_answer(tmp_path):
    """It ends the others, which wait for it: with what was found before."""
    code, said, seconds = on_two_ranks(tmp_path, "estimate")
    assert code == 1 and "ValueError: two and two are five" in said
    assert seconds < 10
    written = found_of(tmp_path / "out")
    assert written["passed"] and "was not done to its end" in written["verdict"]


@pytest.mark.skipif(COMM.size > 1, reason="one rank draws")
def test_pictures_that_fail_are_missing_and_nothing_else(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(commands, "_report", fail)
    commands._draw(tmp_path, quiet=True)
    assert caplog.messages == [f"no pictures: {FAULT}"]
