"""The bulk of assemblies with very many contact dofs: S is applied and never formed.

S y takes a back-substitution with the inside of each connected part, S⁻¹ f one with each whole
part. A part that no support holds gets springs at as few dofs as it has rigid motions: they carry
nothing where the forces on the part are in balance. Both factors are sparse, and stand on rank 0,
which has all of K.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix, diags

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import (
    from_root,
    gathered_on_root,
    of_every_rank,
    raise_together,
)
from fenics_contact.solve.condensed.constant_tangent import OfSchur
from fenics_contact.solve.condensed.part_factors import (
    KnownFactors,
    LocalFactor,
    unknowns_of_parts,
    without,
)
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.unknowns import ContactVariables
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness
from fenics_contact.solve.systems.system import sprung

# In space it takes half the memory of ``lu``, and about its time where no Schur complement is made.
_KIND = "cholesky"
# Energy of a rigid motion, over that of moving its dofs one by one, up to which nothing resists it.
_LOOSE = 1e-9


@dataclass(eq=False)  # of which two matrices are kept
class _Part:
    """A connected part of the body.

    Attributes:
        unknowns: Its unknowns among all.
        matrix: Its stiffness, with identity rows for what is held.
        contact: Its contact dofs, among its own unknowns.
        places: These, among all contact dofs.
        motions: Rigid motions that no support resists, at its contact dofs, (contact, motions).
        inside: Factor with the contact dofs held.
        whole: Factor with springs where it could move.
    """

    unknowns: Integers
    matrix: csr_matrix
    contact: Integers
    places: Integers
    motions: Array
    inside: LocalFactor
    whole: LocalFactor

    @cached_property
    def rows(self) -> csr_matrix:
        """Rows of its stiffness of its contact dofs."""
        return csr_matrix(self.matrix[self.contact])

    @cached_property
    def columns(self) -> csr_matrix:
        """Columns of its stiffness of its contact dofs."""
        return csr_matrix(self.matrix[:, self.contact])

    def times(self, x: Array) -> Array:
        """S x of its contact dofs."""
        forces = self.columns @ x
        found = forces[self.contact]
        forces[self.contact] = 0.0
        return np.asarray(found - self.rows @ self.inside.solve(forces))

    def held_times(self, x: Array) -> Array:
        """Forces on its contact dofs where these alone move."""
        return np.asarray((self.columns @ x)[self.contact])

    def compliance(self, forces: Array) -> Array:
        """Displacements of its contact dofs by forces there, (…, contact)."""
        every = np.zeros((*forces.shape[:-1], len(self.unknowns)))
        every[..., self.contact] = forces
        return np.asarray(self.whole.solve(every)[..., self.contact])


class AppliedBulk(CondensedBulk):
    """The bulk by the factors of its connected parts; its Schur complement is not formed.

    Attributes:
        comm: Communicator.
        count: Number of contact dofs.
        schur: None.
        factorisations: 1 if any part was factorised, else 0.
        diagonal: Stiffness of the body at each contact dof, others held; on rank 0.
        column_sums: Σ |K| over the rows, of each contact dof, likewise.

    Args:
        stiffness: K by ranks.
        held: Which of this rank's unknowns supports hold.
        contact: Numbers of the contact dofs over all ranks, sorted, none held.
        known: Factors of a body before, which serve where a part is the same.

    Raises:
        MachineError: MUMPS had not the memory; on every rank.
    """

    def __init__(
        self,
        stiffness: LocalStiffness,
        held: Flags,
        contact: Integers,
        known: KnownFactors | None = None,
    ) -> None:
        self.comm, self.count, self.schur = stiffness.comm, len(contact), None
        self._is_own = known is None
        self._known = applied_factors() if known is None else known
        before = self._known.made
        self._held = held
        numbers = of_every_rank(self.comm, stiffness.numbers)
        union = np.unique(np.concatenate(numbers))
        self._places = [np.searchsorted(union, one) for one in numbers]
        self._size = len(union)
        self._contact = np.searchsorted(union, contact)
        whole = _on_root(stiffness, held, self._places, self._size)
        self._parts = [] if whole is None else self._factorised(*whole)
        errors = [
            factor.error
            for part in self._parts
            for factor in (part.inside, part.whole)
            if factor.error is not None
        ]
        raise_together(self.comm, errors[0] if errors else None)
        self.factorisations = int(from_root(self.comm, self._known.made > before))

    def _factorised(
        self, matrix: csr_matrix, held: Flags, places: Array, kinds: Integers
    ) -> list[_Part]:
        parts = unknowns_of_parts(matrix, lambda: (places, kinds))
        matrix = without(matrix, held)
        self.diagonal = matrix.diagonal()[self._contact]
        self.column_sums = np.asarray(abs(matrix).sum(axis=0)).ravel()[self._contact]
        of_contact = np.full(self._size, -1)
        of_contact[self._contact] = np.arange(self.count)
        none, found = np.zeros(0, dtype=np.int64), []
        wanted: list[tuple[csr_matrix, Integers]] = []
        for unknowns in parts:
            piece = csr_matrix(matrix[unknowns][:, unknowns])
            piece.sort_indices()
            at = of_contact[unknowns] >= 0
            own = np.flatnonzero(at)
            motions = _free_motions(piece, held[unknowns], places[unknowns], kinds[unknowns])[own]
            springs = np.zeros(len(unknowns))
            fixed = own[sprung(motions)]
            springs[fixed] = piece.diagonal()[fixed]
            braced = csr_matrix(piece + diags(springs))
            braced.sort_indices()
            wanted += [(without(piece, at), none), (braced, none)]
            found.append((unknowns, piece, own, of_contact[unknowns[own]], motions))
        factors = self._known.of(wanted, is_plane=False)
        pairs = zip(found, factors[::2], factors[1::2], strict=True)
        return [_Part(*one, inside, whole) for one, inside, whole in pairs]

    @property
    def motions(self) -> Array:
        """Rigid motions of parts that no support resists, (contact, motions); on rank 0."""
        found = []
        for part in self._parts:
            columns = np.zeros((self.count, part.motions.shape[1]))
            columns[part.places] = part.motions
            found.append(columns)
        return np.hstack([np.zeros((self.count, 0)), *found])

    def times(self, x: Array) -> Array:
        """S x of displacements of the contact dofs, on rank 0."""
        found = np.zeros(self.count)
        for part in self._parts:
            if x[part.places].any():
                found[part.places] = part.times(x[part.places])
        return found

    def held_times(self, x: Array) -> Array:
        """Forces on the contact dofs where these alone move, on rank 0."""
        found = np.zeros(self.count)
        for part in self._parts:
            found[part.places] = part.held_times(x[part.places])
        return found

    def compliance(self, forces: Array) -> Array:
        """Displacements of the contact dofs by forces there, (…, contact), on rank 0.

        Those of a part that could move are up to such motions, if its forces are in balance.
        """
        found = np.zeros_like(forces)
        for part in self._parts:
            own = forces[..., part.places]
            if own.any():
                found[..., part.places] = part.compliance(own)
        return found

    def condense(self, load: Array) -> Array:
        """f_C − K_CI K_II⁻¹ f_I, on rank 0; see ``CondensedBulk``; collective."""
        total = self._summed(load)
        found = np.zeros((*load.shape[:-1], self.count))
        for part in self._parts:
            own = total[..., part.unknowns]
            inside = own.copy()
            inside[..., part.contact] = 0.0
            solved = part.inside.solve(inside)
            left = own - (part.matrix @ solved.T).T
            found[..., part.places] = left[..., part.contact]
        return found

    def expand(self, load: Array, x: Array) -> Array:
        """This rank's unknowns where the contact dofs are x; see ``CondensedBulk``; collective."""
        total = self._summed(load)
        values = np.zeros((*load.shape[:-1], self._size))
        for part in self._parts:
            kept = np.zeros((*load.shape[:-1], len(part.unknowns)))
            kept[..., part.contact] = x[..., part.places]
            right = total[..., part.unknowns] - (part.matrix @ kept.T).T
            right[..., part.contact] = 0.0
            values[..., part.unknowns] = part.inside.solve(right) + kept
        return np.asarray(from_root(self.comm, values)[..., self._places[self.comm.rank]])

    def _summed(self, load: Array) -> Array:
        """Loads of all ranks together, on rank 0; values where held; collective."""
        if self.comm.size == 1:
            return load
        parts = gathered_on_root(self.comm, load)
        heldness = gathered_on_root(self.comm, self._held)
        found = np.zeros((*load.shape[:-1], self._size))
        for places, part, held in zip(self._places, parts or (), heldness or (), strict=False):
            found[..., places[~held]] += part[..., ~held]
            found[..., places[held]] = part[..., held]
        return found

    def forget_schur(self) -> None:
        """There is none."""

    def between(self, variables: ContactVariables) -> AppliedSchur | None:
        """S between unknowns that are jumps where bodies touch; on rank 0, None on others."""
        return AppliedSchur(self, variables) if self.comm.rank == 0 else None

    def destroy(self) -> None:
        """Free PETSc's objects."""
        if self._is_own:
            self._known.destroy()


