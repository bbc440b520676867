"""Derivatives by the adjoint are those of whole runs, by central differences, and closed forms."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Load,
    Material,
    MeshSource,
    Obstacle,
    Profile,
    Scene,
    Study,
    Support,
)
from fenics_contact.contact.laws import friction
from fenics_contact.contact.laws.friction import rules
from fenics_contact.contact.laws.friction.coulomb import MicroSlip
from fenics_contact.contact.laws.friction.rules import BySlip
from fenics_contact.contact.laws.friction.slip_laws import Static
from fenics_contact.contact.laws.friction.tangent import PrimalDual
from fenics_contact.simulation.sensitivities.scene_values import found_in, with_changes
from tests.messages import refused
from tests.preload.joints import joint
from tests.preload.test_joint import BOLT_STIFFNESS, sleeve_stiffness
from tests.preload.test_joint import scene as joint_scene
from tests.scenes import box_body
from tests.simulation.sensitivities.scenes import LINES, NU, OBSTACLE, SAMPLE, TABLE, E
from tests.simulation.sensitivities.table import errors, study_of, value_of
from tests.simulation.studies.cases import BALL, DEPTH, MU, ON_A_FLOOR, PAD, of_contact, square
from tests.solve.condensed.stiff_and_soft import Split


@pytest.mark.parametrize("name", SAMPLE)
def test_derivatives_are_central_differences_of_runs(name):
    found = errors(study_of(name), TABLE[name].of, TABLE[name].by)
    assert {pair: error for pair, error in found.items() if error > 1} == {}


@pytest.mark.parametrize("name", ["in space", "two bodies"])
def test_the_same_with_stiff_and_soft_apart(name, monkeypatch):
    study, of, by = study_of(name), TABLE[name].of, TABLE[name].by
    expected = study.derivatives(of, by)
    split = Split(monkeypatch)
    found = study.derivatives(of, by)
    split.require_used()
    for quantity, slopes in expected.items():
        size = max(abs(slopes[key] * found_in(study.scene, key)) for key in by)
        for key in by:
            off = found[quantity][key] - slopes[key]
            assert abs(off * found_in(study.scene, key)) <= 1e-7 * size, (quantity, key)


@pytest.mark.parametrize(
    ("name", "rule"), [("friction by slip", BySlip), ("micro-slip, in load steps", MicroSlip)]
)
def test_what_a_rule_keeps_goes_back_through_the_load_steps(name, rule, monkeypatch):
    """Without it, derivatives are those with the array held."""

    def nothing(rule, slip, closed, of_end):
        return np.zeros_like(slip), {}

    monkeypatch.setattr(rule, "vjp_state_update", nothing)
    found = errors(study_of(name), ["friction_force_x"], [DEPTH])
    assert min(found.values()) > 1e2


def test_work_of_friction_where_slip_goes_back_has_none():
    with refused("friction_work_has_no_derivative_in_reverse"):
        study_of("micro-slip").derivatives(["friction_work"], [MU])


def test_the_tangent_with_the_bound_held_is_not_the_true_one(monkeypatch):
    def nothing(tangent, slope):
        return np.zeros((*slope.shape, slope.shape[1]))

    monkeypatch.setattr(PrimalDual, "coupling", nothing)
    study = study_of("half-space")
    found = errors(study, ["normal_force"], [DEPTH, MU])
    assert min(found.values()) > 1e3  # a thousandth of the derivative


def uniform_block(**load):
    """A smooth block between a plate that is moved down and a stiff floor: stress is uniform."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        symmetry=("x0",),
        support=(Support("y1", {"y": -DELTA}),),
        contact=(Contact("y0", penalty_parameter=PENALTY),),
        **load,
    )


DELTA, PENALTY, WIDTH, HEIGHT = 1e-3, 1e-4, 2.0, 1.0


