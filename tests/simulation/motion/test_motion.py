"""Bodies that fly, hit and slide: against d'Alembert, Newton and Coulomb."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from dolfinx.mesh import CellType

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Motion,
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
    bar_on_wall,
    force_of_wave,
    force_that_stops,
    jerk,
    times_of,
    touching,
    worst_defect,
)
from fenics_contact.verification.published.sliding import (
    LARGEST_FRICTION,
    oscillator,
    period_of,
)
from tests.scenes import box_body

ALWAYS = Path(time=(0.0,), factor=(1.0,))


def solved(scene, body):
    found = Run(scene, body=body).solve()
    assert found.passed, found.verdict
    return found


@pytest.mark.parametrize(("degree", "courant"), [(1, 1.0), (1, 0.25), (2, 0.5)])
def test_a_bar_presses_a_wall_as_the_wave_in_it_does(degree, courant):
    """With squares of degree 2 the force rings by some per cent about it."""
    cells = 40 // degree
    found = solved(*bar_on_wall(cells, courant, degree=degree))
    times, force = 10 * times_of(found), along(found, "normal_force") / force_of_wave(cells)
    flat = force[(times > 0.6) & (times < 1.6)]
    assert np.abs(flat - 1).max() < (1e-2 if degree == 1 else 7e-2)
    assert abs(flat.mean() - 1) < (1e-3 if degree == 1 else 1e-2)
    assert not touching(found)[times > 2.1].any()
    assert not np.any(along(found, "friction_force"))  # nothing, not round-off
    assert worst_defect(found) < 2e-3
    assert found.quantities["impulse"][0] == pytest.approx(2 * 0.01 / cells, rel=2e-2)


def test_the_error_of_the_impulse_falls_with_the_cells():
    errors = []
    for cells in (10, 40):
        found = solved(*bar_on_wall(cells, 1.0))
        errors.append(abs(found.quantities["impulse"][0] / (2 * 0.01 / cells) - 1))
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize(
    ("kinematics", "cell", "degree"),
    [
        ("plane strain", CellType.triangle, 1),
        ("axisymmetric", CellType.quadrilateral, 1),
        ("3D", CellType.tetrahedron, 2),
    ],
)
def test_a_body_that_nothing_touches_flies_on_a_parabola(kinematics, cell, degree):
    """The midpoint rule is exact for it: v t + ½ g t²."""
    dimension = 3 if kinematics == "3D" else 2
    aside = 0.0 if kinematics == "axisymmetric" else 2.0
    velocity, gravity = np.eye(dimension)[-1] * 3 + np.eye(dimension)[0] * aside, 10.0
    middle = (1.0, 0.5, 0.25)[:dimension]
    scene = Scene(
        kinematics=kinematics,
        material=Material(1e4, 0.3, density=2.0),
        discretisation=Discretisation(degree),
        load=(
            Load(
                "body",
                body_force=tuple(-2.0 * gravity * np.eye(dimension)[-1]),
                path=ALWAYS,
            ),
        ),
        contact=(
            Contact(
                "z0" if dimension == 3 else "y0",
                obstacle=Obstacle(
                    "plane",
                    position=tuple(-9 * np.eye(dimension)[-1]),
                    normal=tuple(np.eye(dimension)[-1]),
                ),
            ),
        ),
        point=(Point(name="middle", at=middle),),
        motion=Motion(step=0.02, end=0.1, velocity={"body": tuple(velocity)}),
    )
    found = solved(scene, box_body((2, 2, 2)[:dimension], (2.0, 1.0, 0.5), cell))
    drop = 0.5 * gravity * 0.1**2 * np.eye(dimension)[-1]
    moved = np.array(found.quantities["displacement_middle"])
    # In others weights and lumped masses differ from node to node, which shakes the body.
    off = 1e-12 if kinematics == "plane strain" else 1e-3
    assert moved == pytest.approx(velocity * 0.1 - drop, abs=off)
    assert found.checks["momentum_balance"].value < 1e-11
    assert found.quantities["energy_defect"] == pytest.approx(0.0, abs=1e-9)


def test_a_mass_with_friction_turns_and_rests_where_coulomb_says():
    found = solved(*oscillator(100, 3.2, first_turn=10.3))
    places = along(found, "displacement_mass")[:, 0] / LARGEST_FRICTION
    inner = places[1:-1]
    turns = inner[(inner - places[:-2]) * (places[2:] - inner) < 0]
    assert turns[:5] == pytest.approx([10.3, -8.3, 6.3, -4.3, 2.3], abs=1e-2)
    assert places[-1] == pytest.approx(-0.3, abs=1e-2)
    energies = along(found, "kinetic_energy")
    assert energies[-1] < 1e-22 * energies.max()  # at rest, and no creep
    assert np.ptp(places[-10:]) < 1e-9
    assert np.abs(along(found, "energy_defect")).max() < 1e-9 * energies.max()


def test_the_midpoint_rule_makes_periods_longer_by_its_own_measure():
    found = solved(*oscillator(20, 3.3, first_turn=None))
    assert period_of(found) == pytest.approx((np.pi / 20) / np.arctan(np.pi / 20), rel=2e-4)


def test_a_support_that_begins_to_move_sends_a_wave_into_a_bar():
    """Its force is ρ c v A until the wave is back; it also holds nodes that may touch a floor."""
    cells, speed, end = 40, 0.01, 0.19  # c = 10, L = 1
    below = Obstacle("plane", position=(0.0, -1.0), normal=(0.0, 1.0))
    scene = Scene(
        kinematics="plane strain",
        material=Material(100.0, 0.0, density=1.0),
        discretisation=Discretisation(1),
        support=(
            Support("bar.x0", {"x": speed * end, "y": 0}, path=Path(time=(0, end), factor=(0, 1))),
        ),
        contact=(Contact("bar.y0", obstacle=below),),
        motion=Motion(step=1 / cells / 10, end=end),
    )
    found = solved(scene, boxes([Box("bar", (0.0, 0.0), (1.0, 1 / cells), (cells, 1))]))
    times = times_of(found)
    force = np.array([step.supports[0].reaction[0] for step in found.steps])
    flat = (times > 0.05) & (times < 0.17)
    assert force[flat].mean() / (10 * speed / cells) == pytest.approx(1, abs=5e-3)
    left, work = (np.abs(along(found, name)) for name in ("energy_defect", "external_work"))
    assert left.max() < 1e-12 * work.max()
    assert found.checks["momentum_balance"].value < 1e-11
    # Half of the work is kinetic energy, half that of strains, as long as the wave is on its way.
    half = np.searchsorted(times, 0.09)
    assert along(found, "kinetic_energy")[half] == pytest.approx(work[half] / 2, rel=2e-2)


def test_friction_slows_a_sliding_block_by_its_share_of_the_weight():
    """Momentum along the floor against −μ times the impulse across it, in every step."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e4, 0.3, density=1.0),
        discretisation=Discretisation(1),
        load=(Load("body", body_force=(0.0, -10.0), path=ALWAYS),),
        contact=(
            Contact(
                "y0",
                obstacle=Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0)),
                friction_coefficient=0.3,
                law="incremental",
            ),
        ),
        motion=Motion(step=2e-3, end=0.06, velocity={"body": (1.0, 0.0)}),
    )
    found = solved(scene, box_body((4, 2), (1.0, 0.5)))
    along_floor, across = found.quantities["impulse"]
    assert along_floor == pytest.approx(found.quantities["momentum"][0] - 0.5, abs=1e-9)
    assert along_floor == pytest.approx(-0.3 * 2e-3 * along(found, "normal_force").sum(), rel=1e-6)
    assert across == pytest.approx(found.quantities["momentum"][1] + 10 * 0.5 * 0.06, abs=1e-9)
    assert found.quantities["friction_work"] > 0.05


