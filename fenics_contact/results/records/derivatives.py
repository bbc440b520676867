"""What ``result.json`` tells of what an answer depends on."""

from __future__ import annotations

from dataclasses import dataclass

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
