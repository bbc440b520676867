"""Nodal values without ranks: by the numbers that cells had in the mesh as it was read.

A node is the i-th of a cell, whichever of its cells that is. Coordinates would not do: nodes of
two bodies may coincide.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.body.spaces import summed_over_ranks
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import total
from fenics_contact.simulation.restart.row_tables import SavedTables


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

    def own(self, wanted: Flags | None = None) -> tuple[Integers, Integers]:
        """Names and numbers of the nodes that this rank owns.

        Args:
            wanted: Only these.
        """
        nodes = np.arange(self._index_map.size_local)
        if wanted is not None:
            nodes = nodes[wanted[nodes]]
        return self._of_node[nodes], nodes

    def values(self, saved: SavedTables, table: str) -> dict[str, Array] | None:
        """Columns of a table at the nodes of this rank, 0 without a row; collective.

        Returns:
            First axis nodes; None if there are rows of another mesh's nodes.
        """
        # A key names a cell that one rank owns, so each row is taken once.
        columns, rows = saved.taken(
            table, self._own_keys.ravel(), self._own_nodes.ravel(), len(self._of_node)
        )
        if int(total(self._comm, rows)) != saved.count(table):
            return None
        return {name: summed_over_ranks(self._index_map, nodal) for name, nodal in columns.items()}
