"""Sentences on the parameters of a fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from scipy import stats

from fenics_contact.results.fit_record import FittedParameter
from fenics_contact.simulation.fits.intervals import Intervals

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
    if misfit is not None and stats.chi2.sf(misfit * free, free) < _UNLIKELY:
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
