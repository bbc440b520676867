"""Wear rates of computed cycles, what sticks in them, and the progress of cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP
from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.systems.solution import Solution


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


class Sticking:
    """Contact points that never slip in a cycle: at its end alone, most of them stick.

    Args:
        contacts: Of the problem.
    """

    def __init__(self, contacts: Sequence[ContactSurface]) -> None:
        self._contacts = contacts
        self._touched = [np.zeros(len(c.trace.weights), dtype=bool) for c in contacts]
        self._slipped = [np.zeros(len(c.trace.weights), dtype=bool) for c in contacts]

    def follow(self, solution: Solution) -> None:
        """Count a load step in."""
        for touched, slipped, state in zip(
            self._touched, self._slipped, solution.states, strict=True
        ):
            touched |= state.status != OPEN
            slipped |= state.status == SLIP

    def areas(self) -> list[float]:
        """Return the area of each contact that touched and never slipped; collective (area)."""
        return [
            float(contact.trace.integral((touched & ~slipped).astype(np.float64)))
            for contact, touched, slipped in zip(
                self._contacts, self._touched, self._slipped, strict=True
            )
        ]
