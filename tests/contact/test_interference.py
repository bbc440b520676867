"""Interferences by value: pressures, energies and their balance against formulas."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Material,
    NormalCompliance,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.analytic.two_bodies import Tube, pressure
from fenics_contact.common.errors import SceneError
from fenics_contact.simulation.state_file import StateFile
from fenics_contact.verification.boxes import Box, boxes, quarter_rings
from tests.contact.fits import CONFINED, FIT, RATIO, STIFFNESS, balances, stack
from tests.messages import refused

COMM = MPI.COMM_WORLD
ROUGH = {"law": "incremental", "friction_coefficient": 0.3}


@pytest.mark.parametrize(
    ("dimension", "solver", "drawn", "given", "more"),
    [
        (2, "condensed", 0.0, FIT, {}),
        (2, "full", 0.0, FIT, ROUGH | {"slave": "on"}),
        (3, "condensed", 0.0, FIT, ROUGH | {"slave": "against"}),
        (3, "iterative", 0.0, FIT, {}),
        (2, "condensed", 2 * FIT, -FIT, {}),  # drawn too deep
        (2, "condensed", FIT, FIT, {"penalty_parameter": 1e-6}),
    ],
)
def test_two_blocks(dimension, solver, drawn, given, more):
    """p = o / (2/M + ε₁) with the confined modulus M and all of the overlap o; work ½ p o."""
    prepared = stack(dimension, drawn, None, solver, interference=given, **more)
    result = prepared.solve()
    balances(prepared, result)
    give = prepared.problem.contacts[0].penalty_parameter
    compliance = 2 / CONFINED + give
    for step, share in zip(result.steps, (0.5, 1.0), strict=True):
        overlap = drawn + share * given
        pressure = step.quantities["max_contact_pressure"]
        assert pressure == pytest.approx(overlap / compliance, rel=1e-6)
    np.testing.assert_allclose(result.points.contact_pressure, pressure, rtol=1e-6)
    assert result.quantities["strain_energy"] == pytest.approx(pressure**2 / CONFINED, rel=1e-6)
    if given == FIT:
        assert result.quantities["external_work"] == pytest.approx(
            0.5 * pressure * (drawn + given), rel=1e-6
        )
    np.testing.assert_allclose(result.points.gap, -give * pressure, rtol=1e-6)


@pytest.mark.parametrize(
    ("law", "depth"),
    [
        ({}, None),
        ({"foundation_stiffness": 500.0}, 1 / 500.0),
        ({"normal_law": NormalCompliance("normal compliance", 500.0, 1.0)}, 1 / 500.0),
        ({"obstacle": Obstacle(shape="plane", position=(0, 0), normal=(0, 1))}, None),
    ],
)
def test_an_obstacle_that_is_too_large(law, depth):
    """One block, o = p/M + p/k; driven besides, both depths add up."""
    prepared = stack(against=None, **law)
    result = prepared.solve()
    give = prepared.problem.contacts[0].penalty_parameter if depth is None else depth
    expected = FIT / (1 / CONFINED + give)
    assert result.passed, result.verdict
    assert result.quantities["max_contact_pressure"] == pytest.approx(expected, rel=1e-6)
    assert result.quantities["external_work"] == pytest.approx(0.5 * expected * FIT, rel=1e-6)
    if "obstacle" in law:
        driven = dataclasses.replace(law["obstacle"], indentation=2 * FIT)
        result = stack(against=None, obstacle=driven).solve()
        assert result.passed, result.verdict
        assert result.quantities["max_contact_pressure"] == pytest.approx(3 * expected, rel=1e-6)


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
@pytest.mark.parametrize("drawn", [False, True])
def test_long_rings_in_space(drawn, solver):
    """A quarter of a slice, held between planes: Lamé's pressure in the mean."""
    radius, angles = 20.0 + (FIT if drawn else 0.0), (16, 20)
    parts = (
        Box("shaft", (10, 0, 0), (radius, 1, 5), (2, angles[0], 1)),
        Box("hub", (20, 0, 0), (30, 1, 5), (2, angles[1], 1)),
    )
    scene = Scene(
        kinematics="3D",
        material=Material(STIFFNESS, RATIO),
        symmetry=tuple(
            f"{box.name}.{side}{end}" for box in parts for side in "yz" for end in (0, 1)
        ),
        contact=(
            Contact("shaft.x1", against="hub.x0", interference=0.0 if drawn else FIT, **ROUGH),
        ),
        steps=Steps(2),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    prepared = Run(scene, COMM, quarter_rings(parts))
    result = prepared.solve()
    balances(prepared, result)
    tubes = Tube(10, 20, STIFFNESS, RATIO), Tube(20, 30, STIFFNESS, RATIO)
    exact, area = pressure(*tubes, FIT, is_long=True), 5 * np.pi / 2 * 20
    found = result.quantities
    assert found["pressure_integral"] / area == pytest.approx(exact, rel=5e-3)
    assert found["external_work"] == pytest.approx(0.5 * exact * FIT * area, rel=5e-3)


def test_fitted_then_drawn_apart():
    """Its path goes back to 0 and beyond: no pressure is left, and all of the work comes back."""
    path = Path(time=(0, 1, 2, 3), factor=(0, 1, 0, -1))
    result = stack(steps=Steps(3, 3.0), interference_path=path).solve()
    assert result.passed, result.verdict
    pressures = [step.quantities["max_contact_pressure"] for step in result.steps]
    assert pressures[0] > 0.1 and max(pressures[1:]) < 1e-9 * pressures[0]
    assert (
        abs(result.quantities["external_work"]) < 1e-9 * result.steps[0].quantities["external_work"]
    )
    np.testing.assert_allclose(result.points.gap, FIT, rtol=1e-9)


def test_single_step_has_the_work_of_the_final_forces():
    result = stack(steps=Steps()).solve()
    assert result.passed, result.verdict
    pressure = result.quantities["max_contact_pressure"]
    assert result.quantities["external_work"] == pytest.approx(pressure * FIT, rel=1e-6)
    stored = result.quantities["strain_energy"] + result.quantities["penalty_energy"]
    assert result.quantities["external_work"] == pytest.approx(2 * stored, rel=1e-6)


def test_clearance():
    """A gap by value closes before anything presses."""
    prepared = stack(interference=-2 * FIT, interference_path=Path((0,), (1,)))
    support = prepared.scene.support
    pressed = dataclasses.replace(
        prepared.scene, support=(*support[:-1], Support("upper.y1", {"y": -3 * FIT}))
    )
    result = Run(pressed, COMM, prepared.problem.body).solve()
    assert result.passed, result.verdict
    expected = FIT / (2 / CONFINED + prepared.problem.contacts[0].penalty_parameter)
    assert result.steps[0].quantities["contact_area"] == 0
    assert result.quantities["max_contact_pressure"] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("law", [{}, ROUGH])
def test_grown_after_what_faces_what_was_found_anew(law):
    """Slid by a tenth of the width under a light fit, then fitted: the work of that balances."""
    parts = (
        Box("lower", (0, -1), (2, 0), (8, 4)),
        Box("upper", (0, 0), (1, 1), (5, 4)),
    )
    slid = {"x": 0.1}
    scene = Scene(
        kinematics="plane strain",
        material=Material(STIFFNESS, RATIO),
        support=(
            Support("lower.y0", {"x": 0, "y": 0}),
            Support("upper.y1", {"y": 0}),
            Support("upper.y1", slid, path=Path((0, 1, 2), (0, 0, 1))),
        ),
        contact=(
            Contact(
                "upper.y0",
                against="lower.y1",
                interference=FIT,
                interference_path=Path((0, 1, 2, 3), (0, 0.1, 0.1, 1)),
                **law,
            ),
        ),
        steps=Steps(times=(1.0, *(1 + n / 8 for n in range(1, 9)), 2.5, 3.0)),
    )
    prepared = Run(scene, COMM, boxes(parts))
    result = prepared.solve()
    assert prepared.problem.contacts[0].kinematics.paired_at is not None
    assert result.passed, result.verdict
    before, after = (result.steps[n].quantities for n in (-3, -1))
    keys = ("strain_energy", "penalty_energy", "friction_work")
    stored = sum(after[key] - before[key] for key in keys)
    fitted = after["external_work"] - before["external_work"]
    assert fitted == pytest.approx(stored, rel=1e-3)
    assert fitted > 5 * before["strain_energy"]


def test_resumed(tmp_path):
    folder = COMM.bcast(tmp_path)
    begun = stack(steps=Steps(times=(0.25, 0.5)), **ROUGH)
    assert begun.solve(StateFile(folder, begun.problem)).converged
    rest = stack(steps=Steps(times=(0.25, 0.5, 1.0)), **ROUGH)
    file = StateFile(folder, rest.problem)
    resumed = rest.solve(file, file.load())
    whole = stack(steps=Steps(times=(0.25, 0.5, 1.0)), **ROUGH).solve()
    assert resumed.passed, resumed.verdict
    for name in ("external_work", "strain_energy", "max_contact_pressure"):
        assert resumed.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-9), name


@pytest.mark.errors
def test_its_error_bar_holds_the_penalty():
    result = stack().solve()
    exact = FIT / (2 / CONFINED)
    for name in ("normal_force", "max_contact_pressure"):
        bar = result.errors[name]["total"]
        assert 0 < abs(abs(result.quantities[name]) - exact) <= bar < 1e-3 * exact, name


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"contact": "bonded"}, "interference_of_bonded_contact"),
        ({"pressure": 1.0}, "interference_of_prescribed_contact"),
        ({"obstacle": Obstacle(force=1.0)}, "interference_of_driven_obstacle"),
        ({"interference": 0.0, "interference_path": Path((0, 1), (1, 0))}, "interference_path"),
    ],
)
def test_refused(change, words):
    with refused(words, SceneError):
        Contact("top", **{"interference": FIT} | change)
