"""A mesh as plain arrays, from what Gmsh has read: what the body is, and is it sound.

Everything here happens on one rank, before the mesh is distributed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import basix.ufl
import numpy as np
from dolfinx import cpp
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.mesh import soundness as mesh_checks
from fenics_contact.mesh.serendipity import complete
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
# Vertices of the facets of each cell, in Gmsh's numbering, and Gmsh's types of facets.
_FACETS = {
    "triangle": (((0, 1), (1, 2), (2, 0)), {1: 1, 2: 8}),
    "quadrilateral": (((0, 1), (1, 2), (2, 3), (3, 0)), {1: 1, 2: 8}),
    "tetrahedron": (((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)), {1: 2, 2: 9}),
    "hexahedron": (
        ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
        {1: 3, 2: 10},
    ),
}
_VERTICES = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
_BOUNDARY_PARTS = {2: "curve", 3: "surface"}
_SIDES = {2: "interval", 3: "triangle", 4: "quadrilateral"}  # by their vertices
_BODY = "body"  # the whole body's group, where the file names none


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


def build(
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    source: MeshSource,
    dimension: int,
    key: str,
) -> MeshArrays:
    """Choose the body's cells and its facets, name the groups, and refuse what is unsound.

    Args:
        read: Arrays of ``gmsh_process``.
        description: Its description of the model.
        source: The scene's mesh, with the groups that it names.
        dimension: Of the model.
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
    """
    where = f"{key}.file = '{source.file}'"
    read, description = complete(read, description)
    mesh_checks.check_dimension(where, description, dimension)
    parts = _body_parts(description, dimension)
    kind, nodes, cell_parts = _cells(where, read, description, parts, dimension)
    cell, order = CELLS[kind]
    points, cells, old_tags = _used_points(where, read, nodes)
    mesh_checks.check_points(where, points, dimension)
    points = points[:, :dimension]
    mesh_checks.check_nodes(where, cells, points)
    cells, cell_tags, body = _unique(cells, cell_parts, _VERTICES[cell], len(points))
    keys = _facet_keys(cell, cells, len(points))
    mesh_checks.check_facets(where, keys)
    cells = cells[:, _permutation(cell, cells.shape[1])]
    mesh_checks.check_jacobians(where, cell, order, points, cells, cell_tags)
    facets, facet_parts, outside = _facets(read, cell, order, old_tags, keys, len(points))
    corners = len(_FACETS[cell][0][0])
    facets, facet_tags, boundary = _unique(facets, facet_parts, corners, len(points))
    facets = facets[:, _permutation(_SIDES[corners], facets.shape[1])]
    tags = _Tags(dimension, body, boundary, outside)
    groups, numbers, sides = _groups(key, source, description, tags)
    relations = tuple(_relation(**found) for found in description.get("relations", ()))
    return MeshArrays(
        *(cell, order, points, cells, cell_tags, facets, facet_tags),
        *(groups, numbers, relations, sides),
    )


def _relation(bodies: list[str], kind: str, overlap: float, share: float) -> Relation:
    return Relation((bodies[0], bodies[1]), kind, overlap, share)


def nodes_of(cell: str, order: int) -> int:
    """Geometry nodes of a cell."""
    return int(basix.ufl.element("Lagrange", cell, order).dim)


def _body_parts(description: Mapping[str, Any], dimension: int) -> list[int]:
    """Parts that make the body: all, or those in physical groups of Gmsh's if there are some."""
    every = [p["tag"] for p in description["parts"] if p["dimension"] == dimension]
    if description.get("whole"):
        return every
    grouped = {p for g in description["groups"] if g["dimension"] == dimension for p in g["parts"]}
    return sorted(grouped) or every


def _cells(
    where: str,
    read: Mapping[str, Any],
    description: Mapping[str, Any],
    parts: list[int],
    dimension: int,
) -> tuple[int, Integers, Integers]:
    """Type, nodes and part of the body's cells, which must be of one type."""
    found = {}
    for kind, name in description["types"].items():
        kind = int(kind)
        size = _dimension_of(name)
        if size == dimension:
            chosen = np.isin(read[f"parts_{kind}"], parts)
            if chosen.any():
                found[kind] = chosen
    names = [description["types"][str(kind)] for kind in sorted(found)]
    if not found:
        raise InputError(f"{where}: the body has no cells of dimension {dimension}")
    if len(found) > 1:
        raise InputError(f"{where}: mixes cells ({', '.join(names)}); all must be of one type")
    kind, chosen = next(iter(found.items()))
    if kind not in CELLS:
        raise InputError(
            f"{where}: its cells are of the type {names[0]}; it must be one of "
            "triangle, quadrilateral, tetrahedron or hexahedron, of order 1 or 2 (complete)"
        )
    return kind, read[f"nodes_{kind}"][chosen].astype(np.int64), read[f"parts_{kind}"][chosen]


def _dimension_of(name: str) -> int:
    """Dimension of Gmsh's element type by its name, such as ``Triangle 6``."""
    kinds = {"Point": 0, "Line": 1, "Triangle": 2, "Quadrilateral": 2, "Polygon": 2}
    return kinds.get(name.split()[0], 3)


