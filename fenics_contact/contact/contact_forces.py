"""Forces of a contact, as solvers balance them: of both its laws, by forms or by points."""

from __future__ import annotations

from collections.abc import Callable

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.term import FrictionTerm
from fenics_contact.contact.laws.normal.term import NormalTerm
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
