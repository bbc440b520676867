"""The points of a boundary at which contact acts, and functions that live on them.

Elements of degree 1 use the vertices, intervals and quadrilaterals of degree 2 Simpson's
rule (the paper's J): the points are the nodes of the trace. On triangles of degree 2 a rule
on the nodes that integrates their shape functions has no weight at the vertices; a seventh
point at the centre gives all of them a positive one (exact to degree 3).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray

from fenics_contact import compat
from fenics_contact.mesh import Group
from fenics_contact.parallel import largest, smallest, total
from fenics_contact.spaces import Spaces

Array = NDArray[np.float64]

_NODES = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]])
_CENTRE = np.array([[1 / 3, 1 / 3]])
# Weights on the reference triangle (area 1/2): vertices, midpoints, centre.
_VERTEX, _MIDPOINT, _MIDDLE = 1 / 40, 1 / 15, 9 / 40
# The six shape functions at the centre: vertices, midpoints.
_AT_CENTRE = np.array([-1 / 9] * 3 + [4 / 9] * 3)


def _custom(points: Array, weights: Array) -> dict[str, Any]:
    return {
        "quadrature_rule": "custom",
        "quadrature_points": tuple(map(tuple, points.tolist())),
        "quadrature_weights": tuple(weights.tolist()),
        "quadrature_degree": 3,
    }


class Trace:
    """Contact points of a boundary group: its nodes, then the centres where there are any.

    Attributes:
        measure: Measure whose quadrature points these are.
        weight: UFL factor of integrals by it (2πr where axisymmetric).
        nodes: Nodes among the points (local, owned and ghost): the first of them.
        all_nodes: Nodes of the surface, also on the axis of revolution.
        coordinates: Of the points, shape (points, 3) (length).
        weights: Area that each stands for, > 0, shape (points,).
        normals: Outward unit normals, single-valued at shared nodes, (points, components).
        owned: Which points this rank counts.
    """

    def __init__(self, spaces: Spaces, group: Group) -> None:
        self.spaces = spaces
        self.group = group
        self._pieces: SurfacePieces | None = None
        self._centres = _Centres(spaces, group) if _needs_centres(spaces) else None
        nodes = spaces.nodes(group)
        self.weight = self._point_weight(nodes)
        weights, normals = self._at_nodes(nodes)
        heaviest = largest(spaces.comm, weights)
        # A point on the axis of revolution stands for no area.
        counted = weights > 1e-12 * heaviest
        self.all_nodes = nodes
        self.nodes = nodes[counted]
        self.weights, self.normals = weights[counted], normals[counted]
        self.coordinates = spaces.coordinates[self.nodes]
        self.owned = spaces.is_owned(self.nodes)
        if self._centres is not None:
            self._append(self._centres)
        # Zero-weight nodes count in quadrature sums, times zero: their normals must exist.
        self.normal = self._function_on(nodes, normals, "normal")

    def _append(self, centres: _Centres) -> None:
        self.weights = np.concatenate([self.weights, centres.weights])
        self.normals = np.concatenate([self.normals, centres.normals])
        self.coordinates = np.concatenate([self.coordinates, centres.coordinates])
        self.owned = np.concatenate([self.owned, np.ones(len(centres.weights), dtype=bool)])

    @property
    def measure(self) -> Any:
        """Measure with the points of this trace."""
        if self._centres is not None:
            weights = np.array([_VERTEX] * 3 + [_MIDPOINT] * 3 + [_MIDDLE])
            rule = _custom(np.concatenate([_NODES, _CENTRE]), weights)
        else:
            rule = self._nodal_rule()
        return self.spaces.boundary(self.group, rule)

    def _nodal_rule(self) -> dict[str, Any]:
        """A rule with positive weights on the nodes alone."""
        if self._centres is not None:
            return _custom(_NODES, np.full(6, 1 / 12))
        triangles = self.spaces.body.mesh.topology.cell_name() == "tetrahedron"
        degree = 1 if self.spaces.degree == 1 else 3
        return {"quadrature_rule": "vertex" if triangles else "GLL", "quadrature_degree": degree}

    def _point_weight(self, nodes: NDArray[np.int32]) -> Any:
        """The integrals' factor at the points.

        On linear facets of an axisymmetric model it is that which gives every vertex its
        part of the area, ∫ 2πr N_i: the vertex rule with 2πr itself would leave none to the
        axis, and its first neighbour would carry the axis' load too (+8 % pressure there).
        """
        spaces = self.spaces
        if spaces.kinematics != "axisymmetric" or spaces.degree != 1:
            return spaces.weight
        test = ufl.TestFunction(spaces.displacement_space)
        along = ufl.as_vector([1.0] * spaces.components)
        measure = spaces.boundary(self.group)
        area = spaces.assemble(fem.form(spaces.weight * ufl.dot(along, test) * measure))[:, 0]
        length = spaces.assemble(fem.form(ufl.dot(along, test) * measure))[:, 0]
        return spaces.nodal_function("weight", area[nodes] / length[nodes], nodes)

    def _at_nodes(self, nodes: NDArray[np.int32]) -> tuple[Array, Array]:
        """Areas and averaged normals of nodes, from integrals of their shape functions."""
        spaces = self.spaces
        test = ufl.TestFunction(spaces.displacement_space)
        measure = spaces.boundary(self.group, self._nodal_rule())
        ones = ufl.as_vector([1.0] * spaces.components)
        area = spaces.assemble(fem.form(self.weight * ufl.dot(ones, test) * measure))[:, 0]
        facet_normal = ufl.FacetNormal(spaces.body.mesh)
        averaged = spaces.assemble(fem.form(ufl.dot(facet_normal, test) * measure))
        lengths = np.linalg.norm(averaged, axis=1)
        normals = averaged / np.where(lengths > 0, lengths, 1.0)[:, None]
        if self._centres is not None:
            area *= self._centres.node_factor
        return area[nodes], normals[nodes]

    @property
    def nodal(self) -> bool:
        """Whether all points are nodes, so that a nodal force is that of one point."""
        return self._centres is None

    def at_points(self, nodal: Array) -> Array:
        """Values at the points of a function given at all nodes of this rank."""
        values = nodal[self.nodes]
        if self._centres is None:
            return values
        return np.concatenate([values, self._centres.interpolate(nodal)])

    def to_nodes(self, values: Array) -> Array:
        """Σ |N_i| × values over the points, at ``nodes``: what points give to nodes at most."""
        if self._centres is None:
            return values
        count = len(self.nodes)
        return values[:count] + self._centres.spread(values[count:])[self.nodes]

    def coefficient(self, values: Array) -> Any:
        """Scalars at the points in UFL: a constant where they are, else a function."""
        least = smallest(self.spaces.comm, values)
        if least == largest(self.spaces.comm, values):
            return fem.Constant(self.spaces.body.mesh, least)
        return self.function(values).ufl

    def function(self, values: Array, empty: float = 0.0) -> TraceFunction:
        """A function of values at the points, scalars (points,) or vectors."""
        function = TraceFunction(self, values.ndim == 2, empty)
        function.set(values)
        return function

    def _function_on(self, nodes: NDArray[np.int32], values: Array, name: str) -> Any:
        """A vector function of values at all nodes of the group, and the points' centres."""
        function = self.spaces.vector_function(name, values, nodes)
        if self._centres is None:
            return function
        return function + self._centres.vector_correction(function, self._centres.normals)

    def integral(self, values: Array) -> Any:
        """∫ of values at the points, first axis (points), by the trace's rule; collective."""
        weighted = np.tensordot(self.weights[self.owned], values[self.owned], axes=(0, 0))
        return total(self.spaces.comm, weighted)

    def relative_facet_size(self) -> float:
        """Largest facet over the extent of the surface; collective."""
        spaces = self.spaces
        mesh = spaces.body.mesh
        points = spaces.coordinates[spaces.nodes(self.group)].T
        extent = [largest(spaces.comm, axis) - smallest(spaces.comm, axis) for axis in points]
        facets = spaces.body.entities(self.group)
        size = largest(spaces.comm, mesh.h(mesh.topology.dim - 1, facets))
        return size / float(np.linalg.norm(extent))

    def smallest_edge(self) -> float:
        """Shortest edge of the cells at the surface (length): flat ones are stiff."""
        mesh = self.spaces.body.mesh
        topology = mesh.topology
        topology.create_entities(1)
        topology.create_connectivity(topology.dim, 1)
        topology.create_connectivity(1, topology.dim)  # which `h` asks for
        cells = np.unique(_facets(self.spaces, self.group)[:, 0])
        links = topology.connectivity(topology.dim, 1)
        edges = [np.zeros(0, dtype=np.int32), *(links.links(cell) for cell in cells)]
        return smallest(self.spaces.comm, mesh.h(1, np.unique(np.concatenate(edges))))

    @property
    def pieces(self) -> SurfacePieces:
        """This rank's facets in segments or triangles between neighbouring nodes."""
        if self._pieces is None:
            self._pieces = SurfacePieces(self)
        return self._pieces


