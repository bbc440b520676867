"""What the gallery says of each demo: the problem in words, and the numbers it should give.

Expected numbers come from formulas, from the paper, or from computations made apart from this
program; each row says which. None is what the demo once gave.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from math import log, pi, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_table import ContactTable
from fenics_contact.verification import formulas
from fenics_contact.verification.case import Finding

PAPER = "L. T. Campos, J. T. Oden, N. Kikuchi, Comput. Methods Appl. Mech. Engrg. 34 (1982) 821-845"
JOHNSON = "K. L. Johnson, Contact Mechanics, Cambridge University Press 1985"
PROTOTYPE = "values of a separate prototype on the same data"
NO_FRICTION = "contact.0.friction_coefficient=0"


@dataclass(frozen=True)
class Solved:
    """A demo that was run.

    Attributes:
        result: The content of its ``result.json``.
        table: Its contact points.
    """

    result: dict[str, Any]
    table: ContactTable

    def value(self, quantity: str, axis: int | None = None) -> float:
        """A quantity of the last load step, of vectors a component."""
        found = self.result["quantities"][quantity]
        return float(found if axis is None else found[axis])

    def bar(self, quantity: str) -> float | None:
        """Its estimated absolute error, if there is one."""
        row = self.result["errors"].get(quantity, {})
        return row.get("total")

    def steps(self) -> list[dict[str, Any]]:
        """Quantities of each load step."""
        return [step["quantities"] for step in self.result["steps"]]

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
        title: Its heading.
        problem: The problem in words, with its formulas, in Markdown.
        source: Where the expected numbers come from.
        findings: What the demo should give.
        variants: Further runs.
    """

    title: str
    problem: str
    source: str
    findings: Findings
    variants: tuple[Variant, ...] = field(default=())


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
    supports = {row["on"]: row["reaction"] for row in solved.result["supports"]}
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


