"""Bodies of several boxes with meshes of their own, for contact between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem, mesh
from mpi4py import MPI

from fenics_contact import Body, Group
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array

COMM = MPI.COMM_WORLD


@dataclass(frozen=True)
class Box:
    """A box, named, from one corner to the opposite one, with cells along each axis."""

    name: str
    low: tuple[float, ...]
    high: tuple[float, ...]
    cells: tuple[int, ...]


def boxes(
    parts: Sequence[Box],
    cell: str = "quadrilateral",
    comm: MPI.Comm = COMM,
    order: int = 1,
    welded: Sequence[Sequence[str]] = (),
    closed: Sequence[str] = (),
) -> Body:
    """Boxes as one mesh; groups such as ``upper`` and ``upper.y0``.

    Args:
        parts: The boxes.
        cell: Kind of their cells.
        comm: Communicator; collective.
        order: Of the cells' geometry.
        welded: Names of boxes that share the nodes that lie in the same place; others are apart.
        closed: Names of boxes whose two ends along the first axis are one: a map of their points
            makes rings of them.
    """
    dimension = len(parts[0].cells)
    points: list[Array] = []
    cells, owner = [], []
    for number, box in enumerate(parts):
        make = mesh.create_rectangle if dimension == 2 else mesh.create_box
        ends = [np.array(box.low), np.array(box.high)]
        made = make(MPI.COMM_SELF, ends, list(box.cells), getattr(mesh.CellType, cell))
        nodes, where = compat.geometry_nodes(made), made.geometry.x
        if order == 2:  # the nodes of such cells are numbered as those of elements are
            space = fem.functionspace(made, ("Lagrange", 2))
            nodes, where = space.dofmap.list, space.tabulate_dof_coordinates()
        cells.append(nodes + sum(len(p) for p in points))
        points.append(where[:, :dimension])
        owner.append(np.full(len(cells[-1]), number + 1, dtype=np.int32))
    places, corners = np.concatenate(points), np.concatenate(cells).astype(np.int64)
    if welded or closed:
        names = [next((n for n in welded if part.name in n), [part.name])[0] for part in parts]
        of_part = [sorted(set(names)).index(name) for name in names]
        body = np.repeat(of_part, [len(part) for part in points])
        keys = np.column_stack([places.round(9), body])
        for part, number in zip(parts, of_part, strict=True):
            if part.name in closed:
                keys[(body == number) & np.isclose(keys[:, 0], part.high[0]), 0] = part.low[0]
        _, kept, new = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        places, corners = places[kept], new.reshape(-1)[corners]
    given = slice(0) if comm.rank else slice(None)
    corners = corners[given]
    whole = compat.create_mesh(comm, cell, order, places[given], corners)
    cell_tags = compat.distributed_tags(whole, dimension, corners, np.concatenate(owner)[given])
    facet_tags, groups = _sides(whole, cell_tags, parts)
    for number, box in enumerate(parts):
        groups[box.name] = Group(dimension, (number + 1,))
    return Body(whole, cell_tags, facet_tags, groups, "boxes")


def _sides(
    whole: mesh.Mesh, cell_tags: mesh.MeshTags, parts: Sequence[Box]
) -> tuple[mesh.MeshTags, dict[str, Group]]:
    """Tags of the boundary facets by box and side, and the groups of these."""
    dimension = whole.topology.dim
    whole.topology.create_entities(dimension - 1)
    whole.topology.create_connectivity(dimension - 1, dimension)
    links = whole.topology.connectivity(dimension - 1, dimension)
    facets = compat.exterior_facets(whole)
    behind = np.array([links.links(facet)[0] for facet in facets], dtype=np.int32)
    owner = np.zeros(cell_tags.indices.max(initial=-1) + 1, dtype=np.int32)
    owner[cell_tags.indices] = cell_tags.values
    centres = mesh.compute_midpoints(whole, dimension - 1, facets)
    tags = np.zeros(len(facets), dtype=np.int32)
    groups: dict[str, Group] = {}
    for number, box in enumerate(parts):
        mine = owner[behind] == number + 1 if len(behind) else np.zeros(0, dtype=bool)
        for axis in range(dimension):
            for end, at in enumerate((box.low[axis], box.high[axis])):
                tag = 1 + 10 * number + 2 * axis + end
                tags[mine & np.isclose(centres[:, axis], at)] = tag
                groups[f"{box.name}.{'xyz'[axis]}{end}"] = Group(dimension - 1, (tag,))
    order = np.argsort(facets)
    return mesh.meshtags(whole, dimension - 1, facets[order], tags[order]), groups
