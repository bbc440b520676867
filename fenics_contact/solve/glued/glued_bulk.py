"""The bulk condensed onto the jumps at its contacts, by one factor of all bodies glued.

What ``CondensedBulk`` holds while it solves inside are all contact dofs; here it is the jumps, and
masters move as the glued bodies let them. Forces f condensed are those that are left at the contact
dofs, which act on slaves and on the masters beneath them as equal and opposite: none is left on the
masters once slaves have jumps as their unknowns. All else that follows from a condensed bulk is as
with one that is condensed onto all contact dofs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    of_every_rank,
    raise_together,
)
from fenics_contact.solve.condensed.constant_tangent import OfSchur
from fenics_contact.solve.condensed.elimination import Eliminated
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.glued.glued_factor import GluedFactor
from fenics_contact.solve.glued.recycled import Directions
from fenics_contact.solve.glued.zone import Zone
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

# Forces on masters, over all, up to which they are round-off.
_NONE = 1e-8


class _Whole(NamedTuple):
    """K of all ranks, and which of its unknowns supports hold."""

    matrix: csr_matrix
    held: Flags


class GluedBulk(CondensedBulk):
    """All bodies glued at their contacts, on rank 0; collective.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.
        variables: The unknowns that stand for these.

    Attributes:
        of_jumps: S' between the jumps, on rank 0; None on others.

    Raises:
        MachineError: MUMPS had not the memory; on every rank.
        NotConvergedError: Supports and glued contacts do not hold the bodies; likewise.
    """

    def __init__(
        self,
        stiffness: LocalStiffness,
        held: Flags,
        contact: Integers,
        variables: ContactVariables,
    ) -> None:
        self.comm, self.count, self.schur = stiffness.comm, len(contact), None
        self.factorisations = 1
        self._variables = variables
        every = of_every_rank(self.comm, stiffness.numbers)
        union = np.unique(np.concatenate(every))
        self._places = [np.searchsorted(union, numbers) for numbers in every]
        self._size = len(union)
        self._held = held
        self._factor: GluedFactor | None = None
        self.of_jumps: JumpStiffness | None = None
        whole, error = self._gathered(stiffness.matrix, held), None
        if whole is not None:
            jumps = np.flatnonzero(variables.acted_on)
            places = np.searchsorted(union, contact)
            self._factor = GluedFactor(*whole, places, variables.glue, jumps)
            error = self._factor.error
            if error is None:
                zone = Zone(*whole, places, jumps)
                masters = Zone(*whole, places, np.flatnonzero(~variables.acted_on))
                self.of_jumps = JumpStiffness(self._factor, zone, masters, variables)
        raise_together(self.comm, error)

    def _gathered(self, matrix: csr_matrix, held: Flags) -> _Whole | None:
        """K of all ranks, on rank 0; collective."""
        parts = gathered_on_root(self.comm, (matrix, held))
        if parts is None:
            return None
        if len(parts) == 1 and (self._places[0] == np.arange(self._size)).all():
            return _Whole(matrix, held)
        rows, columns, values = [], [], []
        is_held = np.zeros(self._size, dtype=bool)
        for places, (part, holds) in zip(self._places, parts, strict=True):
            entries = coo_matrix(part)
            rows.append(places[entries.row])
            columns.append(places[entries.col])
            values.append(entries.data)
            is_held[places[holds]] = True
        where = np.concatenate(rows), np.concatenate(columns)
        shape = self._size, self._size
        whole = csr_matrix((np.concatenate(values), where), shape=shape)
        whole.sort_indices()
        return _Whole(whole, is_held)

    def _forces(self, load: Array) -> Array:
        """This rank's shares of forces summed over ranks, on rank 0; collective.

        Args:
            load: As of ``condense``.
        """
        parts = gathered_on_root(self.comm, (load, self._held))
        found = np.zeros((*load.shape[:-1], self._size))
        for places, (part, held) in zip(self._places, parts or (), strict=False):
            found[..., places] += np.where(held, 0.0, part)
            found[..., places[held]] = part[..., held]
        return found

    def condense(self, load: Array) -> Array:
        """Forces that a load leaves at the contact dofs, on rank 0; collective.

        Args:
            load: As of ``CondensedBulk.condense``.
        """
        return self._condensed(self._forces(load))[0]

    def _condensed(self, forces: Array) -> tuple[Array, Array]:
        """Forces left at the contact dofs, and all displacements; on rank 0, else nothing."""
        if self._factor is None:
            return np.zeros((*forces.shape[:-1], self.count)), forces
        found = self._factor.solve(forces)
        return self._factor.left(forces, found), found

    def condense_and_expand(self, load: Array) -> tuple[Array, Array]:
        """Condensed load, and this rank's unknowns under it while no jump opens; collective."""
        condensed, found = self._condensed(self._forces(load))
        return condensed, self._to_ranks(found)

    def _to_ranks(self, found: Array) -> Array:
        """This rank's unknowns of what rank 0 knows of all; collective."""
        return np.asarray(from_root(self.comm, found)[..., self._places[self.comm.rank]])

    def expand(self, load: Array, x: Array) -> Array:
        """This rank's unknowns where jumps are those of contact dofs x (on rank 0); collective."""
        forces = self._forces(load)
        if self._factor is not None:
            jumps = None
            if x.any():
                jumps = self._variables.unknowns(x)[self._variables.acted_on]
            forces = self._factor.solve(forces, jumps)
        return self._to_ranks(forces)

    def moved(self, load: Array) -> Array | None:
        """How a load moves the free contact dofs while no jump opens, on rank 0; collective."""
        forces = self._forces(load)
        if self._factor is None:
            return forces[..., : self.count]  # of no meaning, but of that shape
        return np.asarray(self._factor.solve(forces)[..., self._factor.contact])

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._factor is not None:
            self._factor.destroy()
        if self.of_jumps is not None:
            self.of_jumps.destroy()