def test_a_bar_hands_its_velocity_to_an_equal_one():
    size = 0.05
    scene = Scene(
        kinematics="plane strain",
        material=Material(100.0, 0.0, density=1.0),
        discretisation=Discretisation(1),
        contact=(Contact("left.x1", against="right.x0"),),
        motion=Motion(step=0.5 * size / 10, end=0.23, velocity={"left": (0.01, 0.0)}),
        point=(Point(name="left", at=(0.5, size / 2)), Point(name="right", at=(1.5, size / 2))),
    )
    parts = [
        Box("left", (0.0, 0.0), (1.0, size), (20, 1)),
        Box("right", (1.0, 0.0), (2.0, size), (20, 1)),
    ]
    found = solved(scene, boxes(parts))
    assert abs(found.quantities["impulse"][0]) == pytest.approx(0.01 * size, rel=3e-2)
    assert found.quantities["momentum"][0] == pytest.approx(0.01 * size, rel=1e-9)
    force = along(found, "normal_force") / (0.5 * 10 * 0.01 * size)  # √(E ρ) v/2
    times = 10 * times_of(found)
    assert np.abs(force[(times > 0.8) & (times < 1.7)] - 1).max() < 2e-2


def test_the_balance_of_momenta_fails_where_a_mass_is_wrong():
    prepared = Run(*bar_on_wall(10, 1.0, end=0.5)[:1], body=bar_on_wall(10, 1.0)[1])
    inertia = prepared.problem.inertia
    assert inertia.moves
    inertia.masses.blocks = inertia.masses.blocks * 1.01  # after 4 M/Δt² was made of it
    found = prepared.solve()
    assert not found.checks["momentum_balance"].passed
    assert "momentum changes by" in found.verdict


