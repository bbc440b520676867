"""Cycles to the first crack, by the parameter of Smith, Watson and Topper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

_MOST_STEPS = 100


@dataclass(frozen=True)
class StrainLife:
    """Constants of the line of Coffin, Manson and Basquin, Δε/2 = (s/E)(2N)^b + e (2N)^c.

    Attributes:
        strength: S, the fatigue strength coefficient (stress).
        strength_exponent: B < 0.
        ductility: E, the fatigue ductility coefficient.
        ductility_exponent: C < 0.
    """

    strength: float
    strength_exponent: float
    ductility: float
    ductility_exponent: float

    def parameter(self, cycles: Array | float, youngs_modulus: Array | float) -> Array:
        """σ_max Δε/2 = (s²/E)(2N)^{2b} + s e (2N)^{b+c} (stress).

        Args:
            cycles: N > 0.
            youngs_modulus: E (stress).
        """
        elastic, plastic = self._logarithms(np.asarray(youngs_modulus))
        reversals = np.log(2 * np.asarray(cycles))
        return np.asarray(
            np.exp(elastic + 2 * self.strength_exponent * reversals)
            + np.exp(plastic + self._plastic_slope * reversals)
        )

    def cycles(self, parameter: Array | float, youngs_modulus: Array | float) -> Array:
        """N at which the parameter has that value; infinite where it is 0.

        The logarithm of the parameter is convex in that of N, so that Newton's method comes to its
        only zero from the left.

        Args:
            parameter: ≥ 0 (stress).
            youngs_modulus: E (stress).

        >>> steel = StrainLife(1000.0, -0.1, 0.5, -0.6)
        >>> found = steel.cycles(steel.parameter(1e5, 2e5), 2e5)
        >>> bool(abs(found / 1e5 - 1) < 1e-9)
        True
        """
        parameter, modulus = np.broadcast_arrays(
            np.asarray(parameter, dtype=float), np.asarray(youngs_modulus, dtype=float)
        )
        pulled = parameter > 0
        target = np.log(np.where(pulled, parameter, 1.0))
        elastic, plastic = self._logarithms(modulus)
        slopes = 2 * self.strength_exponent, self._plastic_slope
        # Either part alone gives at least one of them: the larger life is still below the answer.
        found = np.maximum((target - elastic) / slopes[0], (target - plastic) / slopes[1])
        for _ in range(_MOST_STEPS):
            parts = elastic + slopes[0] * found, plastic + slopes[1] * found
            together = np.logaddexp(*parts)
            share = np.exp(parts[0] - together)
            step = (target - together) / (slopes[0] * share + slopes[1] * (1 - share))
            found = found + step
            if np.abs(step).max(initial=0.0) < 1e-13 * max(1.0, np.abs(found).max(initial=0.0)):
                break
        with np.errstate(over="ignore"):
            return np.where(pulled, np.exp(found) / 2, np.inf)

    @property
    def _plastic_slope(self) -> float:
        return self.strength_exponent + self.ductility_exponent

    def _logarithms(self, youngs_modulus: Array | float) -> tuple[Array, float]:
        """Return the logarithms of the factors of the two powers."""
        elastic = np.log(self.strength**2 / youngs_modulus)
        return elastic, float(np.log(self.strength * self.ductility))
