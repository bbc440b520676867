"""Modes that are driven: loops by formulas, what a contact loses, files, and where no loop is."""

import csv
import dataclasses
import math

import pytest
from mpi4py import MPI

from fenics_contact import Damping, Run, Study
from fenics_contact.cli.summary import _conditions as conditions
from fenics_contact.common.errors import SceneError
from fenics_contact.results.result import read_result
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.verification.published.vibration import (
    Joint,
    bar,
    bar_body,
    bar_scene,
    compared,
)
from tests.messages import refused

COMM = MPI.COMM_WORLD
FORCES = (1.0, 3.0)


@pytest.fixture(scope="module")
def study():
    scene = dataclasses.replace(bar_scene(), damping=Damping((0.01,), increments=24))
    return Study(scene, COMM, bar_body(20))


def test_a_bar_that_slips_damps_what_formulas_say():
    findings = list(bar(20, (0.5,)))
    assert {finding.quantity.split(" ")[0] for finding in findings} == {
        *("loss", "damping_ratio", "natural_frequency")
    }
    assert all(finding.error < 2e-2 for finding in findings)


def test_a_wrong_formula_is_found_out():
    wrong = Joint(moved=lambda force: force, loss=lambda force: force)
    found = compared(bar_scene(), bar_body(20), wrong, (3.0,), 2e-2, axis=0)
    assert not any(finding.passed for finding in found)


def test_loss_is_the_loop_and_all_of_its_contacts(study):
    (row,) = study.vibration({"damping.amplitudes": [0.02]}).damping
    assert row.kind == "steady loop" and row.cycles == 2
    assert row.loss == pytest.approx(row.loop_area, rel=1e-2)
    assert row.loss == pytest.approx(sum(row.contacts.values()), rel=1e-12)
    stored = row.loss / (4 * math.pi * row.damping_ratio)
    mass = study.vibration().modes[0].modal_mass
    omega = 2 * math.pi * row.natural_frequency
    assert stored == pytest.approx(0.5 * mass * omega**2 * row.amplitude**2, rel=1e-9)


def test_small_amplitudes_have_the_frequency_of_the_mode_and_damp_less(study):
    found = study.vibration({"damping.amplitudes": [1e-5, 1e-3, 1e-2]})
    frequency = found.modes[0].natural_frequency
    frequencies = [row.natural_frequency for row in found.damping]
    ratios = [row.damping_ratio for row in found.damping]
    assert frequencies[0] == pytest.approx(frequency, rel=1e-3)
    assert frequencies == sorted(frequencies, reverse=True) and ratios == sorted(ratios)
    assert ratios[0] < 1e-3


def test_each_amplitude_begins_at_the_same_state(study):
    together = study.vibration({"damping.amplitudes": [0.01, 0.02]}).damping[1]
    alone = study.vibration({"damping.amplitudes": [0.02]}).damping[0]
    assert together.loss == pytest.approx(alone.loss, rel=1e-8)
    assert study.factorisations == 1


def test_where_all_slides_through_no_loop_is_found_and_the_others_stay(study):
    found = study.vibration({"damping.amplitudes": [0.01, 10.0], "solver.max_iterations": 30})
    assert len(found.damping) == 1
    assert "Mode 1 was not driven to 10, nor beyond" in found.notes[0]


def test_check_says_what_is_driven():
    scene = dataclasses.replace(bar_scene(), damping=Damping((0.01, 0.02)))
    lines = conditions(scene)
    assert "Modes: the 1 lowest about the last state, contacts stuck" in lines
    assert lines[-1] == (
        "Damping: mode 1 driven to 2 amplitudes, from 0.01 to 0.02, 40 load steps a cycle"
    )


def test_several_values_are_answers_of_their_own_and_keep_the_body(study):
    key = "contact.0.friction_coefficient"
    found = study.vibration({"damping.by": {key: (0.3, 0.6)}})
    assert [row.by for row in found.damping] == [{key: 0.3}, {key: 0.6}]
    for row, alone in zip(found.damping, (0.3, 0.6), strict=True):
        (other,) = study.vibration({key: alone}).damping
        assert row.loss == pytest.approx(other.loss, rel=1e-8)
    # Of twice the friction half of the bar slips, and loses half: D ~ 1/τ.
    assert found.damping[1].loss == pytest.approx(found.damping[0].loss / 2, rel=0.05)
    assert study.factorisations == 1


@pytest.mark.parametrize(
    ("by", "said"),
    [
        ({"contact.0.frction": (0.1,)}, "change_of_unknown_key_in_damping"),
        ({"material.0.youngs_modulus": (1.0, 2.0)}, "damping_by_the_body"),
    ],
)
def test_values_that_cannot_be_had_are_refused_before_anything_is_solved(by, said):
    scene = dataclasses.replace(bar_scene(), damping=Damping((0.01,), by=by))
    with refused(said):
        Run(scene, COMM, bar_body(10))


def test_a_run_writes_modes_and_damping(folder):
    scene = dataclasses.replace(bar_scene(), damping=Damping((0.01, 0.02), increments=16))
    result = solve_and_write(Run(scene, COMM, bar_body(10)), folder)
    assert result.passed and len(result.modes) == 1 and len(result.damping) == 2
    assert result.timings.vibration > 0
    COMM.Barrier()
    read = read_result(folder)
    assert read.damping[1].loss == result.damping[1].loss
    with (folder / "damping.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert float(rows[1]["bar.y1.loss"]) == result.damping[1].loss
    assert float(rows[0]["natural_frequency"]) == result.damping[0].natural_frequency
    assert (folder / "modes.pvd").exists()


@pytest.mark.parametrize(
    ("damping", "said"),
    [
        ({"amplitudes": (0.2, 0.1)}, "amplitudes_do_not_increase"),
        ({"amplitudes": (0.1,), "increments": 10}, "increments_no_multiple_of_4"),
        ({"amplitudes": (0.1,), "modes": (1, 1)}, "mode_given_twice"),
        ({"amplitudes": (0.1,), "modes": (2,)}, "mode_beyond_the_number"),
    ],
)
def test_damping_that_makes_no_sense_is_refused(damping, said):
    with refused(said, SceneError):
        dataclasses.replace(bar_scene(), damping=Damping(**damping))


def test_damping_needs_modes():
    with refused("damping_without_modes", SceneError):
        dataclasses.replace(bar_scene(), modes=None, damping=Damping((0.1,)))
