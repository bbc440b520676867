"""Bodies that move in few modes alone, and else give way as in statics."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Motion,
    MotionModes,
    Obstacle,
    Path,
    Point,
    Run,
    Scene,
    Support,
)
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.impacts import (
    along,
    ball_scene,
    bar_on_wall,
    force_that_stops,
    resting_scene,
    times_of,
)
from tests.messages import refused
from tests.scenes import box_body

ALWAYS = Path(time=(0.0,), factor=(1.0,))
FLOOR = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0))


def in_modes(scene, number, **changes):
    modes = MotionModes(number=number, **changes)
    return dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, modes=modes))


def solved(scene, body=None):
    found = Run(scene, body=body).solve(announce=lambda number, step: None)
    assert found.passed, found.verdict
    return found


def test_a_bar_that_is_pulled_at_once_swings_in_its_modes_about_the_static_answer():
    """u/(F L/EA) = 1 − Σ 8/((2j−1)² π²) cos ω_j t of a fixed-free bar, of 3 modes alone."""
    cells, modulus = 40, 100.0  # c = 10
    scene = Scene(
        kinematics="plane strain",
        material=Material(modulus, 0.0, density=1.0),
        discretisation=Discretisation(1),
        load=(Load("bar.x1", traction=(1.0, 0.0), path=ALWAYS),),
        support=(Support("bar.x0", {"x": 0}), Support("bar", {"y": 0})),
        point=(Point(name="tip", at=(1.0, 0.0)),),
        motion=Motion(step=1e-3, end=0.25, modes=MotionModes(number=3, accuracy=1.0)),
    )
    found = solved(scene, boxes([Box("bar", (0.0, 0.0), (1.0, 1 / cells), (cells, 1))]))
    tip, times = along(found, "displacement_tip")[:, 0] * modulus, times_of(found)
    odd = np.array([1, 3, 5])
    swings = 8 / (odd * np.pi) ** 2 * np.cos(np.outer(times, odd * np.pi / 2 * 10))
    assert tip == pytest.approx(1 - swings.sum(axis=1), abs=5e-3)
    assert found.model.free_modes == 3
    left, work = (np.abs(along(found, name)) for name in ("energy_defect", "external_work"))
    assert left.max() < 1e-10 * work.max()


@pytest.mark.parametrize("degree", [1, 2])
def test_a_free_body_flies_on_a_parabola(degree):
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e4, 0.3, density=2.0),
        discretisation=Discretisation(degree),
        load=(Load("body", body_force=(0.0, -20.0), path=ALWAYS),),
        contact=(Contact("y0", obstacle=dataclasses.replace(FLOOR, position=(0.0, -9.0))),),
        point=(Point(name="middle", at=(1.0, 0.5)),),
        motion=Motion(step=0.02, end=0.1, velocity={"body": (2.0, 3.0)}),
    )
    found = solved(in_modes(scene, 4), box_body((4, 2), (2.0, 1.0)))
    moved = found.quantities["displacement_middle"]
    assert moved == pytest.approx([0.2, 0.25], abs=1e-9 if degree == 1 else 1e-4)
    assert found.checks["momentum_balance"].value < 1e-10


def test_a_ball_is_pressed_as_its_static_answer_says():
    """Of m d'' = −F(d), with F of its own static answer."""
    found = solved(ball_scene(100, modes=10))
    energy = found.steps[0].quantities["kinetic_energy"]
    greatest = force_that_stops(solved(resting_scene()), energy)
    assert along(found, "normal_force").max() == pytest.approx(greatest, rel=5e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_two_bodies_between_which_a_spring_acts_change_their_momenta(dimension):
    """Peak v √(k m/2) of two equal masses m with a spring k between them, far softer than they."""
    height, softness = (0.5,) * (dimension - 1), 0.1
    low, high = (0.0, *(0.0,) * (dimension - 1)), (1.0, *height)
    other = (1.0, *low[1:]), (2.0, *height)
    cells = (2,) * dimension
    scene = Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        material=Material(1e3, 0.3, density=1.0),
        discretisation=Discretisation(1),
        contact=(Contact("left.x1", against="right.x0", penalty_parameter=softness),),
        motion=Motion(step=1e-2, end=0.8, velocity={"left": (0.01, *(0.0,) * (dimension - 1))}),
    )
    kind = "quadrilateral" if dimension == 2 else "hexahedron"
    body = boxes([Box("left", low, high, cells), Box("right", *other, cells)], cell=kind)
    found = solved(in_modes(scene, 3), body)
    area = 0.5 ** (dimension - 1)
    mass, spring = area, area / softness
    force = along(found, "normal_force")
    assert force.max() == pytest.approx(0.01 * np.sqrt(spring * mass / 2), rel=1e-2)
    assert found.quantities["impulse"][0] == pytest.approx(-0.01 * mass, rel=1e-2)
    assert force[-1] == 0
    assert found.checks["momentum_balance"].value < 1e-11


def test_a_body_that_is_shaken_moves_as_all_of_its_mesh_does():
    """A bar on a floor that its support takes along: against the motion without modes."""
    times = np.linspace(0, 0.4, 41)
    path = Path(time=tuple(times), factor=tuple(np.sin(np.pi * times / 0.4) ** 2))
    scene = Scene(
        kinematics="plane strain",
        material=Material(100.0, 0.3, density=1.0),
        discretisation=Discretisation(1),
        support=(Support("x0", {"x": 0, "y": 0.01}, path=path),),
        contact=(Contact("y0", obstacle=dataclasses.replace(FLOOR, position=(0.0, -0.02))),),
        point=(Point(name="tip", at=(4.0, 1.0)),),
        motion=Motion(step=4e-3, end=0.8),
    )
    body = box_body((16, 4), (4.0, 1.0))
    whole, few = (solved(one, body) for one in (scene, in_modes(scene, 20, accuracy=0.5)))
    places = [along(one, "displacement_tip")[:, 1] for one in (whole, few)]
    assert places[1] == pytest.approx(places[0], abs=1e-2 * np.abs(places[0]).max())
    work = along(few, "external_work")
    assert np.abs(along(few, "energy_defect")).max() < 1e-9 * np.abs(work).max()


def test_a_block_that_rests_does_not_begin_to_move():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e3, 0.3, density=1.0),
        discretisation=Discretisation(1),
        load=(Load("body", body_force=(0.0, -10.0), path=ALWAYS),),
        support=(Support("x0", {"x": 0}),),
        contact=(Contact("y0", obstacle=FLOOR),),
        motion=Motion(step=2e-3, end=0.02, start="static"),
    )
    found = solved(in_modes(scene, 4), box_body((8, 4), (2.0, 1.0)))
    assert along(found, "kinetic_energy").max() < 1e-9 * found.quantities["strain_energy"]
    assert found.quantities["impulse"][1] == pytest.approx(20 * 0.02, rel=1e-9)


def test_as_many_modes_as_an_accuracy_needs():
    """What all that the mesh has does is no farther off than estimated."""
    scene = ball_scene(50)
    whole = along(solved(scene), "normal_force")
    found = solved(in_modes(scene, "automatic", accuracy=1e-2))
    assert found.model.free_modes == 10 and 0 < found.model.free_modes_error <= 1e-2
    assert "10 free modes" in found.verdict
    off = np.abs(along(found, "normal_force") - whole).max() / whole.max()
    assert 0.1 * found.model.free_modes_error < off < found.model.free_modes_error


def test_a_shock_moves_all_that_the_mesh_has_and_says_so():
    scene, body = bar_on_wall(40, 1.0, end=0.5)
    whole, found = solved(scene, body), solved(in_modes(scene, "automatic"), body)
    assert found.model.free_modes is None and found.model.free_modes_error is None
    assert "Free modes do not suffice" in found.verdict
    assert along(found, "normal_force") == pytest.approx(along(whole, "normal_force"), rel=1e-9)


def test_modes_that_bend_are_too_few_for_a_blow_along_a_bar():
    """Twice as many that bend change nothing: what they miss is told by its kinetic energy."""
    scene, body = bar_on_wall(20, 1.0, end=0.5)
    found = Run(in_modes(scene, 2), body=body).solve(announce=lambda number, step: None)
    assert not found.passed and not found.checks["free_modes"].passed
    assert "for lack of free modes" in found.verdict
    assert [name for name, check in found.checks.items() if not check.passed] == ["free_modes"]


@pytest.mark.parametrize("poisson", [0.3, 0.4999])
def test_pressures_of_bodies_that_hardly_change_their_volume(poisson):
    """In touch at the end, where forces of the body are compared with those of the contact."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e3, poisson, density=1.0),
        discretisation=Discretisation(2),
        contact=(
            Contact(
                "y0",
                obstacle=Obstacle("cylinder", radius=2.0, position=(1.0, 0.0), normal=(0.0, 1.0)),
            ),
        ),
        motion=Motion(step=5e-3, end=0.1, velocity={"body": (0.0, -0.1)}),
    )
    found = solved(in_modes(scene, 20, accuracy=5.0), box_body((12, 6), (2.0, 1.0)))
    assert found.quantities["normal_force"] > 0 and "contact_law" in found.checks


def test_too_many_modes_of_few_nodes():
    scene, body = bar_on_wall(10, 1.0)
    with refused("too_many_modes_of_motion"):
        Run(in_modes(scene, 30), body=body).solve()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"absorbing": ("bar.x1",)}, "motion_modes_beside_absorbing"),
        ({}, "motion_modes_beside_friction"),
    ],
)
def test_what_modes_cannot_have_yet(change, words):
    scene = in_modes(bar_on_wall(10, 1.0)[0], 3)
    motion = dataclasses.replace(scene.motion, **change)
    contact = scene.contact
    if not change:
        contact = (dataclasses.replace(contact[0], friction_coefficient=0.3, law="incremental"),)
    with refused(words, ValueError):
        dataclasses.replace(scene, motion=motion, contact=contact)
