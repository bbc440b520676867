"""Wear rates of computed cycles, and the progress of cycles that pass over others."""

from __future__ import annotations

from dataclasses import dataclass

from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.newton.solution import Solution


@dataclass(frozen=True, eq=False)
class Rates:
    """Wear of a cycle.

    Attributes:
        number: Of the cycle.
        begin: Depths at which it begins, of each contact (length).
        depths: What it adds, likewise.
        works: Of friction in it, at each contact (energy).
        stick_areas: Of each contact what touched in it and never slipped (area).
        solution: At its end, as it was solved.
        end: Its last load step, to go on from.
    """

    number: int
    begin: list[Array]
    depths: list[Array]
    works: Array
    stick_areas: list[float]
    solution: Solution
    end: AcceptedStep

    @property
    def pressures(self) -> list[Array]:
        """At its end (stress)."""
        return [state.contact_pressure for state in self.solution.states]


@dataclass(frozen=True, eq=False)
class Progress:
    """After a cycle that counts.

    Attributes:
        earlier: The one that was computed before it, or itself.
        rates: The cycle.
        before: Works of friction before it, at each contact (energy).
        size: How many cycles further on the next one is to be.
        passed_over: How many cycles before it were not computed.
        pressure_change: Largest change of a pressure since then, over the largest pressure.
        errors: Estimated error of all jumps so far: ``worn_volume`` (volume) and
            ``max_wear_depth`` (length).
    """

    earlier: Rates
    rates: Rates
    before: Array
    size: int
    passed_over: int
    pressure_change: float
    errors: dict[str, float]

    @classmethod
    def first(cls, rates: Rates, before: Array) -> Progress:
        """After the first cycle.

        Args:
            rates: Of it.
            before: Works of friction on the way to it (energy).
        """
        none = dict.fromkeys((WORN_VOLUME, MAX_WEAR_DEPTH), 0.0)
        return cls(rates, rates, before, 1, 0, 0.0, none)
