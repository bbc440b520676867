"""All answers of contacts that are solved exactly: those that are enumerated by hand."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Obstacle, Scene, Support, run
from tests.messages import refused
from tests.scenes import box_body, with_solver
from tests.trust.test_critical_coefficient import (
    MODULUS,
    answers_by_hand,
    stiffness_of_its_node,
    triangle,
)


def lifted(coefficient, **solver):
    """A triangle of which one node can touch, dragged along the floor and lifted."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(MODULUS, 0.0),
        discretisation=Discretisation(1),
        support=(Support("side", {"x": 0.008, "y": 0.001}),),
        contact=(Contact("floor", obstacle=Obstacle(), friction_coefficient=coefficient),),
    )
    return run(
        with_solver(scene, strategy="exact", errors="none", **solver),
        MPI.COMM_SELF,
        triangle(1.0),
    )


def block(smoothing, **solver):
    """The lifted block (specification, Section 5)."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.02, "y": 0.001}),),
        contact=(Contact("y0", friction_coefficient=2, regularisation_parameter=smoothing),),
    )
    return run(with_solver(scene, errors="none", **solver), body=box_body((16, 8), (2, 1)))


@pytest.mark.parametrize("key", ["all_answers", "branches"])
@pytest.mark.parametrize(("coefficient", "count"), [(2.9, 1), (5.0, 3)])
def test_answers_of_a_single_node_are_those_by_hand(coefficient, count, key):
    wanted = answers_by_hand(stiffness_of_its_node(1.0, 0.0), (0.008, 0.001), coefficient)
    assert len(wanted) == count
    result = lifted(coefficient, **{key: True})
    found = sorted(
        (branch["quantities"]["friction_force"][0], branch["quantities"]["normal_force"])
        for branch in result.branches
    )
    assert np.allclose(found, wanted, rtol=1e-9, atol=1e-12)
    assert all(branch["passed"] for branch in result.branches)
    said = "3 were found" if count == 3 else "It is the only answer"
    assert said in result.verdict
    assert "there may be others" not in result.verdict


def test_the_answer_of_the_run_is_there_again():
    """Quantities of the first of three are those of a run that does not ask for others."""
    with_others, alone = lifted(5.0, all_answers=True), lifted(5.0)
    assert with_others.quantities == alone.quantities
    assert "answer" not in alone.verdict.replace("a single answer", "")
    assert alone.branches == []


def test_a_lifted_block_has_three_answers():
    """Those that are found with small parameters from other starts, too."""
    exact = block(0, strategy="exact", all_answers=True)
    smooth = block(1e-6, branches=True)
    assert "from 24 starts; there may be others" in exact.verdict
    assert len(exact.branches) == len(smooth.branches) == 3
    forces = (
        sorted(branch["quantities"]["normal_force"] for branch in result.branches)
        for result in (exact, smooth)
    )
    assert np.allclose(*forces, rtol=2e-3, atol=1e-12)


def test_other_contacts_have_no_such_search():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0, "y": 0}),),
    )
    with refused("all_answers_of_smoothed_contacts"):
        with_solver(scene, all_answers=True)
