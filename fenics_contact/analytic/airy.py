"""Stresses of two blocks that meet in a pressure p₀ + p₁ cos kx, from an Airy stress function.

φ = −p₀ x²/2 + cos kx (A cosh ky + B y sinh ky) is even in y: along y = 0 there is neither shear
nor a normal displacement, whatever the elasticity, so that it is a solution on both sides of an
interface of different bodies. A = p₁/k²; B makes the pressure uniform at a distance h.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cosh, sinh
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array


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
        """1/2μ (1/stress)."""
        return (1 + self.poissons_ratio) / self.youngs_modulus
