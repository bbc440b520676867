"""The stiffness of the cells of each rank: what ranks share is left unsummed.

So each rank can condense its own cells, with solvers that know of no other rank.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray
from scipy.sparse import bmat, csr_matrix

from fenics_contact.problem import Problem
from fenics_contact.spaces import summed_over_ranks

Array = NDArray[np.float64]


class LocalStiffness:
    """K, or [[K, Bᵀ], [B, −C]] with a mean stress, of this rank's cells.

    Its unknowns are those that its cells touch: displacements, then mean stresses.

    Attributes:
        matrix: Sparse, (unknowns, unknowns) (force/length).
        numbers: Of the unknowns over all ranks.
        shared: Which of them cells of other ranks touch, too.
        displacements: Displacement dofs among them, by their local number in the space.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self.comm = problem.comm
        spaces, mixed = problem.spaces, problem.elastic.mixed
        fields = [spaces.displacement_space]
        blocks = [[_local_matrix(problem.elastic.stiffness)]]
        if mixed is not None:
            fields.append(mixed.mean_stress.function_space)
            gradient, divergence = _local_matrix(mixed.gradient), _local_matrix(mixed.divergence)
            blocks[0].append(gradient)
            blocks.append([divergence, -_local_matrix(mixed.compressibility)])
        whole = csr_matrix(bmat(blocks)) if mixed is not None else blocks[0][0]
        every = [_Unknowns(space) for space in fields]
        sizes = [len(unknowns.sharers) for unknowns in every]
        sharers = np.concatenate([unknowns.sharers for unknowns in every])
        touched = np.flatnonzero(sharers > 0)
        starts = np.cumsum([0, *(unknowns.total for unknowns in every)])
        numbers = [unknowns.numbers + start for unknowns, start in zip(every, starts, strict=False)]
        self.matrix = whole if len(touched) == len(sharers) else whole[touched][:, touched]
        self.numbers = np.concatenate(numbers)[touched]
        self.shared = sharers[touched] > 1
        self._sharers = sharers[touched]
        self.displacements = touched[touched < sizes[0]]
        self._stresses = touched[touched >= sizes[0]] - sizes[0]

    def share(self, nodal: Array) -> Array:
        """This rank's share of nodal forces (nodes, components), at its unknowns."""
        found = np.zeros(len(self.numbers))
        count = len(self.displacements)
        found[:count] = nodal.reshape(-1)[self.displacements] / self._sharers[:count]
        return found

    def at_unknowns(self, nodal: Array) -> Array:
        """Nodal displacements (nodes, components) at its unknowns, no mean stress."""
        found = np.zeros(len(self.numbers))
        found[: len(self.displacements)] = nodal.reshape(-1)[self.displacements]
        return found

    def forces(self, values: Array) -> Array:
        """K u at the nodes, (nodes, components), of all ranks' cells; collective."""
        spaces = self._problem.spaces
        found = np.zeros(spaces.coordinates.shape[0] * spaces.components)
        found[self.displacements] = (self.matrix @ values)[: len(self.displacements)]
        index_map = spaces.displacement_space.dofmap.index_map
        return summed_over_ranks(index_map, found.reshape(-1, spaces.components))

    def set_functions(self, values: Array) -> None:
        """Values of the unknowns into displacement and mean stress; collective."""
        count = len(self.displacements)
        _set(self._problem.displacement, self.displacements, values[:count])
        mixed = self._problem.elastic.mixed
        if mixed is not None:
            _set(mixed.mean_stress, self._stresses, values[count:])


class _Unknowns:
    """Numbers over all ranks of a space's dofs, and how many ranks' cells touch each."""

    def __init__(self, space: Any) -> None:
        dofmap, mesh = space.dofmap, space.mesh
        index_map, size = dofmap.index_map, dofmap.index_map_bs
        count = index_map.size_local + index_map.num_ghosts
        own_cells = mesh.topology.index_map(mesh.topology.dim).size_local
        touched = np.zeros(count)
        touched[dofmap.list[:own_cells].ravel()] = 1.0
        sharers = summed_over_ranks(index_map, touched[:, None])[:, 0]
        self.sharers = np.repeat(np.where(touched > 0, sharers, 0.0), size)
        nodes = index_map.local_to_global(np.arange(count, dtype=np.int32))
        self.numbers = (nodes[:, None] * size + np.arange(size)).ravel()
        self.total = index_map.size_global * size


def _local_matrix(form: Any) -> csr_matrix:
    """A bilinear form over this rank's cells, between its own local dofs; collective."""
    matrix = fem.assemble_matrix(form)
    local = csr_matrix(matrix.to_scipy(ghosted=True))
    rows, columns = (
        (space.dofmap.index_map.size_local + space.dofmap.index_map.num_ghosts)
        * space.dofmap.index_map_bs
        for space in form.function_spaces
    )
    return local if local.shape == (rows, columns) else local[:rows, :columns]


def _set(function: Any, dofs: NDArray[np.int64], values: Array) -> None:
    """Values at this rank's dofs; those that only ghost cells touch come from their owners."""
    function.x.array[dofs] = values
    function.x.scatter_forward()