def test_two_lengths_of_a_step_that_divide_the_end_alike_are_one():
    motion = Motion(step=0.1, end=0.95)
    assert motion.steps.number == 10 and motion.size == pytest.approx(0.095)
    assert dataclasses.replace(motion, end=1.0).steps.number == 10


@pytest.mark.parametrize(("steps", "every"), [(99, 1), (102, 4)])
def test_of_many_steps_strains_are_looked_at_in_every_fourth_and_the_last(steps, every):
    scene = Scene(
        kinematics="plane strain",
        material=(Material(100.0, 0.3, density=1.0),),
        motion=Motion(step=1e-3, end=1e-3 * steps, velocity={"body": (0.1, 0.0)}),
    )
    found = solved(scene, box_body((1, 1)))
    seen = [number for number, step in enumerate(found.steps, 1) if step.linear_range]
    assert seen == sorted({*range(every, steps + 1, every), steps})
    assert found.checks["linear_range"].passed


def test_the_force_that_stops_a_ball_is_that_of_its_energy():
    """Of F = k d^1.5, whose work is .4 F d."""
    stiffness, moved = 50.0, np.linspace(0.05, 2, 40)
    steps = [
        SimpleNamespace(
            quantities={"normal_force": stiffness * way**1.5},
            loads=[SimpleNamespace(displacement=way)],
        )
        for way in moved
    ]
    energy = 0.4 * stiffness * 1.7**2.5
    found = force_that_stops(SimpleNamespace(steps=steps), energy)
    assert found == pytest.approx(stiffness * 1.7**1.5, rel=1e-3)
    assert force_that_stops(SimpleNamespace(steps=steps), 1.02 * energy) > 1.005 * found


def test_a_force_that_rings_jerks():
    smooth = np.sin(np.linspace(0, np.pi, 101))
    assert jerk(smooth) == pytest.approx((np.pi / 100) ** 2, rel=1e-2)
    assert jerk(smooth + 0.01 * smooth * (-1) ** np.arange(101)) > 0.03
