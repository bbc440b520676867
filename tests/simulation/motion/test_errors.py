"""Error bars of motions: they hold against formulas, and a wrong body is beyond them."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import Discretisation, Material, Motion, Run, Scene, SolverSettings, Support
from fenics_contact.common.errors import MachineError
from fenics_contact.simulation.motion_errors import MotionErrors
from fenics_contact.verification.boxes import Box, quarter_rings
from fenics_contact.verification.published.impacts import bar_on_wall
from fenics_contact.verification.published.sliding import LARGEST_FRICTION, oscillator

pytestmark = pytest.mark.errors


def solved(scene, body, errors="all"):
    scene = dataclasses.replace(scene, solver=SolverSettings(errors=errors))
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    return found


def bar_of(found, name):
    return found.errors[name]["total"]


@pytest.mark.parametrize("courant", [1.0, 0.5])
def test_of_the_impulse_of_a_bar_on_a_wall(courant):
    """It leaves as fast as it came: 2 m v."""
    cells = 12
    exact = 2 * 0.01 / cells
    found = solved(*bar_on_wall(cells, courant))
    error = abs(found.quantities["impulse"][0] - exact)
    assert error < bar_of(found, "impulse") < 0.1 * exact
    assert found.contacts[0].errors["impulse"] == found.errors["impulse"]
    row = found.errors["impulse"]
    assert row["mesh"] > 0 and row["step"] > 0 and row["regularisation"] == 0
    scene, body = bar_on_wall(cells, courant)
    heavier = dataclasses.replace(scene.material[0], density=1.15)
    wrong = solved(dataclasses.replace(scene, material=(heavier,)), body, "none")
    assert abs(wrong.quantities["impulse"][0] - exact) > bar_of(found, "impulse")


def test_of_where_a_mass_comes_to_rest():
    """It turns 2 μ N/k nearer, and there, at .3, it stays."""
    exact, found = -0.3 * LARGEST_FRICTION, solved(*oscillator(25, 1.1, 2.3))
    bar = found.errors["displacement_mass"]["step"]  # of a single cell, which is the model
    assert abs(found.quantities["displacement_mass"][0] - exact) < bar < 0.1 * abs(exact)
    other = solved(*oscillator(25, 1.1, 2.4), "none")
    assert abs(other.quantities["displacement_mass"][0] - exact) > bar


def test_of_the_momentum_of_a_round_body():
    """Its mass is that between circles, which is not that of the mesh."""
    body = quarter_rings([Box("ring", (1.0, 0.0), (2.0, 1.0), (3, 4))], order=1)
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1.0, 0.3, density=1.0),),
        discretisation=Discretisation(1),
        support=(Support("ring", {"y": 0}),),
        motion=Motion(step=0.05, end=0.1, velocity={"ring": (1.0, 0.0)}),
    )
    found = solved(scene, body)
    error = abs(found.quantities["momentum"][0] - 0.75 * np.pi)
    assert 0.01 < error < bar_of(found, "momentum") < 4 * error


def test_what_cannot_be_had_or_is_not_asked_for_has_no_bar():
    body = quarter_rings([Box("ring", (1.0, 0.0), (2.0, 1.0), (2, 2))])
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1.0, 0.3, density=1.0),),
        motion=Motion(step=0.05, end=0.1, velocity={"ring": (1.0, 0.0)}),
    )
    answer = solved(scene, body)
    row = answer.errors["momentum"]
    assert row["mesh"] is None and row["total"] is None and row["step"] is not None
    assert "by the mesh was not estimated: cells with curved sides" in answer.error_notes[0]
    found = solved(scene, body, "auto")
    assert not found.errors and 'solver.errors = "all"' in found.error_notes[0]


def test_a_motion_that_cannot_be_solved_with_less_of_an_error_keeps_its_answer():
    """Of the most steps that there may be half as long ones are too many."""
    scene, body = bar_on_wall(2, 1.0)
    motion = Motion(step=1e-5, end=1e-3, velocity={"bar": (-0.01, 0.0)})
    scene = dataclasses.replace(scene, motion=motion)
    found = solved(scene, body, "none")
    too_many = dataclasses.replace(scene, motion=dataclasses.replace(motion, step=1e-3 / 100_000))

    def again(other, mesh):
        raise MachineError("it will not fit into the memory")

    parts = too_many, Run(scene, body=body).problem.spaces, found.contacts, found.steps[-1]
    budget = MotionErrors(*parts, again).budget()
    row = budget.quantities["momentum"]
    assert row["step"] is None and row["mesh"] is None and row["iteration"] is None
    said = " ".join(budget.notes)
    assert "end / step must be at most 100000" in said and "not fit into the memory" in said
