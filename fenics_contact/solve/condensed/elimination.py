"""Displacements on which no contact acts, eliminated from the unknowns once.

Where bodies touch, the jump of a slave is the unknown, and the displacements of the master that it
is measured from have no contact of their own: W has no entries there. So they follow from the
jumps, the loads and the scalars of the body, and a Newton step is as large as the jumps alone. With
S between the jumps w and these masters m,

    [[S_ww, S_wm], [S_mw, S_mm]] = [[S', 0], [0, 0]] + [H, Lᵀ]ᵀ [H, Lᵀ],
    S_mm = L Lᵀ,  H = L⁻¹ S_mw,  m = L⁻ᵀ (L⁻¹ f_m − H w),

so S' = S_ww − Hᵀ H, H and L say all of S, and S itself is needed no longer.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from scipy.linalg import blas, lapack

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import from_root
from fenics_contact.solve.condensed.constant_tangent import OfSchur
from fenics_contact.solve.condensed.unknowns import ContactVariables

# Unknowns, and those to eliminate, from which that pays.
_MANY, _ENOUGH = 400, 100
# A pivot of this share of the largest diagonal entry belongs to a rigid motion of glued bodies.
_SINGULAR = 1e-9


def pays(every: int, rest: int) -> bool:
    """Whether to eliminate so many of all unknowns costs less than it spares."""
    return every >= _MANY and rest >= _ENOUGH


class Eliminated(ABC):
    """S of all unknowns, from which those that no contact acts on are eliminated.

    Attributes:
        kept: Numbers of the unknowns w that are left.
        rest: Those of the unknowns m that are eliminated.
        own: S' of the ones that are left.
        diagonal: Stiffness of the body at the ones that are left, for springs.
    """

    kept: Integers
    rest: Integers
    own: OfSchur
    diagonal: Array

    @abstractmethod
    def carried(self, forces: Array) -> Array:
        """Part of forces on all unknowns that recovers the eliminated ones, (eliminated,)."""

    @abstractmethod
    def onto_kept(self, forces: Array, carried: Array) -> Array:
        """Forces on all unknowns, as those that are left take them.

        Args:
            forces: f, (unknowns,).
            carried: As ``carried`` gave it of them.
        """

    @abstractmethod
    def work(self, forces: Array, carried: Array, others: Array) -> Array:
        """f_mᵀ S_mm⁻¹ g_m of forces f, and of several g.

        Args:
            forces: f, (unknowns,).
            carried: Of f.
            others: Of each g, as columns.
        """

    @abstractmethod
    def every(self, kept: Array, carried: Array) -> Array:
        """All unknowns where those that are eliminated are in balance, (unknowns,).

        Args:
            kept: The ones that are left.
            carried: Of the forces on all unknowns, as ``carried`` gave it.
        """


class ReducedSchur(Eliminated):
    """S of all unknowns as S', H and L.

    Args:
        schur: S, which is not changed.
        kept: Which unknowns are left.
        factor: L of the others, lower triangle.
    """

    def __init__(self, schur: OfSchur, kept: Flags, factor: Array) -> None:
        self.kept, self.rest = np.flatnonzero(kept), np.flatnonzero(~kept)
        self.diagonal = schur.diagonal[self.kept]
        self._factor = factor
        half = schur.matrix[np.ix_(self.kept, self.rest)].T  # S is symmetric; LAPACK's order
        self._half = blas.dtrsm(1.0, factor, half, lower=1, overwrite_b=1)
        own = schur.matrix[np.ix_(self.kept, self.kept)].T
        own = blas.dsyrk(-1.0, self._half, beta=1.0, c=own, trans=1, lower=1, overwrite_c=1)
        self.own = OfSchur.of_lower(own)

    @classmethod
    def of(cls, schur: OfSchur, kept: Flags) -> ReducedSchur | OfSchur:
        """S with what no contact acts on eliminated; S itself where that would be no gain.

        Nor is it where glued bodies could move.

        Args:
            schur: S.
            kept: Unknowns on which contacts act.
        """
        if not pays(len(kept), int((~kept).sum())) or kept.all() or not kept.any():
            return schur
        rest = np.flatnonzero(~kept)
        block = schur.matrix[np.ix_(rest, rest)].T
        largest = block.diagonal().max()
        factor, info = lapack.dpotrf(block, lower=1, overwrite_a=1)
        if info or factor.diagonal().min() ** 2 <= _SINGULAR * largest:
            return schur
        return cls(schur, kept, factor)

    def times(self, values: Array) -> Array:
        """Product S y."""
        kept, rest = values[self.kept], values[self.rest]
        carried = self._half @ kept + blas.dtrmv(self._factor, rest, lower=1, trans=1)
        found = np.empty_like(values)
        found[self.kept] = self.own.times(kept) + carried @ self._half
        found[self.rest] = blas.dtrmv(self._factor, carried, lower=1)
        return found

    def written(self) -> Array:
        """S, written out."""
        found = np.empty((len(self.kept) + len(self.rest),) * 2)
        lower, half = np.tril(self._factor), self._half
        found[np.ix_(self.kept, self.kept)] = self.own.matrix + half.T @ half
        found[np.ix_(self.rest, self.rest)] = lower @ lower.T
        found[np.ix_(self.rest, self.kept)] = across = lower @ half
        found[np.ix_(self.kept, self.rest)] = across.T
        return found

    def carried(self, forces: Array) -> Array:
        """L⁻¹ f_m of forces on all unknowns, (eliminated,)."""
        return np.asarray(blas.dtrsv(self._factor, forces[self.rest], lower=1))

    def onto_kept(self, forces: Array, carried: Array) -> Array:
        """f_w − Hᵀ L⁻¹ f_m; as of any elimination."""
        return np.asarray(forces[self.kept] - carried @ self._half)

    def work(self, forces: Array, carried: Array, others: Array) -> Array:
        """(L⁻¹ f_m)ᵀ L⁻¹ g_m; as of any elimination."""
        return np.asarray(carried @ others)

    def every(self, kept: Array, carried: Array) -> Array:
        """w, and L⁻ᵀ (L⁻¹ f_m − H w); as of any elimination."""
        found = np.empty(len(self.kept) + len(self.rest))
        found[self.kept] = kept
        left = carried - self._half @ kept
        found[self.rest] = blas.dtrsv(self._factor, left, lower=1, trans=1)
        return found


def stiffness_of(
    schur: Array, variables: ContactVariables, acted_on: Flags
) -> OfSchur | ReducedSchur:
    """S between unknowns, without those that no contact acts on where that pays.

    Args:
        schur: S between displacements, which is overwritten.
        variables: The unknowns.
        acted_on: On which of them contacts act.
    """
    return ReducedSchur.of(OfSchur(variables.stiffness(schur)), acted_on)


@dataclass(frozen=True, eq=False)
class KeptLoad:
    """Forces on the free contact dofs, as the unknowns take them; on rank 0, else of no meaning.

    Attributes:
        own: On the unknowns that are left (force).
        carried: On the ones that are eliminated, L⁻¹ f.
        on_scalars: What they do to the balance of each of the body's scalars (force).
    """

    own: Array
    carried: Array
    on_scalars: Array


class KeptUnknowns:
    """The unknowns of the tangent, and how the displacements of contact dofs follow from them.

    Attributes:
        variables: All unknowns that stand for the free contact dofs.
        numbers: Which of them are left, on every rank.
        count: How many these are.
        columns: What a unit of each of the body's scalars does to these, on rank 0.
        corner: What it takes off the stiffness between these scalars, likewise.

    Args:
        comm: Communicator.
        variables: See the attributes.
        schur: S between them, on rank 0.
        scalar_forces: What a unit of each of the body's scalars does to the free contact dofs, on
            rank 0 (force/length).
        scalars_move: How it moves them, as of ``load``.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        variables: ContactVariables,
        schur: OfSchur | Eliminated | None,
        scalar_forces: list[Array],
        scalars_move: Sequence[Array | None],
    ) -> None:
        self._comm, self.variables = comm, variables
        self._reduced = schur if isinstance(schur, Eliminated) else None
        own = None if self._reduced is None else self._reduced.kept
        own = from_root(comm, own)
        self.numbers: Integers = np.arange(variables.count) if own is None else own
        self.count = len(self.numbers)
        self._is_reduced = own is not None
        self.take_scalars(scalar_forces, scalars_move)

    def take_scalars(
        self, scalar_forces: list[Array], scalars_move: Sequence[Array | None]
    ) -> None:
        """Work out what the body's scalars do to the unknowns.

        Args:
            scalar_forces: What a unit of each does to the free contact dofs, on rank 0.
            scalars_move: How it moves them there, as of ``load``.
        """
        eliminated = 0 if self._reduced is None else len(self._reduced.rest)
        self._of_scalars = np.zeros((eliminated, len(scalar_forces)))  # carried of −C
        pairs = list(zip(scalar_forces, scalars_move, strict=True))
        loads = [self.load(*pair) for pair in pairs]
        self.columns = -np.array([one.own for one in loads]).reshape(len(loads), self.count).T
        for number, one in enumerate(loads):
            self._of_scalars[:, number] = -one.carried
        work = [-self.load(*pair).on_scalars for pair in pairs]
        self.corner = np.array(work).reshape(len(loads), len(loads))

    def load(self, forces: Array, moved: Array | None = None) -> KeptLoad:
        """Forces on the free contact dofs, on rank 0, as the unknowns take them (force).

        Args:
            forces: What is condensed onto them.
            moved: How it moves those that are eliminated, where it is condensed onto the others
                alone; None where nothing moves (length).
        """
        every, carried = self.variables.forces(forces), np.zeros(0)
        own, on_scalars = every[self.numbers], np.zeros(self._of_scalars.shape[1])
        if self._reduced is not None:
            if moved is not None:
                every[self._reduced.rest] = 0.0
                carried = moved[self._reduced.rest]
            else:
                carried = self._reduced.carried(every)
                own = self._reduced.onto_kept(every, carried)
            on_scalars = self._reduced.work(every, carried, self._of_scalars)
        return KeptLoad(own, carried, on_scalars)

    def unknowns(self, displacements: Array) -> Array:
        """The unknowns of displacements of the free contact dofs (length)."""
        return np.asarray(self.variables.unknowns(displacements)[self.numbers])

    def displacements(self, values: Array, scalars: Array, carried: Array) -> Array:
        """Displacements of the free contact dofs, on every rank; collective (length).

        Args:
            values: The unknowns.
            scalars: Those of the body.
            carried: Of the loads, as ``load`` gave it.
        """
        every = values
        if self._is_reduced:
            found = None
            if self._reduced is not None:
                found = self._reduced.every(values, carried - self._of_scalars @ scalars)
            every = np.asarray(from_root(self._comm, found))
        return self.variables.displacements(every)

    def derived_jumps(self, values: Array) -> Array:
        """The jumps that are no unknowns, which follow from those that are left (length)."""
        every = np.zeros(self.variables.count)
        every[self.numbers] = values
        return self.variables.derived_jumps(every)
