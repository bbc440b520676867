"""Bodies in motion: bounces, blocks that slide, stick and slip, and steady sliding that squeals.

A mass on a spring, rubbed on both sides under a given pressure: Coulomb's oscillator. It is a
single cell, held along one side, that can move along x alone: half of its mass is at the other
side, and there is one degree of freedom. Between turns it swings about ±μ N/k, so that each turn is
2 μ N/k nearer, until one is nearer than μ N/k.

A mass that rests on a belt by friction that falls when it slides, and is held by a spring. Seen
from the belt: the mass lies still on what does not move, and the spring is pulled at a given speed
v. With D = (μ_s − μ_k) N/k it slides for (2/ω)(π − atan(D ω/v)), each time by as much, and sticks
for 2 D/v until the spring carries μ_s N again.

A block that is pressed onto a plate which slides by: its growth rate, found in two ways. It is 2
wide and 1 high, with E = 1000, ν = .3 and ρ = 1 in plane strain, its top held by a rigid plate
that presses it down by .01. All of its lower side slides, and with a friction coefficient of .3
vibrations grow: those of the largest growth rate overtake all others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import atan, pi

import numpy as np

from fenics_contact.analyses.stability.sliding_modes import (
    exponents,
    first_growth,
    grows,
    lowest_squares,
)
from fenics_contact.analyses.stability.table import Stability
from fenics_contact.common.arrays import Array
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import SpeedDependentFriction
from fenics_contact.scene.loading.conditions import Load, Point
from fenics_contact.scene.loading.motion import Motion
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import Discretisation, Scene
from fenics_contact.scene.values import CONSTANT, Path
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.published.impacts import (
    along,
    ball_scene,
    bar_on_wall,
    falling_bar,
    force_of_wave,
    force_that_stops,
    jerk,
    resting_scene,
    times_of,
    touching,
    worst_defect,
)

_STIFFNESS, _MASS, _COEFFICIENT = 100.0, 1.0, 0.5
FREQUENCY = (_STIFFNESS / _MASS) ** 0.5
_PERIOD = 2 * np.pi / FREQUENCY
# μ N/k (length).
LARGEST_FRICTION = 1e-4


def oscillator(steps: int, periods: float, first_turn: float | None) -> tuple[Scene, Body]:
    """The scene and its mesh.

    Args:
        steps: In a period.
        periods: That it moves.
        first_turn: Where it turns first, over μ N/k; None for no friction.
    """
    speed = FREQUENCY * LARGEST_FRICTION
    contacts: tuple[Contact, ...] = ()
    if first_turn is not None:
        speed *= ((first_turn + 1) ** 2 - 1) ** 0.5
        pressure = _STIFFNESS * LARGEST_FRICTION / _COEFFICIENT  # on half of each of two sides
        rough = {"friction_coefficient": _COEFFICIENT, "law": "incremental"}
        sides = ("mass.y0", "mass.y1")
        contacts = tuple(Contact(side, pressure=pressure, **rough) for side in sides)  # type: ignore[arg-type]
    scene = Scene(
        kinematics="plane strain",
        material=(Material(_STIFFNESS, 0.0, density=2 * _MASS),),
        discretisation=Discretisation(1),
        support=(Support("mass.x0", {"x": 0}), Support("mass", {"y": 0})),
        contact=contacts,
        point=(Point(name="mass", at=(1.0, 0.5)),),
        motion=Motion(step=_PERIOD / steps, end=periods * _PERIOD, velocity={"mass": (speed, 0.0)}),
    )
    return scene, boxes([Box("mass", (0.0, 0.0), (1.0, 1.0), (1, 1))])


def period_of(result: Result) -> float:
    """Of a free oscillation of some periods, over that of the mass on the spring.

    By its passages through 0 upwards, between steps in straight lines.
    """
    times = np.concatenate([[0.0], times_of(result)])
    places = np.concatenate([[0.0], along(result, "displacement_mass")[:, 0]])
    upwards = np.flatnonzero((places[1:-1] < 0) & (places[2:] >= 0)) + 1
    before, after = places[upwards], places[upwards + 1]
    passed = times[upwards] - before / (after - before) * (times[upwards + 1] - times[upwards])
    return float(passed[-1] / len(passed) / _PERIOD)


# μ_k/μ_s, and v over D ω.
_KINETIC, _SPEED = 2 / 3, 0.5
_SHORTER = (1 - _KINETIC) * LARGEST_FRICTION  # D (length)
_PULLED = _SPEED * _SHORTER * FREQUENCY
# Of the pull's speed, from which friction is μ_k: nearly at once, as the formula has it.
_SLIDES = 1e-5
PERIOD = (2 / FREQUENCY) * (pi - atan(1 / _SPEED)) + 2 * _SHORTER / _PULLED


def belt(steps: int, periods: float, kinetic: float = _KINETIC) -> tuple[Scene, Body]:
    """The scene and its mesh.

    Args:
        steps: In a period.
        periods: That it moves.
        kinetic: μ_k/μ_s.
    """
    scene, body = oscillator(steps, periods, first_turn=1.0)
    law = SpeedDependentFriction("speed dependent", (0, _SLIDES * _PULLED), (1, kinetic))
    end = periods * PERIOD
    pulled = Support("mass.x0", {"x": _PULLED * end}, path=Path(time=(0, end), factor=(0, 1)))
    scene = replace(
        scene,
        support=(pulled, Support("mass", {"y": 0})),
        contact=tuple(replace(contact, friction_law=law) for contact in scene.contact),
        motion=Motion(step=PERIOD / steps, end=end),
    )
    return scene, body


def period_on_belt(result: Result) -> float:
    """Of stick and slip, over that of the formula.

    By the passages of the spring's length through its middle, between steps in straight lines.
    """
    times = times_of(result)
    shorter = along(result, "displacement_mass")[:, 0] - _PULLED * times
    settled = shorter[len(shorter) // 2 :]
    off = shorter - 0.5 * (settled.max() + settled.min())
    before = np.flatnonzero((off[:-1] < 0) & (off[1:] >= 0))
    share = off[before] / (off[before] - off[before + 1])
    passed = times[before] + share * (times[before + 1] - times[before])
    return float((passed[-1] - passed[0]) / (len(passed) - 1) / PERIOD)


# E (1 − ν)/((1 + ν)(1 − 2 ν))/ρ.
_WAVE = (1000 * 0.7 / (1.3 * 0.4)) ** 0.5
_SPEED_SLIDING_BLOCK = 20.0  # of the plate; any that no vibration reaches
_PUSH = 1e-4  # by which it is disturbed (stress)
_PATH = Path(time=(0.0, 0.02, 0.04), factor=(0.0, 1.0, 0.0))


def sliding_block(cells: int, stability: Stability | None) -> tuple[Scene, Body]:
    """The scene at rest, under a plate that has slid by 1.

    Args:
        cells: Along its height.
        stability: What is asked of it.
    """
    plate = Obstacle("plane", position=(0.0, 0.0), normal=(0.0, 1.0), displacement=(-1.0, 0.0))
    scene = Scene(
        kinematics="plane strain",
        material=(Material(1000.0, 0.3, density=1.0),),
        discretisation=Discretisation(1),
        support=(Support("block.y1", {"x": 0.0, "y": -0.01}, path=CONSTANT),),
        contact=(Contact("block.y0", obstacle=plate, friction_coefficient=0.3, law="incremental"),),
        stability=stability,
    )
    return scene, boxes([Box("block", (0.0, 0.0), (2.0, 1.0), (2 * cells, cells))])


def moving_block(cells: int, courant: float, end: float) -> tuple[Scene, Body]:
    """The same as a motion, which begins from that state and is pushed a little on one side.

    Args:
        cells: Along its height.
        courant: Speed of a wave times the step, over the length of a cell.
        end: Of the motion (time).
    """
    scene, body = sliding_block(cells, None)
    (contact,) = scene.contact
    assert contact.obstacle is not None
    path = Path(time=(0.0, end), factor=(1.0, 1.0 + _SPEED_SLIDING_BLOCK * end))
    moved = replace(contact, obstacle=replace(contact.obstacle, displacement_path=path))
    motion = Motion(step=courant / (cells * _WAVE), end=end, start="static")
    push = Load("block.x1", traction=(_PUSH, 0.0), path=_PATH)
    return replace(scene, load=(push,), contact=(moved,), motion=motion), body


def growth_in_time(result: Result, last: float) -> float:
    """Rate at which vibrations of a motion grow: half of that of the kinetic energy.

    The block itself is at rest, so that this is that of vibrations alone.

    Args:
        result: Of ``moving_block``.
        last: How long before its end it is measured (time).
    """
    times, energies = times_of(result), along(result, "kinetic_energy")
    late = times >= times[-1] - last
    return float(np.polyfit(times[late], np.log(energies[late]), 1)[0] / 2)


_CELLS = 8


def _squeal(quick: bool) -> Iterator[Finding]:
    yield from _two_masses()
    found = solved(*sliding_block(_CELLS, Stability(number=16))).stability
    assert found is not None
    rate = max(mode.growth_rate for mode in found.modes)
    for courant in (1.0,) if quick else (1.0, 0.25):
        moved = solved(*moving_block(_CELLS, courant, end=3.25))
        label = f"growth rate of a sliding block, by time stepping at CFL {courant:g}"
        yield Finding(label, growth_in_time(moved, last=0.75), rate, 5e-2)


def _two_masses() -> Iterator[Finding]:
    """k₁ = 2, k₂ = 1, k₁₂ = k₂₁ = .3 and k₃ = 1, of unit masses: when their frequencies merge."""
    critical = (0.3 + (2.0 - 1.0) ** 2 / (4 * 0.3)) / 1.0
    found = first_growth(_grows, [0.1 * number for number in range(21)], 1e-5)
    value = np.nan if found is None else found
    yield Finding("critical coefficient of two masses", value, critical, 1e-3)


def _grows(coefficient: float) -> bool:
    stiffness = np.array([[2.0, 0.3 - coefficient], [0.3, 1.0]])

    def solve(force: Array) -> Array:
        return np.asarray(np.linalg.solve(stiffness, force))

    squares, _ = lowest_squares(2, 2, lambda moved: moved, solve)
    return grows(exponents(squares))


SQUEAL_CASES: tuple[Case, ...] = (
    Case(
        "squeal",
        "steady sliding that flutters: two masses, and a block by eigenvalues and in time",
        "frequencies of two masses that merge, (k₁₂ + (k₁ − k₂)²/(4 k₂₁))/k₃; the program's own "
        "motion from the same state",
        _squeal,
    ),
)


_PLATEAU, _ENERGY = 5e-3, 3e-4


def _motion(quick: bool) -> Iterator[Finding]:
    yield from _bars(quick)
    if not quick:
        yield from _falling()
    yield from _balls(quick)
    yield from _oscillators(quick)
    yield from _belts(quick)


def _bars(quick: bool) -> Iterator[Finding]:
    """Force of a bar on a wall, between .2 and 1.8 L/c, its whole impulse, and its energy."""
    asked = [(100, 1.0, None), (100, 0.25, None), (100, 0.25, 1e-6), (400, 1.0, None)]
    for cells, courant, penalty in asked[:1] if quick else [*asked, (400, 0.25, None)]:
        found = solved(*bar_on_wall(cells, courant, penalty=penalty))
        label = f", bar of {cells} cells, CFL {courant:g}"
        label += "" if penalty is None else f", penalty {penalty:g}"
        times = 10 * times_of(found)
        flat = along(found, "normal_force")[(times > 0.2) & (times < 1.8)] / force_of_wave(cells)
        for name, value in (("least", flat.min()), ("largest", flat.max())):
            yield Finding(f"{name} normal_force of the wave{label}", float(value), 1.0, _PLATEAU)
        impulse = found.quantities["impulse"][0] / (2 * 0.01 / cells)
        yield Finding(f"impulse{label}", impulse, 1.0, 1e-2 if cells < 400 else 4e-3)
        yield Finding(f"energy left open{label}", worst_defect(found), 0.0, _ENERGY, absolute=True)


def _falling() -> Iterator[Finding]:
    """A bar that falls lands at 1, with ρ c (v₀ + g t), and again after a flight of 2."""
    cells = 100
    found = solved(*falling_bar(cells, 0.37, 3.75))
    times, touches = times_of(found), touching(found)
    flat = (times > 1.1) & (times < 1.6)
    force = along(found, "normal_force") / (10 / cells) / (30 * 10 * times)
    yield Finding("normal_force of the first impact", float(force[flat].mean()), 1.0, _PLATEAU)
    landings = times[1:][touches[1:] & ~touches[:-1]] - 0.5 * (times[1] - times[0])
    yield Finding("second impact", float(landings[1]), 11 / 3, 3e-3, absolute=True)
    found = solved(*falling_bar(50, 0.37, 5.0))
    left = worst_defect(found)
    yield Finding("energy left open in 5 s", left, 0.0, 2e-3, absolute=True)


def _balls(quick: bool) -> Iterator[Finding]:
    """A ball on a plane: its greatest force, and how smoothly the force goes."""
    resting = solved(resting_scene())
    asked = (
        [(200, None), (200, 10)] if quick else [(200, None), (200, 10), (800, None), (3200, None)]
    )
    for steps, modes in asked:
        found = solved(ball_scene(steps, modes))
        force, energy = along(found, "normal_force"), found.steps[0].quantities["kinetic_energy"]
        label = f", ball, {steps} steps of contact" + (f", in {modes} modes" if modes else "")
        greatest = force_that_stops(resting, energy)
        yield Finding(f"greatest normal_force{label}", float(force.max()), greatest, 3e-3)
        what = f"greatest second difference of it, over it{label}"
        yield Finding(what, jerk(force), 0.0, 5e-3, absolute=True)


def _oscillators(quick: bool) -> Iterator[Finding]:
    """A mass on a spring, rubbed by a force: where it rests; without friction, its period."""
    for steps, tolerance in ((200, 1e-3),) if quick else ((200, 1e-3), (800, 2e-4)):
        found = solved(*oscillator(steps, 3.1, first_turn=10.3))
        places = along(found, "displacement_mass")[:, 0] / LARGEST_FRICTION
        speed = np.sqrt(along(found, "kinetic_energy") / along(found, "kinetic_energy").max())
        label = f", {steps} steps a period"
        rest, last = float(places[-1]), float(speed[-1])
        yield Finding(f"rest of a mass with friction{label}", rest, -0.3, tolerance, absolute=True)
        yield Finding(f"its last speed, over the first{label}", last, 0.0, 1e-9, absolute=True)
    for steps in (20,) if quick else (20, 50):
        found = solved(*oscillator(steps, 4.25, first_turn=None))
        longer = pi / steps / atan(pi / steps)
        yield Finding(f"period at {steps} steps each", period_of(found), longer, 1e-4)


def _belts(quick: bool) -> Iterator[Finding]:
    """A mass that sticks to a belt and slips by turns: its period."""
    for steps, tolerance in ((200, 5e-3),) if quick else ((200, 5e-3), (3200, 5e-4)):
        found = solved(*belt(steps, 2.8))
        what = f"period of stick and slip on a belt, {steps} steps each"
        yield Finding(what, period_on_belt(found), 1.0, tolerance)


MOTION_CASES: tuple[Case, ...] = (
    Case(
        "motion",
        "bars and a ball that bounce, a mass on a spring with friction, stick-slip",
        "waves by d'Alembert; D. Doyen, A. Ern and S. Piperno (2011), Section 5; m d'' = −F(d) "
        "with the ball's own static F(d); turning points of Coulomb's oscillator; the midpoint "
        "rule's period",
        _motion,
    ),
)
