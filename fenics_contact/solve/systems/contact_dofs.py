"""The displacement dofs of all contact surfaces, in one order that every rank knows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.solve.systems.near_nodes import NearNodes


class ContactDofs:
    """Dofs that contacts act on, sorted by their numbers over all ranks (so by ranks, too).

    Attributes:
        numbers: Of all of them.
        is_free: Which of them are unknowns: no support holds them, and they follow from no others.
        free: Numbers of these, the unknowns.
        follow: Those that follow from others across the cut of a sector, or None.
        constrained: Which of all displacement dofs of this rank are held, owned and ghost.

    Args:
        spaces: The body's.
        constrained: Dofs that supports hold (local indices, owned and ghost).
        sides: The surfaces at which contacts may act.
        near: The nodes of each that take part, None for all; by default all of all.
        cut: The cut faces of a sector: of displacements that follow those of the other face it has
            these, too.
    """

    def __init__(
        self,
        spaces: Spaces,
        constrained: Integers,
        sides: Sequence[ContactSides],
        near: Sequence[NearNodes | None] | None = None,
        cut: CutFaces | None = None,
    ) -> None:
        self._comm = spaces.comm
        components = spaces.components
        index_map = spaces.displacement_space.dofmap.index_map
        first, last = (number * components for number in index_map.local_range)
        none = np.zeros(0, dtype=np.int64)
        near = [None] * len(sides) if near is None else near
        self._near = [(s, n) for s, n in zip(sides, near, strict=True) if n is not None]
        touched = [dofs_of(side, which) for side, which in zip(sides, near, strict=True)]
        if self._near and not any(len(dofs) for dofs in touched):
            touched = [sides[0].trace.surface.dofs[:1]]  # ``places`` are to be some
        self.numbers = np.unique(np.concatenate([none, *touched]))
        followed = None if cut is None else np.isin(cut.slaves.numbers, self.numbers)
        if cut is not None:
            masters = cut.masters.numbers[np.unique(cut.matrix[followed].indices)]
            self.numbers = np.union1d(self.numbers, masters)
        self._mine = self.numbers[(self.numbers >= first) & (self.numbers < last)] - first
        self.constrained = np.zeros(len(spaces.coordinates) * components, dtype=bool)
        self.constrained[constrained] = True
        self.is_free = ~self.gathered(self.constrained.astype(float)).astype(bool)
        self.follow: _Following | None = None
        if cut is not None and followed is not None and followed.any():
            self.follow = _Following(cut, followed, self.numbers)
            self.is_free[self.follow.rows] = False
        self.free = self.numbers[self.is_free]
        nodes = np.arange(len(spaces.coordinates), dtype=np.int32)
        every = index_map.local_to_global(nodes).astype(np.int64)
        own = (every[:, None] * components + np.arange(components)).ravel()
        self._here = np.flatnonzero(np.isin(own, self.free))
        self._of_free = np.searchsorted(self.free, own[self._here])

    def followed(self, values: Array) -> Array:
        """Values at all contact dofs, with those that follow across a cut; in place."""
        if self.follow is not None:
            values[self.follow.rows] = self.follow.matrix @ values
        return values

    def expansion(self) -> csr_matrix:
        """All contact dofs over the free ones, without what is held, (contact dofs, free)."""
        count = len(self.numbers)
        own = np.flatnonzero(self.is_free)
        every = csr_matrix(coo_matrix((np.ones(len(own)), (own, own)), shape=(count, count)))
        if self.follow is not None:
            rows = self.follow.rows
            places = rows, np.arange(len(rows))
            lifted = coo_matrix((np.ones(len(rows)), places), shape=(count, len(rows)))
            every = csr_matrix(every + lifted @ self.follow.matrix)
        return csr_matrix(every[:, own])

    def placed(self, values: Array, less: Array | None = None) -> Array:
        """Values at the free contact dofs, at all displacement dofs of this rank, 0 elsewhere.

        Args:
            values: At the free contact dofs.
            less: What is taken off there, at all displacement dofs.
        """
        found = np.zeros(len(self.constrained))
        found[self._here] = values[self._of_free]
        if less is not None:
            found[self._here] -= less[self._here]
        return found

    def gathered(self, values: Array) -> Array:
        """Values at this rank's displacement dofs, at all contact dofs; collective."""
        return gather_rows(self._comm, values[self._mine])

    def places(self, dofs: Integers) -> Integers:
        """Where dofs of surfaces, by the body's global numbers, are among these.

        Of those that are not among them it is that of another one.
        """
        return np.minimum(np.searchsorted(self.numbers, dofs), max(len(self.numbers) - 1, 0))

    @property
    def leaves_out(self) -> bool:
        """Whether some nodes of contact surfaces take no part."""
        return bool(self._near)

    def near(self, sides: ContactSides) -> NearNodes | None:
        """The nodes of two surfaces that take part, None where all of them do."""
        return next((near for one, near in self._near if one is sides), None)


class _Following:
    """Contact dofs that follow from others across the cut of a sector.

    Attributes:
        rows: Places of those that follow among the contact dofs.
        matrix: What they follow by, (rows, contact dofs).

    Args:
        cut: The cut faces.
        followed: Which of the dofs that follow are contact dofs.
        numbers: Of the contact dofs.
    """

    def __init__(self, cut: CutFaces, followed: Flags, numbers: Integers) -> None:
        self.rows = np.searchsorted(numbers, cut.slaves.numbers[followed])
        entries = cut.matrix[followed].tocoo()
        columns = np.searchsorted(numbers, cut.masters.numbers[entries.col])
        places = entries.row, columns
        shape = (len(self.rows), len(numbers))
        self.matrix = csr_matrix(coo_matrix((entries.data, places), shape=shape))


def dofs_of(sides: ContactSides, near: NearNodes | None) -> Integers:
    """The body's numbers of the contact dofs of one contact, on all ranks; collective.

    Args:
        sides: Its surfaces.
        near: The nodes that take part, None for all.
    """
    slaves, size = slaves_of(sides, near), sides.trace.surface.components
    if sides.opposite is None:
        return slaves
    masters = sides.opposite.surface.dofs
    if near is not None:
        masters = masters[np.repeat(near.masters, size)]
    return np.concatenate([slaves, masters])


def slaves_of(sides: ContactSides, near: NearNodes | None) -> Integers:
    """The body's numbers of the contact dofs of one contact's slave, on all ranks; collective.

    Args:
        sides: The contact's surfaces.
        near: The nodes that take part, None for all.
    """
    surface = sides.trace.surface
    if near is None:
        return surface.dofs
    return surface.dofs[np.repeat(near.slaves, surface.components)]