class SurfacePieces:
    """Facets cut into flat segments (2D) or triangles (3D) between nodes.

    Attributes:
        points: Contact points at the corners, (pieces, corners); a node on the axis of
            revolution, which is none, is given its neighbour.
        corners: Coordinates, (pieces, corners, 3) (length).
        areas: Length or area of each, (pieces,).
        weights: Factor of the integral at the corners (2πr where axisymmetric), (pieces, corners).
    """

    def __init__(self, trace: Trace) -> None:
        spaces = trace.spaces
        facets = _facets(spaces, trace.group)
        nodes = _facet_pieces(spaces, facets)
        point_of = np.full(len(spaces.coordinates), -1)
        point_of[trace.nodes] = np.arange(len(trace.nodes))
        points = point_of[nodes]
        self.points = np.where(points < 0, points.max(axis=1, initial=0)[:, None], points)
        self.corners = spaces.coordinates[nodes]
        edges = self.corners[:, 1:] - self.corners[:, :1]
        if edges.shape[1] == 1:
            self.areas = np.linalg.norm(edges[:, 0], axis=1)
        else:
            self.areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        radii = self.corners[:, :, 0]
        axisymmetric = spaces.kinematics == "axisymmetric"
        self.weights = 2 * np.pi * radii if axisymmetric else np.ones_like(radii)


