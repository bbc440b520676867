"""What ``fenics-contact verify motion`` compares."""

from __future__ import annotations

from collections.abc import Iterator
from math import atan, pi

import numpy as np

from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.impacts import (
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
from fenics_contact.verification.sliding import (
    LARGEST_FRICTION,
    belt,
    oscillator,
    period_of,
    period_on_belt,
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