def _used_points(
    where: str, read: Mapping[str, Any], nodes: Integers
) -> tuple[Array, Integers, Integers]:
    """Coordinates of the nodes in use, cells that count from 0, and the nodes' old tags."""
    used, inverse = np.unique(nodes, return_inverse=True)
    tags = read["node_tags"].astype(np.int64)
    order = np.argsort(tags)
    place = np.minimum(np.searchsorted(tags[order], used), len(tags) - 1)
    if len(tags) == 0 or (tags[order][place] != used).any():
        raise InputError(f"{where}: its cells use nodes that it does not define")
    return read["points"][order[place]], inverse.reshape(nodes.shape), used


def _facet_keys(cell: str, cells: Integers, count: int) -> NDArray[np.uint64]:
    """One number for every facet of every cell, the same for the same vertices."""
    return _keys(cells[:, np.array(_FACETS[cell][0])], count)


def _keys(vertices: Integers, count: int) -> NDArray[np.uint64]:
    """Sums of random numbers of the vertices (last axis): equal whatever their order."""
    random = np.random.default_rng(1982).integers(0, 2**63, size=count, dtype=np.uint64)
    return random[vertices].sum(axis=-1, dtype=np.uint64)


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
) -> tuple[Integers, Integers, dict[int, int]]:
    """Nodes and part of the facets that are sides of cells; how many of a part are not."""
    corners, types = _FACETS[cell]
    kind = types[order]
    if f"nodes_{kind}" not in read:
        width = nodes_of(_SIDES[len(corners[0])], order)
        return np.zeros((0, width), dtype=np.int64), np.zeros(0, dtype=np.int64), {}
    nodes, parts = read[f"nodes_{kind}"].astype(np.int64), read[f"parts_{kind}"]
    place = np.minimum(np.searchsorted(old_tags, nodes), len(old_tags) - 1)
    known = (old_tags[place] == nodes).all(axis=1)
    known &= np.isin(_keys(place[:, : len(corners[0])], count), keys)
    lost, counts = np.unique(parts[~known], return_counts=True)
    return (
        place[known],
        parts[known],
        dict(zip(lost.tolist(), counts.tolist(), strict=True)),
    )


def _unique(
    nodes: Integers, parts: Integers, corners: int, count: int
) -> tuple[Integers, NDArray[np.int32], dict[int, set[int]]]:
    """Every cell or facet once, tagged with its part, or with the set of its parts.

    dolfinx's mesh tags have one value an entity, but the user's groups may overlap.

    Returns:
        Nodes, tags, and the tags that make up every part.
    """
    keys = _keys(nodes[:, :corners], count)
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
    return nodes[first[in_file_order]], tags[in_file_order], members


@dataclass(frozen=True)
class _Tags:
    """What became of the parts: the tags of each, and facets that are no side of a cell."""

    dimension: int
    body: Mapping[int, set[int]]
    boundary: Mapping[int, set[int]]
    outside: Mapping[int, int]

    def group(self, dimension: int, parts: Iterable[int], centre: Sequence[float] = ()) -> Group:
        """The group of some parts of the body, or of its boundary."""
        members = self.body if dimension == self.dimension else self.boundary
        tags = {tag for part in parts for tag in members.get(part, ())}
        lost = 0
        if dimension < self.dimension:
            lost = sum(self.outside.get(part, 0) for part in parts)
        return Group(dimension, tuple(sorted(tags)), lost, tuple(centre))


def _groups(
    key: str, source: MeshSource, description: Mapping[str, Any], tags: _Tags
) -> tuple[dict[str, Group], dict[str, Group], dict[str, Group]]:
    """Groups by name (of the file, of the scene, the whole body), by number, and all sides."""
    where = f"{key}.file = '{source.file}'"
    groups: dict[str, Group] = {}
    numbers: dict[str, Group] = {}
    has_boundaries = False
    for found in sorted(description["groups"], key=lambda group: group["dimension"]):
        if found["dimension"] < tags.dimension - 1:
            continue
        has_boundaries |= found["dimension"] < tags.dimension and found["tag"] > 0
        group = tags.group(found["dimension"], found["parts"])
        name = found["name"] or str(found["tag"])
        groups[name] = _joined(where, name, groups.get(name), group)
        if found["tag"]:
            numbers.setdefault(str(found["tag"]), group)
    if description.get("whole") or all(
        group.dimension < tags.dimension for group in groups.values()
    ):
        groups.setdefault(_BODY, tags.group(tags.dimension, tags.body))
    sides = {
        str(part["tag"]): tags.group(tags.dimension - 1, [part["tag"]], part["centre"])
        for part in description["parts"]
        if part["dimension"] == tags.dimension - 1
    }
    for name, parts in source.groups.items():
        if name in groups:
            raise InputError(f"{key}.groups.{name}: {where} has a group of that name already")
        for part in parts:
            if str(part) not in sides:
                raise InputError(
                    f"{key}.groups.{name}: {where} has no "
                    f"{_BOUNDARY_PARTS[tags.dimension]} {part}; "
                    f"it has: {', '.join(sides) or 'none'}"
                )
        groups[name] = tags.group(tags.dimension - 1, parts)
    return groups, numbers if has_boundaries else sides, sides


def _joined(where: str, name: str, first: Group | None, second: Group) -> Group:
    """Two groups of one name as one."""
    if first is None:
        return second
    if first.dimension != second.dimension:
        if name.isdigit():  # unnamed groups: a number is first of all the boundary's
            return first
        raise InputError(
            f"{where}: calls a boundary and a part of the body '{name}': give each its own name"
        )
    return Group(
        first.dimension,
        tuple(sorted({*first.tags, *second.tags})),
        first.outside + second.outside,
    )
