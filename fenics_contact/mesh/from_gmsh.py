"""A mesh as plain arrays, from what Gmsh has read: what the body is, and is it sound.

Everything here happens on one rank, before the mesh is distributed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import basix
import basix.ufl
import numpy as np
from dolfinx import cpp
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.cell_checks import (
    FileCells,
    check_dimension,
    check_points,
    undefined_node,
    vertex_keys,
)
from fenics_contact.mesh.file_groups import PartTags, Piece, left_out, named_groups
from fenics_contact.mesh.readers.element_kinds import dimension_of_name
from fenics_contact.mesh.sides_by_angle import SidesByAngle, name_of_side
from fenics_contact.mesh.subdivision.uniform import Form, body_parts, uniform
from fenics_contact.mesh.tagged_mesh import Group, Relation
from fenics_contact.scene.scene import MeshSource

# Gmsh's element types: cell and order.
CELLS = {
    2: ("triangle", 1),
    9: ("triangle", 2),
    3: ("quadrilateral", 1),
    10: ("quadrilateral", 2),
    4: ("tetrahedron", 1),
    11: ("tetrahedron", 2),
    5: ("hexahedron", 1),
    12: ("hexahedron", 2),
}
# Gmsh's types of the facets of each cell, by the order of both.
_FACETS = {
    "triangle": {1: 1, 2: 8},
    "quadrilateral": {1: 1, 2: 8},
    "tetrahedron": {1: 2, 2: 9},
    "hexahedron": {1: 3, 2: 10},
}
_VERTICES = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
_SIDES = {2: "interval", 3: "triangle", 4: "quadrilateral"}  # by their vertices


@dataclass(frozen=True, eq=False)
class MeshArrays:
    """A sound mesh of one cell type with its groups.

    Attributes:
        cell: Its cell, such as ``tetrahedron``.
        order: Of the geometry.
        points: Nodes of the body, shape (nodes, dimension) (length).
        cells: Nodes of each cell in dolfinx's order.
        cell_tags: Part of each cell.
        facets: Nodes of each tagged facet in dolfinx's order; no facet twice.
        facet_tags: Part of each.
        groups: Name → group.
        numbers: Number → group.
        relations: Of the bodies of the geometry that are near each other.
        sides: Parts of the boundary by Gmsh's numbers, which ``mesh.groups`` takes.
        elements: By which number the file knows each cell.
        kinematics: What the file's types of elements are made for, if they say it, such as
            ``axisymmetric``, and a type that says so, such as ``CAX4``.
        found: Sides by name, where the file names none; what lies against each other there is not
            named by it.
        notes: Sentences, without the full stop, on what of the file is not in the model.
    """

    cell: str
    order: int
    points: Array
    cells: Integers
    cell_tags: NDArray[np.int32]
    facets: Integers
    facet_tags: NDArray[np.int32]
    groups: Mapping[str, Group]
    numbers: Mapping[str, Group]
    relations: tuple[Relation, ...]
    sides: Mapping[str, Group]
    elements: Integers
    kinematics: Mapping[str, str]
    notes: tuple[str, ...]
    found: Mapping[str, Group] = field(default_factory=dict)

    @property
    def named(self) -> dict[str, Group]:
        """All groups that scenes can name."""
        return {**self.groups, **self.found}


def build(
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    source: MeshSource,
    dimension: int,
    key: str,
    form: Form | None = None,
) -> MeshArrays:
    """Choose the body's cells and its facets, name the groups, and refuse what is unsound.

    Args:
        read: Arrays of ``gmsh_process``.
        description: Its description of the model.
        source: The scene's mesh, with the groups that it names.
        dimension: Of the model.
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
        form: Of all cells of the model; by default that of this mesh.
    """
    where = f"{key}.file = '{source.file}'"
    check_dimension(where, description, dimension)
    notes = list(description.get("changed", ()))
    read, description, of_cells = uniform(where, read, description, dimension, form)
    notes += of_cells
    parts = body_parts(description, dimension)
    kind, nodes, cell_parts, numbers = _cells(where, read, description, parts, dimension)
    cell, order = CELLS[kind]
    points, cells, old_tags = _used_points(where, read, nodes, numbers)
    check_points(where, points, dimension)
    points = points[:, :dimension]
    cells = cells[:, _permutation(cell, cells.shape[1])]
    found = FileCells(where, cell, order, cells, numbers, cell_parts)
    found.check_nodes(points)
    found.check_once(vertex_keys(found.corners, len(points)), not description.get("lists_once"))
    cells, cell_tags, body, first = _unique(cells, cell_parts, _VERTICES[cell], len(points))
    found = FileCells(where, cell, order, cells, numbers[first], cell_tags)
    keys = _facet_keys(cell, cells, len(points))
    found.check_facets(keys)
    found.check_jacobians(points)
    facets, facet_parts, are_sides = _facets(read, cell, order, old_tags, keys, len(points))
    corners = len(_corners_of_facets(cell)[0])
    facets, facet_tags, boundary, _ = _unique(facets, facet_parts, corners, len(points))
    facets = facets[:, _permutation(_SIDES[corners], facets.shape[1])]
    places = _places(read, old_tags, points)
    lost = read.get(f"parts_{_FACETS[cell][order]}", are_sides)[~are_sides]
    outside = dict(
        zip(*(several.tolist() for several in np.unique(lost, return_counts=True)), strict=True)
    )
    by_angle = SidesByAngle(cell, order, points, cells)
    if by_angle.are_wanted(description, facet_tags, boundary):
        description = by_angle.description(description, facet_tags, boundary)
        facets, facet_tags = by_angle.facets, by_angle.tags
        boundary = {number: {number} for number in by_angle.centres}
    tags = PartTags(dimension, body, boundary, outside, places)
    groups, by_number, sides = named_groups(key, source, description, tags)
    relations = tuple(_relation(**found) for found in description.get("relations", ()))
    return MeshArrays(
        *(cell, order, points, cells, cell_tags, facets, facet_tags),
        *(groups, by_number, relations, sides, found.numbers),
        description.get("kinematics", {}),
        (
            *notes,
            *left_out(read, description, dimension, _FACETS[cell][order], are_sides),
        ),
        {name_of_side(number, groups): side for number, side in sides.items()}
        if facets is by_angle.facets
        else {},
    )


def _relation(bodies: list[str], kind: str, overlap: float, share: float) -> Relation:
    return Relation((bodies[0], bodies[1]), kind, overlap, share)


def nodes_of(cell: str, order: int) -> int:
    """Geometry nodes of a cell."""
    return int(basix.ufl.element("Lagrange", cell, order).dim)


def _cells(
    where: str,
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    parts: list[int],
    dimension: int,
) -> tuple[int, Integers, Integers, Integers]:
    """Type, nodes, part and number of the body's cells, which must be of one type."""
    found = {}
    for kind, name in description["types"].items():
        kind = int(kind)
        size = dimension_of_name(name)
        if size == dimension:
            chosen = np.isin(read[f"parts_{kind}"], parts)
            if chosen.any():
                found[kind] = chosen
    names = [description["types"][str(kind)] for kind in sorted(found)]
    if not found:
        raise InputError(f"{where}: the body has no cells of dimension {dimension}")
    bad = [name for kind, name in zip(sorted(found), names, strict=True) if kind not in CELLS]
    if bad:
        raise InputError(
            f"{where}: its cells are of the type {' and '.join(bad)}; they must be triangles, "
            "quadrilaterals, tetrahedra, hexahedra, prisms or pyramids, of order 1 or 2"
        )
    ((kind, chosen),) = found.items()
    nodes, parts_of, numbers = (read[f"{name}_{kind}"] for name in ("nodes", "parts", "numbers"))
    return kind, nodes[chosen].astype(np.int64), parts_of[chosen], numbers[chosen].astype(np.int64)


