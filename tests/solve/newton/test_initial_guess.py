"""Robust starts: what only contact holds, what nothing holds, and what never touches."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    MeshSource,
    NoEquilibriumError,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
)
from tests.messages import refused
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
DOWN = Load("y1", traction=(0, -10))
HELD_ASIDE = (Support("x0", {"x": 0}),)


def block(contact=None, load=(DOWN,), support=HELD_ASIDE, cells=(6, 8), size=(1, 2), **keys):
    """A block on a rigid floor."""
    contacts = contact if isinstance(contact, tuple) else (contact or Contact("y0"),)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=support,
        load=load,
        contact=contacts,
        **keys,
    )
    return Run(scene, COMM, box_body(cells, size))


def solved(*arguments, **keys):
    result = block(*arguments, **keys).solve()
    assert result.passed, result.verdict
    return result


def floor(**keys):
    return Contact("y0", obstacle=Obstacle("plane", **keys))


@pytest.mark.parametrize("height", [0.0, -3.0, -1e3, 0.5, 1e3])
def test_a_block_falls_or_rises_onto_its_floor(height):
    """Far out of contact, or deep in it, the answer is that of a block which stands on it."""
    result = solved(floor(position=(0, height)))
    tolerance = 1e-8 if abs(height) < 10 else 1e-4  # round-off of the depth over ε₁
    assert result.points.contact_pressure == pytest.approx(10, rel=tolerance)
    assert result.steps[0]["newton_iterations"] <= 3


def test_a_vise_finds_its_own_opening():
    jaw = Contact("y1", obstacle=Obstacle("plane", position=(0, 5), force=10))
    result = solved((Contact("y0"), jaw), load=())
    shortening = 10 * (1 - 0.3**2) / 1000 * 2
    assert result.quantities["indentation"] == pytest.approx(3 + shortening, rel=1e-6)
    assert result.contacts[0]["quantities"]["normal_force"] == pytest.approx(10, rel=1e-9)
    assert "reaction" in result.quantities


@pytest.mark.parametrize("distance", [0.0, 2.0, 1e3])
def test_a_punch_under_force_is_brought_into_contact(distance):
    punch = Contact(
        "y1", obstacle=Obstacle("parabola", radius=4, position=(0.5, 2 + distance), force=20)
    )
    result = solved(punch, load=(), support=(Support("y0", {"x": 0, "y": 0}),), cells=(16, 16))
    near = solved(
        Contact("y1", obstacle=Obstacle("parabola", radius=4, position=(0.5, 2), force=20)),
        load=(),
        support=(Support("y0", {"x": 0, "y": 0}),),
        cells=(16, 16),
    )
    # A depth of 1e-7 is the difference of two lengths of 1e3: round-off.
    tolerance = 1e-8 if distance < 10 else 1e-6
    assert result.quantities["normal_force"] == pytest.approx(20, rel=tolerance)
    found = result.quantities["indentation"] - distance
    assert found == pytest.approx(near.quantities["indentation"], rel=1e-6)
    assert result.steps[0]["newton_iterations"] <= 8


def test_no_force_leaves_the_obstacle_just_touching():
    """Loads have moved the surface; the obstacle carries nothing and follows it."""
    punch = Contact("y1", obstacle=Obstacle("parabola", radius=4, position=(0.5, 4), force=0))
    load = (Load("body", body_force=(0, -100)),)
    result = solved(punch, load=load, support=(Support("y0", {"x": 0, "y": 0}),))
    assert result.quantities["normal_force"] == 0
    assert result.points.gap.min() == pytest.approx(0, abs=1e-12)
    sunk = result.quantities["indentation"] - 2
    assert 0.5 * 100 * 2**2 / 2 / 1000 < sunk < 2 * 100 * 2**2 / 2 / 1000
    assert (result.points.status == "OPEN").all()
    assert not any("contact" in term for term in result.model["terms"])


def test_without_contact_there_is_an_answer_that_says_so():
    punch = Contact("y1", obstacle=Obstacle("parabola", radius=4, position=(0.5, 2.5)))
    result = solved(punch, load=(), support=(Support("y0", {"x": 0, "y": 0}),))
    assert result.quantities["contact_area"] == 0
    assert "does not touch" in result.verdict


def test_edge_of_a_punch_and_of_the_body():
    punch = Obstacle("flat punch", radius=0.5, position=(1, 2), indentation=0.01)
    result = solved(
        Contact("y1", obstacle=punch), load=(), support=(Support("y0", {"x": 0, "y": 0}),)
    )
    reached = np.isfinite(result.points.gap)
    assert (result.points.coordinates[reached, 0] >= 0.5 - 1e-9).all()
    assert 0.4 < result.quantities["contact_area"] <= 0.5


def test_a_tilted_punch_touches_with_its_edge_first():
    def tilted(force):
        obstacle = Obstacle(
            "plane", position=(0.5, 2), normal=(-0.05, -1), direction=(0, -1), force=force
        )
        contact = Contact("y1", obstacle=obstacle)
        support = (Support("y0", {"x": 0, "y": 0}),)
        return solved(contact, load=(), support=support, cells=(16, 16))

    light, heavy = tilted(1.0), tilted(30.0)
    touching = light.points.coordinates[light.points.status != "OPEN", 0]
    assert (touching > 0.5).all() and touching.max() == pytest.approx(1)
    assert heavy.quantities["contact_area"] > light.quantities["contact_area"]


@pytest.mark.parametrize(
    ("keys", "message", "axis"),
    [
        ({"load": (Load("y1", traction=(0, 10)),)}, "loads_push_away", "y"),
        ({"load": ()}, "nothing_presses", "y"),
        ({"support": ()}, "motion_is_undetermined", "x"),
    ],
    ids=["pulled", "unloaded", "slides"],
)
def test_what_contact_cannot_hold_is_refused(keys, message, axis):
    with refused(message, NoEquilibriumError, motion=f"translation along {axis}"):
        block(**keys)


def test_a_block_tips_when_its_load_lies_outside_its_base():
    """Traction −10 + k (x − ½) on the top has its resultant k/120 beside the middle."""

    def loaded(slope):
        top = Load("y1", traction=(-1e-3, lambda x: -10 + slope * (x[0] - 0.5)))
        stop = Contact("x0")  # lets it go to the right, and turn that way
        return block((Contact("y0"), stop), load=(top,), support=())

    result = loaded(-58).solve()
    assert result.passed
    assert result.contacts[0]["quantities"]["normal_force"] == pytest.approx(10, rel=1e-8)
    pressed = result.points.contact_pressure > 0
    floor = pressed & (result.points.contact == 0)
    assert result.points.coordinates[floor, 0].min() > 0.5
    motion = "translation along x and y, rotation about z"
    with refused("loads_push_away", NoEquilibriumError, motion=motion):
        loaded(-62)


def test_an_obstacle_that_misses_the_body_is_said_before():
    punch = Obstacle("flat punch", radius=0.5, position=(3, 2), indentation=0.1)
    with refused("obstacle_misses_the_surface"):
        block(Contact("y1", obstacle=punch))


def test_deep_indentation_of_a_half_space():
    """Newton's method starts at full depth, with twice the area of the answer in contact."""
    scene = Scene(
        kinematics="axisymmetric",
        mesh=MeshSource(
            str(ROOT / "meshes" / "half_space.geo"),
            cell="quadrilateral",
            parameters={"fine": 20, "size": 1, "extent": 100, "cells_outside": 12},
        ),
        material=Material(1000, 0.3),
        symmetry=("axis",),
        half_space={"on": ("outer",)},
        contact=(Contact("contact", obstacle=Obstacle("paraboloid", radius=8, indentation=30)),),
    )
    result = Run(scene, COMM).solve()
    failed = {name for name, check in result.checks.items() if not check.passed}
    assert result.converged and failed == {"linear_range"}  # of which Hertz's formula knows nothing
    hertz = 4 / 3 * 1000 / 0.91 * np.sqrt(8) * 30**1.5
    assert result.quantities["normal_force"] == pytest.approx(hertz, rel=0.01)
    assert result.steps[0]["newton_iterations"] <= 10


