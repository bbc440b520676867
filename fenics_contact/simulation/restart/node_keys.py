"""Nodal values without ranks: by the numbers that cells had in the mesh as it was read.

A node is the i-th of a cell, whichever of its cells that is. Coordinates would not do: nodes of
two bodies may coincide.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.body.spaces import summed_over_ranks
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gathered_on_root, total


class NodalKeys:
    """Names of the nodes of a space that any number of ranks agrees on.

    Args:
        mesh: dolfinx mesh.
        dofmap: Of the space; its blocks are the nodes.
    """

    def __init__(self, mesh: Any, dofmap: Any) -> None:
        self._comm = mesh.comm
        self._index_map = dofmap.index_map
        cells = mesh.topology.index_map(mesh.topology.dim)
        nodes = np.asarray(dofmap.list)
        original = np.asarray(mesh.topology.original_cell_index, dtype=np.int64)[: len(nodes)]
        keys = original[:, None] * nodes.shape[1] + np.arange(nodes.shape[1])
        self._of_node = np.full(self._index_map.size_local + self._index_map.num_ghosts, -1)
        self._of_node[nodes] = keys
        self._own_keys, self._own_nodes = keys[: cells.size_local], nodes[: cells.size_local]

    def gathered(self, nodal: Array, wanted: Flags | None = None) -> tuple[Integers, Array]:
        """Keys and values of all nodes, on rank 0 and empty elsewhere; collective.

        Args:
            nodal: First axis nodes of this rank.
            wanted: Only these.
        """
        own = np.arange(self._index_map.size_local)
        if wanted is not None:
            own = own[wanted[own]]
        return gather_keyed(self._comm, self._of_node[own], nodal[own])

    def spread(self, keys: Integers, values: Array) -> Array | None:
        """Values at the nodes of this rank, 0 without; None if they are another mesh's; collective.

        Args:
            keys: Sorted, the same on every rank; likewise
            values: First axis keys.
        """
        places, known = found_among(keys, self._own_keys.ravel())
        nodal = np.zeros((len(self._of_node), *values.shape[1:]))
        # A key names a cell that one rank owns, so each value comes in once.
        nodal[self._own_nodes.ravel()[known]] = values[places[known]]
        if int(total(self._comm, int(known.sum()))) != len(keys):
            return None
        return summed_over_ranks(self._index_map, nodal)


def found_among(keys: Integers, wanted: Integers) -> tuple[Integers, Flags]:
    """Places of keys among sorted ones, and which there are."""
    places = np.searchsorted(keys, wanted)
    known = np.zeros(len(wanted), dtype=bool)
    inside = places < len(keys)
    known[inside] = keys[places[inside]] == wanted[inside]
    return places, known


def gather_keyed(comm: MPI.Comm, keys: Integers, values: Array) -> tuple[Integers, Array]:
    """Keys and values of all ranks, sorted, on rank 0 and empty elsewhere; collective."""
    parts = gathered_on_root(comm, (keys, values))
    if parts is None:
        return keys[:0], values[:0]
    all_keys, all_values = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.argsort(all_keys)
    return all_keys[order], all_values[order]
