"""The problem condensed onto what can touch: other nodes of contact surfaces stay inside the body.

Each answer is asked whether anything has closed there. Where it has, the body is condensed onto
more nodes, and the load step is solved again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem, acting_sides
from fenics_contact.solve.systems.near_nodes import (
    NearNodes,
    closed_near,
    coming_near,
    facing_near,
    touching_at,
)
from fenics_contact.solve.systems.solution import FindBody

logger = logging.getLogger(__name__)


class NearSystem(CondensedSystem):
    """The problem condensed onto those nodes of the contact surfaces that can touch.

    Positions are displacements of all nodes, which hold whatever it is condensed onto.

    Attributes:
        near: These nodes of each contact that exerts forces, None for all.

    Args:
        problem: The problem.
        timings: Seconds so far.
        near: The nodes to begin with.
    """

    def __init__(
        self, problem: Problem, timings: Timings, near: Sequence[NearNodes | None]
    ) -> None:
        self.near = list(near)
        super().__init__(problem, timings)

    def _condense(self) -> CondensedBody:
        problem = self.problem
        known = problem.discrete, problem.constrained, acting_sides(problem)
        return CondensedBody(*known, self._timings, near=self.near)

    def _take_body(self, body: CondensedBody) -> None:
        """Set up all that follows from a condensed body; collective."""
        contacts = enumerate(self.problem.contacts)
        acting = (number for number, contact in contacts if contact.forces.terms)
        pairs = zip(acting, self.near, strict=True)
        self.idle = frozenset(n for n, near in pairs if near is not None and near.is_empty)
        super()._take_body(body)

    @property
    def _acting(self) -> list[ContactSurface]:
        """The contacts that exert forces, in the order of ``near``."""
        return [contact for contact in self.problem.contacts if contact.forces.terms]

    def _widened(self, found: Sequence[NearNodes | None]) -> bool:
        """Whether there are further nodes, which are condensed onto from now on; collective.

        The state is lost then.
        """
        joined = [
            near if near is None or more is None else near.joined(more)
            for near, more in zip(self.near, found, strict=True)
        ]
        pairs = zip(self.near, joined, strict=True)
        if all(one is None or (other is not None and one.has(other)) for one, other in pairs):
            return False
        before, self.near = len(self.dofs.numbers), joined
        self.body.destroy()
        self._destroy_vectors()
        self._take_body(self._condense())
        logger.info(
            "contact closes where it was open: condensed onto %d dofs of contacts instead of %d",
            len(self.dofs.numbers),
            before,
        )
        return True

    def begin(self, displacement: Array) -> None:
        """Start from nodal displacements (nodes, components); collective."""
        self._widened(self._of_each(partial(coming_near, displacement=displacement)))
        super().begin(displacement)

    def _of_each(self, find: Callable[[ContactSurface], NearNodes]) -> list[NearNodes | None]:
        """Nodes of each contact, as of ``near``, that some function finds; collective."""
        pairs = zip(self._acting, self.near, strict=True)
        return [None if near is None else find(contact) for contact, near in pairs]

    def position(self) -> Array:
        """Displacements of all nodes of this rank, one after the other; collective.

        At the contact dofs those of the present state, elsewhere of the last answer.
        """
        found = np.array(self.problem.displacement.x.array)
        return np.asarray(found + self.dofs.placed(self.contact_displacements(), less=found))

    def position_of(self, displacement: Array) -> Array:
        """Displacements of all nodes of this rank, one after the other."""
        return displacement.reshape(-1)

    def begin_at(self, position: Array) -> None:
        """Start from displacements of all nodes of this rank; collective.

        What overlaps there has contact dofs: another run may have found it to close.
        """
        displacement = position.reshape(-1, self.problem.spaces.components)
        self._widened(self._of_each(partial(touching_at, displacement=displacement)))
        super().begin_at(super().position_of(position))

    def at_contacts(self, find_body: FindBody) -> Array:
        """Displacement of the present state, at the body's nodes of this rank; collective."""
        return find_body().displacement

    def update_pairing(self) -> None:
        """Update the pairing of contacts; with other masters another factorisation; collective."""
        scalars = self.scalar_values(self.state)
        pairs = zip(self._acting, self.near, strict=True)
        if not self._widened([None if n is None else facing_near(one, n) for one, n in pairs]):
            super().update_pairing()
            return
        self._set_state(super().position_of(self.problem.displacement.x.array), scalars)
        self.follow_loads()
        self._started = self._displacements(self._values(self.state))

    def finish(self) -> FindBody:
        """Find the displacement inside, and the jumps of nodes that are left out; collective."""
        find = super().finish()
        displacement = find().displacement
        values = self._values(self.state)
        solved = self._contacts.displacements(values, self._held_parts)
        every = [self._with_others(number, one, displacement) for number, one in enumerate(solved)]
        self.move_contacts(every, self._scalars_of(values))
        return find

    def _with_others(self, number: int, solved: Array | None, displacement: Array) -> Array | None:
        """Relative displacement at all nodes of a contact's surface of this rank; collective."""
        contact = self.problem.contacts[number]
        near = self.dofs.near(contact.sides)
        if near is None or solved is None:
            return solved
        every = contact.kinematics.relative(displacement)
        present = near.slaves[contact.trace.surface.numbers]
        return np.where(present[:, None], solved, every)

    def take_in_closed(self) -> bool:
        """Take in contact dofs where points have closed that the last answer left out; collective.

        Returns:
            Whether there are any: the step is to be solved again.
        """
        pairs = zip(self._acting, self.near, strict=True)
        return self._widened([None if n is None else closed_near(one, n) for one, n in pairs])

    def take_in_all(self) -> bool:
        """Take in all contact dofs, after a solve without some has failed; collective.

        Returns:
            Whether points take part that did not: the step is to be tried again. Masters that no
            further point faces would change nothing.
        """
        if all(near is None or near.slaves.all() for near in self.near):
            return False
        return self._widened([None if near is None else near.of_all() for near in self.near])
