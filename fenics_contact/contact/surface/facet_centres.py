"""The seventh contact point of triangles of degree 2, at the centre of the facet.

A rule on the six nodes that integrates their shape functions has no weight at the vertices;
with the centre all are positive, and the rule is exact to degree 3.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import compute_midpoints
from numpy.typing import NDArray

from fenics_contact.body.forms import Function, FunctionSpace, Rule
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.surface.space import SurfaceSpace

_NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]])
_CENTRE = np.array([[1 / 3, 1 / 3]])
# Weights on the reference triangle (area 1/2): vertices, midpoints, centre.
_VERTEX, _MIDPOINT, _MIDDLE = 1 / 40, 1 / 15, 9 / 40
# The six shape functions at the centre: vertices, midpoints.
AT_CENTRE = np.array([-1 / 9] * 3 + [4 / 9] * 3)


def custom_rule(points: Array, weights: Array) -> Rule:
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
# Steps of ``fitted``, each of which takes .462 of what is left: 2e-13 of it is left in the end. On
# one facet, so on all, its matrix lies between the nodes' weights and 10/3 of these.
_FITTING_STEPS, _FITTING_FACTOR = 38, 2 / (1 + 10 / 3)
# Equal weights, to tell the nodes' areas apart by their kind.
SIX_NODES = custom_rule(_NODES, np.full(6, 1 / 12))


class FacetCentres:
    """Centres of this rank's facets, on tetrahedra of degree 2.

    A cubic function has one dof at the centre of each facet, whose shape function vanishes
    at all nodes of degree 2: it carries the seventh value.
    """

    def __init__(self, surface: SurfaceSpace) -> None:
        self._surface = surface
        mesh = surface.mesh
        self.scalar_space = fem.functionspace(mesh, ("Lagrange", 3))
        self.vector_space = fem.functionspace(mesh, ("Lagrange", 3, (3,)))
        self.nodes = surface.facet_nodes
        self._scalar_dofs = _centre_dofs(self.scalar_space)
        self._vector_dofs = _centre_dofs(self.vector_space)
        self.coordinates = self.scalar_space.tabulate_dof_coordinates()[self._scalar_dofs]
        measure = surface.measure(custom_rule(_CENTRE, np.array([_MIDDLE])))
        test = ufl.TestFunction(self.scalar_space)
        weights = fem.assemble_vector(form_cache.form(test * measure))
        self.weights = np.array(weights.array[self._scalar_dofs])
        self.normals = self._outward_normals()
        # From equal weights on the six nodes to those of the rule.
        self.node_factor = np.full(len(surface.coordinates), 12 * _MIDPOINT)
        vertices = np.zeros(len(surface.coordinates))
        vertices[self.nodes[:, :3]] = 1.0
        self.node_factor[surface.summed(vertices) > 0] = 12 * _VERTEX

    def _outward_normals(self) -> Array:
        """Unit normals at the centres, away from the cells behind the facets."""
        surface = self._surface
        jacobian = ufl.Jacobian(surface.mesh)
        across = ufl.cross(jacobian[:, 0], jacobian[:, 1])
        facets = np.arange(len(self.nodes), dtype=np.int32)
        normals = form_cache.expression(across, _CENTRE).eval(surface.mesh, facets).reshape(-1, 3)
        cells = np.ascontiguousarray(surface.parents[:, 0])
        behind = compute_midpoints(surface.spaces.body.mesh, 3, cells)
        outward = np.sign(np.einsum("ij,ij->i", normals, self.coordinates - behind))
        return np.asarray(normals * (outward / np.linalg.norm(normals, axis=1))[:, None])

    def interpolate(self, nodal: Array) -> Array:
        """Values at the centres of a function given at all nodes."""
        return np.tensordot(nodal[self.nodes], AT_CENTRE, axes=(1, 0))

    def collected(self, values: Array) -> Array:
        """Σ N_i × vectors (centres, components), at all nodes of this rank; collective."""
        nodal = np.zeros((len(self._surface.coordinates), values.shape[1]))
        np.add.at(nodal, self.nodes, values[:, None, :] * AT_CENTRE[:, None])
        return self._surface.summed(nodal)

    def spread(self, values: Array) -> Array:
        """Σ |N_i| × values over the centres, at all nodes of this rank; collective."""
        nodal = np.zeros(len(self._surface.coordinates))
        np.add.at(nodal, self.nodes, values[:, None] * np.abs(AT_CENTRE))
        return self._surface.summed(nodal)

    def fitted(self, values: Array, weights: Array, within: Flags) -> Array:
        """The nearest function of the facets' space to scalars at nodes and centres; collective.

        In the least squares of the points' weights, so that the sums of the values with every
        shape function stay as they are.

        Args:
            values: At all nodes, then at the centres, (points,).
            weights: Areas of these, (points,).
            within: Facets whose centres count; the others keep their values, (facets,).

        Returns:
            Values at the same points, (points,).
        """
        count, found = len(self._surface.coordinates), values.copy()
        used = np.zeros(count, dtype=bool)
        used[self.nodes[within]] = True
        nodal = np.where(used, values[:count], 0.0)
        missing = np.where(within, values[count:] - self.interpolate(nodal), 0.0)
        shift = np.zeros(count)
        for _ in range(_FITTING_STEPS):
            left = np.where(within, missing - self.interpolate(shift), 0.0) * weights[count:]
            forces = self.collected(left[:, None])[:, 0]
            shift += _FITTING_FACTOR * (forces / weights[:count] - shift)
        found[:count] += shift
        found[count:][within] = self.interpolate(nodal + shift)[within]
        return found

    def vector_correction(self, nodal: Function, values: Array) -> Function:
        """A cubic function that brings a quadratic one to given values at the centres."""
        bubble = Function(self.vector_space)
        self.set_correction(nodal, bubble, values)
        return bubble

    def set_correction(self, nodal: Function, bubble: Function, values: Array) -> None:
        """Set a cubic function so that its sum with a quadratic one has given values."""
        if values.ndim == 2:
            present = self.interpolate(nodal.x.array.reshape(-1, 3))
            bubble.x.array.reshape(-1, 3)[self._vector_dofs] = values - present
        else:
            present = self.interpolate(self._surface.scalars(nodal))
            bubble.x.array[self._scalar_dofs] = values - present


def _centre_dofs(space: FunctionSpace) -> NDArray[np.int32]:
    """The dof of each facet that lies inside it."""
    position = space.dofmap.dof_layout.entity_dofs(2, 0)[0]
    return np.asarray(space.dofmap.list[:, position])
