"""Gaps, slips, areas and turning forces of current places, by formulas and by Taylor's test."""

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Material,
    Obstacle,
    ObstacleRotation,
    Run,
    Scene,
    Support,
)
from fenics_contact.analytic.obstacle_shapes import Sizes, shape_of
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.solve.finite.contact_passes import ContactPasses
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from tests.scenes import box_body

PLANE = Obstacle(shape="plane", position=(0.1, 1.2), normal=(0.3, -1))
PARABOLA = Obstacle(
    shape="parabola",
    radius=0.5,
    position=(0.5, 1.05),
    normal=(0.1, -1),
    rotation=ObstacleRotation(angle=0.4, at=(0.3, 1.5)),
    displacement=(0.1, -0.05),
)
ROLLER = Obstacle(shape="cylinder", radius=0.7, position=(0.4, 1.1), normal=(0.2, -1))


def block(obstacle):
    scene = Scene(
        kinematics="plane strain",
        strains="finite",
        material=Material(1, 0.3, law="neo-Hookean"),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle),),
    )
    return Run(scene, body=box_body((4, 2))).problem


@pytest.fixture(scope="module")
def on_plane():
    return block(PLANE)


@pytest.fixture(scope="module")
def on_roller():
    return block(ROLLER)


@pytest.fixture(scope="module")
def on_parabola():
    return block(PARABOLA)


@pytest.fixture(params=["on_plane", "on_roller", "on_parabola"])
def problem(request):
    return request.getfixturevalue(request.param)


def fields(problem):
    """A displacement of a tenth of the block, and a way for it to change."""
    x, y, _ = problem.spaces.coordinates.T
    return (
        np.stack([0.1 * np.sin(2 * x) * y, 0.1 * x * y], axis=1),
        np.stack([np.cos(3 * x) * y, np.sin(2 * x) * y], axis=1),
    )


