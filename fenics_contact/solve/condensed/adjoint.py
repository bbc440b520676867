"""The adjoint of the condensed problem: what forces and displacements given to it do to a quantity.

With the forces F(y, θ) that are out of balance, dJ = J_θ dθ − Λ · F_θ dθ with Fᵧᵀ Λ = J_y. At an
answer the tangent that couples friction's bound to the pressure is the true Fᵧ. Λ is a virtual
displacement ψ of the body, and a number for each scalar unknown. What is condensed has ψ at the
contacts from one dense transposed solve; inside the body it takes a back-substitution.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import from_root, gathered_on_root, total
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.condensed.condensed_body import CondensedBody
from fenics_contact.solve.condensed.condensed_contacts import ContactJump
from fenics_contact.solve.condensed.elimination import KeptLoad, KeptUnknowns
from fenics_contact.solve.condensed.tangent import ContactTangent


@dataclass(frozen=True, eq=False)
class BodyGradient:
    """Gradient of a quantity in the body's displacement, and forces of supports in it.

    Attributes:
        displacement: At the nodes of this rank, (nodes, components).
        reactions: Factors of the forces of supports at the dofs that they hold, 0 elsewhere,
            likewise.
    """

    displacement: Array
    reactions: Array


class CondensedAdjoint:
    """Solves with the transpose of a tangent; collective.

    Args:
        problem: In the state of the tangent.
        body: Condensed.
        kept: The unknowns.
        dense: The tangent, on rank 0.
        jumps: Of each contact that exerts forces.
    """

    def __init__(
        self,
        problem: Problem,
        body: CondensedBody,
        kept: KeptUnknowns,
        dense: ContactTangent | None,
        jumps: Sequence[ContactJump | None],
    ) -> None:
        self.problem, self.body, self.kept = problem, body, kept
        self.jumps, self._dense = jumps, dense

    def opposing(self, tractions: Sequence[Array | None]) -> Array:
        """Λ whose virtual jumps are minus given ones, wherever these are unknowns; collective.

        The virtual work of a traction is then taken off what a quantity has of it itself, and what
        is left is seen without the stiffness of contacts, of which it would be a small difference.

        Args:
            tractions: At all nodes of each surface, (nodes, components); None for none.
        """
        found = np.zeros(self.kept.count + len(self.problem.unknowns))
        taken = np.zeros(len(found), dtype=bool)
        for jump, traction in zip(self.jumps, tractions, strict=True):
            if jump is None or traction is None:
                continue
            rows = from_root(self.problem.comm, self._gathered(jump, traction))
            own = jump.columns < self.kept.count
            columns, places = jump.columns[own], jump.rows[own]
            mine = ~taken[columns]
            found[columns[mine]] = -rows[places[mine]]
            taken[columns] = True
        return found

    def solve(
        self,
        jumps: Sequence[Array],
        scalars: Array,
        body: BodyGradient | None,
        start: Array,
    ) -> Multipliers:
        """Λ of a quantity; collective.

        Args:
            jumps: Its gradient in the jump at all nodes of each surface, (nodes, components),
                with those of the virtual work of tractions on the jumps of ``start``.
            scalars: In the scalar unknowns, beside what these do to jumps and displacements.
            body: In the body, beside the contacts; None where there are none.
            start: Part of Λ that is known.
        """
        right = self.gradient(jumps, scalars, body)
        found = None
        if self._dense is not None:
            known = self._dense.times_transposed(start)
            found = self._dense.solve_transposed(right.of_unknowns - known)
        return self.multipliers(start, found, right)

    def gradient(
        self, jumps: Sequence[Array], scalars: Array, body: BodyGradient | None
    ) -> UnknownsGradient:
        """Gradient of a quantity in the unknowns, by that in what follows from them; collective.

        Args:
            jumps: As of ``solve``.
            scalars: Likewise.
            body: Likewise.
        """
        free = None if body is None else self._without_contacts(body)
        load = self._of_contact_dofs(free)
        right = self._of_unknowns(free, load)
        right[self.kept.count :] += scalars
        for jump, of_jump in zip(self.jumps, jumps, strict=True):
            if jump is None:
                continue
            rows = self._gathered(jump, of_jump)
            if self._dense is not None:
                onto = self._dense.inner.onto_unknowns(jump.slopes(rows))
                right[: len(onto)] += onto
        return UnknownsGradient(right, body, free, load.carried)

    def multipliers(
        self, start: Array, found: Array | None, right: UnknownsGradient
    ) -> Multipliers:
        """Λ of a quantity from its values at the unknowns; collective.

        Args:
            start: Part of them that is known.
            found: The other part, on rank 0; None on others.
            right: The quantity.

        Raises:
            NotConvergedError: They are no numbers.
        """
        rest = np.asarray(from_root(self.problem.comm, found))
        if not np.isfinite(rest).all():
            raise NotConvergedError(
                "derivatives: the answer is at a limit, where it does not follow what is given"
            )
        return Multipliers(self, start, rest, right)

    def jump(self, number: int, values: Array) -> Array:
        """Virtual jump of a contact at all nodes of its surface of this rank."""
        jump, surface = self.jumps[number], self.problem.contacts[number].trace.surface
        if jump is None:
            return np.zeros((len(surface.coordinates), surface.components))
        inner = len(values) - len(self.problem.body_scalars)
        derived = self.kept.derived_jumps(values[: self.kept.count])
        found = jump.virtual(np.concatenate([values[:inner], derived]))
        return np.asarray(found.reshape(-1, surface.components)[surface.numbers])

    def held_jump(self, number: int, body: BodyGradient | None) -> Array:
        """Virtual jump at the nodes of a surface of dofs whose reactions count; collective."""
        jump = self.jumps[number]
        surface = self.problem.contacts[number].trace.surface
        if jump is None or body is None:
            return np.zeros((len(surface.coordinates), surface.components))
        held = self.body.dofs.gathered(-body.reactions.reshape(-1))
        found = self.kept.variables.held_part(jump.surface, held)
        return np.asarray(found.reshape(-1, surface.components)[surface.numbers])

    def _without_contacts(self, body: BodyGradient) -> _FreeBody:
        """ψ with all contact dofs held, and what it leaves; one back-substitution."""
        stiffness, held = self.body.stiffness, self.body.held
        supported = -body.reactions
        load = stiffness.load(body.displacement, supported, held)
        nothing = np.zeros(len(self.body.dofs.free))
        found = self.body.bulk.expand(load, nothing)
        left = stiffness.share(body.displacement) - stiffness.matrix @ found
        on_scalars = self.body.scalars.from_loads(load, stiffness.at_unknowns(supported))
        on_scalars = on_scalars - self.problem.on_moved(body.displacement)
        return _FreeBody(load, stiffness.whole(left), on_scalars)

    def _of_contact_dofs(self, free: _FreeBody | None) -> KeptLoad:
        """Gradient of a quantity of the body in the free contact dofs; collective."""
        dofs = self.body.dofs
        if free is None:
            return self.kept.load(np.zeros(len(dofs.free)))
        return self.kept.load(dofs.gathered(free.left.reshape(-1))[dofs.is_free])

    def _of_unknowns(self, free: _FreeBody | None, load: KeptLoad) -> Array:
        """Gradient of a quantity of the body in the unknowns, on every rank."""
        count, problem = self.kept.count, self.problem
        found = np.zeros(count + len(problem.unknowns))
        if free is None:
            return found
        left = free.left.reshape(-1)
        found[:count] = load.own
        owned = problem.spaces.owned_nodes * problem.spaces.components
        given = [unknown.prescribes for unknown in problem.unknowns]
        every = [None if one is None else one.owned(owned) for one in given]
        if any(one is not None for one in every):
            moved = [0.0 if one is None else float(one[1] @ left[one[0]]) for one in every]
            found[count:] = total(problem.comm, np.array(moved))
        found[len(found) - len(free.on_scalars) :] -= free.on_scalars + load.on_scalars
        return found

    def _gathered(self, jump: ContactJump, nodal: Array) -> Array:
        """At all dofs of a surface, on rank 0; collective."""
        owned = jump.surface.contact.trace.surface.owned_nodes
        parts = gathered_on_root(self.problem.comm, nodal[:owned].reshape(-1))
        return np.zeros(0) if parts is None else np.concatenate(parts)


@dataclass(frozen=True, eq=False)
class _FreeBody:
    """ψ of a quantity of the body where no contact dof moves.

    Attributes:
        load: As the bulk takes it, this rank's share.
        left: What ψ leaves at the nodes, of all ranks, (nodes, components).
        on_scalars: What it does to the equation of each of the body's scalars.
    """

    load: Array
    left: Array
    on_scalars: Array


@dataclass(frozen=True, eq=False)
class UnknownsGradient:
    """Gradient of a quantity in the unknowns.

    Attributes:
        of_unknowns: In each, (unknowns,); with contacts' part on rank 0.
        body: In the body, beside the contacts.
        free: ψ of that without contacts.
        carried: Of its gradient in the contact dofs, as of ``KeptLoad``.
    """

    of_unknowns: Array
    body: BodyGradient | None
    free: _FreeBody | None
    carried: Array


class Multipliers:
    """Λ: a virtual displacement ψ of the body, and a number for each scalar unknown.

    Where a quantity has forces of supports in it, ψ is minus their factor there: so all of dJ in
    forces is ψ · df.

    Args:
        adjoint: That found it.
        start: Part of it that was known.
        rest: The other part.
        right: The quantity.
    """

    def __init__(
        self,
        adjoint: CondensedAdjoint,
        start: Array,
        rest: Array,
        right: UnknownsGradient,
    ) -> None:
        self._adjoint, self._rest, self._values = adjoint, rest, start + rest
        self._body, self._free, self._carried = right.body, right.free, right.carried
        self._problem = adjoint.problem

    @property
    def scalars(self) -> Array:
        """Multipliers of the scalar unknowns: dJ over the right-hand sides of their equations."""
        return self._values[self._adjoint.kept.count :]

    def other_jump(self, number: int) -> Array:
        """Virtual jump of a contact beyond that of the known part, at all nodes of its surface."""
        return self._adjoint.jump(number, self._rest)

    @cached_property
    def unknowns(self) -> Array:
        """ψ at this rank's unknowns of the stiffness; collective, one back-substitution."""
        adjoint, body = self._adjoint, self._adjoint.body
        load = np.zeros(len(body.stiffness.numbers)) if self._free is None else self._free.load
        for value, one in zip(self._of_body_scalars, body.scalars.loads, strict=True):
            load = load + value * one
        own, kept = self._values[: adjoint.kept.count], adjoint.kept
        at_contacts = kept.displacements(own, self._of_body_scalars, self._carried)
        return body.bulk.expand(load, at_contacts)

    @cached_property
    def displacement(self) -> Array:
        """ψ at the nodes of this rank, (nodes, components); collective."""
        found = self._adjoint.body.stiffness.at_nodes(self.unknowns)
        moved = self._problem.moved_by_scalars(self._of_body_scalars)
        return found if moved is None else found + moved

    @property
    def mean_stress(self) -> Array:
        """Mean stress of ψ at the dofs of this rank; empty without one; collective."""
        return self._adjoint.body.stiffness.mean_stresses(self.unknowns)

    @cached_property
    def at_supports(self) -> Array:
        """Gradient in displacements of dofs that are held, but for contacts' part; collective.

        At the nodes of this rank, (nodes, components).
        """
        stiffness = self._adjoint.body.stiffness
        found = -stiffness.forces(self.unknowns)
        if self._body is not None:
            found += self._body.displacement
        scalars = self._problem.body_scalars
        for value, scalar in zip(self._of_body_scalars, scalars, strict=True):
            found -= value * scalar.forces_on_body.nodal
        cut = self._problem.discrete.cut
        return found if cut is None else cut.folded(found)

    @property
    def kept_scalars(self) -> Array:
        """Gradient in the values that the body's scalars are held at, 0 of others."""
        units = self._adjoint.body.scalars.units
        return units * (self._last - self._of_body_scalars)

    @property
    def _of_body_scalars(self) -> Array:
        """Multipliers of the body's scalars; 0 where these are held, as no equation has them."""
        held = [scalar.held is not None for scalar in self._problem.body_scalars]
        return np.where(np.array(held, dtype=bool), 0.0, self._last)

    @property
    def _last(self) -> Array:
        return self._problem.of_body_scalars(self.scalars)
