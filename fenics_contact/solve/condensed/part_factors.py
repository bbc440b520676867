"""The factors of a rank's cells, one for each connected part, with their Schur complements.

What no cell joins has no common stiffness: so each part has its own factor. Parts that are the
same but for where they stand have one together, and one of a body before serves again where a
change has left its part as it was.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from fenics_contact.common import mumps
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.factors.local_factor import LocalFactor
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness

# Nodes of equal parts are at the same places but for this share of a part's size.
_SAME_PLACE = 1e-7


class KnownFactors:
    """The factors of this rank's parts, kept from one body to the next.

    Attributes:
        made: How many were made so far.
    """

    def __init__(self) -> None:
        self.made = 0
        self._all: list[LocalFactor] = []

    def of(self, wanted: list[tuple[csr_matrix, Integers]], is_plane: bool) -> list[LocalFactor]:
        """The factors of some parts; those that are of none of them are freed first.

        Args:
            wanted: Of each part its stiffness, with identity rows for what is held, and the
                unknowns to condense onto.
            is_plane: Whether the body has two dimensions.
        """
        found = [self._known(*one) for one in wanted]
        self._keep([one for one in found if one is not None])
        for number, (matrix, kept) in enumerate(wanted):
            if found[number] is None:
                found[number] = self._known(matrix, kept) or self._make(matrix, kept, is_plane)
        return [one for one in found if one is not None]

    def _known(self, matrix: csr_matrix, kept: Integers) -> LocalFactor | None:
        return next((one for one in self._all if one.serves(matrix, kept)), None)

    def _make(self, matrix: csr_matrix, kept: Integers, is_plane: bool) -> LocalFactor:
        found = LocalFactor(matrix, kept, mumps.fastest(is_plane, matrix.shape[0]))
        self.made += 1
        if found.error is None:
            self._all.append(found)
        return found

    def _keep(self, used: list[LocalFactor]) -> None:
        """Free the others."""
        for one in self._all:
            if not any(one is other for other in used):
                one.destroy()
        self._all = [one for one in self._all if any(one is other for other in used)]

    def destroy(self) -> None:
        """Free PETSc's objects."""
        self._keep([])


class RankFactor:
    """The inside of this rank's cells, and what is left of it at the unknowns that are kept.

    Args:
        stiffness: K by ranks.
        held: Unknowns that do not follow forces: identity rows take their place.
        kept: Unknowns to condense onto, sorted.
        known: Factors of a body before; what is kept there outlives this one.

    Attributes:
        error: What went wrong on this rank, or None.
        is_new: Whether any part was factorised.
    """

    def __init__(
        self, stiffness: LocalStiffness, held: Flags, kept: Integers, known: KnownFactors | None
    ) -> None:
        self._is_own = known is None  # then its factors end with it
        self._known = KnownFactors() if known is None else known
        before = self._known.made
        matrix = with_unit_rows(stiffness.matrix, held)
        self._parts = _unknowns_of_parts(stiffness)
        self._at = at = np.zeros(len(held), dtype=bool)
        at[kept] = True
        pieces = [matrix] if len(self._parts) == 1 else [_piece(matrix, p) for p in self._parts]
        wanted = [(m, np.flatnonzero(at[p])) for m, p in zip(pieces, self._parts, strict=True)]
        self._matrices = pieces
        self._factors = self._known.of(wanted, stiffness.is_plane)
        self._kept = [np.searchsorted(kept, p[at[p]]) for p in self._parts]
        self._count = len(kept)
        errors = [one.error for one in self._factors if one.error is not None]
        self.error: FenicsContactError | None = errors[0] if errors else None
        self.is_new = self._known.made > before

    def schur(self) -> Array:
        """The Schur complement, dense (kept, kept), which is large."""
        if len(self._parts) == 1:
            return self._factors[0].schur
        found = np.zeros((self._count, self._count))
        for places, factor in zip(self._kept, self._factors, strict=True):
            found[np.ix_(places, places)] = factor.schur
        return found

    @property
    def negative_pivots(self) -> int | None:
        """Number of negative eigenvalues inside of this rank's cells; None where not known."""
        found = [factor.negative_pivots for factor in self._factors]
        known = [count for count in found if count is not None]
        return sum(known) if len(known) == len(found) else None

    def forget_schur(self) -> None:
        """Keep it no longer, unless the factors are for other bodies, too."""
        if self._is_own:
            for factor in self._factors:
                factor.forget_schur()

    def times(self, values: Array) -> Array:
        """K x, without what is held, of one x or several, (…, unknowns)."""
        found = np.zeros_like(values)
        for part, matrix in zip(self._parts, self._matrices, strict=True):
            found[..., part] = (matrix @ values[..., part].T).T
        return found

    def times_at_kept(self, values: Array) -> Array:
        """K x at what is kept alone; as ``times``, which has it at all unknowns."""
        found = np.zeros((*values.shape[:-1], self._count))
        for places, part, rows in zip(self._kept, self._parts, self._rows_of_kept, strict=True):
            found[..., places] = (rows @ values[..., part].T).T
        return found

    @cached_property
    def _rows_of_kept(self) -> list[csr_matrix]:
        """Rows of the kept unknowns, a matrix for each part."""
        return [
            m[np.flatnonzero(self._at[p])] for m, p in zip(self._matrices, self._parts, strict=True)
        ]

    def solve(self, right: Array) -> Array:
        """K_II⁻¹ f_I at all unknowns, 0 at those that are kept; of several f, (…, unknowns)."""
        found = np.zeros_like(right)
        for part, factor in zip(self._parts, self._factors, strict=True):
            own = right[..., part]
            acting = own.any(axis=-1)  # most loads act on a part or two
            if acting.all():
                found[..., part] = factor.solve(own)
            elif acting.any():
                found[np.ix_(acting, part)] = factor.solve(own[acting])
        return found

    def destroy(self) -> None:
        """Free PETSc's objects, but those of factors that others may use."""
        if self._is_own:
            self._known.destroy()


def _unknowns_of_parts(stiffness: LocalStiffness) -> list[Integers]:
    """The unknowns of each connected part of this rank's cells.

    Of several parts in an order that does not depend on where a part stands, so that equal ones
    have equal matrices.
    """
    count, part = connected_components(stiffness.matrix, directed=False)
    if count <= 1:
        return [np.arange(len(part))]
    places, kinds = stiffness.places()
    found = []
    for number in range(count):
        unknowns = np.flatnonzero(part == number)
        own = places[unknowns] - places[unknowns].min(axis=0)
        size = max(float(own.max()), np.finfo(float).tiny)
        rounded = np.round(own / (_SAME_PLACE * size) + 0.377)  # no edge falls on a half
        found.append(unknowns[np.lexsort((kinds[unknowns], *rounded.T))])
    return found


def _piece(matrix: csr_matrix, unknowns: Integers) -> csr_matrix:
    found = csr_matrix(matrix[unknowns][:, unknowns])
    found.sort_indices()
    return found


def with_unit_rows(matrix: csr_matrix, held: Flags) -> csr_matrix:
    """A sparse matrix with identity rows and columns where displacements are held."""
    found = csr_matrix((matrix.data.copy(), matrix.indices, matrix.indptr), shape=matrix.shape)
    found.data[held[found.indices]] = 0.0
    for row in np.flatnonzero(held):
        entries = slice(found.indptr[row], found.indptr[row + 1])
        found.data[entries] = found.indices[entries] == row
    return found
