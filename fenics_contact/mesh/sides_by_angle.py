"""Sides of a mesh that names none: its boundary, parted where it turns by more than an angle."""

from __future__ import annotations

from collections.abc import Container, Mapping
from functools import cached_property
from typing import Any

import basix
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.mesh.cell_checks import vertex_keys

ANGLE = 40.0  # degrees, between normals of neighbours; Gmsh's own where it classifies surfaces
_SIDES = {2: "interval", 3: "triangle", 4: "quadrilateral"}  # by their corners


class SidesByAngle:
    """Sides of a mesh.

    They are in the order of their first facets, and facets in that of their corners by number, so
    that the order of cells in the file does not matter.

    Attributes:
        facets: Nodes of each facet of the boundary in dolfinx's order, (facets, nodes).

    Args:
        cell: Kind of the cells, such as ``tetrahedron``.
        order: Of their geometry.
        points: Nodes in the order of their numbers, (nodes, dimension) (length).
        cells: Nodes of each cell in dolfinx's order.
    """

    def __init__(self, cell: str, order: int, points: Array, cells: Integers) -> None:
        topology = basix.topology(getattr(basix.CellType, cell))
        self._count, self._points = len(topology[-2][0]), points
        every = cells[:, _places(cell, order)]
        keys = vertex_keys(every[..., : self._count], len(points))
        _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
        owner, side = np.nonzero((counts[inverse] == 1).reshape(keys.shape))
        facets = every[owner, side]
        in_order = np.lexsort(np.sort(facets[:, : self._count], axis=1).T[::-1])
        self.facets: Integers = facets[in_order]
        self._inside = points[cells[owner[in_order]][:, : len(topology[0])]].mean(axis=1)

    def are_wanted(
        self,
        description: Mapping[str, Any],
        tags: NDArray[np.int32],
        parts: Mapping[int, set[int]],
    ) -> bool:
        """Whether the file names no side: it has no facets, but for a set of all nodes.

        Args:
            description: Of the mesh.
            tags: Of the facets that the file has.
            parts: Of the boundary → their tags.
        """
        sets = [group for group in description["groups"] if group.get("of_nodes")]
        of_nodes = {part for group in sets for part in group["parts"]}
        counts = {part: int(np.isin(tags, list(of_part)).sum()) for part, of_part in parts.items()}
        return all(
            count == 0 or (part in of_nodes and count == len(self.facets))
            for part, count in counts.items()
        )

    @cached_property
    def tags(self) -> NDArray[np.int32]:
        """The side of each facet, counted from 1, (facets,)."""
        corners = self.facets[:, : self._count]
        normals = _normals(self._points[corners], self._inside)
        part = _parts(corners, normals, len(self._points))
        _, first, part = np.unique(part, return_index=True, return_inverse=True)
        return (1 + np.argsort(np.argsort(first))[part]).astype(np.int32)

    @cached_property
    def centres(self) -> dict[int, list[float]]:
        """Middle of the box around each side, by its number (length)."""
        found = {}
        for number in range(1, int(self.tags.max(initial=0)) + 1):
            at = self._points[self.facets[self.tags == number]].reshape(-1, self._points.shape[1])
            found[number] = ((at.min(axis=0) + at.max(axis=0)) / 2).tolist()
        return found

    def description(
        self,
        description: Mapping[str, Any],
        tags: NDArray[np.int32],
        parts: Mapping[int, set[int]],
    ) -> dict[str, Any]:
        """The description of a mesh whose boundary has these sides as its parts.

        Args:
            description: Without.
            tags: As of ``are_wanted``.
            parts: As of ``are_wanted``.
        """
        dimension = self._points.shape[1] - 1
        whole = {part for part, of_part in parts.items() if np.isin(tags, list(of_part)).any()}
        groups = [
            group | {"parts": list(self.centres) if whole & set(group["parts"]) else []}
            if group["dimension"] == dimension
            else group
            for group in description["groups"]
        ]
        others = [part for part in description["parts"] if part["dimension"] != dimension]
        sides = [
            {"dimension": dimension, "tag": number, "centre": centre}
            for number, centre in self.centres.items()
        ]
        return dict(description) | {"groups": groups, "parts": [*others, *sides]}


def name_of_side(number: str, taken: Container[str]) -> str:
    """The name of a side that is found.

    Args:
        number: Of the side.
        taken: Names of groups.
    """
    name = f"side_{number}"
    while name in taken:
        name += "_"
    return name


def _places(cell: str, order: int) -> Integers:
    """Places of the nodes of each side among those of a cell, both in dolfinx's order."""
    kind = getattr(basix.CellType, cell)
    found = []
    for corners in basix.topology(kind)[-2]:
        of_side = _nodes(_SIDES[len(corners)], order)
        at = basix.geometry(kind)[corners]
        wanted = at[0] + of_side @ (at[1 : 1 + of_side.shape[1]] - at[0])
        apart = np.linalg.norm(_nodes(cell, order)[None] - wanted[:, None], axis=2)
        found.append(np.argmin(apart, axis=1))
    return np.array(found)


def _nodes(cell: str, order: int) -> Array:
    element = basix.create_element(
        basix.ElementFamily.P,
        getattr(basix.CellType, cell),
        order,
        basix.LagrangeVariant.equispaced,
    )
    return np.asarray(element.points)


def _normals(corners: Array, inside: Array) -> Array:
    """Unit normals of facets away from points inside."""
    if corners.shape[2] == 2:
        along = corners[:, 1] - corners[:, 0]
        normals = np.column_stack([along[:, 1], -along[:, 0]])
    else:  # diagonals of four corners in dolfinx's order, two sides of a triangle
        normals = np.cross(corners[:, -1] - corners[:, 0], corners[:, 2] - corners[:, 1])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    outward = ((corners.mean(axis=1) - inside) * normals).sum(axis=1)
    return np.asarray(np.where(outward < 0, -1.0, 1.0)[:, None] * normals)


def _parts(facets: Integers, normals: Array, count: int) -> Integers:
    """Numbers of the connected parts of facets that turn by less than the angle."""
    kind = getattr(basix.CellType, _SIDES[facets.shape[1]])
    ridges = facets[:, np.array(basix.topology(kind)[-2])]
    keys = vertex_keys(ridges, count).ravel()
    of_facet = np.repeat(np.arange(len(facets)), ridges.shape[1])
    in_order = np.argsort(keys, kind="stable")
    keys, of_facet = keys[in_order], of_facet[in_order]
    same = keys[1:] == keys[:-1]
    one, other = of_facet[:-1][same], of_facet[1:][same]
    smooth = (normals[one] * normals[other]).sum(axis=1) > np.cos(np.radians(ANGLE))
    links = (np.ones(int(smooth.sum())), (one[smooth], other[smooth]))
    return np.asarray(
        connected_components(coo_array(links, shape=2 * (len(facets),)), directed=False)[1]
    )
