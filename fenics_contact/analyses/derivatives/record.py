"""Derivatives of quantities and their uncertainties by tolerances, in ``result.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from fenics_contact.results.records.record import Record


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivative(Record):
    """The derivative of a quantity in a number of the scene (unit of the one over the other).

    Attributes:
        value: Of a parabola fitted to slopes in a window, of areas their mean, in which the edges
            of contact and of stick move by about a cell; null where there is none.
        spread: How far derivatives of single answers in the window lie from it; null
            without a window as wide as a cell, unless they differ by more than a tenth in it.
        discrete: Exact derivative of the discrete answer, automatic parameters held; null of areas
            and radii.
        normalised: The value times the number over the quantity: percent of the one for a percent
            of the other; null where one of them is 0.
        one_sided: Whether points just touch, or just slip, so that the discrete answer has a kink.
        of_single_answers: Whether edges move by less than a cell even where the number changes by
            a quarter, so that ``value`` is that of single answers, with their jumps.
    """

    value: float | None
    spread: float | None
    discrete: float | None
    normalised: float | None = None
    one_sided: bool
    of_single_answers: bool = False


# Quantity → key of the scene → derivative.
Derivatives = dict[str, dict[str, Derivative]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Uncertainty(Record):
    """How far a quantity may be off, by the tolerances of the scene and by its discretisation.

    Attributes:
        data: By all tolerances together, as independent ones: the root of the sum of squares; null
            where a derivative is not known.
        data_at_most: The same where all conspire: the sum.
        by: Key of the scene → what its tolerance alone makes of the quantity.
        numerical: The error bar of the run, null where it was not estimated.
        larger: Whether `"data"` or `"mesh"` makes more of it; null where one is not known.
    """

    data: float | None
    data_at_most: float | None
    by: Mapping[str, float | None]
    numerical: float | None
    larger: Literal["data", "mesh"] | None
