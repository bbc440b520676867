"""Two equal bodies that touch at their apexes: Hertz', Cattaneo's, and with nonlocal friction.

The bodies are rectangles of which one side bulges as a circle does, large against the contact;
their meshes are fine around it and do not match. The formulas take the force that the run found.
Between equal cylinders shear does not change the pressure, so that nonlocal friction has a formula.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from math import pi, sqrt
from typing import Any, Literal

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.analytic.two_bodies import averaged, sheared_traction
from fenics_contact.common.arrays import Array
from fenics_contact.common.program import mesh_file
from fenics_contact.results.result import Result
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.laws.friction_laws import NonlocalFriction
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.scene import Discretisation, MeshSource, Scene, SolverSettings, Steps
from fenics_contact.scene.values import Path
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.published.indenters import JOHNSON, MATERIAL, MODULUS

Kinematics = Literal["plane strain", "axisymmetric"]

_RADIUS = 50.0
# Of two equal bodies: 1/E* and 1/R add up (Johnson, (4.1), (4.2)).
BOTH_MODULUS, BOTH_RADIUS = MODULUS / 2, _RADIUS / 2
# Cells of the two bodies on the half-width or radius of the contact, which is about 1. With half as
# many, 16:24 on its whole width, the pressure at r < .9 a is off by 1.8 % (cylinders) and 2.2 %
# (spheres) where the wanted limit is .5 %, and p₀ of the spheres by .37 % where it is .3 %.
CELLS = {"lower": 16, "upper": 24}
# How far the bodies are pressed for that (length).
_PRESSED: dict[Kinematics, float] = {"plane strain": 0.082, "axisymmetric": 0.04}
# The edge is found within an element to some tenth of it, so that its place there decides:
# over these loads it moves by an element. Wanted is .3 % of a (degree 1: 1.5 %): the mean keeps
# that, but not each load, of which the worst is off by .9 % (degree 1: 1.8 %).
_WORST = {2: 1e-2, 1: 2e-2}
_LOADS = tuple(float(time) for time in np.linspace(0.88, 1, 9))

COEFFICIENT = 0.3
# Needs about .57 of the shear that makes all of the contact slip.
SIDEWAYS = 0.0212


def cushions(half: bool, order: int = 2) -> tuple[MeshSource, ...]:
    """The two bodies, or their halves right of x = 0; the order is that of the cells' geometry."""
    return tuple(
        MeshSource(
            mesh_file("cushion.geo"),
            cell="quadrilateral",
            order=order,
            name=name,
            parameters={
                "side": 1 if name == "upper" else -1,
                "half": int(half),
                "radius": _RADIUS,
                "extent": _RADIUS / 2,
                "size": 1 / count,
                "cells_outside": 30,
            },
        )
        for name, count in CELLS.items()
    )


def pressed_scene(kinematics: Kinematics, degree: int = 2) -> Scene:
    """Half of two cylinders, or two spheres, pressed on each other.

    Degree 1 has straight facets, as users' meshes have then.
    """
    return Scene(
        kinematics=kinematics,
        mesh=cushions(half=True, order=degree),
        material=MATERIAL,
        discretisation=Discretisation(degree),
        symmetry=("lower.axis", "upper.axis"),
        support=(
            Support("lower.foot", {"y": 0}),
            Support("upper.foot", {"y": -_PRESSED[kinematics]}),
        ),
        contact=(Contact("lower.contact", against="upper.contact", slave="on"),),
        steps=Steps(times=_LOADS),
    )


def theory(kinematics: Kinematics, force: float) -> formulas.HertzContact:
    """By the force on the half that is modelled, or on the whole sphere."""
    if kinematics == "plane strain":
        return formulas.line_contact(BOTH_MODULUS, BOTH_RADIUS, 2 * force)
    radius = (3 * force * BOTH_RADIUS / (4 * BOTH_MODULUS)) ** (1 / 3)
    return formulas.paraboloid(BOTH_MODULUS, BOTH_RADIUS, radius**2 / BOTH_RADIUS)


def _half_width(kinematics: Kinematics, area: float) -> float:
    return area if kinematics == "plane strain" else sqrt(area / pi)


def reaction(result: Result, name: str) -> Any:
    """Of one support, one entry an axis (force)."""
    (found,) = (row["reaction"] for row in result.supports if row["on"] == name)
    return found