UNLOADED = Path(time=(0, 1, 2, 3), factor=(0, 1, 0, 1))


@pytest.mark.parametrize("coefficient", [0.0, 0.3])
def test_contact_that_is_unloaded_to_nothing_and_loaded_again(coefficient):
    """Under a force on the obstacle, and under the body's own load: nothing is lost on the way."""
    clamp = (Support("y0", {"x": 0, "y": 0}),)
    obstacle = Obstacle("parabola", radius=4, position=(0.5, 2), force=20, path=UNLOADED)
    punch = Contact("y1", obstacle=obstacle, friction_coefficient=coefficient)
    down = Load("y1", traction=(0, -20), path=UNLOADED)
    lies = Contact("y0", friction_coefficient=coefficient)
    for contact, load, support in ((punch, (), clamp), (lies, (down,), HELD_ASIDE)):
        run = block(contact, load, support, steps=Steps(number=3, end=3.0))
        result = run.solve()
        assert result.passed, result.verdict
        forces = [step["quantities"]["normal_force"] for step in result.steps]
        assert forces == pytest.approx([20, 0, 20], rel=1e-8, abs=1e-9)


def test_a_body_that_ends_without_any_load_is_refused():
    """Just touching, where it lies is left open; clamped below, it may."""
    path = Path(time=(0, 1, 2), factor=(0, 1, 0))
    load = (Load("y1", traction=(0, -10), path=path),)
    steps = Steps(number=2, end=2.0)
    with refused("nothing_presses", NoEquilibriumError, motion="translation along y"):
        block(load=load, steps=steps)
    punch = Contact("y1", obstacle=Obstacle("plane", position=(0, 2)))
    result = block(punch, (), (Support("y0", {"x": 0, "y": 0}),)).solve()
    assert result.passed and "does not touch" in result.verdict
    assert result.quantities["normal_force"] == 0


