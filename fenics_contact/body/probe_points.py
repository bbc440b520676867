"""Points of the body at which the displacement is a quantity: ``[[point]]``."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, NoReturn

import numpy as np
from basix.finite_element import FiniteElement
from dolfinx import fem, geometry
from dolfinx.mesh import Mesh
from mpi4py import MPI

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.scene.loading.conditions import Point

# Reference coordinates beyond a cell's by no more are inside: round-off of points on its boundary.
_OUTSIDE = 1e-6
# How far a cell with curved sides may reach beyond the box around its nodes, over that box.
_BULGE = 0.1
_NEWTON_STEPS = 30
# Points whose cells are sought together: what is kept of them meanwhile stays small.
_AT_ONCE = 512


class DisplacementPoints:
    """Where the points are in the mesh; collective, as all it has.

    A point that several cells share counts to the one that came first in the mesh: on the boundary
    of two bodies to the first mesh of the scene, on any number of ranks.

    Args:
        points: Of the scene.
        spaces: The body's.

    Raises:
        InputError: A point is outside the body, or its name is none of a single point.
    """

    def __init__(self, points: Sequence[Point], spaces: Spaces) -> None:
        self._comm, self._spaces = spaces.comm, spaces
        self._names = [f"displacement_{point.name}" for point in points]
        self._shape = len(points), spaces.components
        self._count = len(spaces.coordinates)
        self._at = np.zeros((len(points), 3))
        for number, (place, point) in enumerate(zip(self._at, points, strict=True)):
            at = _place_of(point, f"point[{number}].on", spaces)
            place[: len(at)] = at
        found = _cells_with(spaces, self._at)
        first = _first_of(spaces, found, len(points))
        outside = np.flatnonzero(first == np.inf)
        if outside.size:
            number = int(outside[0])
            at = self._at[number, : spaces.components].tolist()
            _refuse(f"point[{number}].at = {at}", spaces)
        mine = _numbers(spaces)[found.cells] == first[found.points]
        self._points, self._cells = found.points[mine], found.cells[mine]
        element = spaces.displacement_space.ufl_element().sub_elements[0]
        self._weights = _table(element, 0, found.references[mine])[0]
        self._nodes = spaces.displacement_space.dofmap.list[self._cells]

    def quantities(self, displacement: Array) -> dict[str, list[float]]:
        """The displacement at every point, by quantity.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        return self._summed(np.einsum("pn,pnc->pc", self._weights, displacement[self._nodes]))

    @property
    def places(self) -> list[tuple[float, ...]]:
        """Where they are (length)."""
        return [tuple(at) for at in self._at.tolist()]

    def unit_force(self, number: int, axis: int) -> Array:
        """Forces whose work is the displacement of a point along an axis, (nodes, components).

        Those of this rank's cells; the forces of all ranks add up.
        """
        nodal = np.zeros((self._count, self._shape[1]))
        for one in np.flatnonzero(self._points == number):
            np.add.at(nodal[:, axis], self._nodes[one], self._weights[one])
        return nodal

    def named(self, displacements: Array) -> dict[str, list[float]]:
        """Displacements of all points, (points, components), by quantity."""
        return dict(zip(self._names, displacements.tolist(), strict=True))

    def gradient(self, quantity: str, axis: int) -> Array:
        """Gradient of a component of one of them in the displacement; collective.

        Returns:
            At the body's nodes of this rank, (nodes, components).
        """
        found = np.zeros((len(self._spaces.coordinates), self._shape[1]))
        mine = self._points == self._names.index(quantity)
        np.add.at(found[:, axis], self._nodes[mine], self._weights[mine])
        return self._spaces.summed(found)

    def of_function(self, function: fem.Function) -> dict[str, list[float]]:
        """A function of vectors at every point, in the cell that the point counts to."""
        values = function.eval(self._at[self._points], self._cells.astype(np.int32))
        return self._summed(np.reshape(values, (len(self._points), self._shape[1])))

    def of_scalar(self, function: fem.Function) -> Array:
        """A function at every point, (points,), in the cell that it counts to; collective."""
        values = function.eval(self._at[self._points], self._cells.astype(np.int32))
        every = np.zeros(len(self._at))
        every[self._points] = np.reshape(values, len(self._points))
        return np.asarray(total(self._comm, every))

    def _summed(self, values: Array) -> dict[str, list[float]]:
        """Values at the points of this rank, by quantity and of all ranks."""
        every = np.zeros(self._shape)
        every[self._points] = values
        return self.named(np.reshape(total(self._comm, every), self._shape))


class PlacesInBody:
    """The cells that hold some places, of which others may be outside the body; collective.

    On a face between two bodies those of the body that came first in the mesh.

    Args:
        at: The places, (places, 3) (length).
        spaces: The body's.

    Attributes:
        inside: Whether a cell of any rank holds each place, (places,).
        numbers: Of the place of each pair of a place and a cell of this rank, (pairs,).
        cells: The cells of the pairs, (pairs,).
        weights: Shape functions of the displacements there, (pairs, nodes of a cell).
    """

    def __init__(self, at: Array, spaces: Spaces) -> None:
        found = _cells_with(spaces, at)
        first = _first_of(spaces, found, len(at))
        self.inside = first < np.inf
        nodes = spaces.displacement_space.dofmap.list
        parts = spaces.parts.of_node[nodes[found.cells, 0]]
        is_first = _numbers(spaces)[found.cells] == first[found.points]
        part = np.zeros(len(at))
        part[found.points[is_first]] = parts[is_first]
        part = total(spaces.comm, part)
        same = parts == part[found.points]
        self.numbers, self.cells = found.points[same], found.cells[same]
        element = spaces.displacement_space.ufl_element().sub_elements[0]
        self.weights = _table(element, 0, found.references[same])[0]


