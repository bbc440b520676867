"""The numbers that each demo should give, for its page in the gallery; ``problems/`` has the words.

Expected numbers come from formulas, from the paper, or from computations made apart from this
program; each row says which. None is what the demo once gave.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import log, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from fenics_contact.analytic import contact as formulas
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.records.run import RunRecord
from fenics_contact.verification.case import Finding

PAPER = "L. T. Campos, J. T. Oden, N. Kikuchi, Comput. Methods Appl. Mech. Engrg. 34 (1982) 821-845"
JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge University Press 1985"
PROTOTYPE = "values of a separate prototype on the same data"
NO_FRICTION = "contact.0.friction_coefficient=0"
# Of a film: as loads grow from nothing.
_GROWING = ("steps.number=20",)


@dataclass(frozen=True)
class Solved:
    """A demo that was run.

    Attributes:
        result: The content of its ``result.json``.
        table: Its contact points.
    """

    result: RunRecord
    table: ContactTable

    def value(self, quantity: str, axis: int | None = None) -> float:
        """A quantity of the last load step, of vectors a component."""
        found = self.result.quantities[quantity]
        return float(found if axis is None else found[axis])

    def bar(self, quantity: str) -> float | None:
        """Its estimated absolute error, if there is one."""
        row = self.result.errors.get(quantity, {})
        return row.get("total")

    def steps(self) -> list[Quantities]:
        """Quantities of each load step."""
        return [step.quantities for step in self.result.steps]

    def against(
        self,
        label: str,
        quantity: str,
        reference: float,
        tolerance: float,
        axis: int | None = None,
    ) -> Finding:
        """A quantity beside what it should be, within a relative tolerance."""
        value = self.value(quantity, axis)
        return Finding(label, value, reference, tolerance, bar=self.bar(quantity))

    def radius(self, label: str, quantity: str, reference: float, tolerance: float) -> Finding:
        """Radius of the circle that has the area of a quantity."""
        area, bar = self.value(quantity), self.bar(quantity)
        radius = sqrt(area / pi)
        bar = None if bar is None else radius * bar / (2 * area)
        return Finding(label, radius, reference, tolerance, bar=bar)


Findings = Callable[[Solved], Iterator[Finding]]


@dataclass(frozen=True)
class Variant:
    """The demo again, with other values.

    Attributes:
        title: What differs, in words.
        overrides: As for ``--set``.
        findings: What it should give.
    """

    title: str
    overrides: tuple[str, ...]
    findings: Findings


@dataclass(frozen=True)
class Entry:
    """A page of the gallery.

    Attributes:
        source: Where the expected numbers come from.
        findings: What the demo should give.
        variants: Further runs.
        film: Values with which the demo has the load steps of a film, as for ``--set``; none
            where its own steps make one.
    """

    source: str
    findings: Findings
    variants: tuple[Variant, ...] = field(default=())
    film: tuple[str, ...] = ()


def _impact(solved: Solved) -> Iterator[Finding]:
    """Hertz's law with Newton's, for the mass of the mesh; a ball is by 4 % stiffer."""
    modulus, radius, speed = 210e3 / (1 - 0.3**2), 10.0, 5000.0
    mass = 4 / 3 * pi * radius**3 * 7.85e-9
    force = 1.282689 * modulus**0.4 * mass**0.6 * speed**1.2 * radius**0.2
    lasts = 2.868266 * (mass**2 / (radius * modulus**2 * speed)) ** 0.2
    widest = 0.987175 * (radius**2 * mass * speed**2 / modulus) ** 0.2
    forces = np.array([step["normal_force"] for step in solved.steps()])
    areas = np.array([step["contact_area"] for step in solved.steps()])
    yield Finding("largest force, of a half-space", float(forces.max()), force, 0.05)
    time = 2e-7 * np.count_nonzero(forces > 0)
    yield Finding("duration of the contact, likewise", float(time), lasts, 0.05)
    yield Finding("largest radius of the contact", sqrt(areas.max() / pi), widest, 0.06)
    impulse = solved.result.quantities["impulse"][1]
    yield Finding("impulse over 2 m v", impulse / (2 * mass * speed), 1.0, 0.01)
    left = solved.value("kinetic_energy") / (0.5 * mass * speed**2)
    yield Finding("kinetic energy that is left", left, 1.0, 0.01)


def _stick_slip(solved: Solved) -> Iterator[Finding]:
    """What slides fast has the coefficient of sliding."""
    steps = list(solved.steps())
    along = np.array([step["friction_force"][0] for step in steps])
    shares = along / np.array([step["normal_force"] for step in steps])
    fastest = int(np.argmax([step["kinetic_energy"] for step in steps]))
    yield Finding(
        "friction over normal force, when it moves fastest", float(shares[fastest]), 0.5, 0.02
    )
    left = solved.value("energy_defect") / solved.value("external_work")
    yield Finding("energy left open, over the work done", left, 0.0, 0.01, absolute=True)


_MODULUS = formulas.plane_strain_modulus(1000, 0.3)
_HERTZ = formulas.paraboloid(_MODULUS, radius=8, indentation=1)
_RING = formulas.annular_punch_force(_MODULUS, inner=0.5, outer=1, indentation=0.01)


def _sticking(solved: Solved) -> NDArray[np.float64]:
    """Where the points that stick are along x."""
    return solved.table.numbers["x"][solved.table.status == "STICK"]


def _last_sticking(solved: Solved) -> float:
    return float(_sticking(solved).max())


def _slab(solved: Solved) -> Iterator[Finding]:
    yield solved.against("friction force along x", "friction_force", 209.98, 1e-3, axis=0)
    yield solved.against("reaction on the left", "reaction", 90.02, 1e-3, axis=0)
    last = _last_sticking(solved)
    yield Finding("last contact point that sticks, x", last, 6.25, 1e-9, absolute=True)


def _slab_fine(solved: Solved) -> Iterator[Finding]:
    last = _last_sticking(solved)
    yield Finding("last contact point that sticks, x", last, 6.41, 0.01, absolute=True)


def _winkler(solved: Solved) -> Iterator[Finding]:
    yield solved.against("contact force (all that presses)", "normal_force", 10, 1e-6)
    yield solved.against("deflection in the middle, $w(0)$", "max_penetration", 0.0578, 2e-3)
    yield solved.against("contact ends at x", "contact_area", 3.20, 5e-3)
    yield solved.against("friction force along x", "friction_force", -8.20, 5e-3, axis=0)


def _winkler_smooth(solved: Solved) -> Iterator[Finding]:
    yield solved.against("deflection in the middle, $w(0)$", "max_penetration", 0.0718, 2e-3)
    yield solved.against("contact ends at x", "contact_area", 2.36, 5e-3)


def _sphere(solved: Solved) -> Iterator[Finding]:
    force = 1.0247 * _HERTZ.force
    yield solved.against("force, $F = 1.0247\\, F_{Hertz}$", "normal_force", force, 1e-3)
    sticks, touches = solved.value("stick_area"), solved.value("contact_area")
    yield Finding("sticks up to $c/a$", sqrt(sticks / touches), 0.765, 3e-3)


def _hertz(solved: Solved) -> Iterator[Finding]:
    yield solved.against("force, $F$", "normal_force", _HERTZ.force, 1e-3)
    yield solved.against("peak pressure, $p_0$", "max_contact_pressure", _HERTZ.peak, 5e-3)
    yield solved.radius("contact radius, $a$", "contact_area", _HERTZ.radius, 5e-3)


def _annulus(solved: Solved) -> Iterator[Finding]:
    force = 1.0231 * _RING
    yield solved.against("force, 1.0231 times that without friction", "normal_force", force, 2e-3)
    yield Finding("sticks from $r$", float(_sticking(solved).min()), 0.510, 0.01)
    yield Finding("sticks up to $r$", float(_sticking(solved).max()), 0.905, 0.01)


def _annulus_smooth(solved: Solved) -> Iterator[Finding]:
    yield solved.against("force, $F$", "normal_force", _RING, 2e-3)


def _annulus_bonded(solved: Solved) -> Iterator[Finding]:
    yield solved.against("force, 1.0276 times $F$", "normal_force", 1.0276 * _RING, 2e-3)


def _cylinders(solved: Solved) -> Iterator[Finding]:
    force, shear = solved.value("normal_force"), -solved.value("friction_force", 0)
    contact = formulas.line_contact(_MODULUS / 2, radius=4, force=force)
    width = solved.value("contact_area")
    yield Finding("half-width of the contact, $a$", width / 2, contact.radius, 5e-3)
    yield solved.against("peak pressure, $p_0$", "max_contact_pressure", contact.peak, 3e-3)
    ratio = sqrt(1 - shear / (0.3 * force))
    sticks = solved.value("stick_area") / width
    yield Finding("sticks on $c/a = \\sqrt{1 - Q/\\mu F}$", sticks, ratio, 1e-2)


def _incline(solved: Solved) -> Iterator[Finding]:
    weight, slope, friction = 10, 0.1, 0.3
    limit = weight * (friction + slope) / (1 - friction * slope)
    supports = {row.on: row.reaction for row in solved.result.supports}
    push = supports["block.left"][0]
    yield Finding("push $F$ when all of it slides", push, limit, 1e-9)
    normal = (weight + limit * slope) / sqrt(1 + slope**2)
    yield solved.against("force across the incline", "normal_force", normal, 1e-9)


def _cattaneo(solved: Solved) -> Iterator[Finding]:
    area = 2 * solved.value("contact_area")  # the model is half of the body
    yield Finding("contact radius, $a$", sqrt(area / pi), 1.0, 0.015)
    steps = solved.steps()
    for number in (4, 7, 10):
        step = steps[number]
        share = step["friction_force"][0] / (0.3 * step["normal_force"])
        sticks = sqrt(step["stick_area"] / step["contact_area"])
        label = f"sticks up to $c/a$ at $Q = {share:.3f}\\, \\mu P$"
        yield Finding(label, sticks, (1 - share) ** (1 / 3), 0.03, absolute=True)


def _ironing(solved: Solved) -> Iterator[Finding]:
    first, end = solved.steps()[0], solved.steps()[-1]
    yield Finding("force, pressed in", -first["contact_force"][1], 0.416159, 1e-4)
    yield Finding("force, dragged", -end["contact_force"][1], 0.411790, 1e-4)
    yield Finding("force along, dragged", end["contact_force"][0], 0.123484, 1e-4)


def _cycle(solved: Solved) -> Iterator[Finding]:
    steps = solved.steps()
    turns = [steps[number - 1] for number in (6, 26, 46)]
    forces = [abs(turn["friction_force"][0]) for turn in turns]
    most = forces[1] / (0.5 * 20)
    share = (1 - most) * log(1 - most) + most - most**2 / 2
    work = 4 * (0.5 * 20) ** 2 / (pi * 1000 / (1 - 0.49**2)) * share
    for number, (turn, last) in enumerate(zip(turns[1:], turns, strict=False), 1):
        found = turn["friction_work"] - last["friction_work"]
        yield Finding(f"friction work of cycle {number}", found, work, 0.02)
    loop = np.array([step["friction_force"][0] for step in steps[25:46]])
    there = 0.022 * np.linspace(1, -1, 11)
    moved = np.concatenate([there, there[-2::-1]])
    area = float(abs(np.sum((loop[1:] + loop[:-1]) / 2 * np.diff(moved))))
    yield Finding("area of the second loop", area, work, 0.02)


def _fretting(solved: Solved) -> Iterator[Finding]:
    table, half = solved.table, 1.0
    yield Finding("friction, $Q$", -solved.value("friction_force", 0), 60 * (51.693 - 50.357), 1e-3)
    yield solved.against("largest pressure, $p_0$", "max_contact_pressure", 157.0, 5e-3)
    yield solved.against("width of the contact, $2a$", "contact_area", 2 * half, 0.015)
    stick = 2 * half * sqrt(1 - 80.16 / (0.65 * 246.6))
    yield solved.against("width of what sticks, $2c$", "stick_area", stick, 0.02)
    sticks = table.numbers["x"][table.status == "STICK"]
    shift = half * 51.025 / (2 * 0.65 * 157)
    middle = -float(sticks.min() + sticks.max()) / 2
    yield Finding("middle of what sticks, $e$", middle, shift, 0.02, absolute=True)


def _joint(solved: Solved) -> Iterator[Finding]:
    first, last = solved.result.steps[0], solved.result.steps[-1]
    bolt = first.preloads["bolt"]
    yield Finding("force of the bolt when it is tightened, $F_V$", bolt.force, 10e3, 1e-9)
    yield Finding("its elongation, $q$", bolt.elongation, _handbook(10e3), 0.15)
    forces = {row.name: row.quantities for row in last.contacts}
    held = last.preloads["bolt"].force
    yield Finding(
        "force under the head at the end, over the bolt's", _over(forces, held), 1.0, 1e-6
    )
    carried = forces["lap"]["friction_force"][0] - forces["head"]["friction_force"][0]
    yield Finding("friction on the left bar, $Q$", carried, 1500, 1e-6)


def _over(forces: Mapping[str, Quantities], held: float) -> float:
    return float(forces["head"]["normal_force"] / held)


def _handbook(force: float) -> float:
    """Elongation of the joint's bolt by the formulas on its page."""
    diameter, length = 8.0, 10.0
    bolt = 210e3 * pi * diameter**2 / 4 / (length + 0.8 * diameter)
    cone = 5 * (0.5774 * length + 0.5 * diameter) / (0.5774 * length + 2.5 * diameter)
    return force / bolt + force * 2 * log(cone) / (0.5774 * pi * 70e3 * diameter)


