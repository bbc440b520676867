"""Forces of a contact, as solvers balance them, and the work that is done along it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.terms import FrictionTerm, NormalTerm
from fenics_contact.contact.state import ContactState, LastStep
from fenics_contact.contact.surface.trace import Trace


class ContactForces:
    """Forces of the laws across and along a contact.

    Attributes:
        friction_weight: How often friction counts beside pressure in what Newton's method balances:
            twice in steps of motion.
        by_points: Whether forces and tangents are worked out point by point, without the compiled
            forms: the same numbers, sooner where points are few; for nodal points only.

    Args:
        trace: The contact points.
        across: How solvers use the law across the contact.
        along: How they use the law along it.
    """

    def __init__(self, trace: Trace, across: NormalTerm, along: FrictionTerm) -> None:
        self._trace, self._across, self._along = trace, across, along
        self.by_points = False
        self.friction_weight = 1.0

    @property
    def terms(self) -> list[NormalTerm | FrictionTerm]:
        """Forces that follow the jump: of pressure, and of friction."""
        across: list[NormalTerm | FrictionTerm] = [self._across] * self._across.law.follows_jump
        return [*across, self._along] if self._along.law.has_friction else across

    def weight_of(self, term: NormalTerm | FrictionTerm) -> float:
        """How often a term counts in what Newton's method balances."""
        return self.friction_weight if term is self._along else 1.0

    def count_friction_twice(self) -> None:
        """Count friction twice in the balance from now on, as steps of motion do."""
        self.friction_weight = 2.0

    def go_by_points(self) -> None:
        """Work out forces and tangents point by point from now on, where that is possible.

        So it is where all points are nodes, and the laws say what they do at points.
        """
        self.by_points = self._trace.nodal and self._across.law.is_pointwise

    def of(self, term: NormalTerm | FrictionTerm) -> Array:
        """Forces of a term at all nodes of the surface, (nodes, components); collective."""
        if not self.by_points:
            return term.force()
        return self._at_nodes(term.at_points())

    def all(self) -> Array:
        """Forces of both laws at all nodes of the surface, friction by its weight; collective."""
        across, along, weight = self._across, self._along, self.friction_weight
        if not self.by_points:
            return across.force() + weight * along.force()
        return self._at_nodes(across.at_points() + weight * along.at_points())

    def none(self) -> Array:
        """Forces of a contact that touches nowhere, (nodes, components)."""
        surface = self._trace.surface
        return np.zeros((len(self._trace.all_nodes), surface.components))

    def given(self) -> list[tuple[Array, Callable[[float], float]]]:
        """Nodal forces that are given, in full, with the share that acts at a pseudo-time.

        At all nodes of the surface, (nodes, components); collective.
        """
        law = self._across.law
        if not self.by_points:
            return [(self._trace.surface.assemble(form), path) for form, path in law.loads]
        return [(self._at_nodes(traction), path) for traction, path in law.loads_at_points]

    def _at_nodes(self, traction: Array) -> Array:
        """Forces of a traction at the points, which are nodes; collective."""
        return self._trace.at_all_nodes(self._trace.weights[:, None] * traction)


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
