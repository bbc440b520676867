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


def projected(
    given: Temperature, reference: float, key: str, spaces: Spaces, cells: Integers
) -> fem.Function:
    """A temperature less the reference, projected to one degree below the displacements'.

    The projection is that of least squares on the reference cell, so that a polynomial of that
    degree stays what it is. Collective.

    Args:
        given: As in the scene.
        reference: To be taken off (temperature).
        key: Of the temperature, for messages.
        spaces: Those of the body.
        cells: Of this rank; in all others it is 0.

    Raises:
        InputError: On every rank; a function or a file of it fails.
    """
    mesh, degree = spaces.body.mesh, spaces.degree - 1
    space = fem.functionspace(mesh, ("DG", degree))
    points, weights = compat.quadrature_rule(mesh, spaces.bulk_degree)
    geometry = mesh.ufl_domain().ufl_coordinate_element()
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)[cells]]
    shapes = _table(geometry.sub_elements[0], points)
    places = np.einsum("qn,cnd->cqd", shapes, corners)
    found = temperatures_at(given, places.reshape(-1, 3), key, spaces) - reference
    table = _table(space.ufl_element(), points)
    weighted = table.T * weights
    values = np.linalg.solve(weighted @ table, weighted @ found.reshape(len(cells), len(points)).T)
    function = fem.Function(space)
    function.x.array[space.dofmap.list[cells]] = values.T
    return function


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
