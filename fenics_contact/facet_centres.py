"""The seventh contact point of triangles of degree 2, at the centre of the facet.

A rule on the six nodes that integrates their shape functions has no weight at the vertices;
with the centre all are positive, and the rule is exact to degree 3.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray

from fenics_contact.mesh import Group
from fenics_contact.spaces import Spaces

Array = NDArray[np.float64]

_NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]])
_CENTRE = np.array([[1 / 3, 1 / 3]])
# Weights on the reference triangle (area 1/2): vertices, midpoints, centre.
_VERTEX, _MIDPOINT, _MIDDLE = 1 / 40, 1 / 15, 9 / 40
# The six shape functions at the centre: vertices, midpoints.
_AT_CENTRE = np.array([-1 / 9] * 3 + [4 / 9] * 3)


def custom_rule(points: Array, weights: Array) -> dict[str, Any]:
    """Metadata of a measure with the given points on the reference facet, (points, 2)."""
    return {
        "quadrature_rule": "custom",
        "quadrature_points": tuple(map(tuple, points.tolist())),
        "quadrature_weights": tuple(weights.tolist()),
        "quadrature_degree": 3,
    }


SEVEN_POINTS = custom_rule(
    np.concatenate([_NODES, _CENTRE]), np.array([_VERTEX] * 3 + [_MIDPOINT] * 3 + [_MIDDLE])
)
# Equal weights, to tell the nodes' areas apart by their kind.
SIX_NODES = custom_rule(_NODES, np.full(6, 1 / 12))


class FacetCentres:
    """Centres of this rank's facets, on tetrahedra of degree 2.

    A cubic function has one dof at the centre of each facet, whose shape function vanishes
    at all nodes of degree 2: it carries the seventh value.
    """

    def __init__(self, spaces: Spaces, group: Group) -> None:
        self._spaces = spaces
        mesh = spaces.body.mesh
        facets = spaces.facets(group)
        quadratic = spaces.displacement_space.dofmap
        self.scalar_space = fem.functionspace(mesh, ("Lagrange", 3))
        self.vector_space = fem.functionspace(mesh, ("Lagrange", 3, (3,)))
        self.nodes = _facet_dofs(quadratic, facets, closure=True).reshape(-1, 6)
        self._scalar_dofs = _facet_dofs(self.scalar_space.dofmap, facets, closure=False)
        self._vector_dofs = _facet_dofs(self.vector_space.dofmap, facets, closure=False)
        self.coordinates = self.scalar_space.tabulate_dof_coordinates()[self._scalar_dofs]
        measure = spaces.boundary(group, custom_rule(_CENTRE, np.array([_MIDDLE])))
        weights = self._assemble(self.scalar_space, 1.0, measure)
        self.weights = weights[self._scalar_dofs, 0]
        normals = self._assemble(self.vector_space, ufl.FacetNormal(mesh), measure)
        normals = normals[self._vector_dofs]
        self.normals = normals / np.linalg.norm(normals, axis=1)[:, None]
        # From equal weights on the six nodes to those of the rule.
        self.node_factor = np.full(len(spaces.coordinates), 12 * _MIDPOINT)
        vertices = np.zeros(len(spaces.coordinates))
        vertices[self.nodes[:, :3]] = 1.0
        self.node_factor[self._reduced(vertices) > 0] = 12 * _VERTEX

    def _assemble(self, space: Any, integrand: Any, measure: Any) -> Array:
        test = ufl.TestFunction(space)
        vector = fem.assemble_vector(fem.form(ufl.inner(integrand, test) * measure))
        return vector.array.reshape(-1, space.dofmap.bs)

    def interpolate(self, nodal: Array) -> Array:
        """Values at the centres of a function given at all nodes."""
        return np.tensordot(nodal[self.nodes], _AT_CENTRE, axes=(1, 0))

    def spread(self, values: Array) -> Array:
        """Σ |N_i| × values over the centres, at all nodes of this rank; collective."""
        nodal = np.zeros(len(self._spaces.coordinates))
        np.add.at(nodal, self.nodes, values[:, None] * np.abs(_AT_CENTRE))
        return self._reduced(nodal)

    def _reduced(self, nodal: Array) -> Array:
        """Contributions of all ranks added up at shared nodes; collective."""
        vector = la.vector(self._spaces.displacement_space.dofmap.index_map, 1)
        vector.array[:] = nodal
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        return vector.array.copy()

    def vector_correction(self, nodal: Any, values: Array) -> Any:
        """A cubic function that brings a quadratic one to given values at the centres."""
        bubble = fem.Function(self.vector_space)
        self.set_correction(nodal, bubble, values)
        return bubble

    def set_correction(self, nodal: Any, bubble: Any, values: Array) -> None:
        """Set a cubic function so that its sum with a quadratic one has given values."""
        if values.ndim == 2:
            present = self.interpolate(nodal.x.array.reshape(-1, 3))
            bubble.x.array.reshape(-1, 3)[self._vector_dofs] = values - present
        else:
            node_values = self._spaces.nodal_values(nodal)
            bubble.x.array[self._scalar_dofs] = values - self.interpolate(node_values)


def _facet_dofs(dofmap: Any, facets: NDArray[np.int32], closure: bool) -> NDArray[np.int32]:
    """Dofs of facets: with their vertices and edges (in this order), or their own alone."""
    layout = dofmap.dof_layout
    of_facet = layout.entity_closure_dofs if closure else layout.entity_dofs
    positions = np.array([of_facet(2, facet) for facet in range(4)])
    return dofmap.list[facets[:, 0]][np.arange(len(facets))[:, None], positions[facets[:, 1]]][
        :, slice(None) if closure else 0
    ]
