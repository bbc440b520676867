"""Rectangles and boxes with named sides, whose cells may be moved as a case needs them."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.mesh.tagged_mesh import Body, Group

Move = Callable[[Array], Array]
Condition = Callable[[Array], Flags]

_SIDES = {2: ("left", "right", "bottom", "top"), 3: ("left", "right", "front", "back", "bottom")}
_NAMES_3D = (*_SIDES[3], "top")


def box(
    cells: tuple[int, ...],
    size: tuple[float, ...] = (1.0, 1.0, 1.0),
    move: Move | None = None,
    parts: Mapping[str, Condition] | None = None,
    patches: Mapping[str, tuple[str, Condition]] | None = None,
    simplices: bool = False,
    comm: MPI.Comm = MPI.COMM_WORLD,
) -> Body:
    """A rectangle or a box with its corner at the origin; collective.

    Its sides are called left and right (x), bottom and top (the last axis), and in space front and
    back (y); all of it is called body.

    Args:
        cells: Along each axis; two or three.
        size: Along each axis (length).
        move: From where nodes are, (nodes, dimension), to where they go.
        parts: Name → which cells it has, by their midpoints before they are moved; the others are
            called ``rest``.
        patches: Name → a side, and which of its facets it has, likewise.
        simplices: Triangles or tetrahedra in place of quadrilaterals or hexahedra.
        comm: Communicator.
    """
    dimension = len(cells)
    made = _grid(cells, size, simplices, comm)
    groups: dict[str, Group] = {"body": Group(dimension, (0,))}
    cell_tags = _tagged_cells(made, parts or {}, groups)
    facet_tags = _tagged_facets(made, size[:dimension], patches or {}, groups)
    if move is not None:
        nodes = made.geometry.x
        nodes[:, :dimension] = move(nodes[:, :dimension].copy())
    return Body(made, cell_tags, facet_tags, groups, "a box")


def _grid(
    cells: tuple[int, ...], size: tuple[float, ...], simplices: bool, comm: MPI.Comm
) -> mesh.Mesh:
    dimension = len(cells)
    corners = [np.zeros(dimension), np.array(size[:dimension], dtype=float)]
    if dimension == 3:
        kind = mesh.CellType.tetrahedron if simplices else mesh.CellType.hexahedron
        return mesh.create_box(comm, corners, list(cells), kind)
    kind = mesh.CellType.triangle if simplices else mesh.CellType.quadrilateral
    return mesh.create_rectangle(comm, corners, list(cells), kind)


def _tagged_cells(
    made: mesh.Mesh, parts: Mapping[str, Condition], groups: dict[str, Group]
) -> mesh.MeshTags:
    dimension = made.topology.dim
    index_map = made.topology.index_map(dimension)
    numbers = np.arange(index_map.size_local + index_map.num_ghosts, dtype=np.int32)
    values = np.zeros(len(numbers), dtype=np.int32)
    midpoints = mesh.compute_midpoints(made, dimension, numbers)
    for tag, (name, condition) in enumerate(parts.items(), 1):
        values[condition(midpoints)] = tag
        groups[name] = Group(dimension, (tag,))
    groups["body"] = Group(dimension, tuple(range(len(parts) + 1)))
    groups["rest"] = Group(dimension, (0,))
    return mesh.meshtags(made, dimension, numbers, values)


def _tagged_facets(
    made: mesh.Mesh,
    size: tuple[float, ...],
    patches: Mapping[str, tuple[str, Condition]],
    groups: dict[str, Group],
) -> mesh.MeshTags:
    dimension = made.topology.dim
    names = _SIDES[2] if dimension == 2 else _NAMES_3D
    facets, values = [], []
    for number, name in enumerate(names):
        axis, end = divmod(number, 2)
        place = end * size[axis]
        found = mesh.locate_entities_boundary(
            made,
            dimension - 1,
            lambda x, axis=axis, place=place: np.abs(x[axis] - place) < 1e-9 * size[axis],
        )
        tags = np.full(len(found), 1 + number, dtype=np.int32)
        midpoints = mesh.compute_midpoints(made, dimension - 1, found)
        own = [1 + number]
        for count, (patch, (side, condition)) in enumerate(patches.items()):
            if side == name:
                tags[condition(midpoints)] = 100 + count
                groups[patch] = Group(dimension - 1, (100 + count,))
                own.append(100 + count)
        groups[name] = Group(dimension - 1, tuple(own))
        facets.append(found)
        values.append(tags)
    numbers = np.concatenate(facets)
    order = np.argsort(numbers)
    return mesh.meshtags(made, dimension - 1, numbers[order], np.concatenate(values)[order])