def _used_points(
    where: str, read: Mapping[str, Any], nodes: Integers, numbers: Integers
) -> tuple[Array, Integers, Integers]:
    """Coordinates of the nodes in use, cells that count from 0, and the nodes' old tags."""
    used, inverse = np.unique(nodes, return_inverse=True)
    tags = read["node_tags"].astype(np.int64)
    order = np.argsort(tags)
    place = np.minimum(np.searchsorted(tags[order], used), len(tags) - 1)
    if len(tags) == 0 or (tags[order][place] != used).any():
        missing = used[tags[order][place] != used][0] if len(tags) else used[0]
        first = numbers[np.argmax((nodes == missing).any(axis=1))]
        raise undefined_node(where, first, missing)
    return read["points"][order[place]], inverse.reshape(nodes.shape), used


def _facet_keys(cell: str, cells: Integers, count: int) -> NDArray[np.uint64]:
    """One number for every facet of every cell, the same for the same vertices."""
    return vertex_keys(cells[:, _corners_of_facets(cell)], count)


def _corners_of_facets(cell: str) -> Integers:
    """Places of the corners of each facet among those of a cell, in dolfinx's order."""
    return np.array(basix.topology(getattr(basix.CellType, cell))[-2])


def _permutation(cell: str, nodes: int) -> Any:
    """From Gmsh's order of a cell's nodes to dolfinx's."""
    return cpp.io.perm_gmsh(cpp.mesh.to_type(cell), nodes)