@pytest.mark.parametrize("number", [1, 3])
def test_a_support_presses_on_a_block_that_only_friction_holds(number):
    """Nothing touches as it begins. Without Poisson's ratio the floor needs E u A/H = 20."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=(Support("y1", {"y": -0.01}),),
        load=(Load("x1", traction=(4, 0)),),
        contact=(Contact("y0", friction_coefficient=0.3),),
        steps=Steps(number=number),
    )
    result = Run(scene, COMM, box_body((8, 4), (2, 1))).solve()
    assert result.passed, result.verdict
    assert result.quantities["normal_force"] == pytest.approx(20, rel=1e-3)
    assert result.quantities["friction_force"] == pytest.approx([-4, 0], abs=1e-8)


@pytest.mark.parametrize(("push", "wall"), [(-9, 3), (-3, 0), (4, 0)])
def test_friction_holds_what_a_wall_does_not(push, wall):
    """The floor carries 20, so 6 along it; a wall farther off than it gives way takes the rest."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=(Support("y1", {"y": -0.01}),),
        load=(Load("x1", traction=(push, 0)),),
        contact=(
            Contact("y0", friction_coefficient=0.3),
            Contact("x0", obstacle=Obstacle(gap=0.05)),
        ),
    )
    result = Run(scene, COMM, box_body((8, 4), (2, 1))).solve()
    assert result.passed, result.verdict
    floor, beside = (contact["quantities"] for contact in result.contacts)
    assert floor["normal_force"] == pytest.approx(20, rel=1e-3)
    assert floor["friction_force"] == pytest.approx([-push - wall, 0], rel=1e-3, abs=1e-8)
    assert beside["normal_force"] == pytest.approx(wall, rel=1e-2, abs=1e-8)
