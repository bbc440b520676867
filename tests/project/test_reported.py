"""Reports of trouble with other programs: what docs/reported.md says comes out of their scenes."""

import dataclasses
import json
from math import pi
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import load_scene, main, run
from fenics_contact.analytic.two_bodies import Tube, pressure
from fenics_contact.scene.scene import Steps
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
SCENES = ROOT / "docs" / "reported"
PAGE = (ROOT / "docs" / "reported.md").read_text(encoding="utf-8")
DRAGGED = SCENES / "dragged.toml"
NO_BARS = "solver.errors=none"


def scene_of(name, *changes):
    return load_scene(SCENES / f"{name}.toml", (NO_BARS, *changes))


def solved(name, *changes):
    result = run(scene_of(name, *changes), COMM)
    assert result.passed, result.verdict
    return result


@pytest.fixture(scope="module")
def dragged():
    return solved("dragged")


def parameters(result):
    return result.contacts[0]["parameters"]


def newton_steps(result):
    return [step["newton_iterations"] for step in result.steps]


def forces(result):
    return forces_of(result.quantities)


def forces_of(found):
    """Of a surface that wraps around there is no normal force: nan."""
    return np.array([found["normal_force"], *found["friction_force"]], dtype=np.float64)


def test_the_page_tells_of_every_scene():
    for path in SCENES.glob("*.toml"):
        assert f"reported/{path.name}" in PAGE


def test_a_penalty_that_nobody_chose_and_its_tenth_and_tenfold(dragged):
    """What it changes stays below .1 %."""
    chosen = parameters(dragged)["penalty_parameter"]
    for factor in (0.1, 10):
        other = solved("dragged", f"contact.0.penalty_parameter={factor * chosen}")
        assert np.abs(forces(other) - forces(dragged)).max() < 1e-3 * forces(dragged)[0]


def test_friction_opposes_the_motion_by_its_coefficient_times_the_force(dragged):
    normal, along, across = forces(dragged)
    assert along == pytest.approx(-0.3 * normal, rel=1e-6) and across == pytest.approx(0, abs=1e-9)
    # The foot of the dragged block lags behind its head, which moves by .02: it slips by less.
    assert np.all(dragged.points.friction_traction[:, 0] <= 0)
    assert 0 < dragged.quantities["max_slip"] < 0.02


def test_friction_grows_step_by_step_and_does_not_oscillate():
    scene = scene_of("dragged")
    times = (1.0, *np.linspace(1.05, 2, 20))
    result = run(dataclasses.replace(scene, steps=Steps(times=times)), COMM)
    friction, normal = (
        np.array([step["quantities"][name] for step in result.steps])
        for name in ("friction_force", "normal_force")
    )
    ratio = -friction[:, 0] / normal
    assert np.all(np.diff(ratio) > -1e-7)
    assert ratio[-8:] == pytest.approx(0.3, rel=1e-6)


def test_a_resumed_run_ends_as_one_that_was_not_stopped(dragged, tmp_path):
    folder = COMM.bcast(str(tmp_path), root=0)
    arguments = ["run", str(DRAGGED), "--out", folder, "--quiet", "--set", NO_BARS]
    assert main([*arguments, "--set", "steps.times=[1, 1.25, 1.5]"]) == 0
    assert main([*arguments, "--resume"]) == 0
    again = json.loads((Path(folder) / "result.json").read_text(encoding="utf-8"))
    assert forces_of(again["quantities"]) == pytest.approx(forces(dragged), rel=1e-9, abs=1e-12)


def test_load_steps_that_failed_at_first_end_as_those_that_did_not(dragged):
    """Two Newton steps are too few for most of them; the ways after that begin where it began."""
    again = solved("dragged", "solver.max_iterations=2")
    assert sum(bool(step["attempts"]) for step in again.steps) >= 3
    assert not any(step["attempts"] for step in dragged.steps)
    assert forces(again) == pytest.approx(forces(dragged), rel=1e-7, abs=1e-9)


@pytest.mark.errors
def test_what_is_slave_changes_no_more_than_the_bars_say():
    first, second = (
        solved("dragged", f"contact.0.slave={which}", "solver.errors=all")
        for which in ("on", "against")
    )
    bars = [result.contacts[0]["errors"]["normal_force"]["total"] for result in (first, second)]
    difference = abs(forces(first)[0] - forces(second)[0])
    assert 0 < difference < sum(bars)
    assert sum(bars) < 0.02 * forces(first)[0]


def test_a_block_at_rest_creeps_by_no_more_than_said():
    """By about the regularisation parameter in each load step; with micro-slip not at all."""
    result = solved("resting")
    slips = [step["quantities"]["max_slip"] for step in result.steps]
    epsilon = parameters(result)["regularisation_parameter"]
    assert np.diff(slips).min() >= 0 and np.diff(slips).max() < 1.5 * epsilon
    assert slips[-1] < (1 + 2e-4) * slips[0]
    assert result.quantities["slip_area"] == 0
    normal, along, across = forces(result)
    slope = np.sqrt(1 + 0.2**2)
    assert normal == pytest.approx(10 / slope, rel=1e-6)
    assert np.hypot(along, across) == pytest.approx(10 * 0.2 / slope, rel=1e-6)
    remembering = solved("resting", "contact.0.friction_law={kind='micro-slip', elastic_slip=1e-6}")
    slips = [step["quantities"]["max_slip"] for step in remembering.steps]
    assert np.ptp(slips) < 1e-9 * slips[0]


def test_any_number_of_ranks_finds_the_same(dragged):
    alone = run(scene_of("dragged"), MPI.COMM_SELF)
    assert forces(alone) == pytest.approx(forces(dragged), rel=1e-9, abs=1e-12)


def test_bodies_that_touch_without_a_force_are_no_failure():
    assert np.all(forces(solved("touching")) == 0)


def test_the_press_fit_by_lames_formula_and_in_other_units():
    shaft, hub = Tube(10, 20, 196e3, 0), Tube(20, 30, 196e3, 0)
    exact = 0.1 * pressure(shaft, hub, 2.5e-3, is_long=False) * 2 * pi * 20 * 19
    assert exact == pytest.approx(1371, rel=1e-3)
    found = solved("press_fit", "material.poissons_ratio=0")
    assert forces(found)[2] == pytest.approx(exact, rel=1e-3)
    metres = (
        "mesh.parameters={bore=0.01, radius=0.02, outer=0.03, length=0.019, size=0.002}",
        "material.youngs_modulus=196e9",
        "support.1.displacement={y=-4e-6}",
        "contact.0.interference=2.5e-6",
    )
    in_millimetres, in_metres = solved("press_fit"), solved("press_fit", *metres)
    assert newton_steps(in_metres) == newton_steps(in_millimetres)
    assert forces(in_metres)[1:] == pytest.approx(forces(in_millimetres)[1:], rel=1e-9, abs=1e-9)


def test_hertz_where_his_assumptions_hold_and_said_where_they_do_not():
    """The peak pressure of Hertz is √(F E*/(π R)), with radii and moduli of both together."""
    small = solved("cylinders")
    assert "linear theory" not in small.verdict
    force, peak = small.quantities["normal_force"], small.quantities["max_contact_pressure"]
    modulus, radius = 1000 / (2 * (1 - 0.3**2)), 4.0
    assert peak == pytest.approx(np.sqrt(force * modulus / (pi * radius)), rel=0.005)
    large = solved("cylinders", "support.1.displacement={x=0, y=-1.1}")
    assert "Outside the range of linear theory" in large.verdict
