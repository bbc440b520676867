"""A mesh of order 1 brought to one rank, to be made another one there and dealt out anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gathered_on_root, on_root
from fenics_contact.mesh.tagged_mesh import Body

Tags = NDArray[np.int32]

CORNERS = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
_FACET_CORNERS = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 4}


@dataclass(frozen=True, eq=False)
class GatheredMesh:
    """A mesh of order 1 as arrays, cells in the order of the ranks that own them.

    Attributes:
        cell: Kind of the cells.
        points: (points, dimension) (length).
        cells: Corners of each, in dolfinx's order.
        cell_tags: Of each.
        facets: Corners of those that have tags, in dolfinx's order.
        facet_tags: Of these.
    """

    cell: str
    points: Array
    cells: Integers
    cell_tags: Tags
    facets: Integers
    facet_tags: Tags


def is_of_order_1(mesh: Any) -> bool:
    """Whether cells have no nodes but their corners."""
    return bool(compat.geometry_nodes(mesh).shape[1] == CORNERS[mesh.topology.cell_name()])


def changed(body: Body, change: Callable[[GatheredMesh], GatheredMesh]) -> Body:
    """A body with another mesh, dealt out anew; collective.

    Args:
        body: Of cells of order 1.
        change: Of its mesh, on rank 0.
    """
    comm, dimension, found = body.mesh.comm, body.dimension, _gathered(body)
    made: list[GatheredMesh] = []  # stays on rank 0

    def make() -> None:
        assert found is not None
        made.append(change(found))

    on_root(comm, make)
    every = made[0] if made else _empty(body)
    mesh = compat.create_mesh(comm, every.cell, 1, every.points, every.cells)
    return Body(
        mesh,
        compat.distributed_tags(mesh, dimension, every.cells, every.cell_tags),
        compat.distributed_tags(mesh, dimension - 1, every.facets, every.facet_tags),
        body.groups,
        body.source,
        body.numbers,
    )


def all_values(tags: Any, number: int) -> Tags:
    """The tag of each of the first cells; of those without, one that no group has."""
    values = np.full(number, np.iinfo(np.int32).min, dtype=np.int32)
    mine = tags.indices < number
    values[tags.indices[mine]] = tags.values[mine]
    return values


def _gathered(body: Body) -> GatheredMesh | None:
    """A body on rank 0, None on the others; collective."""
    mesh, dimension = body.mesh, body.dimension
    cell = mesh.topology.cell_name()
    numbers = np.asarray(mesh.geometry.input_global_indices)
    own = mesh.topology.index_map(dimension).size_local
    nodes = compat.geometry_nodes(mesh)[:own]
    facet_tags = body.facet_tags
    mine = facet_tags.indices < mesh.topology.index_map(dimension - 1).size_local
    facets = compat.nodes_of_entities(mesh, dimension - 1, facet_tags.indices[mine])
    rows = gathered_on_root(
        mesh.comm,
        (
            numbers[nodes],
            mesh.geometry.x[nodes][:, :, :dimension],
            all_values(body.cell_tags, own),
            numbers[facets].reshape(-1, _FACET_CORNERS[cell]),
            facet_tags.values[mine],
        ),
    )
    if rows is None:
        return None
    cells, points, cell_tags, facets, tags = (
        np.concatenate(part) for part in zip(*rows, strict=True)
    )
    known, first, inverse = np.unique(cells, return_index=True, return_inverse=True)
    return GatheredMesh(
        cell,
        points.reshape(-1, dimension)[first],
        inverse.reshape(cells.shape).astype(np.int64),
        cell_tags.astype(np.int32),
        np.searchsorted(known, facets).astype(np.int64),
        tags.astype(np.int32),
    )


def _empty(body: Body) -> GatheredMesh:
    """Return the empty mesh of ranks other than 0."""
    cell, no_tags = body.mesh.topology.cell_name(), np.zeros(0, dtype=np.int32)
    corners = (CORNERS[cell], _FACET_CORNERS[cell])
    cells, facets = (np.zeros((0, count), dtype=np.int64) for count in corners)
    return GatheredMesh(cell, np.zeros((0, body.dimension)), cells, no_tags, facets, no_tags)
