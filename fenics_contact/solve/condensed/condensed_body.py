"""A body condensed onto the surfaces at which contacts may act: whatever no condition changes.

One factorisation of the bulk, and the Schur complement S. It holds for any laws, coefficients,
obstacles, loads, values of supports and load steps; a problem that is done with leaves it behind.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.timings import Timings
from fenics_contact.contact.mortar.projection import Projection
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.motion_states import StepStiffness
from fenics_contact.problem.scalar_unknown import PrescribedDisplacement, ScalarUnknown
from fenics_contact.solve.condensed.condensed_loads import CondensedLoads, LoadsOfBody
from fenics_contact.solve.condensed.constant_tangent import OfSchur
from fenics_contact.solve.condensed.elimination import Eliminated, ReducedSchur, stiffness_of
from fenics_contact.solve.condensed.kept_rows import BodyRows
from fenics_contact.solve.condensed.part_factors import KnownFactors
from fenics_contact.solve.condensed.scalar_border import CondensedScalars
from fenics_contact.solve.condensed.schur import (
    BulkWithoutFactor,
    CondensedBulk,
    Functional,
    RowMaker,
)
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.contact_dofs import ContactDofs
from fenics_contact.solve.systems.near_nodes import NearNodes
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

# Displacements that scalars prescribe and that are kept: an obstacle that moves along the surface
# of a half-space makes others.
_MOST_KEPT = 8


@dataclass(frozen=True, eq=False)
class ScalarLoad:
    """Loads and displacements that a unit of a scalar unknown makes in the bulk.

    Attributes:
        load: On this rank's unknowns (force).
        displacements: At the contact dofs (length).
        condensed: The load condensed onto them, on rank 0 (force).
    """

    load: Array
    displacements: Array
    condensed: Array


class CondensedBody:
    """K, its factorisation, S and the loads condensed so far; collective.

    Attributes:
        discrete: The body.
        sides: The surfaces at which contacts may act.
        stiffness: That of each rank's cells.
        dofs: The contact dofs.
        held: Which of this rank's unknowns of the stiffness supports hold.
        bulk: The factorisation, and S on rank 0.
        loads: Those condensed so far.
        loads_at: What loads and supports of a moment do.
        scalars: What the scalars of the body's energy do.
        rows: Those of numbers that are linear in the displacement.

    Args:
        discrete: The body.
        constrained: Dofs that supports hold (local indices, owned and ghost).
        sides: The surfaces at which contacts may act.
        timings: Seconds so far.
        schur: Gives S on rank 0, where it is known, in the order of given contact dofs; collective.
        factors: Those of a body before, which serve where a part of the body is the same.
        step: As of ``LocalStiffness``.
        near: As of ``ContactDofs``.

    Raises:
        MachineError: There is not the memory for the factorisation; on every rank.
        NotConvergedError: Supports and contacts do not hold the body; likewise.
    """

    def __init__(
        self,
        discrete: DiscreteBody,
        constrained: Integers,
        sides: Sequence[ContactSides],
        timings: Timings,
        schur: Callable[[ContactDofs], Array | None] | None = None,
        factors: KnownFactors | None = None,
        step: StepStiffness | None = None,
        near: Sequence[NearNodes | None] | None = None,
    ) -> None:
        self.discrete, self._known = discrete, factors
        self._constrained, self.sides = constrained, tuple(sides)
        self._moves = step is not None
        self._columns = None if step is None else step.scalars
        with timings.phase("assemble"):
            self.stiffness = LocalStiffness(discrete, step)
        self.dofs = ContactDofs(discrete.spaces, constrained, sides, near, discrete.cut)
        self.held = self.stiffness.held(self.dofs.constrained)
        with timings.phase("factorise"):
            self._take(self._make_bulk(None if schur is None else (schur(self.dofs),)))

    def _make_bulk(self, schur: tuple[Array | None] | None) -> CondensedBulk:
        """The bulk, whose S may be known: on rank 0, None on others; collective."""
        known = (self.stiffness, self.held, self.dofs.free)
        if schur is None:
            return CondensedBulk(*known, self._known)
        return BulkWithoutFactor(*known, *schur, self._known)

    def _take(self, bulk: CondensedBulk) -> None:
        """Work out all that follows from a factorisation and is remembered; collective."""
        self.bulk, self.loads = bulk, CondensedLoads(bulk)
        self.renew_scalars()
        self._of_schur: OfSchur | None = None
        self._of_jumps: tuple[list[Projection], Flags, OfSchur | ReducedSchur] | None = None
        self._of_prescribed: list[tuple[Array, ScalarLoad]] = []
        self._given_up: tuple[OfSchur | ReducedSchur, ContactVariables] | None = None

    def renew_scalars(self) -> None:
        """Work out what the scalars of the body do to it at present; collective."""
        bulk, discrete, moves = self.bulk, self.discrete, self._moves
        columns = self._columns or discrete.elastic.columns
        self.scalars = CondensedScalars(columns, self.stiffness, bulk, self.held)
        self.loads_at = LoadsOfBody(
            self.stiffness,
            self.held,
            self.dofs,
            bulk.condense if self._moves else self.loads.condense,
            self.scalars,
            self._constrained,
            lambda: discrete.is_kept and not moves,
        )
        self.rows = BodyRows(RowMaker(self.stiffness, self.held, self.dofs, bulk))

    def with_bulk(self, bulk: CondensedBulk) -> CondensedBody:
        """The body with another bulk, that of steps of motion; collective.

        Args:
            bulk: Of the same unknowns and contact dofs; its caller keeps it.
        """
        found = copy.copy(self)
        found._moves = True
        found._take(bulk)
        return found

    def scalar_load(self, unknown: ScalarUnknown) -> ScalarLoad:
        """The load of a unit of a scalar unknown, worked out once for each; collective.

        Args:
            unknown: One of a problem on this body.
        """
        forces = unknown.forces_on_body
        if forces is None:
            return self._load_of_prescribed(unknown.prescribes)
        number = self.discrete.elastic.scalar_forces.index(forces)
        loads, condensed = self.scalars.loads, self.scalars.condensed
        return ScalarLoad(loads[number], np.zeros(len(self.dofs.numbers)), condensed[number])

    def _load_of_prescribed(self, given: PrescribedDisplacement | None) -> ScalarLoad:
        """The load of displacements that a scalar prescribes, or of none; collective."""
        size = len(self.dofs.constrained)
        column = None if given is None else given.displacement
        found = next((load for known, load in self._of_prescribed if known is column), None)
        if found is None:
            displacements = np.zeros(size) if given is None else given.of_all(size)
            nodal = displacements.reshape(-1, self.discrete.spaces.components)
            load = self.stiffness.load(np.zeros_like(nodal), nodal, self.held)
            found = ScalarLoad(load, self.dofs.gathered(displacements), self.loads.condense(load))
            if column is not None:
                self._of_prescribed = [
                    *self._of_prescribed[-_MOST_KEPT + 1 :],
                    (column, found),
                ]
        return found

    def precompute_loads(self, loads: Sequence[Array]) -> None:
        """Find what loads do that are going to act, together: it takes hardly longer than of one.

        Condensed onto the contacts, and what is linear in it; collective.

        Args:
            loads: At the nodes of this rank, (nodes, components) each (force).
        """
        stiffness = self.stiffness
        none = np.zeros_like(loads[0])
        every = [stiffness.load(one, none, self.held) for one in loads]
        self.loads.precompute(np.array(every))
        self.rows.given.precompute([Functional(forces=stiffness.share(one)) for one in loads])

    @property
    def of_schur(self) -> OfSchur | None:
        """S of a body that is kept, with what follows from it; on rank 0, None on others."""
        if self._of_schur is None and self.bulk.schur is not None:
            self._of_schur = OfSchur(self.bulk.schur)
        return self._of_schur

    def of_unknowns(
        self, variables: ContactVariables, acted_on: Flags
    ) -> OfSchur | ReducedSchur | None:
        """S between unknowns that are jumps where bodies touch; on rank 0.

        Kept of the bodies as meshed, with which every problem on them begins.

        Args:
            variables: The unknowns.
            acted_on: On which of them contacts act; used on rank 0.
        """
        schur, projections = self.bulk.schur, variables.projections
        if schur is None or not variables.has_jumps:
            return self.of_schur
        known = self._of_jumps
        if known and known[0] == projections and np.array_equal(known[1], acted_on):
            return known[2]
        found = stiffness_of(schur.copy(), variables, acted_on)
        if variables.is_as_meshed:
            self._of_jumps = projections, acted_on, found
        return found

    @property
    def factorisations(self) -> int:
        """How often K was factorised."""
        return self.bulk.factorisations

    def give_up(self, variables: ContactVariables, acted_on: Flags) -> OfSchur | Eliminated | None:
        """Return S between unknowns and forget it, as it is large; see ``of_unknowns``.

        Of other unknowns it is found again from what was returned last.
        """
        schur, self.bulk.schur = self.bulk.schur, None
        if self._given_up is not None:
            of_schur, before = self._given_up
            schur = before.nodal_stiffness(of_schur.written())
        if schur is None:
            return None
        found = stiffness_of(schur, variables, acted_on)
        self._given_up = found, variables
        return found

    def bulk_forces(self, position: Array) -> Array | None:
        """S x of displacements of the free contact dofs, on rank 0, None on others (force).

        Args:
            position: The displacements (length).
        """
        if self._given_up is None:
            return None if self.bulk.schur is None else self.bulk.schur @ position
        of_schur, variables = self._given_up
        return variables.nodal_forces(of_schur.times(variables.unknowns(position)))

    def serves(self, constrained: Integers, sides: Sequence[ContactSides]) -> bool:
        """Whether contacts on such surfaces of the body, so held, may act; collective.

        Args:
            constrained: Dofs that supports hold (local indices, owned and ghost).
            sides: The surfaces at which contacts act.
        """
        is_held_so = np.array_equal(self._constrained, constrained)
        has_all = all(any(one is other for other in self.sides) for one in sides)
        return bool(self.stiffness.comm.allreduce(is_held_so and has_all, op=MPI.LAND))

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self.bulk.destroy()
