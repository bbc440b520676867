"""Work along a contact: what friction takes, what goes back, what a load step leaves open."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.last_step import LastStep
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.trace import Trace


class ContactWork:
    """Works of a contact, over all of it; each method is collective.

    Args:
        trace: The contact points.
        normal: The law across it.
        friction: The law along it.
        last_step: What is kept of its last load step.
    """

    def __init__(
        self, trace: Trace, normal: NormalLaw, friction: FrictionLaw, last_step: LastStep
    ) -> None:
        self._trace, self._last = trace, last_step
        self._normal, self._friction = normal, friction

    def in_step(self, state: ContactState) -> float:
        """Dissipated in the present step; with the static law, since the start (energy).

        Args:
            state: At its end, before it is accepted.
        """
        friction, last = self._friction, self._last
        in_step = last.dissipation(state, self._slip_in_step(state))
        before = last.state.friction_traction
        work = friction.work(in_step, before, state.friction_traction, state.slip)
        return float(self._trace.integral(work))

    def _slip_in_step(self, state: ContactState) -> Array:
        """Slip of the present step, less what goes back, (points, components) (length)."""
        if self._last.acts_all_along:  # friction counts slip from elsewhere, by the velocity
            return state.slip - self._last.state.slip
        return self._friction.sliding(state.slip)

    def of_friction(self, state: ContactState) -> float:
        """Dissipated since the start: in all steps, or by the static law (energy).

        Args:
            state: As of ``in_step``.
        """
        before = self._last.dissipated if self._friction.follows_path else 0.0
        return before + self.in_step(state)

    def in_elastic_slip(self, state: ContactState) -> float:
        """Stored along the surface by slip that goes back (energy).

        Args:
            state: As of ``in_step``.
        """
        friction = self._friction
        if not friction.stores_energy:
            return 0.0
        elastic = friction.rule.elastic(friction.effective_slip(state.slip))
        stored = 0.0 - 0.5 * np.einsum("ij,ij->i", state.friction_traction, elastic)
        return float(self._trace.integral(stored))

    def left_open(self, state: ContactState) -> float:
        """Work that the present step leaves open where points began to touch or to slip (energy).

        Args:
            state: As of ``in_step``.
        """
        left = np.zeros(len(state.gap))
        if self._normal.pushes_only:
            left += self._last.open_pressing(state)
        if self._friction.has_friction:
            left += self._last.open_friction(state, self._slip_in_step(state))
        return float(self._trace.integral(left))