def test_derivatives_of_a_uniform_stress_are_those_of_the_formula():
    """Force W δ / c and energy W δ² h (1 − ν²) / (2 E c²), c = h (1 − ν²)/E + ε₁."""
    young, solid = 1000.0, 0.3
    soft = 1 - solid**2
    c = HEIGHT * soft / young + PENALTY
    force = WIDTH * DELTA / c
    by_c = {
        E: -HEIGHT * soft / young**2,
        NU: -2 * solid * HEIGHT / young,
        "contact.0.penalty_parameter": 1.0,
    }
    study = Study(uniform_block(), body=box_body((3, 2), (WIDTH, HEIGHT)))
    down = "support.0.displacement.y"
    of = ["normal_force", "y1.reaction_y", "strain_energy", "external_work", "max_contact_pressure"]
    found = study.derivatives(of, [*by_c, down, "contact.0.interference"])
    for key, slope in by_c.items():
        assert found["normal_force"][key] == pytest.approx(-force / c * slope, rel=1e-9)
        assert found["y1.reaction_y"][key] == pytest.approx(force / c * slope, rel=1e-9)
        assert found["external_work"][key] == pytest.approx(-DELTA * force / c * slope, rel=1e-8)
        own = WIDTH * DELTA**2 / 2 * (c - PENALTY)  # over c²
        partly = 0.0 if slope == 1.0 else WIDTH * DELTA**2 / 2 * slope / c**2
        expected = partly - 2 * own / c**3 * slope
        assert found["strain_energy"][key] == pytest.approx(expected, rel=1e-8)
    assert found["normal_force"][down] == pytest.approx(-WIDTH / c, rel=1e-9)
    assert found["max_contact_pressure"][down] == pytest.approx(-1 / c, rel=1e-9)
    assert found["normal_force"]["contact.0.interference"] == pytest.approx(WIDTH / c, rel=1e-9)
    assert found["external_work"][down] == pytest.approx(-2 * force, rel=1e-8)


def test_forces_go_with_the_thickness_unless_they_are_given():
    """Moved down, force W t δ / c; pressed by F, it goes down by F c / (W t), c = h/E + ε₁."""
    thickness, force, c = 0.5, 3.0, HEIGHT / 1000 + PENALTY
    plate = dataclasses.replace(uniform_block(), kinematics="plane stress", thickness=thickness)
    body = box_body((3, 2), (WIDTH, HEIGHT))
    of = ["normal_force", "y1.reaction_y", "strain_energy", "max_contact_pressure"]
    found = Study(plate, body=body).derivatives(of, ["thickness"])
    slopes = [found[name]["thickness"] for name in of]
    energy = WIDTH * DELTA**2 / (2 * c**2) * HEIGHT / 1000
    assert slopes == pytest.approx([WIDTH * DELTA / c, -WIDTH * DELTA / c, energy, 0.0], rel=1e-9)
    plane = Obstacle("plane", normal=(0.0, 1.0), force=force)
    pressed = Contact("y0", penalty_parameter=PENALTY, obstacle=plane)
    held = (Support("y1", {"y": 0}),)
    plate = dataclasses.replace(plate, support=held, contact=(pressed,))
    of = ["normal_force", "indentation", "max_contact_pressure", "strain_energy"]
    found = Study(plate, body=body).derivatives(of, ["thickness"])
    lengths = [force * c / WIDTH, force / WIDTH, force**2 * HEIGHT / 1000 / (2 * WIDTH)]
    expected = [0.0, *(-length / thickness**2 for length in lengths)]
    slopes = [found[name]["thickness"] for name in of]
    assert slopes == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_a_sphere_without_friction_is_that_of_hertz_but_for_the_mesh():
    """F = (4/3) E* √R d^(3/2): from cell to cell the discrete derivatives jump by some per cent."""
    ball = with_changes(BALL, {MU: 0.0, DEPTH: 0.04, "contact.0.penalty_parameter": 1e-6})
    study = Study(ball, body=box_body((14, 14), (1, 1)))
    young, ratio, radius, depth = 1000.0, 0.3, 4.0, 0.04
    force = 4 / 3 * young / (1 - ratio**2) * np.sqrt(radius) * depth**1.5
    found = study.derivatives(["normal_force"])["normal_force"]
    assert found[DEPTH] == pytest.approx(1.5 * force / depth, rel=0.05)
    assert found[f"{OBSTACLE}.radius"] == pytest.approx(force / (2 * radius), rel=0.1)
    assert found[E] == pytest.approx(force / young, rel=0.02)
    assert found[NU] == pytest.approx(force * 2 * ratio / (1 - ratio**2), rel=0.06)
    # Whatever the mesh: in units of stress, F is E f(E ε₁).
    own = study.quantities().contacts[0]["normal_force"]
    of_penalty = 1e-6 * found["contact.0.penalty_parameter"]
    assert young * found[E] - of_penalty == pytest.approx(own, rel=1e-8)
    assert found[f"{OBSTACLE}.position.1"] == pytest.approx(-found[DEPTH], rel=1e-8)


