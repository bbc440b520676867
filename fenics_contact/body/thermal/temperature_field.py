"""Temperatures that vary in space, as polynomials in each cell of a body."""

from __future__ import annotations

from typing import Any

import numpy as np
from dolfinx import fem

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.mesh.readers.field_values import load_field
from fenics_contact.scene.loading.temperatures import Temperature


class CellProjection:
    """Projects fields to one degree below the displacements', cell by cell.

    By least squares on the reference cell, so that a polynomial of that degree stays what it is.

    Attributes:
        space: Of the projections.

    Args:
        spaces: Those of the body.
        cells: Of this rank; in all others fields are 0.
    """

    def __init__(self, spaces: Spaces, cells: Integers) -> None:
        mesh = spaces.body.mesh
        self._spaces, self._cells = spaces, cells
        self.space = fem.functionspace(mesh, ("DG", spaces.degree - 1))
        self._points, weights = compat.quadrature_rule(mesh, spaces.bulk_degree)
        table = _table(self.space.ufl_element(), self._points)
        weighted = table.T * weights
        self._onto = np.linalg.solve(weighted @ table, weighted)

    @property
    def places(self) -> Array:
        """Where fields are asked for, (places, 3) (length)."""
        mesh = self._spaces.body.mesh
        geometry = mesh.ufl_domain().ufl_coordinate_element().sub_elements[0]
        corners = mesh.geometry.x[compat.geometry_nodes(mesh)[self._cells]]
        shapes = _table(geometry, self._points)
        return np.asarray(np.einsum("qn,cnd->cqd", shapes, corners).reshape(-1, 3))

    def of_places(self, values: Array) -> fem.Function:
        """The projection of values at ``places``."""
        found = values.reshape(len(self._cells), len(self._points))
        function = fem.Function(self.space)
        function.x.array[self.space.dofmap.list[self._cells]] = found @ self._onto.T
        return function

    def of_nodes(self, nodal: Array) -> fem.Function:
        """The projection of a field by its values at the nodes of the displacements, (nodes,)."""
        nodes = self._spaces.displacement_space.dofmap.list[self._cells]
        return self.of_places(nodal[nodes] @ self._of_nodes.T)

    def transposed(self, values: Array) -> Array:
        """From values at the dofs of projections to those at the nodes, by own cells alone.

        Args:
            values: At the dofs of this rank.

        Returns:
            At the nodes of this rank, each with the share of this rank's cells, (nodes,).
        """
        body = self._spaces.body
        owned = body.mesh.topology.index_map(body.dimension).size_local
        cells = self._cells[self._cells < owned]
        by_cell = values[self.space.dofmap.list[cells]] @ self._onto @ self._of_nodes
        found = np.zeros(len(self._spaces.coordinates))
        np.add.at(found, self._spaces.displacement_space.dofmap.list[cells], by_cell)
        return found

    @property
    def _of_nodes(self) -> Array:
        """From values at the nodes of a cell to those at its points, (points, nodes)."""
        element = self._spaces.displacement_space.ufl_element().sub_elements[0]
        return _table(element, self._points)


def temperatures_at(given: Temperature, places: Array, key: str, spaces: Spaces) -> Array:
    """A temperature of a scene at places, once its path is 1; collective.

    Args:
        given: As in the scene.
        places: (places, 3) (length).
        key: Of the temperature, for messages.
        spaces: Those of the body.

    Returns:
        (places,) (temperature).

    Raises:
        InputError: On every rank; a function or a file of it fails.
    """
    if given.value is not None:
        return spaces.evaluate_at(given.value, places.T, f"{key}.value")
    assert given.file is not None
    field = load_field(given.file, given.field, key, spaces.comm)
    return field.at(places, spaces.components, spaces.comm)


def _table(element: Any, points: Array) -> Array:
    """Values of the shape functions of a scalar element, (points, functions)."""
    return np.asarray(element.tabulate(0, points)[0])
