"""A bracket from a CAD file, held back by two friction pads: a scene unlike any demo."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import load_scene, run
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
SCENE = load_scene(ROOT / "docs" / "bracket.toml")
LOAD = np.array([40.0, 10.0, 0.0]) * 30 * 8
PADS = {"upper_pad": (40.0, 0.6), "lower_pad": (40.0, 0.2)}  # pressure, coefficient
AREA = 20 * 20


def solved(size):
    mesh = dataclasses.replace(SCENE.mesh[0], size=size)
    return run(dataclasses.replace(SCENE, mesh=mesh), COMM)


@pytest.fixture(scope="module")
def result():
    return solved(6.0)


def pad(result, name):
    return next(c["quantities"] for c in result.contacts if c["name"] == name)


def friction_of(result):
    """Of both pads together: they are on the same body, and lie in one plane."""
    return sum(np.array(pad(result, name)["friction_force"]) for name in PADS)


def test_checks_of_the_physics_pass(result):
    assert result.passed, result.verdict
    assert result.model["kinematics"] == "3D"
    assert result.model["cell"] == "tetrahedron"
    assert result.model["degree"] == 2


def test_resultants_balance_the_load(result):
    """Friction is the sum over the pads; the pads' pressures cancel."""
    friction = friction_of(result)
    reaction = np.array(result.quantities["reaction"])
    assert np.abs(LOAD + friction + reaction).max() < 1e-6 * np.linalg.norm(LOAD)
    carried = sum(np.array(pad(result, name)["contact_force"]) for name in PADS)
    assert np.abs(LOAD + carried + reaction).max() < 1e-6 * np.linalg.norm(LOAD)
    # both hold the bracket back, the rougher one more
    assert friction @ LOAD < -0.3 * LOAD @ LOAD
    forces = [np.linalg.norm(pad(result, name)["friction_force"]) for name in PADS]
    assert forces[0] > 1.2 * forces[1]


@pytest.mark.parametrize("name", PADS)
def test_friction_within_its_bound(result, name):
    pressure, coefficient = PADS[name]
    found = pad(result, name)
    assert found["normal_force"] == pytest.approx(pressure * AREA)
    assert found["stick_area"] + found["slip_area"] == pytest.approx(AREA)
    assert np.linalg.norm(found["friction_force"]) < coefficient * pressure * AREA
    points, chosen = points_of(result, name)
    traction = np.linalg.norm(points.friction_traction[chosen], axis=1)
    bound = coefficient * pressure
    assert traction.max() < bound * (1 + 1e-6)
    assert traction[points.status[chosen] == "SLIP"].min() > bound * (1 - 1e-6)
    assert np.abs(points.friction_traction[chosen, 2]).max() < 1e-9 * bound  # tangential


def points_of(result, name):
    number = list(PADS).index(name)
    return result.points, result.points.contact == number


@pytest.mark.parametrize("name", PADS)
def test_slip_opposes_traction(result, name):
    points, chosen = points_of(result, name)
    slips = chosen & (points.status == "SLIP")
    traction, slip = points.friction_traction[slips], points.slip[slips]
    sizes = np.linalg.norm(traction, axis=1) * np.linalg.norm(slip, axis=1)
    assert np.einsum("ij,ij->i", traction, slip) / sizes == pytest.approx(-1)


def test_weaker_pad_slips_all_over_and_more(result):
    upper, lower = (pad(result, name) for name in PADS)
    assert lower["slip_area"] == pytest.approx(AREA)
    assert 0.3 * AREA < upper["stick_area"] < 0.7 * AREA
    assert lower["max_slip"] > 1.5 * upper["max_slip"]
    assert result.quantities["friction_work"] > 0


def test_rougher_pad_sticks_next_to_the_wall(result):
    """The load pulls from the other side, so slip starts there."""
    points, chosen = points_of(result, "upper_pad")
    x = points.coordinates[chosen, 0]
    sticks = points.status[chosen] == "STICK"
    assert x[sticks].mean() < 30 < x[~sticks].mean()


def test_refinement_changes_little(result):
    fine = solved(4.5)
    assert fine.passed
    assert fine.model["dofs"] > 1.4 * result.model["dofs"]
    coarse_force, force = friction_of(result), friction_of(fine)
    assert np.linalg.norm(force - coarse_force) < 0.01 * np.linalg.norm(force)
    assert fine.quantities["max_slip"] == pytest.approx(result.quantities["max_slip"], rel=0.02)