def test_all_numbers_that_have_a_derivative_are_found():
    scene = dataclasses.replace(
        ON_A_FLOOR,
        load=(Load("x1", pressure=Profile("y", (0, 1), (-1, -0.5))),),
        contact=(Contact("y0", friction_coefficient=0.3, obstacle=Obstacle("plane")),),
    )
    found = Study(scene, body=square()).derivatives(["normal_force"])["normal_force"]
    assert sorted(found) == [
        MU,
        "load.0.pressure.values.0",
        "load.0.pressure.values.1",
        NU,
        E,
        "support.0.displacement.x",
        "support.0.displacement.y",
    ]


def test_a_value_that_acts_beyond_the_body_changes_nothing():
    pressed = Profile("y", (0, 1, 3), (-1, -0.5, 7))
    scene = dataclasses.replace(ON_A_FLOOR, load=(Load("x1", pressure=pressed),))
    keys = [f"load.0.pressure.values.{number}" for number in range(3)]
    found = Study(scene, body=square()).derivatives(["normal_force"], keys)["normal_force"]
    assert found[keys[2]] == 0 and found[keys[1]] != 0


@pytest.mark.parametrize(
    ("of", "by", "said"),
    [
        ("contact_area", MU, "contact_area_has_no_derivatives"),
        ("friction_force", MU, "study_derivative_of_a_vector"),
        ("normal_fors", MU, "derivative_of_normal_fors"),
        ("normal_force", "contact.0.friction", "derivative_by_friction"),
        ("normal_force", "contact.0.law", "derivative_by_law"),
        ("normal_force", "contact.0.penalty_parameter", "derivative_by_automatic_penalty"),
        ("normal_force", "solver.tolerance", "study_derivative_by_tolerance"),
        ("normal_force", "support.0.path.time.0", "derivative_by_path"),
        ("normal_force", "thickness.values.0", "derivative_by_varying_thickness"),
        ("normal_force", "mesh.0.parameters.cells", "derivative_by_cells"),
        ("normal_force", "contact.0.obstacle.normal.0", "derivative_by_edge_of_obstacle"),
    ],
)
def test_what_has_no_derivative_is_refused_in_a_sentence(of, by, said):
    scene = dataclasses.replace(
        ON_A_FLOOR,
        kinematics="plane stress",
        thickness=Profile("x", (0, 1), (0.5, 0.5)),
        mesh=(MeshSource("block.geo", parameters={"cells": 4.0}),),
    )
    punch = Obstacle("flat punch", radius=0.3, normal=(0.0, 1.0), position=(0.5, 0.0))
    study = Study(of_contact(scene, obstacle=punch), body=square())
    with refused(said):
        study.derivatives([of], [by])