def _hertz(kinematics: Kinematics, quick: bool) -> Iterator[Finding]:
    for degree, tolerance in ((2, 3e-3), (1, 1.5e-2)):
        if quick and degree == 2:
            continue
        result = solved(pressed_scene(kinematics, degree))
        expected = theory(kinematics, reaction(result, "lower.foot")[1])
        label = f", degree {degree}"
        force = result.quantities["normal_force"]
        yield Finding(f"normal_force{label}", force, reaction(result, "lower.foot")[1], 1e-7)
        ratios = [
            _half_width(kinematics, step["quantities"]["contact_area"])
            / theory(kinematics, step["quantities"]["normal_force"]).radius
            for step in result.steps
        ]
        yield Finding(f"a over theory, mean{label}", float(np.mean(ratios)), 1, tolerance)
        worst_ratio = max(ratios, key=lambda ratio: abs(ratio - 1))
        yield Finding(f"a over theory, worst{label}", worst_ratio, 1, _WORST[degree])
        yield of_quantity(result, "max_contact_pressure", expected.peak, tolerance, label)
        worst = _pressure_error(result, expected)
        yield Finding(
            f"pressure error, r < .9 a{label}", worst, 0, 5e-3 if degree == 2 else tolerance, True
        )


def _pressure_error(result: Result, expected: formulas.HertzContact) -> float:
    """Largest error of the pressure p₀ √(1 − (r/a)²) at points r < .9 a, over it."""
    assert result.points is not None
    share = result.points.coordinates[:, 0] / expected.radius
    inside = share < 0.9
    exact = expected.peak * np.sqrt(1 - share[inside] ** 2)
    return float(np.abs(result.points.contact_pressure[inside] / exact - 1).max())


def _cylinders(quick: bool) -> Iterator[Finding]:
    return _hertz("plane strain", quick)


def _spheres(quick: bool) -> Iterator[Finding]:
    return _hertz("axisymmetric", quick)


def sheared_scene(steps: int) -> Scene:
    """Two cylinders, pressed on each other in the first step, then sheared."""
    return Scene(
        kinematics="plane strain",
        mesh=cushions(half=False),
        material=MATERIAL,
        support=(
            Support("lower.foot", {"x": 0, "y": 0}),
            Support("upper.foot", {"y": -_PRESSED["plane strain"]}),
            Support(
                "upper.foot", {"x": SIDEWAYS}, Path(time=(1.0, 1.0 + steps), factor=(0.0, 1.0))
            ),
        ),
        contact=(
            Contact(
                "lower.contact",
                against="upper.contact",
                slave="on",
                friction_coefficient=COEFFICIENT,
                law="incremental",
            ),
        ),
        steps=Steps(1 + steps, 1.0 + steps),
        solver=SolverSettings(strategy="monolithic"),
    )


def _cattaneo(quick: bool) -> Iterator[Finding]:
    """c/a = √(1 − Q/μF) and q = μ p₀ (√(1 − x²/a²) − c/a √(1 − x²/c²)), by the Q and F found."""
    result = solved(sheared_scene(1 if quick else 3))
    sideways, force = reaction(result, "lower.foot")
    share = abs(sideways) / (COEFFICIENT * force)
    expected = formulas.line_contact(BOTH_MODULUS, BOTH_RADIUS, force)
    quantities, a = result.quantities, expected.radius
    cell = 1 / CELLS["lower"]
    stick = quantities["stick_area"] / quantities["contact_area"]
    c = a * sqrt(1 - share)
    yield Finding(f"c/a, Q = {share:.3f} μF", stick, c / a, cell / a, absolute=True)
    assert result.points is not None
    x = np.abs(result.points.coordinates[:, 0])
    exact = formulas.partial_slip(expected, COEFFICIENT, c, x)
    error = np.abs(np.abs(result.points.friction_traction[:, 0]) - exact)
    away = np.abs(x - c) > cell
    # Wanted is 1.5 % wherever it is an element from c. In the last element before a, where the
    # pressure is off, too, it is 1.7 %.
    for where, chosen, tolerance in (
        ("", away, 2e-2),
        (", r < .9 a", away & (x < 0.9 * a), 1.5e-2),
    ):
        worst = float(error[chosen].max() / exact.max())
        label = f"traction error, an element from c{where}"
        yield Finding(label, worst, 0, tolerance, absolute=True)


HERTZ_PAIR_CASES: tuple[Case, ...] = (
    Case(
        "hertz_cylinders",
        "two equal elastic cylinders",
        f"{JOHNSON}, (4.43), (4.45)",
        _cylinders,
    ),
    Case("hertz_spheres", "two equal elastic spheres", f"{JOHNSON}, (4.22)-(4.24)", _spheres),
    Case(
        "cattaneo_pair",
        "two equal elastic cylinders pressed, then sheared",
        f"{JOHNSON}, (7.24)-(7.28)",
        _cattaneo,
    ),
)


# The contact's half-width is about 1; the surfaces end at 1.5, which is felt two radii inwards.
_AVERAGING_RADIUS = 0.25
# Over what moves the cylinders sideways in `cattaneo_pair`: then all of the contact slips.
_FAR = 3.0


