"""Nonlocal friction of two equal cylinders, of which shear does not change the pressure."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np

from fenics_contact.analytic import contact as formulas
from fenics_contact.analytic.nonlocal_slip import averaged, sheared_traction
from fenics_contact.common.arrays import Array
from fenics_contact.results.result import Result
from fenics_contact.scene.laws.friction_laws import NonlocalFriction
from fenics_contact.scene.loading.conditions import Support
from fenics_contact.scene.scene import Scene
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.published.hertz_pair import (
    BOTH_MODULUS,
    BOTH_RADIUS,
    CELLS,
    COEFFICIENT,
    SIDEWAYS,
    reaction,
    sheared_scene,
)

# The contact's half-width is about 1; the surfaces end at 1.5, which is felt two radii inwards.
_RADIUS = 0.25
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


def _hertz(result: Result) -> formulas.HertzContact:
    """By the force found."""
    return formulas.line_contact(BOTH_MODULUS, BOTH_RADIUS, reaction(result, "lower.foot")[1])


def _pressure_at(hertz: formulas.HertzContact, x: Array) -> Array:
    return np.asarray(hertz.peak * np.sqrt(np.maximum(1 - (x / hertz.radius) ** 2, 0)))


def _bound(hertz: formulas.HertzContact, x: Array) -> Array:
    return COEFFICIENT * averaged(lambda s: _pressure_at(hertz, s), _RADIUS, x)


def _sliding() -> Iterator[Finding]:
    """Where all slips, t = μ (w ∗ p) of Hertz' pressure, beyond its edge too, and μF in all."""
    result = solved(nonlocal_scene(_RADIUS, _FAR))
    hertz = _hertz(result)
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
    result = solved(nonlocal_scene(_RADIUS))
    hertz = _hertz(result)
    sideways, force = reaction(result, "lower.foot")
    width = hertz.radius + 0.999 * _RADIUS
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
