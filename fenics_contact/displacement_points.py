"""Points of the body at which the displacement is a quantity: ``[[point]]``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact import compat
from fenics_contact.errors import InputError
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.scene import Point
from fenics_contact.spaces import Spaces

Array = NDArray[np.float64]

# Reference coordinates beyond a cell's by no more are inside: round-off of points on its boundary.
_OUTSIDE = 1e-6
# How far a cell with curved sides may reach beyond the box around its nodes, over that box.
_BULGE = 0.1
_NEWTON_STEPS = 30


class DisplacementPoints:
    """Where the points are in the mesh; collective, as all it has.

    A point that several cells share counts to the one that came first in the mesh: on the boundary
    of two bodies to the first mesh of the scene, on any number of ranks.

    Args:
        points: Of the scene.
        spaces: The body's.

    Raises:
        InputError: A point is outside the body.
    """

    def __init__(self, points: Sequence[Point], spaces: Spaces) -> None:
        self._comm, self._components = spaces.comm, spaces.components
        self._found = [_find(point, number, spaces) for number, point in enumerate(points)]
        self._names = [f"displacement_{point.name}" for point in points]
        self._at = np.zeros((len(points), 3))
        for place, point in zip(self._at, points, strict=True):
            place[: len(point.at)] = point.at

    def quantities(self, displacement: Array) -> dict[str, list[float]]:
        """The displacement at every point, by quantity.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        values = np.zeros((len(self._found), self._components))
        for value, (_, nodes, weights) in zip(values, self._found, strict=True):
            value += weights @ displacement[nodes]
        return self._summed(values)

    def of_function(self, function: fem.Function) -> dict[str, list[float]]:
        """A function of vectors at every point, in the cell that the point counts to."""
        values = np.zeros((len(self._found), self._components))
        for value, at, (cell, _, _) in zip(values, self._at, self._found, strict=True):
            if cell is not None:
                value += function.eval(at, cell)
        return self._summed(values)

    def _summed(self, values: Array) -> dict[str, list[float]]:
        return dict(zip(self._names, total(self._comm, values).tolist(), strict=True))


def _find(point: Point, number: int, spaces: Spaces) -> tuple[int | None, NDArray[np.int32], Array]:
    """Cell, nodes and shape functions of a point on the rank that has it, none on the others."""
    mesh = spaces.body.mesh
    at = np.zeros(3)
    at[: len(point.at)] = point.at
    inside = _cells_with(mesh, spaces.body.dimension, at)
    original = np.asarray(mesh.topology.original_cell_index, dtype=np.float64)
    first = smallest(spaces.comm, original[list(inside)], empty=np.inf)
    if first == np.inf:
        corners = mesh.geometry.x.T[: len(point.at)]
        least, most = ([f(spaces.comm, x) for x in corners] for f in (smallest, largest))
        raise InputError(
            f"point[{number}].at = {list(point.at)}: is outside the body, which reaches from "
            f"{_written(least)} to {_written(most)}"
        )
    for cell, reference in inside.items():
        if original[cell] == first:
            element = spaces.displacement_space.ufl_element().sub_elements[0]
            weights = element.tabulate(0, reference[None])[0].reshape(-1)
            return cell, spaces.displacement_space.dofmap.cell_dofs(cell), weights
    return None, np.zeros(0, dtype=np.int32), np.zeros(0)


def _cells_with(mesh: Any, dimension: int, at: Array) -> dict[int, Array]:
    """This rank's own cells that hold a point, and where it is on their reference cell."""
    corners = mesh.geometry.x[
        compat.geometry_nodes(mesh)[: mesh.topology.index_map(dimension).size_local]
    ][:, :, :dimension]
    least, most = corners.min(axis=1), corners.max(axis=1)
    margin = _BULGE * (most - least)
    place = at[:dimension]
    near = ((place >= least - margin) & (place <= most + margin)).all(axis=1)
    found = {}
    for cell in np.flatnonzero(near):
        reference = _reference_of(mesh, corners[cell], place)
        if reference is not None:
            found[int(cell)] = reference
    return found


def _reference_of(mesh: Any, corners: Array, place: Array) -> Array | None:
    """Where a point is on a cell's reference cell, by Newton's method; None if outside."""
    element = mesh.ufl_domain().ufl_coordinate_element().sub_elements[0]
    tensor = compat.is_tensor_cell(mesh)
    dimension = len(place)
    reference = np.full(dimension, 1 / 2 if tensor else 1 / (dimension + 1))
    for _ in range(_NEWTON_STEPS):
        table = element.tabulate(1, reference[None]).reshape(1 + dimension, -1)
        gradient = (table[1:] @ corners).T
        if not np.linalg.det(gradient):
            return None
        step = np.linalg.solve(gradient, place - table[0] @ corners)
        reference = reference + step
        if np.abs(step).max() < 1e-2 * _OUTSIDE:
            break
    else:
        return None
    beyond = max(-reference.min(), reference.max() - 1 if tensor else reference.sum() - 1)
    return reference if beyond <= _OUTSIDE else None


def _written(values: Sequence[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"
