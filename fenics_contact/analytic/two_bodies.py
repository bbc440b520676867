"""Closed solutions of two bodies pressed together: wavy pressure, cylinders, nonlocal friction.

Closed solutions of two bodies pressed together: blocks with wavy pressure, cylinders. Stresses of
two blocks that meet in a pressure p₀ + p₁ cos kx, from an Airy stress function. φ = −p₀ x²/2 + cos
kx (A cosh ky + B y sinh ky) is even in y: along y = 0 there is neither shear nor a normal
displacement, whatever the elasticity, so that it is a solution on both sides of an interface of
different bodies. A = p₁/k²; B makes the pressure uniform at a distance h.

Press fits of two long cylinders: G. Lamé's thick-walled tubes, in user's units. S. P. Timoshenko,
J. N. Goodier, Theory of Elasticity, 3rd ed., McGraw-Hill 1970, Section 28.

Line contact with nonlocal friction: averages of a pressure, and the traction in shear. For bodies
whose pressure shear does not change (equal ones, or incompressible on rigid).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cosh, sinh
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Flags


@dataclass(frozen=True)
class AiryField:
    """Displacements of a body under plane strain.

    2μ u_x = −φ,x + (1 − ν) ∫ Δφ dx and likewise u_y (S. P. Timoshenko and J. N. Goodier, Theory of
    Elasticity, 3rd ed. 1970, section 43).

    Attributes:
        mean: p₀ (stress).
        amplitude: p₁ (stress).
        wave_number: k (1/length).
        height: h (length).
        youngs_modulus: E (stress).
        poissons_ratio: ν.
    """

    mean: float
    amplitude: float
    wave_number: float
    height: float
    youngs_modulus: float
    poissons_ratio: float

    @property
    def _factors(self) -> tuple[float, float]:
        """A and B (force; stress × length)."""
        a = self.amplitude / self.wave_number**2
        reach = self.wave_number * self.height
        return a, -a * cosh(reach) / (self.height * sinh(reach))

    def pressure(self, x: Array) -> Array:
        """At the interface, shape of x (stress)."""
        return self.mean + self.amplitude * np.cos(self.wave_number * x)

    def along(self, points: Array) -> Any:
        """u_x at points of shape (3, n), shape (n,) (length)."""
        (a, b), k, (x, y) = self._factors, self.wave_number, points[:2]
        slope = -self.mean * x - k * np.sin(k * x) * (a * np.cosh(k * y) + b * y * np.sinh(k * y))
        laplacian = 2 * b * np.cosh(k * y) * np.sin(k * x) - self.mean * x
        return self._compliance * (-slope + (1 - self.poissons_ratio) * laplacian)

    def across(self, points: Array) -> Any:
        """u_y at points of shape (3, n), shape (n,) (length)."""
        (a, b), k, (x, y) = self._factors, self.wave_number, points[:2]
        wave = np.cos(k * x)
        slope = wave * ((a * k + b) * np.sinh(k * y) + b * k * y * np.cosh(k * y))
        laplacian = 2 * b * np.sinh(k * y) * wave - self.mean * y
        return self._compliance * (-slope + (1 - self.poissons_ratio) * laplacian)

    @property
    def _compliance(self) -> float:
        """Half of the shear compliance, 1/2μ (1/stress)."""
        return (1 + self.poissons_ratio) / self.youngs_modulus


@dataclass(frozen=True)
class Tube:
    """A cylinder, hollow or not.

    Attributes:
        inner: Radius of its bore, 0 without one (length).
        outer: Outer radius (length).
        youngs_modulus: E (stress).
        poissons_ratio: ν.
    """

    inner: float
    outer: float
    youngs_modulus: float
    poissons_ratio: float

    def compliance(self, at: float, pressed_from: str, is_long: bool) -> float:
        """How far its surface at a radius moves over a pressure on it (length/stress).

        b/E [(r_o² + r_i²)/(r_o² − r_i²) ± ν], + under a pressure from inside; where it cannot
        become longer, with E/(1 − ν²) and ν/(1 − ν) in place of E and ν.

        Args:
            at: The radius, one of its own (length).
            pressed_from: ``inside`` or ``outside``.
            is_long: Whether its length is kept (plane strain), not free (plane stress).
        """
        modulus, ratio = self.youngs_modulus, self.poissons_ratio
        if is_long:
            modulus, ratio = modulus / (1 - ratio**2), ratio / (1 - ratio)
        squares = self.outer**2 + self.inner**2, self.outer**2 - self.inner**2
        sign = 1 if pressed_from == "inside" else -1
        return at / modulus * (squares[0] / squares[1] + sign * ratio)


def pressure(
    shaft: Tube, hub: Tube, interference: float, is_long: bool, give: float = 0.0
) -> float:
    """Pressure between a shaft and a hub (stress).

    Args:
        shaft: The cylinder inside.
        hub: That around it, whose bore is where the shaft ends.
        interference: How much too large the shaft's radius is (length).
        is_long: As of ``Tube.compliance``.
        give: Of the contact itself: depth over pressure (length/stress).
    """
    radius = hub.inner
    inside = shaft.compliance(radius, "outside", is_long)
    outside = hub.compliance(radius, "inside", is_long)
    return interference / (inside + outside + give)


# Gauss points over the kernel's width.
_POINTS = 400


def averaged(pressure: Callable[[Array], Array], radius: float, x: Array) -> Array:
    """(w_ρ ∗ p)(x) on a line, w_ρ ∝ exp(−1 / (1 − (s/ρ)²)) for |s| < ρ.

    Args:
        pressure: Of places, (…,) → (…,) (stress).
        radius: ρ (length).
        x: Where, (points,) (length).
    """
    shares, weights = np.polynomial.legendre.leggauss(_POINTS)
    kernel = weights * np.exp(-1 / (1 - shares**2))
    return np.asarray(pressure(x[:, None] - radius * shares) @ kernel / kernel.sum())


def sheared_traction(
    bound: Callable[[Array], Array], width: float, shear: float, cells: int = 800
) -> tuple[Array, Array, Flags]:
    """Traction of a line contact that is pressed first, and then sheared by a force that grows.

    Where it sticks, both surfaces have moved by the same, ∫ ln|x − s| q(s) ds = constant; elsewhere
    q is the bound (K. L. Johnson, Contact Mechanics, 1985, section 7.2, with a bound of any kind).

    Args:
        bound: Of places, > 0 within ``width`` (stress).
        width: Half of the width on which there may be traction (length).
        shear: Force per thickness, less than ∫ of the bound.
        cells: Of constant traction.

    Returns:
        Places, tractions there, and which of them stick.
    """
    ends = np.linspace(-width, width, cells + 1)
    x = 0.5 * (ends[1:] + ends[:-1])
    size, limit = ends[1] - ends[0], bound(x)
    apart = (x[:, None] - ends[None, :]) / width
    primitive = apart * (np.log(np.abs(apart)) - 1)
    moved = primitive[:, 1:] - primitive[:, :-1]  # −∫ ln over each cell, of a unit traction
    sticks = np.ones(cells, dtype=bool)
    while True:
        inner = np.flatnonzero(sticks)
        slipped = np.where(sticks, 0.0, limit)
        matrix = np.ones((len(inner) + 1, len(inner) + 1))
        matrix[:-1, :-1] = moved[np.ix_(inner, inner)]
        matrix[-1, -1] = 0.0
        right = np.append(-(moved @ slipped)[inner], shear / size - slipped.sum())
        traction = slipped.copy()
        traction[inner] = np.linalg.solve(matrix, right)[:-1]
        beyond = sticks & (traction > limit)
        if not beyond.any():
            return x, traction, sticks
        sticks &= ~beyond