def _joint_damping(solved: Solved) -> Iterator[Finding]:
    result = solved.result
    unit = sqrt(210e3 / 7.85e-9) * 10 / sqrt(12) / (2 * pi * 200**2)
    for mode, square, tolerance in zip(
        result.modes, (3.516015, 22.034492, 61.697214), (5e-3, 2e-2, 5e-2), strict=True
    ):
        name = f"natural frequency {mode.number} while all sticks (Hz)"
        yield Finding(name, mode.natural_frequency, square * unit, tolerance)
    last = result.damping[-1]
    name = "natural frequency at the largest amplitude (Hz)"
    yield Finding(name, last.natural_frequency, 0.5 * 3.516015 * unit, 0.1)
    name = "what friction dissipates there in a cycle, against the area of the loop"
    yield Finding(name, last.loss, last.loop_area, 1e-2)


def warm_fit(share: float) -> tuple[float, float]:
    """Pressure of the warm fit (N/mm²), and the heat that crosses (N mm/s), by its page's formulas.

    Args:
        share: Of the temperature at the bore that there is.
    """
    inner, radius, outer, length, conductivity, rise = 10.0, 20.0, 40.0, 20.0, 50.0, 180 * share
    rings, shear = ((inner, radius), (radius, outer)), 1.3 / 210e3

    def flow(pressure: float) -> float:
        parts = [1 / (radius * pressure / 20), 1 / (outer * 5)]
        parts += [log(to / start) / conductivity for start, to in rings]
        return rise / sum(parts)

    def overlap(pressure: float) -> float:
        """What is left of the interference once both rings have moved."""
        heat, moved, at = flow(pressure), [0.01, 0.0], rise
        for number, (start, to) in enumerate(rings):
            drop = heat * log(to / start) / conductivity
            end, size = at - drop, to**2 - start**2
            warmth = (end * to**2 - at * start**2) / 2 + drop * size / (4 * log(to / start))
            other = start if number == 0 else to
            soft = shear * radius * (0.4 * radius**2 + other**2) / size
            moved[number] += 2 * 12e-6 * 1.3 * radius * warmth / size
            moved[number] += soft * pressure * (-1 if number == 0 else 1)
            at = end - heat / (radius * pressure / 20)
        return moved[0] - moved[1]

    pressure = float(brentq(overlap, 1e-3, 1e3, xtol=1e-12))
    return pressure, 2 * pi * length * flow(pressure)