class JumpStiffness(Eliminated):
    """S of all unknowns: one back-substitution for each product; on rank 0.

    Args:
        factor: Of the glued bodies.
        zone: Cells at the slaves.
        masters: Cells at what is no jump.
        variables: The unknowns.

    Attributes:
        zone: See the arguments.
        directions: Those of solves so far.
    """

    own: AppliedSchur

    def __init__(
        self, factor: GluedFactor, zone: Zone, masters: Zone, variables: ContactVariables
    ) -> None:
        self.zone, self._factor, self._variables = zone, factor, variables
        self._masters = masters.on_springs()
        self.kept = np.flatnonzero(variables.acted_on)
        self.rest = np.flatnonzero(~variables.acted_on)
        self.own = AppliedSchur(factor, zone)
        self.directions = Directions(len(self.kept), self.own.product)
        self.diagonal = self.own.diagonal

    def given_way(self, forces: Array) -> Array:
        """Nearly how far masters give way beneath slaves under forces on these, (vectors, jumps).

        Args:
            forces: That slaves put on masters, (vectors, jumps).
        """
        every = np.zeros((len(forces), len(self.kept) + len(self.rest)))
        every[:, self.kept] = forces
        pressed = np.array([self._variables.forces(one)[self.rest] for one in every])
        every[:] = 0.0
        every[:, self.rest] = self._masters.solve(pressed)
        return np.array([self._variables.displacements(one)[self.kept] for one in every])

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._masters.destroy()

    def _under(self, forces: Array) -> tuple[Array, Array]:
        """Forces at the jumps, and how masters move, under forces on masters while no jump opens.

        Args:
            forces: On all unknowns, (unknowns,).
        """
        contact = self._factor.contact
        nodal = np.zeros(self.zone.unknowns)
        nodal[contact[self.rest]] = forces[self.rest]
        found = self._factor.solve(nodal)
        return self._factor.left(nodal, found)[self.kept], found[contact[self.rest]]

    def _acts(self, forces: Array) -> bool:
        """Whether forces on masters are more than round-off."""
        left = np.abs(forces[self.rest]).max(initial=0.0)
        return bool(left > _NONE * np.abs(forces).max(initial=0.0))

    def carried(self, forces: Array) -> Array:
        """S_mm⁻¹ f_m, (eliminated,)."""
        return self._under(forces)[1] if self._acts(forces) else np.zeros(len(self.rest))

    def onto_kept(self, forces: Array, carried: Array) -> Array:
        """f_w − S_wm S_mm⁻¹ f_m; as of any elimination."""
        own = forces[self.kept]
        return np.asarray(own + self._under(forces)[0] if self._acts(forces) else own)

    def work(self, forces: Array, carried: Array, others: Array) -> Array:
        """f_mᵀ S_mm⁻¹ g_m; as of any elimination."""
        return np.asarray(forces[self.rest] @ others)

    def every(self, kept: Array, carried: Array) -> Array:
        """w, and S_mm⁻¹ (f_m − S_mw w); as of any elimination."""
        found = np.empty(len(self.kept) + len(self.rest))
        found[self.kept] = kept
        moved = self._factor.solve(np.zeros(self.zone.unknowns), kept)
        found[self.rest] = carried + moved[self._factor.contact[self.rest]]
        return found


class AppliedSchur(OfSchur):
    """S' between jumps, which is applied and not written.

    Args:
        factor: Of the glued bodies.
        zone: Cells at the slaves.
    """

    def __init__(self, factor: GluedFactor, zone: Zone) -> None:
        self._factor, self._zone = factor, zone
        self._known: list[tuple[Array, Array]] = []

    def times(self, values: Array) -> Array:
        """Product S' w; of what lies on the line through the last two known ones without a solve.

        As the states are that a search along a step tries.
        """
        found = self._on_line(values)
        if found is None:
            found = self._factor.times(values)
            self._known = [*self._known[-1:], (values.copy(), found)]
        return found.copy()

    def product(self, values: Array) -> Array:
        """Product S' w of a vector that has nothing to do with states."""
        return self._factor.times(values)

    def _on_line(self, values: Array) -> Array | None:
        if not self._known:
            return None
        last, product = self._known[-1]
        if np.array_equal(last, values):
            return product
        if len(self._known) < 2:
            return None
        first, of_first = self._known[0]
        way, of_way = last - first, product - of_first
        share = float(way @ (values - first)) / float(way @ way)
        off = np.abs(values - first - share * way).max()
        is_near = off <= _SAME * np.abs(values).max()
        return np.asarray(of_first + share * of_way) if is_near else None

    @property
    def diagonal(self) -> Array:
        """Diagonal of the stiffness of the slaves' cells, (jumps,)."""
        return self._zone.diagonal

    @property
    def stiffest(self) -> float:
        """Largest entry of the diagonal; 1 if there is none."""
        return float(self.diagonal.max(initial=0.0)) or 1.0

    @property
    def column_sums(self) -> Array:
        """Σ |K| over the rows, which the round-off of a product grows with, (jumps,)."""
        return self._zone.column_sums


# Of the largest jump, up to which a state is on a line.
_SAME = 1e-14
