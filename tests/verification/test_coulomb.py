"""Coulomb friction: three ways to one answer, the law point by point, energy along a path."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Obstacle, Run, Scene, SolverSettings, Support, run
from fenics_contact.scene.scene import Steps
from fenics_contact.verification.published.friction import with_friction
from fenics_contact.verification.published.indenters import half_space_scene
from tests.common.test_parallel import assert_same
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
STRATEGIES = {
    "campos": "the paper's alternation of friction and contact",
    "lagged": "contact and friction with the bound of the last pass",
    "monolithic": "Newton's method on contact and friction together",
}
MESH = {"fine": 4, "size": 0.5, "extent": 60, "cells_outside": 10}


def sphere(coefficient=0.6, law="static", steps=1, strategy="auto", **keys):
    """A paraboloid of radius 8 pressed 1 deep into a half-space, as in the paper's example 3."""
    obstacle = Obstacle("paraboloid", radius=8, indentation=1, **keys)
    scene = with_friction(half_space_scene(obstacle, **MESH), coefficient, law)
    return dataclasses.replace(scene, steps=Steps(steps), solver=SolverSettings(strategy=strategy))


def sheared(strategy="auto", law="static", steps=1):
    """A parabola pressed into a block and pushed sideways."""
    obstacle = Obstacle(
        "parabola", radius=2, position=(1, 1), indentation=0.03, displacement=(0.006, 0)
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle),),
        steps=Steps(steps),
        solver=SolverSettings(strategy=strategy),
    )
    return with_friction(scene, 0.5, law)


def block(comm=COMM):
    return box_body((32, 16), (2, 1), comm=comm)


def in_partial_slip(result):
    """Converged and checked, with points that stick and points that slip."""
    return result.passed and {"STICK", "SLIP"} <= set(result.points.status)


def require_law(result, coefficient, tolerance=1e-8):
    """Traction within the cone, on it and against the slip where points slip.

    Args:
        tolerance: Over the peak pressure.
    """
    points = result.points
    allowed = tolerance * points.contact_pressure.max()
    bound = coefficient * points.contact_pressure
    size = np.linalg.norm(points.friction_traction, axis=1)
    assert (size - bound).max() <= allowed
    slips = points.status == "SLIP"
    slip = points.slip[slips]
    expected = -bound[slips, None] * slip / np.linalg.norm(slip, axis=1)[:, None]
    assert np.abs(points.friction_traction[slips] - expected).max() <= allowed
    assert (np.einsum("ij,ij->i", points.friction_traction, points.slip) <= 1e-12).all()


@pytest.mark.parametrize(("scene", "body"), [(sphere, None), (sheared, block)])
def test_three_ways_to_one_answer(scene, body):
    results = [run(scene(strategy=way), COMM, body and body()) for way in STRATEGIES]
    peak = results[0].quantities["max_contact_pressure"]
    for result, words in zip(results, STRATEGIES.values(), strict=True):
        assert in_partial_slip(result), result.verdict
        assert words in result.model["strategy"]
        for name in ("contact_pressure", "friction_traction"):
            difference = getattr(result.points, name) - getattr(results[0].points, name)
            assert np.abs(difference).max() <= 1e-6 * peak
    assert results[2].steps[0]["outer_iterations"] == 0


@pytest.mark.parametrize("way", STRATEGIES)
def test_friction_law_at_every_point(way):
    require_law(run(sphere(strategy=way)), 0.6)
    require_law(run(sheared(way), COMM, block()), 0.5)


@pytest.mark.parametrize(("coefficient", "lagged"), [(0.3, 7), (0.6, 8), (2, 12)])
def test_counts_on_the_sphere(coefficient, lagged):
    """Those of the specification's table, without its acceleration; the paper needs 10 passes."""
    steps = {}
    for way in STRATEGIES:
        scene = with_solver(sphere(coefficient, strategy=way), outer_tolerance=1e-6)
        contact = dataclasses.replace(scene.contact[0], regularisation_parameter=1e-6)
        result = run(dataclasses.replace(scene, contact=(contact,)))
        assert result.passed, result.verdict
        steps[way] = result.steps[0]
    assert 2 < steps["campos"]["outer_iterations"] <= 12
    assert 2 < steps["lagged"]["outer_iterations"] <= lagged
    assert steps["monolithic"]["newton_iterations"] <= 10


def test_first_of_all_ways_is_the_papers():
    result = run(sphere())
    assert STRATEGIES["campos"] in result.model["strategy"]
    assert "accelerated" in result.model["strategy"]


@pytest.mark.parametrize("coefficient", [0.3, 0.6, 2.0])
def test_newton_steps_do_not_grow_with_smaller_regularisation(coefficient):
    """From the adhesive start at most ten, whatever ε between 1e-3 and 1e-8 of the slip."""
    scene = sphere(coefficient, strategy="monolithic")
    slip = run(scene).quantities["max_slip"]
    counts = []
    for exponent in range(3, 9):
        epsilon = slip * 10.0**-exponent
        contact = dataclasses.replace(scene.contact[0], regularisation_parameter=epsilon)
        result = run(dataclasses.replace(scene, contact=(contact,)))
        assert result.passed
        counts.append(result.steps[0]["newton_iterations"])
    assert max(counts) <= 10


