"""What a mesh must not be: each check refuses it in one sentence. Plain arrays, one rank."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import basix
import basix.ufl
import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError

_FLAT = 1e-9  # out of plane, over the size of the body
_DEGENERATE = 1e-12  # Jacobian determinant over the cell's size
_CHUNK = 50_000  # cells looked at together: bounds the memory of the Jacobians


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
            "as a two-dimensional model needs"
        )


def check_nodes(where: str, cells: Integers, points: Array) -> None:
    """No node twice in a cell."""
    in_order = np.sort(cells, axis=1)
    collapsed = (in_order[:, 1:] == in_order[:, :-1]).any(axis=1)
    if collapsed.any():
        first = points[cells[np.argmax(collapsed)]].mean(axis=0)
        raise InputError(
            f"{where}: {_cells_are(collapsed.sum())} degenerate (the same node twice), "
            f"the first at {_at(first)}"
        )


def check_facets(where: str, keys: NDArray[np.uint64]) -> None:
    """No facet of more than two cells."""
    _, counts = np.unique(keys, return_counts=True)
    if counts.max() > 2:
        raise InputError(
            f"{where}: {(counts > 2).sum()} facets belong to more than two cells: cells overlap"
        )


def check_jacobians(
    where: str, cell: str, order: int, points: Array, cells: Integers, parts: NDArray[Any]
) -> None:
    """The Jacobian determinant keeps one sign in every part, and is nowhere zero.

    A part may be numbered the other way round as a whole: dolfinx does not mind.
    """
    element = basix.ufl.element(
        "Lagrange", cell, order, lagrange_variant=basix.LagrangeVariant.equispaced
    )
    at = _sample_points(cell, order)
    gradients = element.tabulate(1, at)[1:]  # (dimension, samples, nodes)
    least, largest = np.empty(len(cells)), np.empty(len(cells))
    for start in range(0, len(cells), _CHUNK):
        x = points[cells[start : start + _CHUNK]]
        size = np.ptp(x, axis=1).max(axis=1)[:, None] ** points.shape[1]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            jacobians = np.einsum("cnd,jqn->cqdj", x, gradients)
            relative = np.nan_to_num(np.linalg.det(jacobians) / size)
        least[start : start + _CHUNK] = relative.min(axis=1)
        largest[start : start + _CHUNK] = relative.max(axis=1)
    _, part = np.unique(parts, return_inverse=True)
    turned = (np.bincount(part, np.sign(least + largest)) < 0)[part]
    least = np.where(turned, -largest, least)
    bad = least <= _DEGENERATE
    if bad.any():
        first = points[cells[np.argmax(bad)]].mean(axis=0)
        raise InputError(
            f"{where}: {_cells_are(bad.sum())} degenerate or inverted (their Jacobian is zero or "
            f"negative), the first at {_at(first)}"
        )


def _sample_points(cell: str, order: int) -> Array:
    """Vertices and quadrature points of the reference cell; one point where J is constant."""
    kind = getattr(basix.CellType, cell)
    if order == 1 and cell in ("triangle", "tetrahedron"):
        return np.asarray(basix.geometry(kind).mean(axis=0)[None, :])
    return np.vstack([basix.geometry(kind), basix.make_quadrature(kind, 4)[0]])


def _cells_are(count: Any) -> str:
    return "1 cell is" if count == 1 else f"{count} cells are"


def _at(point: Array) -> str:
    return f"({', '.join(f'{value:g}' for value in point)})"