class _Found(NamedTuple):
    """Cells of this rank that hold points: a row for each pair of these.

    Attributes:
        points: Numbers of the points, (pairs,).
        cells: Numbers of the cells, (pairs,).
        references: Where the point is on the reference cell, (pairs, dimension).
    """

    points: AnyIntegers
    cells: AnyIntegers
    references: Array


def _numbers(spaces: Spaces) -> Array:
    """The number that each cell of this rank had where the mesh was made."""
    return np.asarray(spaces.body.mesh.topology.original_cell_index, dtype=np.float64)


def _first_of(spaces: Spaces, found: _Found, count: int) -> Array:
    """First number of all ranks' cells that hold a point, infinite without one; collective."""
    first = np.full(count, np.inf)
    np.minimum.at(first, found.points, _numbers(spaces)[found.cells])
    spaces.comm.Allreduce(MPI.IN_PLACE, first, op=MPI.MIN)
    return first


def _place_of(point: Point, key: str, spaces: Spaces) -> tuple[float, ...]:
    """Where a point is, by its coordinates or its name in the mesh; collective."""
    if point.at is not None:
        return point.at
    assert point.on is not None
    group = spaces.body.group(point.on, key)
    places = {end for piece in group.places for end in piece}
    if len(places) != 1:
        raise InputError(
            f"{key} = '{point.on}': is no single point; give the name of one, or its place, at"
        )
    return places.pop()


def _refuse(key: str, spaces: Spaces) -> NoReturn:
    """A point that no cell holds; collective."""
    corners = spaces.body.mesh.geometry.x.T[: spaces.components]
    least, most = ([f(spaces.comm, x) for x in corners] for f in (smallest, largest))
    raise InputError(
        f"{key}: is outside the body, which reaches from {_written(least)} to {_written(most)}"
    )


def _cells_with(spaces: Spaces, at: Array) -> _Found:
    """This rank's own cells that hold the points."""
    mesh, dimension = spaces.body.mesh, spaces.body.dimension
    nothing = np.zeros(0, dtype=np.int64)
    if not len(at):
        return _Found(nothing, nothing, np.zeros((0, dimension)))
    own = np.arange(mesh.topology.index_map(dimension).size_local, dtype=np.int32)
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)[own]][:, :, :dimension]
    parts = [_Found(nothing, nothing, np.zeros((0, dimension)))]
    if len(own):
        # Round-off is in units of the coordinates, too, for bodies far from the origin.
        bulge = _BULGE if spaces.geometry_order > 1 else _OUTSIDE
        margin = bulge * np.ptp(corners, axis=1).max() + 1e-12 * np.abs(corners).max()
        tree = geometry.bb_tree(mesh, dimension, entities=own, padding=margin)
        for start in range(0, len(at), _AT_ONCE):
            near = geometry.compute_collisions_points(tree, at[start : start + _AT_ONCE])
            points = start + np.repeat(np.arange(near.num_nodes), np.diff(near.offsets))
            parts.append(_inside(mesh, corners, at[:, :dimension], points, near.array))
    return _Found(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _inside(
    mesh: Mesh, corners: Array, at: Array, points: AnyIntegers, cells: AnyIntegers
) -> _Found:
    """The pairs of points and cells near each other whose cell really holds the point."""
    least, most = corners.min(axis=1), corners.max(axis=1)
    margin = _BULGE * (most - least)
    place, least, most = at[points], (least - margin)[cells], (most + margin)[cells]
    near = np.all((place >= least) & (place <= most), axis=1)
    points, cells = points[near], cells[near]
    references, inside = _references_of(mesh, corners[cells], at[points])
    return _Found(points[inside], cells[inside], references[inside])


def _references_of(mesh: Mesh, corners: Array, places: Array) -> tuple[Array, Flags]:
    """Where points are on the reference cells, by Newton's method, and whether they are inside.

    Args:
        mesh: Whose cells they are.
        corners: All points of each cell's geometry, (pairs, points, dimension).
        places: The points that are sought, (pairs, dimension).
    """
    element = mesh.ufl_domain().ufl_coordinate_element().sub_elements[0]
    tensor = compat.is_tensor_cell(mesh)
    dimension = places.shape[1]
    references = np.full(places.shape, 1 / 2 if tensor else 1 / (dimension + 1))
    settled = np.zeros(len(places), dtype=bool)
    active = np.arange(len(places))
    for _ in range(_NEWTON_STEPS):
        if not active.size:
            break
        table = _table(element, 1, references[active])
        reached, *slopes = (np.einsum("pn,pnd->pd", rows, corners[active]) for rows in table)
        gradients = np.stack(slopes, axis=2)
        regular = np.linalg.det(gradients) != 0
        active = active[regular]
        missing = places[active] - reached[regular]
        steps = np.linalg.solve(gradients[regular], missing[:, :, None])[:, :, 0]
        references[active] += steps
        done = np.abs(steps).max(axis=1, initial=0.0) < 1e-2 * _OUTSIDE
        settled[active[done]] = True
        active = active[~done]
    far = references.max(axis=1) - 1 if tensor else references.sum(axis=1) - 1
    beyond = np.maximum(-references.min(axis=1), far)
    return references, settled & (beyond <= _OUTSIDE)


def _table(element: FiniteElement, order: int, references: Array) -> Array:
    """Shape functions, and their slopes, at points: (1 or 1 + dimension, points, nodes)."""
    if len(references):
        return np.asarray(element.tabulate(order, references))
    # basix takes no empty list of points
    return np.zeros((1 + order * references.shape[1], 0, element.dim))


def _written(values: Sequence[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"