ENTRIES: dict[str, Entry] = {
    "slab": Entry(
        title="A slab pushed against friction",
        source=f"{PAPER}, example 1; parts of its data are lost and reconstructed, {PROTOTYPE}",
        findings=_slab,
        variants=(
            Variant(
                "Cells of an eighth of that",
                ("mesh.parameters.cells_along=128", "mesh.parameters.cells_across=16"),
                _slab_fine,
            ),
        ),
        problem=r"""
A slab of 8 × 1 lies on a smooth floor. A ceiling presses on it with $p = 300$ and is rough: friction
can carry up to $g = \mu p = 90$. Its right end is pushed with 300. How far does the slab slip?

The pressure is given, the paper's case (i), so there is an energy to minimise,

$$
I(v) = \tfrac12 a(v, v) - f(v) + \int_{\Gamma_C} g\, |v_T|\, ds ,
$$

and just one answer. Where the traction stays below $g$, nothing moves; at the right end the slab
slips, and friction is $g$ there. Balance of forces checks the answer by hand. Pressed by 300 from above,
the slab would widen; where it sticks it cannot, which takes a stress of
$\nu\,\sigma_y = -90$ in plane stress, and that is what the left support feels, nearly. Friction carries
the rest, 210.
""",
    ),
    "winkler": Entry(
        title="A slab on springs that only push",
        source=f"{PAPER}, example 2; data reconstructed, {PROTOTYPE}",
        findings=_winkler,
        variants=(Variant("Without friction", (NO_FRICTION,), _winkler_smooth),),
        problem=r"""
A slab of 20 × 1 lies on a Winkler foundation: springs that push, but do not pull, with a pressure of
$k = 100$ times the depth, and rub, with a friction of at most $\mu p$, $\mu = 1$. A patch in its middle is
pressed down by 10 on each half. The ends lift off; the model is the right half.

The foundation is the paper's penalty (4.1), with a stiffness that is meant:

$$
\frac{k}{2} \int_{\Gamma_C} \big((v_n - s)_+\big)^2 ds , \qquad p = k\,(v_n - s)_+ .
$$

Friction along the bottom hinders the slab's bending: it sinks in less, and touches farther out. A beam
theory, whose sections stay plane and whose bottom does not move along the springs, would miss this.
""",
    ),
    "sphere": Entry(
        title="A sphere on a half-space, with friction",
        source=(
            f"{PAPER}, example 3, ratios of an integral equation solved apart; "
            f"without friction {JOHNSON}, (4.22)-(4.24)"
        ),
        findings=_sphere,
        variants=(Variant("Without friction: Hertz's problem", (NO_FRICTION,), _hertz),),
        problem=r"""
A rigid paraboloid with the curvature of a sphere, $R = 8$, is driven by $d = 1$ into a half-space.
Without friction this is Hertz's problem, with $E^* = E/(1 - \nu^2)$:

$$
F = \tfrac43 E^* \sqrt{R}\, d^{3/2}, \qquad a = \sqrt{R d}, \qquad
p_0 = \frac{2 E^*}{\pi} \sqrt{\frac{d}{R}} .
$$

With friction the surface, which would move inwards, is held back: the middle of the contact sticks, a
ring around it slips, and the same indentation takes more force. The pressure is not known beforehand
(case (ii)): friction depends on the pressure and the pressure on friction. The law is the static one, on
the total displacement; with the incremental law and small load steps nearly all of the contact sticks.

The mesh is a piece of the half-space, with the displacements that Boussinesq gives for the contact's
force on its outer boundary.
""",
    ),
    "annulus": Entry(
        title="A flat ring on a half-space",
        source=(
            f"{PAPER}, example 4, ratios of a separate prototype; without friction the integral "
            f"equation of ring loads ({JOHNSON}, section 3.8)"
        ),
        findings=_annulus,
        variants=(
            Variant("Without friction", (NO_FRICTION,), _annulus_smooth),
            Variant(
                "Glued to the ring",
                ('contact.0.contact="bonded"', NO_FRICTION),
                _annulus_bonded,
            ),
        ),
        problem=r"""
A rigid, flat ring, $.5 < r < 1$, is pressed by $d = .01$ into a half-space. All is linear in $d$. The
surface under the ring moves towards its middle line; friction with $\mu = .3$ holds the inner part, and
near both edges it slips. The pressure is infinite at the edges: it has no peak to converge to, but the
force does. Without friction the pressure obeys

$$
\frac{4}{\pi E^*} \int_{.5}^{1} p(s)\, \frac{s}{r + s}\, K(m)\, ds = d , \qquad
1 - m = \left(\frac{r - s}{r + s}\right)^2 ,
$$

with the complete elliptic integral $K$. It is solved numerically for the table: the ring takes 98 % of
the force $2 E^* d$ of a full punch of radius 1.
""",
    ),
    "cylinders": Entry(
        title="Two cylinders pressed together, then shifted",
        source=f"{JOHNSON}, (4.43), (4.45) and section 7.2, for the forces that came out",
        findings=_cylinders,
        problem=r"""
Halves of two equal elastic cylinders, $R = 8$, are pressed together and then shifted along each other.
They have meshes of their own, which do not match. With $1/R' = 2/R$ and $1/E' = 2(1 - \nu^2)/E$ and the
force $F$ that comes out, Hertz has

$$
a = \sqrt{\frac{4 F R'}{\pi E'}} , \qquad p_0 = \frac{2F}{\pi a} ,
$$

and Cattaneo and Mindlin, for the shear force $Q$ that comes out, a zone of half-width $c$ that sticks:

$$
\frac{c}{a} = \sqrt{1 - \frac{Q}{\mu F}} .
$$

Equal bodies that are only pressed do not slide on each other, so pressing makes no friction.
""",
    ),
    "incline": Entry(
        title="A block pushed up an incline",
        source="balance of forces and Coulomb's law",
        findings=_incline,
        problem=r"""
An elastic block, $G = 10$, lies on an elastic incline, $\tan\alpha = .1$, and is pushed up it by its rear
face with $\mu = .3$. The front begins to slip first. When all of the block slips, statics alone gives the
push, however the pressure is spread:

$$
F = G\, \frac{\mu + \tan\alpha}{1 - \mu \tan\alpha} , \qquad
N = (G + F \tan\alpha) \cos\alpha .
$$

Two bodies, two materials, two meshes that do not match, and a limit load that has to come out to
round-off.
""",
    ),
    "cycle": Entry(
        title="Moved to and fro: a hysteresis loop",
        source=f"{JOHNSON}, sections 7.2 and 7.4, for the largest force that came out",
        findings=_cycle,
        problem=r"""
A rigid parabola is pressed on a half-plane by $P = 20$ and moved to and fro along it, by so little that
the middle of the contact always sticks. Its edges slip, there and back, and that dissipates. After the
first quarter, force against displacement is a closed loop, the same in every cycle. By Cattaneo's and
Mindlin's theory its area is, with $q = Q/\mu P$ at the turns,

$$
W = \frac{4 (\mu P)^2}{\pi E^*} \Big( (1 - q) \ln(1 - q) + q - \tfrac12 q^2 \Big) .
$$

In plane strain displacements along a half-plane have no datum, but the area of a closed loop needs none.
The law is the incremental one: friction has to remember.
""",
    ),
    "cattaneo": Entry(
        title="A sphere pressed, then pushed sideways, in 3D",
        source=f"{JOHNSON}, section 7.2, for the forces that came out",
        findings=_cattaneo,
        problem=r"""
A rigid paraboloid is pressed on a half-space, so that contact ends at Hertz's radius $a = 1$, and then
pushed along it. Full sticking would need an infinite friction at the edge of the contact: so a ring of
slip begins there, and grows inwards with the force $Q$ along the surface. By Cattaneo and Mindlin the
contact sticks up to the radius

$$
c = a \left( 1 - \frac{Q}{\mu P} \right)^{1/3} .
$$

The model is half of the body. On its outer boundary displacements are those of Boussinesq and Cerruti.
$\nu = .49$, so that pressing alone makes next to no friction, as the theory assumes.
""",
    ),
}
