"""Intervals of fitted parameters, in numbers and in sentences.

To first order the estimate moves by G δ as the data move by δ, with G = (JᵀWJ)⁻¹JᵀW. The noise of
the data makes a standard deviation of that. What the discretisation is estimated to change of the
curve moves each parameter by a number of its own, as it moves each quantity of a run: along the
curve its errors have signs, and are far from independent.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import optimize, special  # not `stats`, which takes a second to import

from fenics_contact.common.arrays import Array
from fenics_contact.results.fit_record import FittedParameter

CONFIDENCE = 0.95
# Of what local problems give, which see nothing beyond one degree more: as in the error bars of a
# run (trust/error_estimates/mesh).
_LOCAL = 2.0
# Singular values below this share of the largest, columns of length 1, are round-off.
_ROUND_OFF = 1e-9
# A part of a direction that counts.
_PART = 0.1


@dataclass(frozen=True, eq=False)
class Intervals:
    """Confidence intervals of the parameters of a fit.

    Attributes:
        slopes: J, (rows, parameters).
        deviation: Standard deviation of each row, (rows,).
        freedom: Degrees of freedom with which it was estimated; None where it was given.
        errors: Source → changes of the rows, (draws, rows).
    """

    slopes: Array
    deviation: Array
    freedom: int | None
    errors: Mapping[str, Array]

    @cached_property
    def _lengths(self) -> Array:
        """Lengths of the weighted columns; 1 for those that are zero."""
        lengths = np.linalg.norm(self.slopes / self.deviation[:, None], axis=0)
        return np.where(lengths > 0, lengths, 1.0)

    @cached_property
    def _parts(self) -> tuple[Array, Array, Array]:
        """Singular vectors and values of the weighted columns of length 1."""
        scaled = self.slopes / self.deviation[:, None] / self._lengths
        left, values, right = np.linalg.svd(scaled, full_matrices=False)
        return left, values, right

    @property
    def singular_values(self) -> Array:
        """Singular values of the derivatives with columns of length 1, the largest first."""
        return self._parts[1]

    @cached_property
    def unknown(self) -> list[list[int]]:
        """Numbers of parameters that the data do not tell apart at all, direction by direction."""
        _, values, right = self._parts
        lost = right[values <= _ROUND_OFF * max(values[0], 1e-300)]
        return [np.flatnonzero(np.abs(row) > _PART).tolist() for row in lost]

    def is_known(self, number: int) -> bool:
        """Whether the data determine a parameter.

        Args:
            number: Of it.
        """
        return not any(number in group for group in self.unknown)

    @cached_property
    def gain(self) -> Array:
        """G, (parameters, rows), along what the data determine."""
        left, values, right = self._parts
        kept = values > _ROUND_OFF * max(values[0], 1e-300)
        inverse = (right[kept].T / values[kept]) @ left[:, kept].T
        return np.asarray(inverse / self._lengths[:, None] / self.deviation)

    @cached_property
    def covariance(self) -> Array:
        """Covariance by the noise alone, (parameters, parameters)."""
        weighted = self.gain * self.deviation
        return np.asarray(weighted @ weighted.T)

    @property
    def noise(self) -> Array:
        """Standard deviations by the noise alone, (parameters,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlations(self) -> Array:
        """Correlations of the parameters, (parameters, parameters)."""
        deviations = np.where(self.noise > 0, self.noise, 1.0)
        return np.asarray(self.covariance / np.outer(deviations, deviations))

    @cached_property
    def discretisation(self) -> Array:
        """Error of each parameter by mesh, penalty and regularisation, (parameters,)."""
        found = np.zeros(self.slopes.shape[1])
        for source, draws in self.errors.items():
            whole, *drawn = np.abs(draws @ self.gain.T)
            if drawn:  # not less than what cells' errors of any signs would make
                whole = np.maximum(whole, np.sqrt(np.mean(np.square(drawn), axis=0)))
            found += (_LOCAL if source == "mesh" else 1.0) * whole
        return found

    @property
    def half_widths(self) -> Array:
        """Half widths of the intervals about the estimates, (parameters,)."""
        pairs = zip(self.noise, self.discretisation, strict=True)
        return np.array([_half_width(noise, shift, self.freedom) for noise, shift in pairs])

    @property
    def half_widths_by_noise(self) -> Array:
        """Half widths of the intervals if the run had no errors, (parameters,)."""
        return np.array([_half_width(noise, 0.0, self.freedom) for noise in self.noise])


def _half_width(noise: float, shift: float, freedom: int | None) -> float:
    """Return the half width that covers the truth with ``CONFIDENCE`` under noise and a shift.

    Args:
        noise: Standard deviation.
        shift: At the most.
        freedom: As of ``Intervals``.

    >>> round(_half_width(1.0, 0.0, None), 3), round(_half_width(1e-9, 1.0, None), 3)
    (1.96, 1.0)
    """
    if noise <= 1e-12 * shift:
        return shift
    if noise == 0.0:
        return 0.0
    off = shift / noise

    def below(value: float) -> float:
        return float(special.ndtr(value) if freedom is None else special.stdtr(freedom, value))

    def excess(width: float) -> float:
        return below(width - off) - below(-width - off) - CONFIDENCE

    level = 0.5 + CONFIDENCE / 2
    widest = off + float(
        special.ndtri(level) if freedom is None else special.stdtrit(freedom, level)
    )
    if math.isinf(widest):
        return math.inf
    return noise * float(optimize.brentq(excess, 0.0, widest * (1 + 1e-9)))


# Estimates that are correlated more than this are hardly told apart.
_CORRELATED = 0.95
# Probability of data as far off, if run and uncertainties are right, below which they are not.
_UNLIKELY = 1e-3


def verdict_of(
    parameters: Mapping[str, FittedParameter], converged: bool, failed: Sequence[str]
) -> str:
    """Whether to trust the values.

    Args:
        parameters: That were found.
        converged: Whether the search came to its end.
        failed: Checks of the physics that failed.
    """
    unknown = [key for key, one in parameters.items() if one.low is None]
    said = (
        "The best values were found."
        if converged
        else (
            "The search did not come to its end: the values are the best so far; begin nearer to "
            "them, or give bounds."
        )
    )
    if unknown:
        said += f" The data do not determine {' and '.join(unknown)}."
    if failed:
        said += f" With these values checks of the physics fail: {', '.join(failed)}."
    return said


def notes_of(
    keys: Sequence[str],
    intervals: Intervals,
    parameters: Mapping[str, FittedParameter],
    misfit: float | None,
    free: int,
) -> list[str]:
    """Return remarks on the intervals.

    Args:
        keys: Of the parameters.
        intervals: Of them, in that order.
        parameters: What was found of each.
        misfit: As of ``FitRecord``.
        free: Degrees of freedom.
    """
    return [
        *_not_told_apart(keys, intervals),
        *_wide(parameters),
        *_at_bounds(parameters),
        *_misfit(misfit, free),
        *_errors(intervals),
    ]


def _not_told_apart(keys: Sequence[str], intervals: Intervals) -> Iterator[str]:
    for group in intervals.unknown:
        names = [keys[number] for number in group]
        if len(names) == 1:
            yield f"The curve does not depend on {names[0]}: leave it out."
        else:
            yield (
                f"The data cannot tell {' and '.join(names)} apart: other values of them, changed "
                "together, give the same curve. Leave one out, or measure something else besides."
            )
    correlations = intervals.correlations
    for first, one in enumerate(keys):
        for second in range(first + 1, len(keys)):
            found = correlations[first, second]
            known = intervals.is_known(first) and intervals.is_known(second)
            if known and abs(found) > _CORRELATED:
                yield (
                    f"The data hardly tell {one} and {keys[second]} apart (correlation "
                    f"{found:.3f}): each is known worse than it would be if the other were given."
                )


def _wide(parameters: Mapping[str, FittedParameter]) -> Iterator[str]:
    for key, one in parameters.items():
        if one.noise is not None and one.noise > abs(one.value):
            yield f"The data hardly tell {key}: by their noise alone it may be off by its own size."


def _at_bounds(parameters: Mapping[str, FittedParameter]) -> Iterator[str]:
    for key, one in parameters.items():
        if one.at_bound:
            yield (
                f"{key} is at its bound, and the data would have it beyond: its interval is cut "
                "off there, and those of the others hold only if the bound is right."
            )


def _misfit(misfit: float | None, free: int) -> Iterator[str]:
    if misfit is not None and special.chdtrc(free, misfit * free) < _UNLIKELY:
        yield (
            f"Run and data are further apart than the uncertainties say ({misfit:.3g} times in "
            "squares): the model lacks something, or the uncertainties are too small; so are then "
            "the intervals."
        )


def _errors(intervals: Intervals) -> Iterator[str]:
    if "mesh" not in intervals.errors:
        yield (
            "A fit does not estimate the error by the mesh of nearly incompressible bodies: the "
            "intervals hold the noise alone, besides what penalty and regularisation change."
        )
    yield "Sizes of load steps are no part of the intervals: try half as long ones."