def test_no_coefficient_is_no_friction():
    without, frictionless = (
        run(sphere(0.0)),
        run(half_space_scene(Obstacle("paraboloid", radius=8, indentation=1), **MESH)),
    )
    assert without.model["terms"] == frictionless.model["terms"]
    for key, value in frictionless.quantities.items():
        assert without.quantities[key] == pytest.approx(value, rel=1e-12, abs=1e-12), key


def test_one_step_of_the_incremental_law_is_the_static_law():
    for scene, body in ((sphere, None), (sheared, block)):
        static, incremental = (
            run(scene(law=law), COMM, body and body()) for law in ("static", "incremental")
        )
        for key, value in static.quantities.items():
            assert incremental.quantities[key] == pytest.approx(value, rel=1e-9, abs=1e-9), key


@pytest.mark.parametrize(("scene", "body"), [(sphere, None), (sheared, block)])
def test_only_the_incremental_law_has_a_memory(scene, body):
    """Five steps: the static law forgets them, the other does not.

    ε is given: the automatic one follows from the pressure of the first step.
    """

    def solved(law, steps):
        made = scene(law=law, steps=steps, strategy="monolithic")
        contact = dataclasses.replace(made.contact[0], regularisation_parameter=1e-6)
        return run(dataclasses.replace(made, contact=(contact,)), COMM, body and body())

    at_once, in_steps, remembered = (
        solved("static", 1),
        solved("static", 5),
        solved("incremental", 5),
    )
    peak = at_once.quantities["max_contact_pressure"]
    for name in ("contact_pressure", "friction_traction"):
        first, second = getattr(at_once.points, name), getattr(in_steps.points, name)
        assert np.abs(first - second).max() <= 1e-8 * peak
    difference = remembered.points.friction_traction - at_once.points.friction_traction
    assert np.abs(difference).max() > 1e-2 * peak


@pytest.mark.parametrize("law", ["static", "incremental"])
def test_friction_takes_work_and_gives_none_back(law):
    for result in (
        run(sphere(law=law, steps=6)),
        run(sheared(law=law, steps=6), COMM, block()),
    ):
        assert result.passed
        work = [step["quantities"]["friction_work"] for step in result.steps]
        assert work[0] > 0
        assert (np.diff(work) > 0).all()


def test_work_of_the_final_forces_is_twice_the_energies():
    """Virtual work with the solution itself, on a flat obstacle: no gap takes part."""
    obstacle = Obstacle(indentation=0.02, displacement=(0.012, 0))
    scene = dataclasses.replace(sheared(), contact=(Contact("y1", obstacle=obstacle),))
    result = run(with_friction(scene, 0.3), COMM, block())
    assert in_partial_slip(result), result.verdict
    quantities = result.quantities
    energies = quantities["strain_energy"] + quantities["penalty_energy"]
    assert quantities["friction_work"] > 1e-3 * energies
    assert quantities["external_work"] == pytest.approx(
        2 * energies + quantities["friction_work"], rel=1e-6
    )


def test_block_dragged_obliquely():
    """Gross sliding: what the bulk and the supports feel is μ p along the obstacle's way."""
    coefficient, way = 0.3, np.array([3.0, 1.0, 0.0]) / np.sqrt(10)
    obstacle = Obstacle(indentation=0.01, displacement=tuple(30.0 * way))
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=obstacle, friction_coefficient=coefficient),),
    )
    prepared = Run(scene, COMM, box_body((4, 4, 2)))
    result = prepared.solve()
    assert result.passed
    assert result.quantities["stick_area"] == 0
    reaction = np.array(result.quantities["reaction"])
    along = np.hypot(*reaction[:2])
    assert along == pytest.approx(coefficient * result.quantities["normal_force"], rel=1e-6)
    assert reaction[:2] / along == pytest.approx(-way[:2], abs=1e-3)
    contact, solution = prepared.problem.contacts[0], prepared.solution
    traction = solution.internal_force[contact.nodes, :2] / contact.trace.weights[:, None]
    slip = solution.states[0].slip[:, :2]
    bound = coefficient * solution.states[0].contact_pressure
    expected = -bound[:, None] * slip / np.linalg.norm(slip, axis=1)[:, None]
    mine = contact.owned_nodes
    assert np.abs(traction - expected)[mine].max(initial=0) <= 1e-6 * bound.max(initial=1)


@pytest.mark.parametrize("law", ["static", "incremental"])
@pytest.mark.parametrize("way", STRATEGIES)
def test_sheared_block_alone_and_together(way, law):
    scene = sheared(way, law, steps=2)
    assert_same(run(scene, MPI.COMM_SELF, block(MPI.COMM_SELF)), run(scene, COMM, block()))


def test_sphere_alone_and_together():
    scene = sphere(law="incremental", steps=2)
    assert_same(run(scene, MPI.COMM_SELF), run(scene, COMM))