def orders(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def measured(contact: ContactSurface, displacement):
    """Current places, gaps and slips of this rank's points."""
    contact.measure(displacement)
    kinematics = contact.kinematics
    jump = kinematics.jump_at_points()
    normals = contact.trace.normals
    slip = normals[:, 1] * jump[:, 0] - normals[:, 0] * jump[:, 1]
    return kinematics.places.copy(), -kinematics.normal(jump), slip


def test_gap_and_slip_of_a_plane_are_those_of_places(on_plane):
    u, _ = fields(on_plane)
    contact = on_plane.contacts[0]
    first, _, _ = measured(contact, 0 * u)
    places, gap, slip = measured(contact, u)
    normal = np.array([0.3, -1]) / np.hypot(0.3, 1)
    assert np.allclose(gap, (places - [0.1, 1.2]) @ normal, atol=1e-14)
    assert np.allclose(slip, (places - first) @ [1, 0.3] / np.hypot(0.3, 1), atol=1e-14)


def test_gap_and_slip_of_a_cylinder_are_radius_and_arc(on_roller):
    u, _ = fields(on_roller)
    contact = on_roller.contacts[0]
    centre = np.array([0.4, 1.1]) - 0.7 * np.array([0.2, -1]) / np.hypot(0.2, 1)
    first, _, _ = measured(contact, 0 * u)
    places, gap, slip = measured(contact, u)
    assert np.allclose(gap, np.linalg.norm(places - centre, axis=1) - 0.7, atol=1e-14)
    before, now = first - centre, places - centre
    cross = before[:, 0] * now[:, 1] - before[:, 1] * now[:, 0]
    angle = np.arctan2(cross, np.einsum("ij,ij->i", before, now))
    assert np.allclose(slip, 0.7 * angle, atol=1e-14)


def test_gap_and_slip_of_a_parabola_are_the_least_distance_and_the_length_of_its_line(on_parabola):
    """That moved aside and turned; by brute force among many of its points."""
    contact = on_parabola.contacts[0]
    u, _ = fields(on_parabola)
    first, _, _ = measured(contact, 0 * u)
    places, gap, slip = measured(contact, u)
    normal = np.array([0.1, -1]) / np.hypot(0.1, 1)
    along = np.linspace(-4, 4, 400_001)
    line = np.array([0.5, 1.05]) + np.outer(along, [-normal[1], normal[0]])
    line -= np.outer(along**2 / (2 * 0.5), normal)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    moved = [0.3, 1.5] + (line - [0.3, 1.5]) @ turn.T + [0.1, -0.05]

    def nearest(places, on):
        away = [np.linalg.norm(on - place, axis=1) for place in places]
        feet = np.array([one.argmin() for one in away], dtype=np.int64)
        return np.array([one.min() for one in away]), length[feet]

    distance, foot = nearest(places, moved)
    _, before = nearest(first, line)
    assert np.allclose(np.abs(gap), distance, atol=1e-9)
    assert np.allclose(slip, foot - before, atol=3e-5)


def test_slip_goes_on_around_a_cylinder():
    """A way of more than half of its circumference, in three load steps."""
    shape, sizes = shape_of("cylinder"), Sizes(np.array([0.0, 1, 0]), 2.0, 0.0)
    angles = np.array([0.0, 2.0, 4.0, 6.0])
    offsets = 3 * np.stack([-np.sin(angles), np.cos(angles)], axis=1) - [0, 2]
    arcs = shape.nearest(offsets, sizes).arc
    period = shape.period(sizes)
    slips = [0.0]
    for arc in arcs[1:]:
        slips.append(arc - period * np.round((arc - slips[-1]) / period))
    assert np.allclose(slips, 2 * angles)


def test_points_stand_for_current_lengths(problem):
    contact = problem.contacts[0]
    stretched = np.stack(
        [0.5 * problem.spaces.coordinates[:, 0], 0 * problem.spaces.coordinates[:, 0]], axis=1
    )
    contact.measure(0 * stretched)
    assert abs(contact.trace.integral(np.ones(len(contact.trace.weights))) - 1) < 1e-14
    contact.measure(stretched)
    assert abs(contact.trace.integral(np.ones(len(contact.trace.weights))) - 1.5) < 1e-14


def geometry_at(problem, displacement):
    passes = ContactPasses(
        problem,
        ContactDofs(problem.spaces, problem.constrained, [problem.contacts[0].sides]),
    )
    return passes._measure(displacement, np.zeros(len(passes._dofs.free))), passes._dofs


def test_gaps_and_slips_change_by_their_rows(problem):
    """To second order in the change; of a plane exactly."""
    u, v = fields(problem)
    at, dofs = geometry_at(problem, u)
    way = dofs.gathered(v.reshape(-1))[dofs.is_free]
    sizes = (0.02, 0.01, 0.005)
    errors = [
        np.abs(geometry_at(problem, u + h * v)[0].openings - at.openings - h * at.moves @ way).max()
        for h in sizes
    ]
    if problem.contacts[0].contact.obstacle is PLANE:
        assert max(errors) < 1e-14
    else:
        assert np.all(np.abs(orders(errors) - 2) < 0.1)


def test_forces_turn_with_the_obstacle(problem):
    """Forces that keep their size along and across an obstacle, on points that move along it."""
    u, v = fields(problem)
    at, dofs = geometry_at(problem, u)
    way = dofs.gathered(v.reshape(-1))[dofs.is_free]
    forces = np.sin(np.arange(len(at.openings)))
    expected = at.turning(forces) @ way
    errors = [
        np.abs((geometry_at(problem, u + h * v)[0].rows - at.rows).T @ forces - h * expected).max()
        for h in (0.02, 0.01, 0.005)
    ]
    if problem.contacts[0].contact.obstacle is PLANE:
        assert max(errors) < 1e-14
    else:
        assert np.all(np.abs(orders(errors) - 2) < 0.1)
