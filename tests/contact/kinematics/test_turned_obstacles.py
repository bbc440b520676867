"""Rigid obstacles that turn: by a given angle, or under a moment that finds it."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    CyclicSymmetry,
    DerivativeRequest,
    FaceRotation,
    HalfSpace,
    Material,
    Motion,
    Obstacle,
    ObstacleRotation,
    Path,
    Point,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import CONSTANT
from tests.contact.kinematics.test_obstacle_files import box, write_stl
from tests.messages import refused
from tests.problem.rings import ring
from tests.scenes import box_body

STEEL = Material(1000, 0.3)
FIXED = Support("z0", {"x": 0, "y": 0, "z": 0})
AXIS, AT = (1.0, 2.0, 2.0), (0.3, 0.2, 0.6)
ABOUT = ObstacleRotation(axis=AXIS, at=AT)
UNIT = np.array(AXIS) / 3


def angled(rotation, angle):
    return dataclasses.replace(rotation, angle=angle)


def glued(obstacle, penalty=1e-10, **settings):
    """A block whose top is glued to a rigid plate."""
    contact = Contact(
        "z1",
        contact="bonded",
        penalty_parameter=penalty,
        obstacle=obstacle,
        moment_about=AT,
        axis=AXIS,
    )
    return Scene(
        kinematics="3D",
        material=STEEL,
        support=(FIXED,),
        contact=(contact,),
        point=(Point("inside", (0.4, 0.3, 0.2)),),
        solver=SolverSettings(**settings),
    )


def pressed(obstacle, coefficient=0.0, steps=None, **of_contact):
    """A strip on a fixed base, with an obstacle on its top, in plane strain."""
    law = {"law": "incremental"} if steps and coefficient else {}
    contact = Contact(
        "y1",
        friction_coefficient=coefficient,
        obstacle=obstacle,
        moment_about=(0.5, 1),
        **law,
        **of_contact,
    )
    return Scene(
        kinematics="plane strain",
        material=STEEL,
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(contact,),
        steps=Steps() if steps is None else Steps(number=steps),
    )


def test_a_glued_plate_turns_a_block_as_a_support_does():
    body = box_body((2, 2, 2))
    by_plate = run(glued(Obstacle(rotation=angled(ABOUT, 0.01)), 1e-12), body=body)
    turned = Support("z1", rotation=FaceRotation(angle=0.01, axis=AXIS, at=AT))
    scene = glued(None)
    by_support = run(dataclasses.replace(scene, contact=(), support=(FIXED, turned)), body=body)
    assert by_plate.passed, by_plate.verdict
    for name in ("strain_energy", "displacement_inside"):
        given, found = by_support.quantities[name], by_plate.quantities[name]
        assert found == pytest.approx(given, rel=1e-8, abs=1e-12)
    # No more than the final forces are known: their work is twice the energy.
    twice = 2 * by_support.quantities["strain_energy"]
    assert by_plate.quantities["external_work"] == pytest.approx(twice, rel=1e-6)


@pytest.mark.parametrize("solver", ["full", "condensed", "iterative"])
def test_the_angle_under_a_moment_needs_this_moment(solver):
    body, moment = box_body((2, 2, 2)), 0.7
    by_moment = run(glued(Obstacle(rotation=ABOUT, moment=moment), solver=solver), body=body)
    assert by_moment.passed, by_moment.verdict
    angle = by_moment.quantities["obstacle_rotation"]
    assert angle > 1e-3
    by_angle = run(glued(Obstacle(rotation=angled(ABOUT, angle)), solver=solver), body=body)
    for found in (by_moment, by_angle):
        assert found.quantities["torque"] == pytest.approx(moment, rel=1e-8)
    for name in ("strain_energy", "displacement_inside", "contact_force"):
        given, found = by_angle.quantities[name], by_moment.quantities[name]
        assert found == pytest.approx(given, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("solver", ["full", "condensed"])
def test_a_force_and_a_moment_find_depth_and_angle(solver):
    """Part of the surface opens, and some of it slips."""
    about, body = ObstacleRotation(at=(0.5, 1)), box_body((6, 4))

    def answer(rotation, **driven):
        plane = Obstacle("plane", position=(0, 1), normal=(0, -1), rotation=rotation, **driven)
        scene = dataclasses.replace(pressed(plane, 0.3), solver=SolverSettings(solver=solver))
        return run(scene, body=body).quantities

    found = answer(about, force=10.0, moment=3.0)
    assert 0.2 < found["contact_area"] < 0.9
    rotation = angled(about, found["obstacle_rotation"])
    again = answer(rotation, indentation=found["indentation"])
    assert found["torque"] == pytest.approx(3.0, rel=1e-8)
    assert again["torque"] == pytest.approx(3.0, rel=1e-6)
    assert again["normal_force"] == pytest.approx(10.0, rel=1e-6)
    assert again["strain_energy"] == pytest.approx(found["strain_energy"], rel=1e-6)


@pytest.mark.parametrize("by", ["angle", "moment"])
def test_a_winkler_foundation_resists_by_its_second_moment(by):
    """M = k ∫ x² dA θ on a body that hardly gives way, here of width 2 and depth 3."""
    stiffness, angle, inertia = 50.0, 1e-3, 3 * 2**3 / 12
    turned = {"moment": stiffness * inertia * angle} if by == "moment" else {}
    rotation = ObstacleRotation(angle=None if turned else angle, axis=(0, 5, 0), at=(1, 0, 0.7))
    contact = Contact(
        "z1",
        foundation_stiffness=stiffness,
        obstacle=Obstacle(indentation=0.01, rotation=rotation, **turned),
        moment_about=(1, 0, 0),
        axis=(0, 1, 0),
    )
    scene = Scene(
        kinematics="3D", material=Material(1e14, 0.3), support=(FIXED,), contact=(contact,)
    )
    found = run(scene, body=box_body((2, 2, 1), (2, 3, 1))).quantities
    assert found["normal_force"] == pytest.approx(stiffness * 6 * 0.01, rel=1e-10)
    assert found["torque"] == pytest.approx(stiffness * inertia * angle, rel=1e-10)
    assert found["obstacle_rotation"] == pytest.approx(angle, rel=1e-10)


HOLE, RIM = 10.0, 30.0


def shaft(coefficient=0.2, oversize=0.01, **turned):
    """A rigid shaft, a little too large for its hole in a plate that is held at its rim."""
    radius = HOLE + oversize
    obstacle = Obstacle("cylinder", radius=radius, normal=(0, -1), position=(0, -radius), **turned)
    return Scene(
        kinematics="plane strain",
        material=STEEL,
        support=(Support("ring.y1", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "ring.y0",
                friction_coefficient=coefficient,
                obstacle=obstacle,
                moment_about=(0, 0),
            ),
        ),
    )


def test_a_shaft_that_turns_drags_its_hole_by_all_the_friction_there_is():
    found = run(shaft(rotation=ObstacleRotation(angle=0.02)), body=ring(24)).quantities
    assert found["stick_area"] == 0
    limit = 0.2 * HOLE * found["pressure_integral"]
    assert abs(found["torque"]) == pytest.approx(limit, rel=1e-8)


def test_a_moment_on_a_shaft_that_sticks_twists_the_plate():
    """θ = M / 4πG (1/a² − 1/b²): shear of a ring whose rim is held."""
    moment, shear = 200.0, 1000 / 2.6
    expected = moment / (4 * np.pi * shear) * (1 / HOLE**2 - 1 / RIM**2)
    result = run(shaft(0.8, 0.05, moment=moment), body=ring(32, layers=6))
    assert result.passed, result.verdict
    found = result.quantities
    assert found["slip_area"] == 0
    assert found["obstacle_rotation"] == pytest.approx(expected, rel=2e-3)


def test_a_moment_on_a_shaft_without_friction_is_refused():
    with refused("shaft_without_friction"):
        run(shaft(0.0, 0.05, moment=200.0), body=ring(16))


def test_a_plate_that_tips_over_is_refused():
    """The moment is more than the force can hold at the end of the surface: 10 × ½ < 6."""
    about = ObstacleRotation(at=(0.5, 1))
    plane = Obstacle("plane", position=(0, 1), normal=(0, -1), rotation=about, force=10, moment=6)
    with refused("plate_tips_over"):
        run(pressed(plane, 0.3), body=box_body((6, 4)))


def test_an_angle_beyond_linear_theory_is_told():
    about = ObstacleRotation(angle=0.15, at=(0, 1))
    plane = Obstacle("plane", position=(0, 1), normal=(0, -1), rotation=about)
    result = run(pressed(plane), body=box_body((3, 2)))
    assert "an obstacle that turns by 15 % of a radian near 'y1'" in result.verdict


@pytest.mark.errors
@pytest.mark.parametrize("moment", [0.5, 3.0])
def test_error_bars_hold_the_answer_of_a_finer_mesh(moment):
    """While the plate touches all of the block, and where it lifts off from a part of it."""
    plane = Obstacle(
        "plane",
        position=(0, 1),
        normal=(0, -1),
        rotation=ObstacleRotation(at=(0.5, 1)),
        moment=moment,
        force=10,
    )
    scene = dataclasses.replace(pressed(plane, 0.3), solver=SolverSettings(errors="all"))
    coarse, fine = (run(scene, body=box_body((n, n))) for n in (6, 24))
    for name in ("obstacle_rotation", "indentation", "strain_energy", "torque"):
        error = coarse.errors[name]["total"]
        off = abs(coarse.quantities[name] - fine.quantities[name])
        assert error is not None and off <= error, (name, off, error)
        if name != "torque":
            assert error < 0.1 * abs(coarse.quantities[name])


def rotation_matrix(axis, angle):
    """That of a rotation about an axis (Rodrigues)."""
    cross = np.cross(np.eye(3), np.array(axis) / np.linalg.norm(axis))
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


SHAPES = {
    "plane": {"shape": "plane", "normal": (0.2, 0.1, -1), "position": (0.4, 0.5, 1.1)},
    "sphere": {"shape": "sphere", "radius": 2, "normal": (0, 0, -1), "position": (0.4, 0.5, 1.1)},
    "cylinder": {
        "shape": "cylinder",
        "radius": 2,
        "normal": (0, 0, -1),
        "along": (0, 1, 0),
        "position": (0.4, 0.5, 1.1),
    },
    "file": {"normal": (0, 0, -1), "position": (0.4, 0.5, 1.1)},
}


@pytest.mark.parametrize("shape", SHAPES)
def test_gaps_are_those_of_the_turned_shape_to_first_order(shape, folder):
    """Against the shape in its turned place, whose gap is known: errors of second order."""
    keys, at = SHAPES[shape], np.array([0.1, 0.3, 1.4])
    body = box_body((4, 4, 1), (1, 1, 1))

    def gap(obstacle):
        contact = Contact("z1", obstacle=obstacle)
        scene = Scene(kinematics="3D", material=STEEL, support=(FIXED,), contact=(contact,))
        kinematics = Problem.on_mesh(scene, body).contacts[0].kinematics
        return kinematics.gap + kinematics.normal(kinematics.motion_at_points)

    def off(angle):
        matrix = rotation_matrix(AXIS, angle)
        corners = box() * [0.8, 0.8, 1]
        file = {}, {}
        if shape == "file":
            names = [folder / f"{name}{angle}.stl" for name in ("first", "turned")]
            file = (
                {"file": write_stl(names[0], corners)},
                {"file": write_stl(names[1], corners @ matrix.T)},
            )
        ways = {name: keys[name] for name in ("normal", "along") if name in keys}
        moved = {name: tuple(matrix @ np.array(way)) for name, way in ways.items()}
        moved["position"] = tuple(matrix @ (np.array(keys["position"]) - at) + at)
        rotation = ObstacleRotation(angle=angle, axis=AXIS, at=tuple(at))
        by_angle = gap(Obstacle(**keys, **file[0], rotation=rotation))
        as_turned = gap(Obstacle(**{**keys, **moved}, **file[1]))
        both = np.isfinite(by_angle) & np.isfinite(as_turned)
        return np.abs(by_angle - as_turned)[both].max(initial=0.0), both.sum(), len(both)

    wide, narrow = off(0.02), off(0.01)
    if wide[1] == wide[2] and wide[0] > 0:
        assert wide[0] < 3e-3
        assert wide[0] / narrow[0] == pytest.approx(4, rel=0.2)


def test_a_cylinder_that_turns_about_its_own_axis_presses_as_before():
    radius = 2.0
    block = Obstacle("cylinder", radius=radius, position=(0.5, 1), normal=(0, -1), indentation=0.02)
    about = ObstacleRotation(angle=0.005, at=(0.5, 1 + radius))
    body = box_body((16, 6))
    still = run(pressed(block), body=body).quantities
    turned = run(pressed(dataclasses.replace(block, rotation=about)), body=body).quantities
    assert turned["normal_force"] == pytest.approx(still["normal_force"], rel=5e-3)
    assert turned["contact_area"] == pytest.approx(still["contact_area"], rel=1e-2)


def test_energies_balance_while_a_plate_rocks_on_rough_ground():
    plane = Obstacle(
        "plane",
        position=(0, 1),
        normal=(0, -1),
        indentation=0.02,
        path=Path(time=(0, 1, 3), factor=(0, 1, 1)),
        rotation=ObstacleRotation(angle=0.02, at=(0.3, 1.2)),
        rotation_path=Path(time=(0, 1, 2, 3), factor=(0, 0, 1, -1)),
    )
    body = box_body((6, 4))

    def defect(number):
        scene = pressed(plane, 0.3, steps=number)
        result = run(dataclasses.replace(scene, steps=Steps(number=number, end=3)), body=body)
        assert result.passed, result.verdict
        found = result.quantities
        assert found["friction_work"] > 1e-4
        return abs(found["energy_defect"]) / found["friction_work"]

    coarse, fine = defect(12), defect(48)
    assert fine < 0.02
    assert fine < 0.5 * coarse


def test_the_work_of_a_moment_is_the_energy_that_it_stores():
    scene = dataclasses.replace(glued(Obstacle(rotation=ABOUT, moment=0.7)), steps=Steps(number=3))
    found = run(scene, body=box_body((2, 2, 2))).quantities
    work = 0.5 * 0.7 * found["obstacle_rotation"]
    assert found["external_work"] == pytest.approx(work, rel=1e-8)
    assert found["strain_energy"] + found["penalty_energy"] == pytest.approx(work, rel=1e-8)


@pytest.mark.parametrize("key", ["rotation.angle", "moment"])
def test_derivatives_by_angle_and_moment(key):
    names = ("torque", "obstacle_rotation", "strain_energy")

    def answer(value, request=None):
        about = ObstacleRotation(at=(0.5, 2), angle=value if key == "rotation.angle" else None)
        more = {} if key == "rotation.angle" else {"moment": value}
        shape = Obstacle(
            "cylinder",
            radius=3,
            position=(0.45, 1),
            normal=(0, -1),
            indentation=0.03,
            rotation=about,
            **more,
        )
        scene = pressed(shape, 0.3)
        return run(dataclasses.replace(scene, derivatives=request), body=box_body((12, 4)))

    value, step = (0.01, 1e-5) if key == "rotation.angle" else (0.3, 1e-4)
    where = f"contact.0.obstacle.{key}"
    found = answer(value, DerivativeRequest(of=names, by=(where,))).derivatives
    sides = [answer(value + sign * step).quantities for sign in (1, -1)]
    for name in names:
        slope = (sides[0][name] - sides[1][name]) / (2 * step)
        assert found[name][where].discrete == pytest.approx(slope, rel=2e-3, abs=1e-9)


def test_numbers_of_a_shape_that_a_moment_turns_have_no_derivatives():
    about = ObstacleRotation(at=(0.5, 2))
    keys = {"position": (0.5, 1), "normal": (0, -1), "indentation": 0.03, "rotation": about}
    shape = Obstacle("cylinder", radius=3, moment=0.1, **keys)
    study = Study(pressed(shape), body=box_body((4, 2)))
    with refused("derivative_by_a_radius_under_a_moment"):
        study.derivatives(["torque"], ["contact.0.obstacle.radius"])


@pytest.mark.parametrize(("at", "steps"), [((0.5, 1.2), 1), ((0.5, 2.0), 1), ((0.5, 2.0), 4)])
def test_a_moment_turns_a_curved_shape_as_its_angle_does(at, steps):
    """To first order in the angle, of which the gap is a function: half the angle, a quarter."""
    about, body = ObstacleRotation(at=at), box_body((16, 4))
    always = Path(time=(0,), factor=(1,))

    def off(moment):
        keys = {"position": (0.5, 1), "normal": (0, -1), "indentation": 0.03, "path": always}
        shape = Obstacle("cylinder", radius=2, moment=moment, rotation=about, **keys)
        by_moment = run(pressed(shape, steps=steps), body=body)
        assert by_moment.passed, by_moment.verdict
        turned = angled(about, by_moment.quantities["obstacle_rotation"])
        by_angle = run(pressed(Obstacle("cylinder", radius=2, rotation=turned, **keys)), body=body)
        return abs(by_angle.quantities["torque"] / moment - 1)

    assert off(0.15) < 5e-3
    assert off(0.075) < 0.6 * off(0.15)


def test_what_cannot_turn_is_refused():
    about = ObstacleRotation(angle=0.1)
    flat = {"kinematics": "plane strain", "material": STEEL}

    def on_top(**keys):
        return (Contact("y1", obstacle=Obstacle(**keys)),)

    with refused("rotation_by_angle_and_moment"):
        Obstacle(rotation=about, moment=1.0)
    with refused("rotation_by_nothing"):
        Obstacle(rotation=ObstacleRotation(at=(0, 1)))
    with refused("rotation_path_without_a_rotation"):
        Obstacle(rotation_path=Path(time=(0, 1), factor=(0, 2)))
    with refused("obstacle_axis_of_no_length"):
        ObstacleRotation(angle=0.1, axis=(0, 0, 0))
    with refused("obstacle_turns_without_an_axis"):
        Scene(kinematics="3D", material=STEEL, contact=on_top(moment=1))
    with refused("obstacle_turns_in_an_axisymmetric_model"):
        Scene(
            **{**flat, "kinematics": "axisymmetric"},
            contact=(Contact("y1", obstacle=Obstacle(rotation=about)),),
        )
    with refused("obstacle_turns_about_an_axis_in_the_plane"):
        tilted = ObstacleRotation(angle=0.1, axis=(0, 0, 1))
        Scene(**flat, contact=on_top(rotation=tilted))
    with refused("obstacle_turns_about_a_point_of_the_wrong_size"):
        far = ObstacleRotation(angle=0.1, at=(0, 0, 1))
        Scene(**flat, contact=on_top(rotation=far))
    with refused("obstacle_turns_on_a_half_space"):
        Scene(**flat, half_space=HalfSpace(("x0",)), contact=on_top(rotation=about, force=1))
    with refused("obstacle_turns_in_a_sector"):
        sector = CyclicSymmetry(on="x0", against="x1", sectors=4)
        Scene(**flat, cyclic_symmetry=sector, contact=on_top(rotation=about))
    with refused("obstacle_turns_in_motion"):
        moving = Motion(end=1, step=0.1)
        Scene(**flat, motion=moving, contact=on_top(rotation=about, rotation_path=CONSTANT))


def test_an_obstacle_turns_across_no_plane_of_symmetry():
    tilted = Obstacle(rotation=ObstacleRotation(angle=0.1, axis=(0, 1, 0)))
    scene = dataclasses.replace(glued(tilted), symmetry=("x0",))
    with refused("obstacle_turns_out_of_a_plane_of_symmetry"):
        run(scene, body=box_body((2, 2, 2)))