class AppliedSchur(OfSchur):
    """Tᵀ S T of the unknowns, applied; ``matrix`` has no entries.

    Attributes:
        motions: Rigid motions of parts that no support resists, (unknowns, motions).

    Args:
        bulk: S.
        variables: T.
    """

    def __init__(self, bulk: AppliedBulk, variables: ContactVariables) -> None:
        super().__init__(np.zeros((0, 0)))
        self._bulk, self._variables = bulk, variables
        motions = [variables.unknowns(one) for one in bulk.motions.T]
        self.motions = np.array(motions).reshape(len(motions), variables.count).T

    @property
    def diagonal(self) -> Array:
        """Stiffness of the body at each of the displacements."""
        return np.asarray(self._bulk.diagonal)

    @property
    def stiffest(self) -> float:
        """Largest of these; 1 where supports hold all contact dofs."""
        return float(self.diagonal.max(initial=0.0)) or 1.0

    @cached_property
    def column_sums(self) -> Array:
        """Those of K, over the unknowns."""
        return np.abs(self._variables.forces(self._bulk.column_sums))

    def held_times(self, values: Array) -> Array:
        """Product of unknowns with the stiffness of bodies of which nothing else moves."""
        forces = self._bulk.held_times(self._variables.displacements(values))
        return self._variables.forces(forces)

    def times(self, values: Array) -> Array:
        """Product with unknowns."""
        forces = self._bulk.times(self._variables.displacements(values))
        return self._variables.forces(forces)

    def moved_by(self, forces: Array) -> Array:
        """Product of its inverse with forces, (…, unknowns); see ``AppliedBulk.compliance``."""
        variables = self._variables
        if forces.ndim == 1:
            moved = self._bulk.compliance(variables.nodal_forces(forces))
            return variables.unknowns(moved)
        nodal = np.array([variables.nodal_forces(one) for one in forces])
        moved = self._bulk.compliance(nodal.reshape(forces.shape))
        return np.array([variables.unknowns(one) for one in moved]).reshape(forces.shape)