@pytest.mark.parametrize(
    ("scene", "key", "said"),
    [
        (BALL, "normal.1", "derivative_by_normal_on_half_space"),
        (
            with_changes(PAD, {"symmetry": ("y0",), **LINES, f"{OBSTACLE}.along": (1.0, 0, 0)}),
            "normal.1",
            "derivative_by_normal_without_symmetry",
        ),
        (with_changes(PAD, LINES), "along.2", "derivative_by_along"),
    ],
)
def test_directions_that_cannot_turn_are_refused(scene, key, said):
    if scene is BALL:
        scene = with_changes(scene, {f"{OBSTACLE}.normal": (0.0, -1.0)})
    body = box_body((3, 3, 2)) if scene.kinematics == "3D" else box_body((4, 4), (1, 1))
    with refused(said):
        Study(scene, body=body).derivatives(["strain_energy"], [f"{OBSTACLE}.{key}"])


@pytest.mark.parametrize(
    ("name", "of", "key"),
    [
        ("a force that turns with its obstacle", "friction_force_x", "normal.0"),
        ("an obstacle that turns, in load steps", "normal_force", "direction.0"),
        ("lines that turn, in space", "strain_energy", "along.1"),
    ],
)
def test_what_derivatives_by_directions_leave_is_of_second_order(name, of, key):
    """Taylor's: J(θ + h) = J + h J' + O(h²)."""
    study, key = study_of(name), f"{OBSTACLE}.{key}"
    slope, at = study.derivatives([of], [key])[of][key], found_in(study.scene, key)
    here, *others = (
        value_of(study.solve({key: at + step}), of) for step in (0.0, 4e-3, 2e-3, 1e-3)
    )
    steps = np.array([4e-3, 2e-3, 1e-3])
    left = np.abs(np.array(others) - here - steps * slope)
    orders = np.log2(left[:-1] / left[1:])
    assert (orders > 1.7).all() and (orders < 2.3).all()


def test_a_locked_bolt_keeps_its_length_as_the_joint_diagram_has_it():
    """Seat F_V − (1 − Φ) F_A with Φ = k_b / (k_b + k_p); tightened by F_V (1/k_b + 1/k_p)."""
    bolt, sleeve = BOLT_STIFFNESS, sleeve_stiffness()
    study = Study(joint_scene(pulled=1.0), body=joint())
    of = ["seat.normal_force", "bolt.elongation"]
    found = study.derivatives(of, ["preload.0.force", "contact.0.obstacle.force"])
    share = bolt / (bolt + sleeve)
    assert found["seat.normal_force"]["preload.0.force"] == pytest.approx(1.0, rel=1e-6)
    assert found["seat.normal_force"]["contact.0.obstacle.force"] == pytest.approx(
        share - 1, rel=1e-6
    )
    tightened = 1 / bolt + 1 / sleeve
    assert found["bolt.elongation"]["preload.0.force"] == pytest.approx(tightened, rel=1e-6)
    assert abs(found["bolt.elongation"]["contact.0.obstacle.force"]) < 1e-9 * tightened


class Counting(BySlip):
    """A rule that counts in its own way, and does not say the derivatives of this."""

    def at_step_end(self, slip, closed):
        return super().at_step_end(slip, closed)


def test_a_rule_that_does_not_say_what_its_state_does_is_refused(monkeypatch):
    monkeypatch.setattr(rules, "RULES", (Counting,))
    with refused("friction_law_has_no_derivative"):
        study_of("friction by slip").derivatives(["normal_force"], [MU])


class Reversed(Static):
    """A law with forces of its own, which says nothing of their derivatives."""

    def traction(self, slip):
        return super().traction(slip)


def test_a_law_that_does_not_say_its_derivatives_is_refused(monkeypatch):
    monkeypatch.setattr(friction, "LAWS", (Reversed,))
    with refused("static_law_has_no_derivative"):
        Study(ON_A_FLOOR, body=square()).derivatives(["normal_force"], [MU])
