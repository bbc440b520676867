"""The displacement dofs of all contact surfaces, in one order that every rank knows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fenics_contact.problem import Problem
from fenics_contact.surface_matrix import SurfaceMatrix

Array = NDArray[np.float64]


class ContactDofs:
    """Dofs that contacts act on, sorted by their numbers over all ranks (so by ranks, too).

    Attributes:
        numbers: Of all of them.
        is_free: Which of them no support holds.
        free: Numbers of these, the unknowns.
        constrained: Which of all displacement dofs of this rank are held, owned and ghost.

    Args:
        problem: The problem.
        surfaces: Those of the contacts that exert forces.
    """

    def __init__(self, problem: Problem, surfaces: Sequence[SurfaceMatrix]) -> None:
        self._comm = problem.comm
        components = problem.spaces.components
        index_map = problem.spaces.displacement_space.dofmap.index_map
        first, last = (number * components for number in index_map.local_range)
        none = np.zeros(0, dtype=np.int64)
        self.numbers = np.unique(np.concatenate([none, *(surface.dofs for surface in surfaces)]))
        self._mine = self.numbers[(self.numbers >= first) & (self.numbers < last)] - first
        self.constrained = np.zeros(len(problem.spaces.coordinates) * components, dtype=bool)
        self.constrained[problem.constrained] = True
        self.is_free = ~self.gathered(self.constrained.astype(float)).astype(bool)
        self.free = self.numbers[self.is_free]

    def gathered(self, values: Array) -> Array:
        """Values at this rank's displacement dofs, at all contact dofs; collective."""
        return np.concatenate(self._comm.allgather(values[self._mine]))

    def places(self, surface: SurfaceMatrix) -> NDArray[np.int64]:
        """Where the dofs of a surface, by their numbers there, are among these."""
        return np.searchsorted(self.numbers, surface.dofs)

    def local_places(self, surface: SurfaceMatrix) -> NDArray[np.int64]:
        """Where those of this rank's nodes of a surface are, (nodes, components)."""
        space = surface.contact.trace.surface.space.dofmap
        count = space.index_map.size_local + space.index_map.num_ghosts
        nodes = space.index_map.local_to_global(np.arange(count, dtype=np.int32))
        return self.places(surface).reshape(-1, space.index_map_bs)[nodes]