def _facet_pieces(spaces: Spaces, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Nodes of the segments or triangles of facets, (pieces, corners)."""
    from scipy.spatial import Delaunay

    layout = spaces.displacement_space.dofmap.dof_layout
    reference = compat.interpolation_points(
        fem.functionspace(spaces.body.mesh, ("Lagrange", spaces.degree)).element
    )
    dimension = spaces.body.dimension
    found = [np.zeros((0, dimension), dtype=np.int32)]
    for facet in np.unique(facets[:, 1]):
        dofs = np.array(layout.entity_closure_dofs(dimension - 1, int(facet)))
        points = reference[dofs] - reference[dofs].mean(axis=0)
        # Coordinates within the facet: its principal directions.
        inside = points @ np.linalg.svd(points)[2][: dimension - 1].T
        if dimension == 2:
            order = np.argsort(inside[:, 0])
            pieces = np.stack([order[:-1], order[1:]], axis=1)
        else:
            pieces = Delaunay(inside).simplices
        cells = facets[facets[:, 1] == facet, 0]
        nodes = spaces.displacement_space.dofmap.list[cells][:, dofs]
        found.append(nodes[:, pieces].reshape(-1, dimension))
    return np.concatenate(found)


class TraceFunction:
    """A settable function of values at the points of a trace.

    Attributes:
        ufl: What stands in forms.
    """

    def __init__(self, trace: Trace, is_vector: bool, empty: float = 0.0) -> None:
        self._trace = trace
        spaces, centres = trace.spaces, trace._centres
        no_values, no_nodes = np.zeros(0), np.zeros(0, dtype=np.int32)
        if is_vector:
            self._nodal = fem.Function(spaces.displacement_space)
            self._bubble = fem.Function(centres.vector_space) if centres else None
        else:
            self._nodal = spaces.nodal_function("values", no_values, no_nodes, empty)
            self._bubble = fem.Function(centres.scalar_space) if centres else None
        self.ufl = self._nodal if self._bubble is None else self._nodal + self._bubble

    def set(self, values: Array) -> None:
        """Give it values at the points."""
        trace = self._trace
        count = len(trace.nodes)
        components = trace.spaces.components
        if values.ndim == 2:
            array = self._nodal.x.array.reshape(-1, components)
            array[trace.nodes] = values[:count]
        else:
            trace.spaces.set_nodal(self._nodal, values[:count], trace.nodes)
        if self._bubble is None:
            return
        centres = trace._centres
        assert centres is not None
        centres.set_correction(self._nodal, self._bubble, values[count:])


def _needs_centres(spaces: Spaces) -> bool:
    return spaces.degree == 2 and spaces.body.mesh.topology.cell_name() == "tetrahedron"


def _facets(spaces: Spaces, group: Group) -> NDArray[np.int32]:
    """(cell, local facet) of this rank's facets of a group, shape (facets, 2)."""
    found = compat.boundary_entities(spaces.body.mesh.topology, spaces.body.entities(group))
    return np.asarray(found).reshape(-1, 2)


class _Centres:
    """Centres of this rank's facets, on tetrahedra of degree 2.

    A cubic function has one dof at the centre of each facet, whose shape function vanishes
    at all nodes of degree 2: it carries the seventh value.
    """

    def __init__(self, spaces: Spaces, group: Group) -> None:
        self._spaces = spaces
        mesh = spaces.body.mesh
        facets = _facets(spaces, group)
        quadratic = spaces.displacement_space.dofmap
        self.scalar_space = fem.functionspace(mesh, ("Lagrange", 3))
        self.vector_space = fem.functionspace(mesh, ("Lagrange", 3, (3,)))
        self.nodes = _facet_dofs(quadratic, facets, closure=True).reshape(-1, 6)
        self._scalar_dofs = _facet_dofs(self.scalar_space.dofmap, facets, closure=False)
        self._vector_dofs = _facet_dofs(self.vector_space.dofmap, facets, closure=False)
        self.coordinates = self.scalar_space.tabulate_dof_coordinates()[self._scalar_dofs]
        measure = spaces.boundary(group, _custom(_CENTRE, np.array([_MIDDLE])))
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
