"""The critical plane of Smith, Watson and Topper's parameter, and lives by that parameter."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from fenics_contact.common.arrays import Array, Integers

# Of the planes that are tried first, as an angle between neighbours; the best is then improved.
_FIRST_ANGLE = np.radians(6.0)
# So many of them are begun at: the best of each hill, and others, as two hills may be close by.
_BEGINS = 8
# The parameter is flat about its largest value: an angle of 1e-5 changes it by some 1e-10.
_LAST_ANGLE, _SHORTER = 1e-5, 0.6
# Numbers of places, times and planes that are kept together.
_AT_ONCE = 2_000_000


def swt(stress: Array, strain: Array) -> tuple[Array, Array]:
    """The largest σ_n,max · Δε_n / 2 over all planes, and the normals of these planes.

    Args:
        stress: A cycle at each place, (places, times, 3, 3) (stress).
        strain: Its strains.

    Returns:
        The parameter, (places,), 0 where no plane is pulled (stress), and normals, (places, 3).

    >>> ones = np.diag([1.0, 0.0, 0.0])
    >>> cycle = np.array([[100 * ones, -100 * ones]])
    >>> parameter, plane = swt(cycle, cycle / 200e3)
    >>> float(parameter[0].round(12)), np.abs(plane[0]).round(5).tolist()
    (0.05, [1.0, 0.0, 0.0])
    """
    parameter, normals = np.zeros(len(stress)), np.zeros((len(stress), 3))
    together = max(_AT_ONCE // (stress.shape[1] * len(_hemisphere())), 1)
    for begin in range(0, len(stress), together):
        piece = slice(begin, begin + together)
        parameter[piece], normals[piece] = _searched(stress[piece], strain[piece])
    return parameter, normals


def _searched(stress: Array, strain: Array) -> tuple[Array, Array]:
    """Return ``swt`` and its normals, searched from the best of planes all around."""
    best, normals = np.full(len(stress), -np.inf), np.zeros((len(stress), 3))
    first = _parameter(stress, strain, _hemisphere())
    is_peak = (first[:, :, None] >= first[:, _neighbours()]).all(axis=2)
    begins = np.argsort(-first * (1 + is_peak), axis=1)[:, :_BEGINS]
    for begin in begins.T:
        value, normal = _improved(stress, strain, _hemisphere()[begin])
        better = value > best
        best[better], normals[better] = value[better], normal[better]
    return np.maximum(best, 0.0), normals


def _improved(stress: Array, strain: Array, normals: Array) -> tuple[Array, Array]:
    """The parameter and the plane at the top of the hill that a plane at each place is on.

    The larger of several smooth hills has edges only in its valleys, so that steps to the best of
    eight planes around, shorter and shorter, come to the top.
    """
    rows = np.arange(len(stress))
    best, normals = _parameter(stress, strain, normals[:, None])[:, 0], normals.copy()
    angle = _FIRST_ANGLE
    while angle > _LAST_ANGLE:
        tried = _around(normals, angle)
        values = _parameter(stress, strain, tried)
        most = values.argmax(axis=1)
        better = values[rows, most] > best
        best[better] = values[rows, most][better]
        normals[better] = tried[rows, most][better]
        angle *= _SHORTER
    return best, normals


def _parameter(stress: Array, strain: Array, normals: Array) -> Array:
    """Return the parameter of planes at each place, (places, planes).

    Args:
        stress: As above.
        strain: As above.
        normals: (places, planes, 3), or (planes, 3) of all.
    """
    dyads = (normals[..., :, None] * normals[..., None, :]).reshape(*normals.shape[:-1], 9)
    across = np.swapaxes(dyads, -1, -2)
    places, times = stress.shape[:2]
    pull = (stress.reshape(places, times, 9) @ across).max(axis=1)
    stretch = strain.reshape(places, times, 9) @ across
    return np.asarray(np.maximum(pull, 0.0) * np.ptp(stretch, axis=1) / 2)


@cache
def _hemisphere() -> Array:
    """Normals of planes all around, some 6 degrees apart, with the axes among them."""
    found = []
    for polar in np.linspace(0, np.pi / 2, round(np.pi / 2 / _FIRST_ANGLE) + 1):
        around = max(round(2 * np.pi * np.sin(polar) / _FIRST_ANGLE / 4) * 4, 1)
        angles = 2 * np.pi * np.arange(around) / around
        ring = (np.sin(polar) * np.cos(angles), np.sin(polar) * np.sin(angles))
        found.append(np.column_stack([*ring, np.full(around, np.cos(polar))]))
    return np.concatenate(found)


@cache
def _neighbours() -> Integers:
    """Numbers of the eight planes nearest to each of them, (planes, 8)."""
    planes = _hemisphere()
    return np.asarray(np.argsort(-np.abs(planes @ planes.T), axis=1)[:, 1:9])


def _around(normals: Array, angle: float) -> Array:
    """Eight normals around each, turned by an angle, (places, 8, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    turns = np.arange(8) * np.pi / 4
    sideways = np.cos(turns)[:, None] * first[:, None] + np.sin(turns)[:, None] * second[:, None]
    return np.asarray(np.cos(angle) * normals[:, None] + np.sin(angle) * sideways)


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
