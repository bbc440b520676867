"""What meets a surface between its points is seen, refused, or told to be missed."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Obstacle,
    Run,
    Scene,
    Support,
    run,
)
from fenics_contact.contact.between_points import TooCoarseError
from fenics_contact.scene.values import Profile
from fenics_contact.trust.convergence import unseen
from fenics_contact.trust.convergence.coarse_contacts import hidden_obstacles
from fenics_contact.trust.convergence.unseen import LARGEST_UNSEEN
from fenics_contact.trust.error_estimates.mesh import singular_places
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body, with_solver
from tests.trust.convergence.blocks import GEOMETRY, pressed

COMM = MPI.COMM_WORLD
CELLS = 10
# Between two of the eleven nodes.
BETWEEN = 0.55


def square():
    return box_body((CELLS, CELLS), (1, 1))


@pytest.mark.errors
def test_an_obstacle_between_two_points_fails_a_check_and_has_no_bars():
    """It sinks in by all of its way, and nothing pushes back."""
    parabola = Obstacle("parabola", radius=2, position=(BETWEEN, 1), indentation=0.0006)
    found = run(pressed(parabola), COMM, square())
    check = found.checks["unseen_contact"]
    assert check.value == pytest.approx(1.0) and check.place[0] == pytest.approx(BETWEEN)
    assert found.exit_code == 4 and "unseen contact" in found.verdict
    assert all(row["total"] is None for row in found.errors.values())
    assert "not seen" in " ".join(found.error_notes)


def test_at_a_point_the_same_obstacle_is_seen():
    parabola = Obstacle("parabola", radius=2, position=(0.5, 1), indentation=0.0006)
    found = run(pressed(parabola), COMM, square())
    assert found.checks["unseen_contact"].value < LARGEST_UNSEEN and found.exit_code == 0


@pytest.mark.parametrize(("radius", "is_seen"), [(0.02, False), (200.0, True)])
def test_a_force_brings_an_obstacle_up_to_where_it_first_touches(radius, is_seen):
    """The apex touches, at a height of 0, not the circle's height over the next node, h²/8R."""
    driven = Obstacle("parabola", radius=radius, position=(BETWEEN, 1.01), force=0.05)
    prepared = Run(pressed(driven), COMM, square())
    brought_up = prepared.problem.contacts[0].kinematics.brought_up
    assert brought_up == pytest.approx(0.01, rel=1e-6)
    assert (len(hidden_obstacles(prepared.problem)) == 0) == is_seen
    if not is_seen:
        assert prepared.solve().exit_code == 4


@pytest.mark.parametrize("half_width", [0.04, 0.004])
def test_a_punch_between_two_points_is_refused_for_the_right_reason(half_width):
    punch = Obstacle("flat punch", radius=half_width, position=(BETWEEN, 1), indentation=0.01)
    with refused("obstacle_between_points", TooCoarseError):
        Run(pressed(punch), COMM, square())


def test_what_stands_beside_the_surface_is_refused_as_before():
    punch = Obstacle("flat punch", radius=0.1, position=(1.5, 1), normal=(0, -1), indentation=0.01)
    with refused("obstacle_misses_the_surface"):
        Run(pressed(punch), COMM, square())


def test_a_sphere_between_the_points_of_a_face():
    """Of a quarter of a cell: no ray from a node meets it."""
    sphere = Obstacle("sphere", radius=0.06, position=(0.625, 0.625, 1), indentation=0.01)
    with refused("obstacle_between_points_in_3d", TooCoarseError):
        Run(pressed(sphere, 3), COMM, box_body((4, 4, 4), (1, 1, 1)))


def test_a_bump_of_a_profile_is_seen_between_points():
    gap = Profile("x", (0.0, 0.53, 0.55, 0.57, 1.0), (0.01, 0.01, 0.0, 0.01, 0.01))
    found = run(pressed(Obstacle(gap=gap, indentation=0.005)), COMM, square())
    assert found.checks["unseen_contact"].value == pytest.approx(1.0)


def ridge_under_a_block(slave, push=0.002, beside=()):
    """A coarse block, pushed onto a narrow one with a rounded top between two of its nodes."""
    low = Box("low", (0.45, 0), (0.65, 1), (8, 8))
    body = boxes([low, Box("high", (0, 1.5), (1, 2.5), (4, 4)), *beside])
    places = body.mesh.geometry.x
    top, high = np.isclose(places[:, 1], 1) & (places[:, 0] < 1), places[:, 1] > 1.2
    places[top, 1] -= 2 * (places[top, 0] - BETWEEN) ** 2
    places[high, 1] -= 0.5
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(
            Support("low.y0", {"x": 0, "y": 0}),
            Support("high.y1", {"x": 0, "y": -push}),
        ),
        contact=(Contact("high.y0", against="low.y1", slave=slave),),
    )
    return scene, COMM, body


@pytest.mark.parametrize(("slave", "is_seen"), [("on", False), ("against", True)])
def test_a_body_whose_ridge_stands_between_nodes_of_the_other(slave, is_seen):
    """Points of the ridge meet the block; no node of the block meets the ridge."""
    found = run(*ridge_under_a_block(slave))
    assert (found.checks["unseen_contact"].value < LARGEST_UNSEEN) == is_seen
    assert found.exit_code == (0 if is_seen else 4)


