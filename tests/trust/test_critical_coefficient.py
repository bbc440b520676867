"""Several answers of Coulomb's friction: the coefficient they begin at, and finding them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    Load,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.results.records.steps import BranchRecord
from fenics_contact.trust.uniqueness import OtherAnswers
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
MODULUS = 1000.0


def triangle(lean):
    """One triangle on the floor y = 0, held along the side from (0, 0) to (lean, 1), on each rank.

    Its node (1, 0) is the only contact point that can move.
    """
    points = np.array([[0, 0], [1, 0], [lean, 1]], dtype=float)
    made = compat.create_mesh(MPI.COMM_SELF, "triangle", 1, points, np.array([[0, 1, 2]]))
    floor = mesh.locate_entities_boundary(made, 1, lambda x: np.isclose(x[1], 0))
    side = mesh.locate_entities_boundary(made, 1, lambda x: np.isclose(x[0], lean * x[1]))
    facets = np.concatenate([floor, side])
    order = np.argsort(facets)
    values = np.array([1, 2], dtype=np.int32)[order]
    facet_tags = mesh.meshtags(made, 1, facets[order], values)
    cell_tags = mesh.meshtags(made, 2, np.zeros(1, np.int32), np.ones(1, np.int32))
    groups = {"floor": Group(1, (1,)), "side": Group(1, (2,)), "body": Group(2, (1,))}
    return Body(made, cell_tags, facet_tags, groups, "a triangle")


def stiffness_of_its_node(lean, poisson):
    """K of the free node by hand: its shape function is x − lean y, the area 1/2."""
    shear = MODULUS / 2 / (1 + poisson)
    first = MODULUS * poisson / (1 + poisson) / (1 - 2 * poisson)
    stiff = first + 2 * shear
    coupled = -(first + shear) * lean
    return 0.5 * np.array([[stiff + shear * lean**2, coupled], [coupled, stiff * lean**2 + shear]])


def answers_by_hand(stiffness, moved, coefficient):
    """All forces (T, N) of the floor on the node where the support has moved it by ``moved``."""
    compliance = np.linalg.inv(stiffness)
    found = [(0.0, 0.0)] if moved[1] >= 0 else []
    along, across = -stiffness @ moved
    if across >= 0 and abs(along) <= coefficient * across:
        found.append((along, across))
    for sign in (1.0, -1.0):
        ray = np.array([-sign * coefficient, 1.0])  # of forces where it slips this way
        across = -moved[1] / (compliance @ ray)[1]
        if across > 0 and sign * (moved + compliance @ ray * across)[0] > 0:
            found.append((-sign * coefficient * across, across))
    return sorted(found)


def lifted(lean, poisson, coefficient, **solver):
    scene = Scene(
        kinematics="plane strain",
        material=Material(MODULUS, poisson),
        discretisation=Discretisation(1),
        support=(Support("side", {"x": 0.008, "y": 0.001}),),
        contact=(
            Contact(
                "floor",
                obstacle=Obstacle(),
                friction_coefficient=coefficient,
                penalty_parameter=1e-9,
                regularisation_parameter=1e-11,
            ),
        ),
        solver=SolverSettings(**solver),
    )
    return run(scene, MPI.COMM_SELF, triangle(lean))


@pytest.mark.parametrize(("lean", "poisson"), [(1.0, 0.0), (0.5, 0.3)])
def test_limit_of_a_single_node_is_that_by_hand(lean, poisson):
    """One answer as long as N moves the node up more than μ N along moves it down."""
    stiffness = stiffness_of_its_node(lean, poisson)
    compliance = np.linalg.inv(stiffness)
    limit = compliance[1, 1] / abs(compliance[1, 0])
    result = lifted(lean, poisson, 0.5)
    assert result.contacts[0]["uniqueness_limit"] == pytest.approx(limit, rel=1e-6)
    if (lean, poisson) == (1.0, 0.0):
        assert limit == pytest.approx(3)


@pytest.mark.parametrize(("coefficient", "count"), [(0.5, 1), (2.9, 1), (3.2, 1), (5.0, 3)])
def test_all_answers_of_a_single_node_are_found(coefficient, count):
    """Apart, stuck and slipping, as enumerated by hand."""
    wanted = answers_by_hand(stiffness_of_its_node(1.0, 0.0), (0.008, 0.001), coefficient)
    assert len(wanted) == count
    result = lifted(1.0, 0.0, coefficient, branches=True)
    found = sorted(
        (branch["quantities"]["friction_force"][0], branch["quantities"]["normal_force"])
        for branch in result.branches
    )
    assert np.allclose(found, wanted, rtol=1e-5, atol=1e-9)
    assert all(branch["passed"] for branch in result.branches)
    assert ("not the only answer" in result.verdict) == (len(wanted) > 1)
    assert result.branches[0]["quantities"] == {
        key: value
        for key, value in result.quantities.items()
        if key in result.branches[0]["quantities"]
    }


def block(coefficient, cells=(16, 8), **solver):
    """The lifted block (specification, Section 5)."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.02, "y": 0.001}),),
        contact=(Contact("y0", friction_coefficient=coefficient, regularisation_parameter=1e-6),),
        solver=SolverSettings(**solver),
    )
    return run(scene, COMM, box_body(cells, (2, 1)))


