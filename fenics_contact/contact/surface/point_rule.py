"""The contact points of a surface: their rule, centres of facets, functions of values at them.

The rule whose points are the contact points, and the factor of integrals by it. Elements of degree
1 use the vertices, intervals and quadrilaterals of degree 2 Simpson's rule (the paper's J): the
points are the nodes of the trace. On triangles of degree 2 a rule on the nodes that integrates
their shape functions has no weight at the vertices; a seventh point at the centre gives all of
them a positive one (exact to degree 3).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import Form as CompiledForm
from dolfinx.fem import Function, FunctionSpace
from dolfinx.mesh import compute_midpoints
from numpy.typing import NDArray
from ufl import Measure
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.contact.surface.space import Rule, SurfaceSpace

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


# Radius over the largest coordinate, up to which a point lies on the axis of revolution.
_ON_AXIS = 1e-12


def needs_centres(spaces: Spaces) -> bool:
    """Whether facets have a point at their centre, which is no node."""
    return spaces.degree == 2 and spaces.body.mesh.topology.cell_name() == "tetrahedron"


def nodal_rule(spaces: Spaces) -> Rule:
    """A rule with positive weights on the nodes alone."""
    if needs_centres(spaces):
        return SIX_NODES
    triangles = spaces.body.mesh.topology.cell_name() == "tetrahedron"
    degree = 1 if spaces.degree == 1 else 3
    return {"quadrature_rule": "vertex" if triangles else "GLL", "quadrature_degree": degree}


def node_form(surface: SurfaceSpace, weight: Expr | float, measure: Measure) -> CompiledForm:
    """∫ N_i of the shape function of every node, in each component."""
    test = ufl.TestFunction(surface.space)
    along = ufl.as_vector([1.0] * surface.components)
    return form_cache.form(weight * ufl.dot(along, test) * measure)


def node_integrals(surface: SurfaceSpace, weight: Expr | float, measure: Measure) -> Array:
    """∫ N_i of the shape function of every node, (nodes,); collective."""
    return surface.assemble(node_form(surface, weight, measure))[:, 0]


def point_weight(surface: SurfaceSpace) -> Expr | float:
    """The integrals' factor at the points; collective.

    On linear facets of an axisymmetric model it is that which gives every vertex its
    part of the area, ∫ 2πr N_i: the vertex rule with 2πr itself would leave none to the
    axis, and its first neighbour would carry the axis' load too (+8 % pressure there).

    On other ones it is 2πr, and exactly 0 on the axis: what is no point has no obstacle either,
    and round-off of r would press it.
    """
    spaces = surface.spaces
    if spaces.kinematics != "axisymmetric":
        return surface.weight
    if spaces.degree != 1:
        least = fem.Constant(surface.mesh, _ON_AXIS * surface.farthest())
        return ufl.conditional(ufl.gt(surface.position[0], least), surface.weight, 0.0)
    measure = surface.measure()
    area = node_integrals(surface, surface.weight, measure)
    return surface.scalar_function(area / node_integrals(surface, 1.0, measure), "weight")


class TraceFunction:
    """A function of values at the nodes, and at the centres of facets where these are points.

    It is made when forms first ask for it: laws that are evaluated point by point never do.

    Args:
        surface: The surface.
        numbers: Nodes of the surface that are points.
        centres: Points that are no nodes; None where there are none.
        is_vector: Whether values are (points, components), not (points,).
        empty: Value at nodes that are no points.
    """

    def __init__(
        self,
        surface: SurfaceSpace,
        numbers: AnyIntegers,
        centres: FacetCentres | None,
        is_vector: bool,
        empty: float = 0.0,
    ) -> None:
        self._surface, self._numbers, self._centres = surface, numbers, centres
        self._is_vector, self._empty = is_vector, empty
        self._values = np.zeros(0)
        self._nodal: Function | None = None
        self._bubble: Function | None = None

    @cached_property
    def ufl(self) -> Expr:
        """The function in UFL, for forms."""
        surface, centres = self._surface, self._centres
        self._nodal = Function(surface.space if self._is_vector else surface.scalar_space)
        found: Expr = self._nodal
        if centres is not None:
            space = centres.vector_space if self._is_vector else centres.scalar_space
            self._bubble = Function(space)
            found = self._nodal + self._bubble
        self._fill(self._nodal)
        return found

    def set(self, values: Array) -> None:
        """Give it values at the points."""
        self._values = values.copy()
        if self._nodal is not None:
            self._fill(self._nodal)

    def _fill(self, nodal: Function) -> None:
        surface, values, count = self._surface, self._values, len(self._numbers)
        nodes = len(surface.coordinates)
        at_nodes = np.full((nodes, surface.components) if self._is_vector else nodes, self._empty)
        at_nodes[self._numbers] = values[:count]
        if self._is_vector:
            nodal.x.array[:] = at_nodes.reshape(-1)
        else:
            surface.set_scalars(nodal, at_nodes)
        if self._centres is not None:
            assert self._bubble is not None
            self._centres.set_correction(nodal, self._bubble, values[count:])