@pytest.mark.errors
@pytest.mark.parametrize(("pressed", "code"), [(0.0, 4), (0.05, 0)])
def test_a_contact_that_carries_next_to_nothing_does_not_govern(pressed, code):
    """An apex stands .0005 deep between nodes .25 apart; a block beside it is pressed or not.

    The surface would carry at most E* d/h = 2 there, the block beside it carries 500.
    """
    beside = Box("other", (2, 0), (3, 1), (2, 2))
    scene, _, body = ridge_under_a_block("on", push=5e-4, beside=(beside,))
    plane = Obstacle("plane", position=(0, 1), normal=(0, -1), indentation=pressed)
    moduli = {"low": 1000, "high": 1000, "other": 10_000}
    scene = dataclasses.replace(
        scene,
        material=tuple(Material(e, 0.3, on=part) for part, e in moduli.items()),
        support=(*scene.support, Support("other.y0", {"x": 0, "y": 0})),
        contact=(*scene.contact, Contact("other.y1", obstacle=plane)),
    )
    found = run(scene, COMM, body)
    assert found.exit_code == code
    assert (found.checks["unseen_contact"].value < LARGEST_UNSEEN) == (code == 0)
    assert found.errors["max_contact_pressure"]["total"] is None


def test_planes_over_whole_faces_have_nothing_to_compare():
    plane = Obstacle("plane", position=(0, 1), normal=(0, -1), indentation=0.01)
    assert "unseen_contact" not in run(pressed(plane), COMM, square()).checks


def strip(cells, **solver):
    """Clamped at both ends, pressed down between two nodes by a cylinder."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0, "y": 0}), Support("x1", {"x": 0, "y": 0})),
        contact=(
            Contact(
                "y1",
                obstacle=Obstacle(
                    "cylinder", radius=0.2, position=(0.508, 0.025), indentation=0.005
                ),
            ),
        ),
    )
    return run(
        with_solver(scene, **solver), COMM, box_body(cells, (1, 0.025), CellType.quadrilateral)
    )


@pytest.mark.errors
def test_a_strip_that_bends_is_told_by_how_far_it_gives_way():
    """Its force on cells a ninth as long. The roller sinks in by more than what closes near by."""
    right = strip((279, 3), errors="none").quantities["normal_force"]
    found = strip((31, 1), errors="auto")
    assert found.exit_code == 0
    assert found.checks["unseen_contact"].value < LARGEST_UNSEEN
    total = found.errors["normal_force"]["total"]
    assert abs(found.quantities["normal_force"] - right) < total
    assert found.errors["max_contact_pressure"]["total"] is None


@pytest.mark.parametrize("raised", [0.0, 0.5])
def test_what_other_loads_move_does_not_count(raised):
    """Both nodes beside it touch; pushed in by the sag of the circle, it presses much harder."""
    place = (BETWEEN, 1 + raised)
    parabola = Obstacle("parabola", radius=0.5, position=place, indentation=0.003)
    scene = pressed(parabola)
    lifted = (Support("y0", {"x": 0, "y": raised}),)
    found = run(dataclasses.replace(scene, support=lifted), COMM, square())
    assert found.quantities["normal_force"] > 0
    assert found.exit_code == 4 and not found.checks["unseen_contact"].passed


@pytest.mark.errors
def test_bars_hold_what_edges_between_points_do(monkeypatch):
    """A punch 4.4 spacings of points wide, against the force on cells of a quarter of the size."""

    def punched(count, errors):
        punch = Obstacle("flat punch", radius=0.11, position=(0.525, 1), indentation=0.01)
        scene = dataclasses.replace(pressed(punch), discretisation=Discretisation(2))
        return run(with_solver(scene, errors=errors), COMM, box_body((count, count), (1, 1)))

    right = punched(40, "none").quantities["normal_force"]
    found = punched(10, "auto")
    off = abs(found.quantities["normal_force"] - right)
    assert found.exit_code == 0 and off < found.errors["normal_force"]["total"]
    monkeypatch.setattr(unseen, "_COUNTS", 1.0)
    # What the place of its edge makes is as much, and would hide that.
    monkeypatch.setattr(singular_places, "_last_points", lambda contact, state: (None, 0.0))
    assert punched(10, "auto").errors["normal_force"]["total"] < 0.5 * off


@pytest.mark.errors
def test_work_of_friction_goes_by_the_size_of_a_contact():
    """On cells of a quarter of the size some of what touches slips; here the only point sticks."""
    parabola = Obstacle("parabola", radius=2, position=(0.5, 1), indentation=0.0006)
    scene = pressed(parabola)
    rubbed = dataclasses.replace(scene.contact[0], friction_coefficient=0.05)
    scene = dataclasses.replace(scene, contact=(rubbed,))
    found = run(with_solver(scene, errors="auto"), COMM, square())
    fine = run(with_solver(scene, errors="none"), COMM, box_body((40, 40), (1, 1)))
    assert fine.quantities["friction_work"] > 10 * found.quantities["friction_work"]
    assert found.exit_code == 0 and found.errors["friction_work"]["total"] is None


@pytest.mark.errors
def test_an_accuracy_begins_on_a_mesh_that_shows_the_obstacle(tmp_path):
    """The force on 80 × 80 cells of the same square, .2169, and on 160 × 160 .2166."""
    (tmp_path / "b.geo").write_text(GEOMETRY)
    parabola = Obstacle("parabola", radius=2, position=(BETWEEN, 1), indentation=0.0006)
    scene = pressed(
        parabola, mesh=MeshSource(str(tmp_path / "b.geo")), accuracy=Accuracy(normal_force=0.05)
    )
    found = run(scene)
    assert found.exit_code == 0 and found.levels[0].cells > CELLS**2
    assert found.quantities["normal_force"] == pytest.approx(0.2166, rel=0.05)
