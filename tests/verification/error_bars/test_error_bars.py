"""Error bars against true errors: wrong ones fail, and what cannot be told is left out."""

import dataclasses
import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Material, Scene, main
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.verification.error_bars import CASES
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Model,
    Parameters,
    Reference,
    rows_of,
)
from fenics_contact.verification.error_bars.command import verify_errors
from fenics_contact.verification.error_bars.runs import (
    BarAnswer,
    count,
    page,
    reference_of,
    run_bar_case,
)
from tests.messages import says
from tests.scenes import ROOT

SCENE = Scene(kinematics="plane strain", material=Material(1000, 0.3))
TRUE = {"normal_force": 10.0, "reaction": [0.0, 10.0], "max_slip": 0.5}
SOURCES = ("mesh", "penalty", "regularisation", "iteration", "step", "domain")


def made(role="tested", **changes):
    """A case that no solver needs to solve: its formula is a constant."""
    return BarCase(
        name="made",
        summary="made up",
        source="none",
        role=role,
        model=lambda element, cells, load: Model(dataclasses.replace(SCENE, title=str(cells))),
        elements=("Q2",),
        parameters=(Parameters(), Parameters(1e-5), Parameters(1e-4)),
        exact=lambda load: TRUE,
        **changes,
    )


def estimator(factor):
    """Answers off by 1 % over the number of cells, and bars of so many times that; None of None."""

    def solve(model):
        share = 0.01 / int(model.scene.title)
        quantities = {name: (np.array(value) * (1 + share)) for name, value in TRUE.items()}
        errors = {}
        for name, value in TRUE.items():
            size = None if factor is None else factor * share * float(np.linalg.norm(value))
            errors[name] = dict.fromkeys(SOURCES, 0.0) | {"mesh": size, "total": size}
        return BarAnswer(quantities, errors)

    return solve


@pytest.mark.parametrize(
    ("factor", "code"), [(2.0, 0), (1.001, 0), (0.999, 4), (0.0, 4), (6.0, 4), (None, 4)]
)
def test_bars_that_are_too_short_too_long_or_missing_fail(factor, code, capsys):
    assert verify_errors([], cases=[made()], solver=estimator(factor)) == code
    said = capsys.readouterr().out
    if MPI.COMM_WORLD.rank == 0:
        assert ("NOT MET" in said) == (code == 4)
        assert ("too short: made, max_slip" in said) == (factor in (0.999, 0.0))


def test_cases_that_test_must_hold_by_themselves():
    """Good bars of many cases that constants were chosen by do not make up for them."""
    good = [dataclasses.replace(made("chosen"), name=f"chosen_{number}") for number in range(30)]
    solver = estimator(2.0)

    def wrong_in_one(model):
        return (estimator(0.5) if model.body == "wrong" else solver)(model)

    wrong = made(
        cells={1: (1, 1, 1), 2: (1, 1, 1)},
    )
    wrong = dataclasses.replace(
        wrong, model=lambda *of: Model(dataclasses.replace(SCENE, title="1"), "wrong")
    )
    assert verify_errors([], cases=[*good, made()], solver=wrong_in_one) == 0
    assert verify_errors([], cases=[*good, wrong], solver=wrong_in_one) == 4


def test_a_run_without_an_answer_fails_the_whole():
    def solve(model):
        if model.scene.title == "4":
            raise NotConvergedError("no answer", [])
        return estimator(2.0)(model)

    outcome = run_bar_case(made(), quick=False, solver=solve)
    assert len(outcome.notes) == 3 and "no answer" in outcome.notes[0]
    assert "Runs without an answer" in page([outcome])
    assert verify_errors([], cases=[made()], solver=solve) == 4


def row(error, total, doubt=0.0, size=1.0, quantity="normal_force"):
    """A row of given numbers, through the function that makes them."""
    case = made()
    (found,) = rows_of(
        case,
        case.runs(True)[0],
        {quantity: size + error},
        {quantity: {"total": total}},
        Reference({quantity: size}, {quantity: doubt}),
    )
    return found


def test_what_counts():
    assert row(0.01, 0.02).counts and row(0.01, 0.02).held
    assert row(0.01, 0.02).ratio == pytest.approx(2)
    # By a reference that is off by no more than a tenth of either, what is wrong is wrong.
    assert row(0.01, 0.0, doubt=1e-3).counts and not row(0.01, 0.0, doubt=1e-3).held
    assert not row(0.01, 0.02, doubt=3e-3).counts
    assert row(1e-6, 0.02, doubt=1e-3).counts
    # Round-off of what is given; but a bar where there is no error counts.
    assert not row(1e-11, 1e-10).counts
    assert row(0.0, 1e-3).counts
    found = count([row(0.01, 0.02), row(0.01, 0.02, doubt=1.0), row(0.01, None), row(0.0, 0.0)])
    assert (len(found.rows), found.undecided, found.without) == (1, 1, 1)


