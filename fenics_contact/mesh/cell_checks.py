"""Checks of the cells of a mesh: each refuses bad ones in one sentence.

They look at plain arrays, on one rank, after reading, whatever program wrote the mesh. Messages
name cells by the numbers that their file gives them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import basix
import basix.ufl
import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError

_FLAT = 1e-9  # out of plane, over the size of the body
_DEGENERATE = 1e-12  # Jacobian determinant over the cell's size
_TIP = 1e-6  # the same at a corner, where a node at a quarter of an edge makes it zero
_CHUNK = 10_000  # cells looked at together: bounds the memory of the Jacobians
_CORNERS = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}


@dataclass(frozen=True, eq=False)
class FileCells:
    """The cells that a file makes of the body, as it lists them.

    Attributes:
        where: What begins a message: the file.
        cell: Kind of the cells, such as ``tetrahedron``.
        order: Of their geometry.
        nodes: Of each cell, as places among the points, in dolfinx's order.
        numbers: By which the file knows each cell.
        parts: Part of each.
    """

    where: str
    cell: str
    order: int
    nodes: Integers
    numbers: Integers
    parts: NDArray[Any]

    @property
    def corners(self) -> Integers:
        """Corners of each cell."""
        return self.nodes[:, : _CORNERS[self.cell]]

    def check_nodes(self, points: Array) -> None:
        """No node twice in a cell.

        Args:
            points: Coordinates of the nodes, shape (nodes, dimension) (length).
        """
        in_order = np.sort(self.nodes, axis=1)
        collapsed = (in_order[:, 1:] == in_order[:, :-1]).any(axis=1)
        if collapsed.any():
            what, advice = "degenerate (the same node twice)", "; mesh these places again"
            raise self._refusal(collapsed, what, points, advice)

    def check_once(self, keys: NDArray[np.uint64], may_be_in_several: bool) -> None:
        """No cell twice: its stiffness would count twice, and its sides would lie inside.

        Args:
            keys: The same for cells with the same corners.
            may_be_in_several: Whether the file lists a cell once for each group that it is in.
        """
        order = np.lexsort((self.parts, keys))
        same = keys[order][1:] == keys[order][:-1]
        if may_be_in_several:
            same &= self.parts[order][1:] == self.parts[order][:-1]
        if same.any():
            rows = order[np.flatnonzero(same)[0] : np.flatnonzero(same)[0] + 2]
            first, second = sorted(self.numbers[rows].tolist())
            more = f" (and {same.sum() - 1} more such pairs)" if same.sum() > 1 else ""
            raise InputError(
                f"{self.where}: the elements {first} and {second} have the same corners{more}: the "
                "same cell is listed twice; remove one of the two"
            )

    def check_facets(self, keys: NDArray[np.uint64]) -> None:
        """No facet of more than two cells.

        Args:
            keys: Of every facet of every cell, shape (cells, facets).
        """
        _, facet, counts = np.unique(keys, return_inverse=True, return_counts=True)
        if counts.max() > 2:
            first = np.argmax(counts > 2)
            rows = np.flatnonzero((facet.reshape(keys.shape) == first).any(axis=1))[:3]
            named = ", ".join(map(str, self.numbers[rows].tolist()))
            raise InputError(
                f"{self.where}: {(counts > 2).sum()} facets belong to more than two cells: cells "
                f"overlap, such as the elements {named}"
            )

    def check_jacobians(self, points: Array) -> None:
        """The Jacobian determinant keeps one sign in every part, and is nowhere zero.

        A part may be numbered the other way round as a whole: dolfinx does not mind. At corners
        it may be zero where a node on an edge stands at a quarter of it, as at the tip of a crack.

        Args:
            points: Coordinates of the nodes, shape (nodes, dimension) (length).
        """
        least, largest = self._jacobians(points)
        _, part = np.unique(self.parts, return_inverse=True)
        turned = (np.bincount(part, np.sign(least + largest)) < 0)[part]
        least = np.where(turned, -largest, least)
        bad = least <= _DEGENERATE
        if bad.any():
            what = "degenerate or inverted (their Jacobian is zero or negative)"
            raise self._refusal(bad, what, points, self._advice(bad, points))

    def _jacobians(self, points: Array) -> tuple[Array, Array]:
        """Least and largest determinant in each cell, over its size."""
        element = basix.ufl.element(
            "Lagrange", self.cell, self.order, lagrange_variant=basix.LagrangeVariant.equispaced
        )
        corners = _CORNERS[self.cell]
        gradients = element.tabulate(1, _sample_points(self.cell, self.order))[1:]
        least, largest = np.empty(len(self.nodes)), np.empty(len(self.nodes))
        for start in range(0, len(self.nodes), _CHUNK):
            x = points[self.nodes[start : start + _CHUNK]]
            size = np.ptp(x, axis=1).max(axis=1)[:, None] ** points.shape[1]
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                jacobians = np.einsum("cnd,jqn->cqdj", x, gradients)
                relative = np.nan_to_num(np.linalg.det(jacobians) / size)
            if self.order > 1:
                at_corners = relative[:, :corners]
                at_corners[np.abs(at_corners) < _TIP] = np.nan
            least[start : start + _CHUNK] = np.nanmin(relative, axis=1)
            largest[start : start + _CHUNK] = np.nanmax(relative, axis=1)
        return least, largest

    def _advice(self, bad: Flags, points: Array) -> str:
        """Return advice on what to look at first, by how many cells are bad."""
        edges = np.array(basix.topology(getattr(basix.CellType, self.cell))[1])
        if self.order > 1:
            corners = points[self.nodes[bad][:, edges]]
            middles = points[self.nodes[bad][:, _CORNERS[self.cell] :][:, : len(edges)]]
            off = np.linalg.norm(middles - corners.mean(axis=2), axis=-1)
            long = np.linalg.norm(corners[:, :, 1] - corners[:, :, 0], axis=-1)
            if (off > long / 2).any(axis=1).mean() > 0.5:
                return (
                    "; their nodes on edges lie far from these: does the file list them in the "
                    "order that its format has?"
                )
        if bad.mean() > 0.5:
            return "; does the file list the nodes of elements in the order that its format has?"
        return ""

    def _refusal(self, bad: Flags, what: str, points: Array, advice: str = "") -> InputError:
        are = "1 cell is" if bad.sum() == 1 else f"{bad.sum()} cells are"
        first = int(np.argmax(bad))
        place = ", ".join(f"{value:g}" for value in points[self.nodes[first]].mean(axis=0))
        return InputError(
            f"{self.where}: {are} {what}, the first at ({place}): the element "
            f"{self.numbers[first]}{advice}"
        )


def undefined_node(where: str, element: int, node: int) -> InputError:
    """The error of a cell with a node that the file does not define.

    Args:
        where: What begins a message: the file.
        element: By its number.
        node: By its number.
    """
    return InputError(
        f"{where}: its cells use nodes that it does not define: the element {element} the node "
        f"{node}"
    )


def vertex_keys(vertices: Integers, count: int) -> NDArray[np.uint64]:
    """Sums of random numbers of vertices (last axis): equal whatever their order.

    Args:
        vertices: As places among the points.
        count: Of all points.
    """
    random = np.random.default_rng(1982).integers(0, 2**63, size=count, dtype=np.uint64)
    return np.asarray(random[vertices].sum(axis=-1, dtype=np.uint64))


def check_dimension(where: str, description: Mapping[str, Any], dimension: int) -> None:
    """The mesh has the dimension that the model needs."""
    found = description["dimension"]
    if found != dimension:
        raise InputError(
            f"{where}: is {max(found, 0)}-dimensional, but the scene's kinematics needs a mesh "
            f"of dimension {dimension}"
        )


def check_points(where: str, points: Array, dimension: int) -> None:
    """Coordinates are finite, and those of a plane model in its plane."""
    if not np.isfinite(points).all() or np.abs(points).max() > 1e100:
        raise InputError(f"{where}: has coordinates that are not finite")
    size = np.ptp(points, axis=0).max()
    height = np.abs(points[:, 2]).max()
    if dimension == 2 and height > _FLAT * size:
        raise InputError(
            f"{where}: is not in the plane z = 0 (|z| is up to {height:g}), "
            "as a two-dimensional model needs; turn a section into it; shells are not solved: mesh "
            "their bodies by solids"
        )


def _sample_points(cell: str, order: int) -> Array:
    """Where Jacobians are looked at; one point where they are constant.

    Corners, a grid between them, and quadrature points.
    """
    kind = getattr(basix.CellType, cell)
    if order == 1 and cell in ("triangle", "tetrahedron"):
        return np.asarray(basix.geometry(kind).mean(axis=0)[None, :])
    every = basix.create_lattice(kind, 2 * order, basix.LatticeType.equispaced, True)
    at_corners = np.isclose(every[:, None], basix.geometry(kind)[None]).all(axis=2).any(axis=1)
    grid = every[~at_corners]
    return np.vstack([basix.geometry(kind), grid, basix.make_quadrature(kind, 4)[0]])