def _warm_fit(solved: Solved) -> Iterator[Finding]:
    area, steps = 2 * pi * 20 * 20, solved.steps()
    cold, (warm, heat) = warm_fit(0.0)[0], warm_fit(1.0)
    yield Finding("pressure while it is cold", steps[0]["pressure_integral"] / area, cold, 1e-4)
    yield Finding("pressure in the end", steps[-1]["pressure_integral"] / area, warm, 1e-4)
    yield Finding("heat that crosses", -solved.value("heat_flow"), heat, 1e-4)


ENTRIES: dict[str, Entry] = {
    "slab": Entry(
        source=f"{PAPER}, example 1; parts of its data are lost and reconstructed, {PROTOTYPE}",
        findings=_slab,
        film=_GROWING,
        variants=(
            Variant(
                "Cells of an eighth of that",
                ("mesh.parameters.cells_along=128", "mesh.parameters.cells_across=16"),
                _slab_fine,
            ),
        ),
    ),
    "winkler": Entry(
        source=f"{PAPER}, example 2; data reconstructed, {PROTOTYPE}",
        findings=_winkler,
        film=_GROWING,
        variants=(Variant("Without friction", (NO_FRICTION,), _winkler_smooth),),
    ),
    "sphere": Entry(
        source=(
            f"{PAPER}, example 3, ratios of an integral equation solved apart; "
            f"without friction {JOHNSON}, (4.22)-(4.24)"
        ),
        findings=_sphere,
        film=_GROWING,
        variants=(Variant("Without friction: Hertz's problem", (NO_FRICTION,), _hertz),),
    ),
    "annulus": Entry(
        source=(
            f"{PAPER}, example 4, ratios of a separate prototype; without friction the integral "
            f"equation of ring loads ({JOHNSON}, section 3.8)"
        ),
        findings=_annulus,
        film=_GROWING,
        variants=(
            Variant("Without friction", (NO_FRICTION,), _annulus_smooth),
            Variant(
                "Glued to the ring",
                ('contact.0.contact="bonded"', NO_FRICTION),
                _annulus_bonded,
            ),
        ),
    ),
    "cylinders": Entry(
        source=f"{JOHNSON}, (4.43), (4.45) and section 7.2, for the forces that came out",
        findings=_cylinders,
        film=(f"steps.times={[round(1 + 0.1 * step, 1) for step in range(11)]}",),
    ),
    "incline": Entry(
        source="balance of forces and Coulomb's law",
        findings=_incline,
    ),
    "joint": Entry(
        source="balance of forces; J. E. Shigley, Mechanical Engineering Design, (8-22)",
        findings=_joint,
    ),
    "joint_damping": Entry(
        source="Euler's beam, of both layers together and of each alone; balance of energy",
        findings=_joint_damping,
    ),
    "ironing": Entry(source=PROTOTYPE, findings=_ironing),
    "cycle": Entry(
        source=f"{JOHNSON}, sections 7.2 and 7.4, for the largest force that came out",
        findings=_cycle,
    ),
    "warm_fit": Entry(
        source="S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970, articles 28 and 151",
        findings=_warm_fit,
    ),
    "impact": Entry(
        source=f"H. Hertz; {JOHNSON}, section 11.4; balance of momentum",
        findings=_impact,
    ),
    "stick_slip": Entry(
        source="Coulomb's law at rest and in sliding; balance of energy",
        findings=_stick_slip,
    ),
    "fretting": Entry(
        source="D. Nowell, D. A. Hills, Int. J. Mech. Sci. 29 (1987) 355-365",
        findings=_fretting,
    ),
    "cattaneo": Entry(
        source=f"{JOHNSON}, section 7.2, for the forces that came out",
        findings=_cattaneo,
    ),
}