def nonlocal_scene(radius: float, farther: float = 1.0) -> Scene:
    """Two cylinders, pressed in the first step and moved sideways in the second.

    Args:
        radius: ρ (length).
        farther: How far, over that of `cattaneo_pair`.
    """
    scene = sheared_scene(1)
    law = NonlocalFriction(kind="nonlocal", averaging_radius=radius)
    *others, moved = scene.support
    moved = Support(moved.on, {"x": farther * SIDEWAYS}, moved.path)
    contact = dataclasses.replace(scene.contact[0], friction_law=law)
    return dataclasses.replace(scene, support=(*others, moved), contact=(contact,))


def _hertz_of_reaction(result: Result) -> formulas.HertzContact:
    """Hertz's contact by the reaction found."""
    return formulas.line_contact(BOTH_MODULUS, BOTH_RADIUS, reaction(result, "lower.foot")[1])


def _pressure_at(hertz: formulas.HertzContact, x: Array) -> Array:
    return np.asarray(hertz.peak * np.sqrt(np.maximum(1 - (x / hertz.radius) ** 2, 0)))


def _bound(hertz: formulas.HertzContact, x: Array) -> Array:
    return COEFFICIENT * averaged(lambda s: _pressure_at(hertz, s), _AVERAGING_RADIUS, x)


def _sliding() -> Iterator[Finding]:
    """Where all slips, t = μ (w ∗ p) of Hertz' pressure, beyond its edge too, and μF in all."""
    result = solved(nonlocal_scene(_AVERAGING_RADIUS, _FAR))
    hertz = _hertz_of_reaction(result)
    sideways, force = reaction(result, "lower.foot")
    yield Finding("Q over μF, sliding", abs(sideways) / (COEFFICIENT * force), 1, 1e-6)
    assert result.points is not None
    x = result.points.coordinates[:, 0]
    traction = np.abs(result.points.friction_traction[:, 0])
    exact = _bound(hertz, x)
    middle, edge = (int(np.argmin(np.abs(np.abs(x) - at))) for at in (0.0, hertz.radius))
    yield Finding("traction in the middle, sliding", traction[middle], exact[middle], 1e-3)
    yield Finding("traction at the edge, sliding", traction[edge], exact[edge], 1e-2)
    worst = float(np.abs(traction - exact).max() / exact.max())
    yield Finding("worst traction error, sliding", worst, 0, 5e-3, absolute=True)


def _partly() -> Iterator[Finding]:
    """Where it slips partly, an integral equation solved on its own, by the Q and F found."""
    result = solved(nonlocal_scene(_AVERAGING_RADIUS))
    hertz = _hertz_of_reaction(result)
    sideways, force = reaction(result, "lower.foot")
    width = hertz.radius + 0.999 * _AVERAGING_RADIUS
    places, tractions, sticks = sheared_traction(lambda x: _bound(hertz, x), width, abs(sideways))
    at = f", Q = {abs(sideways) / (COEFFICIENT * force):.3f} μF"
    assert result.points is not None
    x = result.points.coordinates[:, 0]
    found = np.abs(result.points.friction_traction[:, 0])
    exact = np.interp(x, places, tractions, left=0, right=0)
    size = places[1] - places[0]
    stick = size * np.count_nonzero(sticks & (np.abs(places) < hertz.radius))
    yield Finding(f"stick width{at}", result.quantities["stick_area"], stick, 3e-2)
    middle = np.abs(x) < 0.25 * hertz.radius
    mean = found[middle].mean()
    yield Finding(f"mean traction, r < .25 a{at}", mean, exact[middle].mean(), 5e-3)
    away = np.abs(np.abs(x) - 0.5 * stick) > 1 / CELLS["lower"]
    worst = float(np.abs(found - exact)[away].max() / exact.max())
    label = f"worst traction error, an element from where it sticks{at}"
    yield Finding(label, worst, 0, 1e-2, absolute=True)
    outside = np.abs(x) > hertz.radius
    yield Finding(
        f"traction just outside the contact{at}", found[outside].max(), exact[outside].max(), 1e-2
    )


def _nonlocal(quick: bool) -> Iterator[Finding]:
    yield from _sliding()
    if not quick:
        yield from _partly()


NONLOCAL_FRICTION_CASES: tuple[Case, ...] = (
    Case(
        "nonlocal",
        "nonlocal friction of two equal cylinders, sliding and partly sliding",
        "G. Duvaut, C. R. Acad. Sci. Paris A 290 (1980) 263-265, with Hertz' pressure; the "
        "integral equation of Johnson 1985, section 7.2, with its bound",
        _nonlocal,
    ),
)