@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_lifted_block_has_three_answers_from_some_coefficient_on(solver):
    """Separated, slipping and sticking at μ = 2, only the first at 1 (specification, Section 5)."""
    few, many = (block(mu, solver=solver, branches=True) for mu in (1.0, 2.0))
    assert [branch["quantities"]["normal_force"] for branch in few.branches] == [0.0]
    assert "answer" not in few.verdict
    apart, *touching_ones = many.branches
    assert apart["quantities"]["normal_force"] == 0
    areas = [
        (b["quantities"]["stick_area"] > 0, b["quantities"]["slip_area"] > 0) for b in touching_ones
    ]
    assert sorted(areas) == [(False, True), (True, False)]
    assert all(branch["passed"] for branch in many.branches)
    for branch in touching_ones:
        along, normal = (
            branch["quantities"]["friction_force"][0],
            branch["quantities"]["normal_force"],
        )
        assert abs(along) <= 2 * normal * (1 + 1e-9)
        if branch["quantities"]["slip_area"] > 0:
            assert abs(along) == pytest.approx(2 * normal, rel=1e-9)
    assert "3 were found" in many.verdict
    assert many.quantities["normal_force"] == 0  # the answer reported is still the first


def test_coefficient_beyond_the_limit_is_warned_of():
    limits = [block(0.5, cells).contacts[0]["uniqueness_limit"] for cells in ((16, 8), (32, 16))]
    assert 1 < limits[0] < 2
    assert limits[1] == pytest.approx(limits[0], rel=0.02)
    assert "there may be others" not in block(0.99 * limits[0]).verdict
    beyond = block(1.01 * limits[0])
    assert "there may be others; solver.branches looks for them" in beyond.verdict
    assert "none was found from other starts" in block(1.01 * limits[0], branches=True).verdict


def test_bodies_that_mirror_each_other_have_no_limit():
    """Pressure moves both sides alike along the surface, so that nothing slips by it."""
    upper = Box("upper", (0, 0), (1, 1), (4, 3))
    support = Support("upper.y1", {"x": 0.002, "y": -0.01})
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(support, Support("lower.y0", {"x": 0, "y": 0})),
        contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=0.3),),
    )
    pair = run(scene, COMM, boxes((Box("lower", (0, -1), (1, 0), (4, 3)), upper)))
    assert "uniqueness_limit" not in pair.contacts[0]
    obstacle = Contact("upper.y0", obstacle=Obstacle(), friction_coefficient=0.3)
    alone = dataclasses.replace(scene, support=(support,), contact=(obstacle,))
    assert 1 < run(alone, COMM, boxes((upper,))).contacts[0]["uniqueness_limit"] < 3


def test_answers_of_the_last_load_step_are_those_after_the_steps_before():
    """The incremental law counts slip from the step before, whatever was tried in between."""
    steps = dataclasses.replace(Scene(kinematics="3D", material=Material(1, 0)).steps, number=2)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.02, "y": -0.001}),),
        contact=(Contact("y0", friction_coefficient=0.5, law="incremental"),),
        steps=steps,
    )
    body = box_body((16, 8), (2, 1))
    plain = run(scene, COMM, body)
    looked = run(dataclasses.replace(scene, solver=SolverSettings(branches=True)), COMM, body)
    assert len(looked.branches) == 1
    assert looked.quantities == plain.quantities
    assert (looked.points.status == plain.points.status).all()


def test_a_cylinder_along_a_plane_of_symmetry_has_its_limit_whatever_its_axis():
    """It touches where nothing can slip one of the ways, which moves nothing across."""
    limits = []
    for axis, cells, along in (("x", (4, 3, 2), (0, 1, 0)), ("y", (3, 4, 2), (1, 0, 0))):
        obstacle = Obstacle("cylinder", radius=5, position=(0, 0, 1), along=along, indentation=2e-3)
        scene = Scene(
            kinematics="3D",
            material=Material(1000, 0.3),
            discretisation=Discretisation(1),
            support=(Support(f"{axis}0", {axis: 0}), Support("z0", {"x": 0, "y": 0, "z": 0})),
            contact=(Contact("z1", obstacle=obstacle, friction_coefficient=0.3),),
        )
        result = run(scene, COMM, box_body(cells, (1, 1, 1)))
        limits.append(result.contacts[0]["uniqueness_limit"])
    assert limits[0] == pytest.approx(limits[1], rel=1e-6)


def test_an_answer_that_fails_a_check_is_none():
    branches = [
        BranchRecord(start=start, newton_iterations=1, passed=start != "apart", quantities={})
        for start in ("as solved", "apart")
    ]
    assert OtherAnswers(branches=branches).words() == ""
    limits = {"pad": (1.0, 2.0)}
    assert "none was found from other starts" in OtherAnswers(limits, branches).words()
    branches.append(dataclasses.replace(branches[0], start="all sticks"))
    assert (
        "2 were found, the others from the starts 'all sticks';"
        in OtherAnswers(limits, branches).words()
    )


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_start_that_runs_away_is_passed_over_in_silence():
    """A block on another one, held by contact alone, set apart from it."""
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000, 0.3, on="upper"), Material(300, 0.2, on="lower")),
        support=(Support("lower.y0", {"x": 0, "y": 0}),),
        load=(Load("upper.y1", traction=(0.2, -1)),),
        contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=0.5),),
        solver=SolverSettings(branches=True),
    )
    lower = Box("lower", (0, -1), (1, 0), (6, 5))
    result = run(scene, COMM, boxes((lower, Box("upper", (0.1, 0), (0.9, 1), (4, 3)))))
    assert result.passed, result.verdict
    assert len(result.branches) == 1
