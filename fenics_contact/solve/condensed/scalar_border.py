"""The border of the condensed problem: a row and a column for each scalar of the body's energy.

Such a scalar q, as the shortening of a preloaded part, puts forces into the bulk, which are
condensed once, as those of a load. Its row is the force ∂W/∂q that does work on it, N = Cᵀ y + D q
+ N₀, with N₀ by loads and supports alone. Both are second derivatives of the energy, so row and
column are the same; D is what the bulk leaves of ∂²W/∂q² when the contact dofs are held.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc
from scipy.linalg import lapack

from fenics_contact.body.preloaded_part import ScalarColumns
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import total
from fenics_contact.solve.condensed.elimination import KeptUnknowns
from fenics_contact.solve.condensed.schur import CondensedBulk
from fenics_contact.solve.condensed.split_solver import SplitSolver
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness


class CondensedScalars:
    """Rows, columns and corner of scalars of the body's energy, condensed; collective.

    Attributes:
        loads: This rank's share of the forces of a unit of each on its unknowns (force/length).
        nodal: Forces of a unit of each on the displacements, (nodes, components) each.
        condensed: These forces condensed onto the contact dofs, on rank 0 (force/length).
        at_contacts: How they move the contact dofs meanwhile, as ``CondensedBulk.moved`` gives it.
        corner: D, (scalars, scalars) (force/length).

    Args:
        columns: What a unit of each scalar does to the body.
        stiffness: Of this rank's cells.
        bulk: Condensed.
        held: Which of this rank's unknowns supports hold.
    """

    def __init__(
        self,
        columns: ScalarColumns,
        stiffness: LocalStiffness,
        bulk: CondensedBulk,
        held: Flags,
    ) -> None:
        self._comm, self._held = bulk.comm, held
        self.nodal = columns.nodal
        shape = (len(self.nodal), len(held))
        pairs = zip(self.nodal, columns.on_mean_stress, strict=True)
        shares = [stiffness.share(nodal, stresses) for nodal, stresses in pairs]
        self._forces = np.array(shares).reshape(shape)
        self.loads = np.where(held, 0.0, -self._forces)
        condensed, self._moved = np.zeros((0, bulk.count)), np.zeros(shape)
        moved = None
        if len(self.nodal):
            condensed, self._moved = bulk.condense_and_expand(self.loads)
            moved = bulk.moved(self.loads)
        self.condensed = list(condensed)
        self.at_contacts = [None] * len(condensed) if moved is None else list(moved)
        self.corner = np.asarray(total(self._comm, self._forces @ self._moved.T))
        self.corner = self.corner + columns.corner

    def border(self, kept: KeptUnknowns, size: int) -> ScalarBorder:
        """Rows and columns of the scalars, on rank 0.

        Args:
            kept: What stands for the contact dofs, first among the unknowns.
            size: Number of unknowns beside these scalars.
        """
        columns = np.zeros((size, len(self.condensed)))
        columns[: kept.count] = kept.columns
        return ScalarBorder(columns, self.corner - kept.corner, self.units)

    @property
    def units(self) -> Array:
        """Entries of the rows of scalars that are held, on the diagonal (force/length)."""
        diagonal = self.corner.diagonal()
        found = np.where(diagonal == 0, np.abs(self.corner).max(axis=1, initial=0.0), diagonal)
        return np.where(found == 0, 1.0, found)  # of a scalar that does nothing at present

    def from_loads(self, load: Array, supported: Array) -> Array:
        """N₀, (scalars,) (force); collective.

        Args:
            load: This rank's share of the loads, with what displacements of supports add.
            supported: These displacements at this rank's unknowns, 0 elsewhere (length).
        """
        if len(self.loads) == 0:
            return np.zeros(0)
        by_loads = self._moved @ np.where(self._held, 0.0, load)
        shares = self._forces @ np.where(self._held, supported, 0.0)
        return np.asarray(total(self._comm, shares - by_loads))


class ScalarBorder:
    """[[M, C], [Cᵀ, D]] by M⁻¹, with unit rows for scalars that are held.

    M is the tangent of the condensed bulk and the contacts with all these scalars held. So it can
    be solved wherever the whole can.

    Attributes:
        columns: C.
        corner: D, without what ``stiffen`` adds.
        held: Which scalars are held.

    Args:
        columns: C, (unknowns of M, scalars).
        corner: D.
        units: Entries of the rows of scalars that are held, on the diagonal.
    """

    def __init__(self, columns: Array, corner: Array, units: Array) -> None:
        self.columns, self.corner, self._units = columns, corner, units
        self._added = np.zeros_like(corner)
        self._solved: Array | None = None
        self.held = np.zeros(len(corner), dtype=bool)

    @classmethod
    def empty(cls, size: int) -> ScalarBorder:
        """A border of no scalars, around a matrix of a size."""
        return cls(np.zeros((size, 0)), np.zeros((0, 0)), np.zeros(0))

    @property
    def count(self) -> int:
        """Number of scalars."""
        return len(self.corner)

    @property
    def stiffest(self) -> Array:
        """Stiffness of a spring for each scalar, about that of what it moves (force/length)."""
        return np.abs(self._units)

    def forget(self) -> None:
        """M has changed."""
        self._solved = None

    def hold(self, held: Flags) -> None:
        """Say which scalars are held, (scalars,)."""
        self.held = held

    def stiffen(self, added: Array) -> None:
        """Say what D has besides in the tangent, (scalars, scalars): it changes with the answer."""
        self._added = added

    def times_added(self, scalars: Array) -> Array:
        """Forces on the scalars by the stiffness that ``stiffen`` adds, (scalars,)."""
        return np.asarray(self._added @ scalars)

    def times(self, inner: Array, scalars: Array) -> tuple[Array, Array]:
        """C q, and Cᵀ y + D q, without what is added to D.

        Args:
            inner: y.
            scalars: q.
        """
        own = self.columns.T @ inner + self.corner @ scalars
        return self.columns @ scalars, own

    def magnitude(self, inner: Array, scalars: Array) -> float:
        """Sum over all rows of ``times`` with the absolute values of all entries."""
        columns, corner = np.abs(self.columns), np.abs(self.corner)
        return float((columns @ scalars).sum() + (columns.T @ inner + corner @ scalars).sum())

    def solve(self, right: Array, solve_inner: Callable[[Array], Array]) -> Array:
        """Solve with the whole matrix; not a number where it is singular.

        Args:
            right: Of all unknowns.
            solve_inner: M⁻¹.
        """
        if self.count == 0:
            return solve_inner(right)
        if self._solved is None:
            self._solved = np.column_stack([solve_inner(column) for column in self.columns.T])
        rows, corner = self._own_rows
        return _eliminated(right, solve_inner, self._solved, rows, corner)

    def around(self, split: SplitSolver) -> BorderedSplit:
        """The whole matrix, as GMRES needs it, where M is solved in stiff and soft parts."""
        return BorderedSplit(split, self.columns, *self._own_rows)

    def solve_transposed(self, right: Array, solve_inner: Callable[[Array], Array]) -> Array:
        """Solve with the transpose of the whole, by M⁻ᵀ; the arguments are those of ``solve``."""
        if self.count == 0:
            return solve_inner(right)
        rows, corner = self._own_rows
        solved = np.column_stack([solve_inner(row) for row in rows])
        return _eliminated(right, solve_inner, solved, self.columns.T, corner.T)

    def multipliers_of_held(self, right: Array, values: Array) -> Array:
        """Values of the scalars that are held in a transposed solve; (held,).

        Args:
            right: Its right-hand side for the scalars, (scalars,).
            values: What is found for all that is not held, M's unknowns first; 0 for the held.
        """
        inner, own = np.split(values, [len(self.columns)])
        pulled = self.columns.T @ inner + self.corner.T @ own
        return np.asarray(((right - pulled) / self._units)[self.held])

    @property
    def _own_rows(self) -> tuple[Array, Array]:
        """Cᵀ and D with unit rows for scalars that are held."""
        held, units = self.held[:, None], np.diag(self._units)
        return np.where(held, 0.0, self.columns.T), np.where(held, units, self.corner + self._added)


class BorderedSplit:
    """[[M, B], [R, D]] for GMRES, with what is nearly its inverse by what is nearly that of M.

    Args:
        split: Solves nearly with M.
        columns: B.
        rows: R.
        corner: D.
    """

    def __init__(self, split: SplitSolver, columns: Array, rows: Array, corner: Array) -> None:
        self._split, self._columns, self._rows, self._corner = split, columns, rows, corner
        self._size = len(columns)
        self._solved = split.nearly_solved_each(columns)

    def mult(self, matrix: PETSc.Mat, values: PETSc.Vec, result: PETSc.Vec) -> None:
        """Product with the whole, as PETSc asks for it."""
        given = np.array(values.array_r)
        with result as array:
            array[:] = self.with_inner(given, self._split.times(given[: self._size]))

    def with_inner(self, values: Array, inner: Array) -> Array:
        """Product with the whole of a vector, or of several as columns.

        Args:
            values: The vector.
            inner: M times its part.
        """
        own, scalars = values[: self._size], values[self._size :]
        last = self._rows @ own + self._corner @ scalars
        return np.concatenate([inner + self._columns @ scalars, last])

    def apply(self, preconditioner: PETSc.PC, right: PETSc.Vec, solution: PETSc.Vec) -> None:
        """Apply the preconditioner, an approximate inverse of the whole bordered matrix."""
        with solution as array:
            array[:] = self.nearly_solved(np.array(right.array_r))

    def nearly_solved(self, given: Array) -> Array:
        """Nearly the inverse of the whole, times a vector."""
        solve = self._split.nearly_solved
        return _eliminated(given, solve, self._solved, self._rows, self._corner)


def _eliminated(
    right: Array, solve_inner: Callable[[Array], Array], solved: Array, rows: Array, corner: Array
) -> Array:
    """[[M, B], [R, D]]⁻¹ r; not a number where it is singular.

    Args:
        right: r.
        solve_inner: M⁻¹.
        solved: M⁻¹ B.
        rows: R.
        corner: D.
    """
    size = len(right) - len(corner)
    inner = solve_inner(right[:size])
    factor, pivots, singular = lapack.dgetrf(corner - rows @ solved)
    if singular:
        return np.full(len(right), np.nan)
    scalars, _ = lapack.dgetrs(factor, pivots, right[size:] - rows @ inner)
    return np.concatenate([inner - solved @ scalars, scalars])
