"""Elastic supports: bars and blocks on springs against formulas of springs in series."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Path,
    Point,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.common.errors import InputError
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, LENGTH, HEIGHT, FORCE, K = 1000.0, 4.0, 0.5, 3.0, 70.0
AXES = "xyz"
GIVE = 1e-7  # of the penalty: one more spring in series


def bar(size=2, by_area=False, **more):
    """A bar along x whose end x0 is on springs and whose end x1 is pulled."""
    area = HEIGHT ** (size - 1)
    spring = {"foundation_stiffness": {"x": K / area}} if by_area else {"stiffness": {"x": K}}
    given = {
        "kinematics": "3D" if size == 3 else "plane strain",
        "material": Material(E, 0.0),
        "support": (
            Support("x0", **spring),
            *(Support(f"{axis}0", {axis: 0}) for axis in AXES[1:size]),
        ),
        "load": (Load("x1", force=(FORCE, 0, 0)[:size]),),
        "point": (Point("tip", (LENGTH, 0, 0)[:size]),),
    }
    return Scene(**given | more), area


def body(size=2, cells=4):
    return box_body((cells, 1, 1)[:size], (LENGTH, HEIGHT, HEIGHT)[:size])


@pytest.mark.parametrize(
    ("size", "solver"),
    [(2, "full"), (2, "condensed"), (3, "full"), (3, "condensed"), (3, "iterative")],
)
@pytest.mark.parametrize("by_area", [False, True])
def test_a_pulled_bar_on_springs_moves_as_springs_in_series(size, solver, by_area):
    """Its tip moves F/k + F L/(E A), and its support carries −F."""
    scene, area = bar(size, by_area, solver=SolverSettings(solver=solver))
    found = run(scene, COMM, body(size))
    assert found.passed, found.verdict
    series = 1 / K + LENGTH / (E * area)
    tip = found.quantities["displacement_tip"][0]
    assert tip == pytest.approx(FORCE * series, rel=1e-10)
    held = next(row for row in found.supports if row.name == "x0")
    assert held.reaction[0] == pytest.approx(-FORCE, rel=1e-10)
    assert held.displacement[0] == pytest.approx(FORCE / K, rel=1e-10)
    assert found.quantities["strain_energy"] == pytest.approx(
        FORCE**2 * LENGTH / (2 * E * area), rel=1e-9
    )
    assert found.quantities["spring_energy"] == pytest.approx(FORCE**2 / (2 * K), rel=1e-9)
    assert found.quantities["external_work"] == pytest.approx(FORCE**2 * series, rel=1e-9)
    assert found.checks["equilibrium"].passed


@pytest.mark.parametrize("solver", ["full", "condensed"])
def test_a_foot_that_moves_pulls_a_bar_that_is_held(solver):
    """The far end is held: springs in series between the foot and it, over a path to and fro."""
    scene, area = bar(solver=SolverSettings(solver=solver), load=())
    support = (
        replace(scene.support[0], displacement={"x": 0.02}, path=Path((0, 1, 2), (0, 1, -0.5))),
        *scene.support[1:],
        Support("x1", {"x": 0}),
    )
    found = run(replace(scene, support=support, steps=Steps(times=(1.0, 2.0))), COMM, body())
    assert found.passed, found.verdict
    series = 1 / (1 / K + LENGTH / (E * area))
    for step, moved in zip(found.steps, (0.02, -0.01), strict=True):
        rows = {row.name: row.reaction[0] for row in step.supports}
        assert rows["x0"] == pytest.approx(series * moved, rel=1e-10)
        assert rows["x1"] == pytest.approx(-series * moved, rel=1e-10)
    whole = 0.5 * series * 0.01**2
    stored = found.quantities["strain_energy"] + found.quantities["spring_energy"]
    assert stored == pytest.approx(whole, rel=1e-9)
    # By the trapezoidal rule the work along straight parts of the path is exact.
    assert found.quantities["external_work"] == pytest.approx(whole, rel=1e-8)
    assert abs(found.quantities["energy_defect"]) < 1e-9 * whole


@pytest.mark.parametrize("solver", ["full", "condensed"])
@pytest.mark.parametrize("degree", [1, 2])
def test_a_block_on_springs_that_is_pressed_on_a_rigid_plane(solver, degree):
    """Springs above, a gap below: what is beyond the gap is shared by body and springs."""
    gap, moved = 0.01, -0.05
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, 0.0),
        discretisation=Discretisation(degree),
        support=(Support("y1", {"y": moved}, stiffness={"y": K}), Support("x0", {"x": 0})),
        contact=(Contact("y0", obstacle=Obstacle(gap=gap), penalty_parameter=GIVE),),
        solver=SolverSettings(solver=solver),
    )
    found = run(scene, COMM, body())
    assert found.passed, found.verdict
    series = 1 / (1 / K + HEIGHT / (E * LENGTH) + GIVE / LENGTH)
    force = series * (abs(moved) - gap)
    assert found.contacts[0].quantities["normal_force"] == pytest.approx(force, rel=1e-9)
    assert found.reactions["y1"].reaction[1] == pytest.approx(-force, rel=1e-9)
