"""Contact points that never slip in a cycle: at its end alone, most of them stick."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP
from fenics_contact.solve.newton.solution import Solution


class Sticking:
    """Follows the load steps of a cycle.

    Args:
        contacts: Of the problem.
    """

    def __init__(self, contacts: Sequence[ContactSurface]) -> None:
        self._contacts = contacts
        self._touched = [np.zeros(len(c.trace.weights), dtype=bool) for c in contacts]
        self._slipped = [np.zeros(len(c.trace.weights), dtype=bool) for c in contacts]

    def follow(self, solution: Solution) -> None:
        """Count a load step in.

        Args:
            solution: Of it.
        """
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