def _facets(
    read: Mapping[str, Any],
    cell: str,
    order: int,
    old_tags: Integers,
    keys: NDArray[np.uint64],
    count: int,
) -> tuple[Integers, Integers, Flags]:
    """Nodes and part of the facets that are sides of cells; whether each in the file is one."""
    kind, corners = _FACETS[cell][order], len(_corners_of_facets(cell)[0])
    if f"nodes_{kind}" not in read:
        width = nodes_of(_SIDES[corners], order)
        none = np.zeros(0, dtype=np.int64)
        return np.zeros((0, width), dtype=np.int64), none, none.astype(bool)
    nodes, parts = read[f"nodes_{kind}"].astype(np.int64), read[f"parts_{kind}"]
    place = np.minimum(np.searchsorted(old_tags, nodes), len(old_tags) - 1)
    known = (old_tags[place] == nodes).all(axis=1)
    known &= np.isin(vertex_keys(place[:, :corners], count), keys)
    return place[known], parts[known], known


# Gmsh's types of points and edges, by their dimension.
_SLENDER = {0: (15,), 1: (1, 8)}


def _places(
    read: Mapping[str, Any], old_tags: Integers, points: Array
) -> dict[tuple[int, int], list[Piece]]:
    """Pieces of points, and of edges in space, by their dimension and part.

    Edges of order 2 are known by their nodes alone. Nodes that no cell has are left out.
    """
    found: dict[tuple[int, int], list[Piece]] = {}
    for dimension in range(points.shape[1] - 1):
        for kind in _SLENDER[dimension]:
            nodes = read.get(f"nodes_{kind}", np.zeros((0, 1))).astype(np.int64)
            place = np.minimum(np.searchsorted(old_tags, nodes), len(old_tags) - 1)
            known = (old_tags[place] == nodes).all(axis=1)
            rows = zip(place[known], read.get(f"parts_{kind}", known)[known], strict=True)
            for row, part in rows:
                every = [tuple(points[node].tolist()) for node in row]
                pieces = [(every[0], every[-1])] if len(every) < 3 else [(p, p) for p in every]
                found.setdefault((dimension, int(part)), []).extend(pieces)
    return found


def _unique(
    nodes: Integers, parts: Integers, corners: int, count: int
) -> tuple[Integers, NDArray[np.int32], dict[int, set[int]], Integers]:
    """Every cell or facet once, tagged with its part, or with the set of its parts.

    dolfinx's mesh tags have one value an entity, but the user's groups may overlap.

    Returns:
        Nodes, tags, the tags that make up every part, and the row that each entity was first.
    """
    keys = vertex_keys(nodes[:, :corners], count)
    _, first, entity = np.unique(keys, return_index=True, return_inverse=True)
    members: dict[int, set[int]] = {int(part): {int(part)} for part in np.unique(parts)}
    tags = parts[first].astype(np.int32)
    repeated = np.bincount(entity, minlength=len(first)) > 1
    owners: dict[int, set[int]] = {}
    for row in np.flatnonzero(repeated[entity]):
        owners.setdefault(int(entity[row]), set()).add(int(parts[row]))
    shared: dict[frozenset[int], int] = {}
    following = int(parts.max(initial=0)) + 1
    for number, several in owners.items():
        if len(several) > 1:
            tags[number] = shared.setdefault(frozenset(several), following + len(shared))
            for part in several:
                members[part].add(int(tags[number]))
    in_file_order = np.argsort(first)
    first = first[in_file_order]
    return nodes[first], tags[in_file_order], members, first
