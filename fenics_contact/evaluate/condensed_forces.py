"""Internal forces of an answer of which only contacts and supports are known.

Inside the body forces balance, as its displacement follows from what is known. What is linear in it
has a row (``solve/condensed/schur.py``): with these no displacement inside is found.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_root
from fenics_contact.evaluate.internal_forces import Balances, InternalForces
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.evaluate.rows_of_body import RowsOfBody, prescribed
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarState
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.condensed.schur import GivenState
from fenics_contact.solve.systems.solution import Solution


class CondensedForces(InternalForces):
    """Internal forces from what is known at contacts and supports; collective, as all.

    Args:
        problem: The model, in the state of the answer.
        solution: The answer; nothing inside the body is asked of it.
        body: The body, condensed.
        position: Displacements of the free contact dofs, on every rank (length).
        scalars: Values of the scalar unknowns.
    """

    tells_inside = False

    def __init__(
        self,
        problem: Problem,
        solution: Solution,
        body: CondensedBody,
        position: Array,
        scalars: Array,
    ) -> None:
        super().__init__(problem, solution)
        self._body, self._rows = body, RowsOfBody(problem, body)
        self._scalars = problem.of_body_scalars(scalars)
        moving = [
            (float(value), unknown.prescribes)
            for value, unknown in zip(scalars, problem.unknowns, strict=True)
            if unknown.prescribes is not None
        ]
        self._moving = np.array([value for value, _ in moving])
        self._columns = [
            given.of_all(problem.load.size).reshape(problem.load.shape) for _, given in moving
        ]
        self._prescribed = prescribed(problem)
        self._displacement = body.dofs.placed(position).reshape(problem.load.shape)
        self._displacement += self._prescribed
        for value, column in zip(self._moving, self._columns, strict=True):
            self._displacement += value * column
        stiffness = body.stiffness
        self._load = stiffness.share(self.load)
        forces = self._load + stiffness.share(self.contacts)
        for value, share in zip(self._scalars, self._rows.of_scalars, strict=True):
            forces -= value * share
        at_unknowns = stiffness.at_unknowns(self._displacement)
        self._state = GivenState(position, at_unknowns[body.held], forces)

    @classmethod
    def of(cls, system: CondensedSystem, solution: Solution) -> InternalForces:
        """Forces of a solution, in the state of the system that has found it; collective.

        Springs of supports are stretched by displacements that are found inside, and temperatures
        that change between load steps do work on these; faces that are coupled move by scalars, and
        the cut faces of a sector pull at each other, of which its rows do not know. At points that
        are held forces are asked for dof by dof.
        """
        problem = system.problem
        is_coupled = problem.couplings.size > 0 or problem.discrete.cut is not None
        does_work = problem.follows_temperature and problem.scene.load_steps.several
        if problem.feet or is_coupled or problem.at_places or does_work:
            return BulkForces(system.problem, solution)
        scalars = system.scalar_values(system.state)
        moved = system.contact_displacements()
        return cls(system.problem, solution, system.body, moved, scalars)

    @cached_property
    def _of_given(self) -> tuple[Array, Array]:
        """Work of the loads, of reactions on displacements of supports, and on those of scalars.

        And what each of these and of the body's scalars does to the free contact dofs, (…, dofs).
        """
        given, (shares, _) = self._body.rows.given, self._shares
        return given.values(shares, self._state), given.of_contacts(shares)

    @cached_property
    def _shares(self) -> tuple[Array, int]:
        """Shares of the kept rows in what is given, and how often rows were forgotten before."""
        given = self._body.rows.given
        held = [self._prescribed, *self._columns]
        return given.shares(self._rows.given([self._load], held)), given.forgotten

    @cached_property
    def unbalanced(self) -> Array:
        """K u less loads and contacts at the free contact dofs, 0 elsewhere."""
        _, columns = self._of_given
        far = 2 + len(self._moving)
        acting = columns[0] - columns[1] - self._moving @ columns[2:far]
        acting -= self._scalars @ columns[far:]
        found = self._body.bulk_forces(self._state.contacts)
        needed = None if found is None else found - acting
        needed = np.asarray(from_root(self.problem.comm, needed))
        found = self._body.dofs.placed(needed, less=self.contacts.reshape(-1))
        return found.reshape(self.load.shape)

    def _reactions_at(self, number: int) -> Array | float:
        """Reactions across a contact's surface at its nodes (force)."""
        return self._rows.across(number, self._state)

    @property
    def displacement(self) -> Array:
        """Displacement of contacts and of held dofs, 0 elsewhere, (nodes, components) (length)."""
        return self._displacement

    @property
    def imbalance(self) -> float:
        """The imbalance accepted: inside the body forces balance (force)."""
        return self.solution.imbalance_limit

    @property
    def given_work(self) -> float:
        """Work of loads and reactions on the displacement (energy)."""
        works, _ = self._of_given
        return float(works[0] + works[1] + self._moving @ works[2 : 2 + len(self._moving)])

    @cached_property
    def strain_energy(self) -> float:
        """½ a(u, u): the work of all nodal forces, as the bulk is linear (energy)."""
        product = self._summed(self._displacement * (self.unbalanced + self.contacts))
        return 0.5 * (self.given_work + product + self.solution.work_on_scalars)

    @cached_property
    def of_supports(self) -> Array:
        """Resultant of each applied support, (supports, components) (force)."""
        return self._rows.supports(self._state, self._scalars)

    @cached_property
    def moments_of_supports(self) -> Array:
        """Moment of each applied support, (supports, rotations) (force times length)."""
        return self._rows.support_moments(self._state, self._scalars) + 0.0  # no −0

    @property
    def of_all_supports(self) -> Array:
        """Resultant of all supports, (components,) (force)."""
        return np.asarray(self.of_supports.sum(axis=0)) + 0.0  # no −0

    def at_points(self) -> dict[str, list[float]]:
        """The displacement at the scene's points, by quantity."""
        return self._rows.points(self._state)

    def balances(self) -> Balances:
        """Resultants and moments that add up to zero in every connected part of the body.

        Reactions and their moments come from rows, and none of these is a sum of what the contacts
        get: so what a wrong solution leaves at the contacts shows here. Of the reactions those of
        each support together are ``carried``, which is no more than that of each node.
        """
        spaces = self.problem.spaces
        size, parts = spaces.components, spaces.parts
        reactions, moments = self._rows.of_parts(self._state)
        forces = self.load + self.contacts
        nodes = self.acting(forces)
        resultants, turning = np.zeros((parts.count, 3)), np.zeros((len(nodes), 3))
        resultants[:, :size] = parts.sums(forces[nodes], nodes) + reactions.sum(axis=0)
        turning[:, :size] = forces[nodes]
        arms = parts.arms[nodes] / parts.sizes[parts.of_node[nodes], None]
        carried = parts.sums(np.abs(forces[nodes]).sum(axis=1), nodes)
        return Balances(
            resultants,
            parts.sums(np.cross(arms, turning), nodes) + moments,
            carried + np.abs(reactions).sum(axis=(0, 2)),
        )

    def at_stabilised(self) -> Array:
        """Reactions at dofs that a stabilisation holds, of all ranks (force)."""
        return self._rows.stabilised(self._state)

    def of_stress(self, number: int) -> Array:
        """∫ σ n over the slave surface of a contact, by its number (force)."""
        return self._rows.stress(number, self._state, self._scalars)

    def scalar_states(self) -> tuple[ScalarState, ...]:
        """The body's scalars, with the forces on them that follow from the displacement."""
        works, _ = self._of_given
        on_scalars = works[2 + len(self._moving) :]
        on_scalars = on_scalars + self.problem.elastic.scalar_stiffness @ self._scalars
        known = zip(self.problem.body_scalars, self._scalars, on_scalars, strict=True)
        return tuple(one.state_at(float(force), float(value)) for one, value, force in known)

    def works_since(self, before: InternalForces | None) -> tuple[float, float]:
        """Works of loads and reactions since another answer, by the trapezoidal rule (energy)."""
        works, _ = self._of_given
        if before is None:
            return 0.5 * float(works[0]), 0.5 * (self.given_work - float(works[0]))
        assert isinstance(before, CondensedForces)
        loads = supports = 0.0
        for one, sign in ((self, 1.0), (before, -1.0)):
            now, then = one._works_in(self), one._works_in(before)
            moved = sign * np.array([1.0, *one._moving])
            loads += 0.5 * float(now[0] - then[0])
            supports += 0.5 * float(moved @ (now + then)[1 : 1 + len(moved)])
        return loads, supports

    def _works_in(self, other: CondensedForces) -> Array:
        """Works of what is given here on another answer: loads, supports, scalars; collective."""
        given = self._body.rows.given
        if self._shares[1] != given.forgotten:
            del self._shares
        return given.values(self._shares[0], other._state)