def test_vectors_count_by_the_length_of_the_difference():
    case = made()
    (found,) = rows_of(
        case,
        case.runs(True)[0],
        {"reaction": [0.03, 10.04]},
        {"reaction": {"total": 0.06}},
        Reference({"reaction": [0.0, 10.0]}, {}),
    )
    assert found.error == pytest.approx(0.05) and found.held


def test_diagnostics_and_what_the_reference_has_not_are_left_out():
    case = made(left_out=("max_slip",))
    errors = {name: {"total": 1.0} for name in ("max_slip", "undecided_points", "contact_area")}
    quantities = dict.fromkeys(errors, 1.0)
    assert rows_of(case, case.runs(True)[0], quantities, errors, Reference(quantities, {})) != []
    known = Reference({"max_slip": 1.0, "undecided_points": 1.0}, {})
    assert rows_of(case, case.runs(True)[0], quantities, errors, known) == []


def test_what_penalties_add_counts_where_it_is_real():
    """As the depth of a foundation, not as that into a rigid obstacle."""
    case = made()
    errors = {"max_penetration": {"total": 1.0}}
    quantities = {"max_penetration": 0.1}
    for depth, count_of_rows in ((0.0, 0), (0.09, 1)):
        found = rows_of(
            case, case.runs(True)[0], quantities, errors, Reference({"max_penetration": depth}, {})
        )
        assert len(found) == count_of_rows


def test_files(tmp_path):
    names = tmp_path / "rows.json", tmp_path / "table.md"
    names = MPI.COMM_WORLD.bcast(names)
    assert verify_errors([], False, *names, cases=[made()], solver=estimator(2.0)) == 0
    if MPI.COMM_WORLD.rank == 0:
        rows = json.loads(names[0].read_text(encoding="utf-8"))
        assert len(rows) == 3 * 3 * 3
        assert rows[0]["estimated_error"] == pytest.approx(2 * rows[0]["true_error"])
        assert rows[0]["held"] and rows[0]["counts"] and rows[0]["mesh"] > 0
        text = names[1].read_text(encoding="utf-8")
        assert "27 of 27 bars hold (100.0 %), median ratio 2" in text


def test_cases_have_names_roles_and_references():
    assert len({case.name for case in CASES}) == len(CASES)
    assert {case.role for case in CASES} == {"chosen", "tested"}
    assert 2 * sum(case.role == "tested" for case in CASES) > len(CASES)
    for case in CASES:
        assert (case.exact is None) != (case.finer is None), case.name
        assert len(case.runs(False)) == 9 * len(case.elements)
        assert case.source and case.summary
    elements = {element for case in CASES if case.role == "tested" for element in case.elements}
    assert elements == {"P1", "Q1", "P2", "Q2"}


@pytest.mark.errors
def test_bars_of_a_uniform_strain_are_those_of_the_penalty():
    """No mesh is wrong there, so bars must be the true errors, at leading order."""
    (case,) = (case for case in CASES if case.name == "block")
    outcome = run_bar_case(case, quick=True)
    assert not outcome.notes
    forces = [found for found in outcome.rows if found.quantity == "normal_force"]
    assert len(forces) == 4
    for found in forces:
        assert found.held
        assert found.sources["penalty"] == pytest.approx(found.error, rel=0.1)


@pytest.mark.errors
def test_bars_of_displacements_hold_between_nodes():
    """Inside a cell a displacement is off by what its nodes' ones are, and by more."""
    (case,) = (case for case in CASES if case.name == "lame")
    outcome = run_bar_case(case, quick=True)
    within = [found for found in outcome.rows if found.quantity == "displacement_within"]
    assert len(within) == 4
    for found in within:
        assert found.held and found.ratio < 30


def test_the_reference_of_two_meshes_says_how_good_it_is():
    """Of the punch without friction: its work F d/2 is the strain energy."""
    (case,) = (case for case in CASES if case.name == "punch_0")
    reference = reference_of(case, 1.0)
    force, energy = (reference.quantities[name] for name in ("normal_force", "strain_energy"))
    assert energy == pytest.approx(force * 0.01 / 2, rel=1e-4)
    assert 0 < reference.doubt["normal_force"] < 1e-4 * force
    assert reference.quantities["penalty_energy"] == reference.doubt["penalty_energy"] == 0


def test_command_line_refuses_what_it_has_not(capfd):
    assert main(["verify", "--errors", "no_such_case"]) == 2
    assert main(["verify", "--errors", "--hard"]) == 2
    assert main(["verify", "--table", "x.md"]) == 2
    said = capfd.readouterr().err
    if MPI.COMM_WORLD.rank == 0:
        assert "no case 'no_such_case'; there are" in said and "sphere_0" in said
        says("verify_both", said)
        says("verify_table_of_neither", said)


def test_the_page_has_every_case_and_says_that_bars_hold():
    text = (ROOT / "docs" / "error_bars.md").read_text(encoding="utf-8")
    for case in CASES:
        row = f"| {case.name} | {case.summary} | {case.role} |"
        assert row in text, f"{case.name}: run verify --errors --table docs/error_bars.md"