def applied_factors() -> KnownFactors:
    """Return a collection for the factors of bodies of which S is applied."""
    return KnownFactors(_KIND)


def _on_root(
    stiffness: LocalStiffness, held: Flags, places: Sequence[Integers], size: int
) -> tuple[csr_matrix, Flags, Array, Integers] | None:
    """K of all ranks, what is held, where its unknowns are and their components; on rank 0."""
    positions, kinds = stiffness.places()
    if stiffness.comm.size == 1:
        order = np.argsort(places[0])
        if (np.diff(places[0]) > 0).all():
            return stiffness.matrix, held, positions, kinds
        matrix = csr_matrix(stiffness.matrix[order][:, order])
        return matrix, held[order], positions[order], kinds[order]
    entries = stiffness.matrix.tocoo()
    mine = entries.row, entries.col, entries.data, held, positions, kinds
    every = gathered_on_root(stiffness.comm, mine)
    if every is None:
        return None
    rows = np.concatenate([at[one[0]] for at, one in zip(places, every, strict=True)])
    columns = np.concatenate([at[one[1]] for at, one in zip(places, every, strict=True)])
    values = np.concatenate([one[2] for one in every])
    matrix = csr_matrix((values, (rows, columns)), shape=(size, size))
    is_held, where = np.zeros(size, dtype=bool), np.zeros((size, positions.shape[1]))
    which = np.zeros(size, dtype=np.int64)
    for at, one in zip(places, every, strict=True):
        is_held[at] |= one[3]
        where[at], which[at] = one[4], one[5]
    return matrix, is_held, where, which


def _free_motions(matrix: csr_matrix, held: Flags, places: Array, kinds: Integers) -> Array:
    """Rigid motions in space that neither supports nor foundations resist, (unknowns, motions)."""
    arms = places - places.mean(axis=0)
    arms = arms / (np.abs(arms).max() or 1.0)
    found = np.zeros((len(kinds), 6))
    found[np.arange(len(kinds)), kinds] = 1.0
    for axis in range(3):  # e_axis × arm
        turned = np.cross(np.eye(3)[axis], arms)
        found[:, 3 + axis] = turned[np.arange(len(kinds)), kinds]
    energy = found.T @ (matrix @ found)  # what is held has 1 on the diagonal
    stiff = found[held].T @ found[held] * matrix.diagonal().max()
    scale = np.einsum("ij,i,ij->j", found, matrix.diagonal(), found)
    size = np.sqrt(np.outer(scale, scale))
    values, vectors = np.linalg.eigh((energy + stiff) / size)
    loose = vectors[:, values < _LOOSE] / np.sqrt(scale)[:, None]
    return np.asarray(found @ loose)
