"""The points of a boundary at which contact acts, and functions that live on them.

Elements of degree 1 use the vertices, intervals and quadrilaterals of degree 2 Simpson's
rule (the paper's J): the points are the nodes of the trace. On triangles of degree 2 a rule
on the nodes that integrates their shape functions has no weight at the vertices; a seventh
point at the centre gives all of them a positive one (exact to degree 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, largest, smallest, total
from fenics_contact.contact.surface.facet_centres import SEVEN_POINTS, SIX_NODES, FacetCentres
from fenics_contact.contact.surface.pieces import SurfacePieces
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.mesh.tagged_mesh import Group

# Cosine of half the largest angle between neighbouring facets of one surface.
_SHARP = float(np.cos(np.pi / 8))
# Radius over the largest coordinate, up to which a point lies on the axis of revolution.
_ON_AXIS = 1e-12


class Trace:
    """Contact points of a boundary group: its nodes, then the centres where there are any.

    Attributes:
        measure: Measure whose quadrature points these are.
        weight: UFL factor of integrals by it (2πr where axisymmetric).
        surface: The space of functions on it.
        numbers: Nodes of the surface among the points: the first of them.
        nodes: The same, by the body's local numbers.
        all_nodes: The body's numbers of all nodes of the surface, also on the axis of revolution.
        coordinates: Of the points, shape (points, 3) (length).
        weights: Area that each stands for, > 0, shape (points,).
        normals: Outward unit normals, single-valued at shared nodes, (points, components).
        normals_at_nodes: Those of the surface itself, at all of its nodes.
        mean_normal: Mean of the outward unit normal over the surface, of a full revolution where
            axisymmetric, (components,); shorter the more the surface wraps around.
        area: Of the surface.
        owned: Which points this rank counts.
    """

    def __init__(
        self, spaces: Spaces, group: Group, flat_sides: Sequence[tuple[int, float]] = ()
    ) -> None:
        self.spaces = spaces
        self.group = group
        self.surface = SurfaceSpace(spaces, group)
        self._pieces: SurfacePieces | None = None
        self._centres = FacetCentres(self.surface) if _needs_centres(spaces) else None
        self.weight = self._point_weight()
        weights, normals = self._at_nodes()
        self._flat_sides = flat_sides
        self.mirror(normals)
        heaviest = largest(spaces.comm, weights)
        # A point on the axis of revolution stands for no area.
        self.numbers = np.flatnonzero(weights > 1e-12 * heaviest)
        self.all_nodes = self.surface.body_nodes
        self.nodes = self.all_nodes[self.numbers]
        self.weights, self.normals = weights[self.numbers], normals[self.numbers]
        self.coordinates = self.surface.coordinates[self.numbers]
        self.owned = self.numbers < self.surface.owned_nodes
        # Zero-weight nodes count in quadrature sums, times zero: their normals must exist.
        self.normals_at_nodes = normals
        self._nodal_normal = self.surface.vector_function(normals, "normal")
        self.normal = self._nodal_normal
        if self._centres is not None:
            self._append(self._centres)
            centred = self._centres.vector_correction(self.normal, self._centres.normals)
            self._centred_normal = centred
            self.normal += centred
        self._counted: Any = None
        self._area_form: Any = None
        self._whole_weights = self.weights
        self.area = float(self.integral(np.ones(len(self.weights))))

    def _append(self, centres: FacetCentres) -> None:
        self.weights = np.concatenate([self.weights, centres.weights])
        self.normals = np.concatenate([self.normals, centres.normals])
        self.coordinates = np.concatenate([self.coordinates, centres.coordinates])
        self.owned = np.concatenate([self.owned, np.ones(len(centres.weights), dtype=bool)])

    @property
    def centres(self) -> Array:
        """Points that are no nodes, one a facet of this rank, (centres, 3); mostly none."""
        return np.asarray(self.coordinates[len(self.nodes) :])

    def turn(self, normals: Array, at_centres: Array) -> None:
        """Take other normals, as those between two bodies are; forms follow.

        Args:
            normals: Unit normals at all nodes, (nodes, components).
            at_centres: Likewise, at ``centres``.
        """
        self.normals = np.concatenate([normals[self.numbers], at_centres])
        self._nodal_normal.x.array[:] = normals.reshape(-1)
        if self._centres is not None:
            self._centres.set_correction(self._nodal_normal, self._centred_normal, at_centres)

    def count(self, shares: Array) -> Flags:
        """Let only a share of each facet of this rank count from now on; forms follow; collective.

        Args:
            shares: 0 … 1, (facets,).

        Returns:
            Points that stand for any area; the others keep their weights, and are to be idle.
        """
        if self._counted is None:
            space = fem.functionspace(self.surface.mesh, ("DG", 0))
            self._counted = fem.Function(space)
            self.weight = self.weight * self._counted
            test = ufl.TestFunction(self.surface.space)
            along = ufl.as_vector([1.0] * self.surface.components)
            measure = self.surface.measure(self._nodal_rule())
            self._area_form = form_cache.form(self.weight * ufl.dot(along, test) * measure)
        cells = self._counted.function_space.dofmap.list[: len(shares), 0]
        self._counted.x.array[cells] = shares
        weights = self.surface.assemble(self._area_form)[:, 0]
        if self._centres is not None:
            weights = weights * self._centres.node_factor
        weights = weights[self.numbers]
        if self._centres is not None:
            weights = np.concatenate([weights, self._centres.weights * shares])
        counts = weights > 1e-6 * self._whole_weights
        self.weights = np.where(counts, weights, self._whole_weights)
        return counts

    @property
    def measure(self) -> Any:
        """Measure with the points of this trace."""
        rule = self._nodal_rule() if self._centres is None else SEVEN_POINTS
        return self.surface.measure(rule)

    def _nodal_rule(self) -> dict[str, Any]:
        """A rule with positive weights on the nodes alone."""
        if self._centres is not None:
            return SIX_NODES
        triangles = self.spaces.body.mesh.topology.cell_name() == "tetrahedron"
        degree = 1 if self.spaces.degree == 1 else 3
        return {"quadrature_rule": "vertex" if triangles else "GLL", "quadrature_degree": degree}

    def _point_weight(self) -> Any:
        """The integrals' factor at the points.

        On linear facets of an axisymmetric model it is that which gives every vertex its
        part of the area, ∫ 2πr N_i: the vertex rule with 2πr itself would leave none to the
        axis, and its first neighbour would carry the axis' load too (+8 % pressure there).

        On other ones it is 2πr, and exactly 0 on the axis: what is no point has no obstacle either,
        and round-off of r would press it.
        """
        surface, spaces = self.surface, self.spaces
        if spaces.kinematics != "axisymmetric":
            return surface.weight
        if spaces.degree != 1:
            least = fem.Constant(surface.mesh, _ON_AXIS * self.farthest())
            return ufl.conditional(ufl.gt(surface.position[0], least), surface.weight, 0.0)
        measure = surface.measure()
        area = self._integrals(surface.weight, measure)
        return surface.scalar_function(area / self._integrals(1.0, measure), "weight")

    def _integrals(self, weight: Any, measure: Any) -> Array:
        """∫ N_i of the shape function of every node; collective."""
        test = ufl.TestFunction(self.surface.space)
        along = ufl.as_vector([1.0] * self.surface.components)
        return self.surface.assemble(form_cache.form(weight * ufl.dot(along, test) * measure))[:, 0]

    def _at_nodes(self) -> tuple[Array, Array]:
        """Areas and averaged normals of all nodes, from integrals of their shape functions."""
        spaces = self.spaces
        measure = self.surface.measure(self._nodal_rule())
        area, bare = self._integrals(self.weight, measure), self._integrals(1.0, measure)
        test = ufl.TestFunction(spaces.displacement_space)
        outward = ufl.dot(ufl.FacetNormal(spaces.body.mesh), test)
        boundary = spaces.boundary(self.group, self._nodal_rule())
        averaged = spaces.assemble(form_cache.form(outward * boundary))[self.surface.body_nodes]
        lengths = np.linalg.norm(averaged, axis=1)
        self.mean_normal = self._mean(averaged, bare)
        # 1 on a flat surface; the cosine of half the angle at an edge between two facets.
        self._flatness = lengths / np.where(bare > 0, bare, 1.0)
        if self._centres is not None:
            area = area * self._centres.node_factor
        return area, averaged / np.where(lengths > 0, lengths, 1.0)[:, None]

    def _mean(self, normals: Array, areas: Array) -> Array:
        """∫ n over ∫ 1, from their integrals with the nodes' shape functions; collective."""
        owned = slice(0, self.surface.owned_nodes)
        rows = np.column_stack([normals, areas])[owned]
        axisymmetric = self.spaces.kinematics == "axisymmetric"
        if axisymmetric:  # the radius is linear on a straight facet, and so is what it weighs
            rows = rows * self.surface.coordinates[owned, :1]
        summed: Array = total(self.spaces.comm, rows.sum(axis=0))
        if axisymmetric:  # over a revolution radial ones cancel
            summed[0] = 0.0
        return np.asarray(summed[:-1] / summed[-1])

    @property
    def mirrored_axes(self) -> list[int]:
        """Axes across planes of symmetry, and across the axis of revolution."""
        return sorted({axis for axis, _ in self._flat_sides})

    def in_planes(self) -> Flags:
        """Across which axes nodes lie in planes of symmetry, (nodes, components); collective."""
        found = np.zeros((len(self.surface.coordinates), self.surface.components), dtype=bool)
        size = self.extent()
        for axis, at in self._flat_sides:
            found[:, axis] |= np.abs(self.surface.coordinates[:, axis] - at) <= 1e-9 * size
        return found

    def cut_axes(self) -> list[int]:
        """Axes across planes of symmetry that the surface ends in, and the radius; collective.

        The rest of a surface lies behind such a plane. One that does not reach it has a mirror
        image of its own there.
        """
        owned = slice(0, self.surface.owned_nodes)
        found = total(self.spaces.comm, self.in_planes()[owned].sum(axis=0)) > 0
        if self.spaces.kinematics == "axisymmetric":
            found[0] = True
        return [int(axis) for axis in np.flatnonzero(found)]

    def mirror(self, normals: Array) -> None:
        """In a plane of symmetry, or on the axis, normals have no part across it; collective.

        The average over one side alone would be tilted where the surface is curved.
        """
        normals[self.in_planes()] = 0.0
        lengths = np.linalg.norm(normals, axis=1)
        normals /= np.where(lengths > 0, lengths, 1.0)[:, None]

    def sharp_corner(self) -> Array | None:
        """A point where facets meet at more than 45°, the same on every rank; or None."""
        sharp = (self._flatness < _SHARP) & (self._flatness > 0)
        rows = gather_rows(self.spaces.comm, self.surface.coordinates[sharp])
        order = np.lexsort(np.round(rows / (np.abs(rows).max(initial=0.0) or 1.0), 9).T)
        return rows[order[0]] if len(rows) else None

    @property
    def nodal(self) -> bool:
        """Whether all points are nodes, so that a nodal force is that of one point."""
        return self._centres is None

    def at_points(self, nodal: Array) -> Array:
        """Values at the points of a function given at all nodes of the surface."""
        values = nodal[self.numbers]
        if self._centres is None:
            return values
        return np.concatenate([values, self._centres.interpolate(nodal)])

    def to_nodes(self, values: Array) -> Array:
        """Σ |N_i| × values over the points, at ``nodes``: what points give to nodes at most."""
        if self._centres is None:
            return values
        count = len(self.nodes)
        return values[:count] + self._centres.spread(values[count:])[self.numbers]

    def at_all_nodes(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values at ``nodes`` as an array of all nodes of the surface, 0 elsewhere."""
        nodal = np.zeros((len(self.all_nodes), *values.shape[1:]), values.dtype)
        nodal[self.numbers] = values
        return nodal

    def coefficient(self, values: Array) -> Any:
        """Scalars at the points in UFL: a constant where they are, else a function."""
        least = smallest(self.spaces.comm, values)
        if least == largest(self.spaces.comm, values):
            return fem.Constant(self.surface.mesh, least)
        return self.function(values).ufl

    def function(self, values: Array, empty: float = 0.0) -> TraceFunction:
        """A function of values at the points, scalars (points,) or vectors."""
        function = TraceFunction(self, values.ndim == 2, empty)
        function.set(values)
        return function

    def integral(self, values: Array) -> Any:
        """∫ of values at the points, first axis (points), by the trace's rule; collective."""
        weighted = np.tensordot(self.weights[self.owned], values[self.owned], axes=(0, 0))
        return total(self.spaces.comm, weighted)

    def extent(self) -> float:
        """Diagonal of the box around the surface (length); collective."""
        comm, points = self.spaces.comm, self.surface.coordinates.T
        return float(np.linalg.norm([largest(comm, x) - smallest(comm, x) for x in points]))

    def farthest(self) -> float:
        """Largest coordinate of the surface (length); collective."""
        return largest(self.spaces.comm, np.abs(self.surface.coordinates).ravel())

    def relative_facet_size(self) -> float:
        """Largest facet over the extent of the surface; collective."""
        mesh = self.surface.mesh
        facets = np.arange(len(self.surface.facet_nodes), dtype=np.int32)
        return largest(self.spaces.comm, mesh.h(mesh.topology.dim, facets)) / self.extent()

    def relative_cell_size(self) -> float:
        """Largest of the cells behind the facets over the extent of the surface; collective."""
        mesh = self.spaces.body.mesh
        cells = np.unique(self.surface.parents[:, 0]).astype(np.int32)
        return largest(self.spaces.comm, mesh.h(mesh.topology.dim, cells)) / self.extent()

    def smallest_edge(self) -> float:
        """Shortest edge of the cells at the surface (length): flat ones are stiff."""
        mesh = self.spaces.body.mesh
        topology = mesh.topology
        topology.create_entities(1)
        topology.create_connectivity(topology.dim, 1)
        topology.create_connectivity(1, topology.dim)  # which `h` asks for
        cells = np.unique(self.surface.parents[:, 0])
        links = topology.connectivity(topology.dim, 1)
        edges = [np.zeros(0, dtype=np.int32), *(links.links(cell) for cell in cells)]
        return smallest(self.spaces.comm, mesh.h(1, np.unique(np.concatenate(edges))))

    @property
    def pieces(self) -> SurfacePieces:
        """This rank's facets in segments or triangles between neighbouring nodes."""
        if self._pieces is None:
            self._pieces = SurfacePieces(self.surface, self.numbers)
        return self._pieces


class TraceFunction:
    """A settable function of values at the points of a trace.

    Attributes:
        ufl: What stands in forms.
    """

    def __init__(self, trace: Trace, is_vector: bool, empty: float = 0.0) -> None:
        self._trace = trace
        surface, centres = trace.surface, trace._centres
        shape = (len(trace.all_nodes), surface.components) if is_vector else len(trace.all_nodes)
        self._values = np.full(shape, empty)
        space = surface.space if is_vector else surface.scalar_space
        self._nodal = fem.Function(space)
        self._bubble: Any = None
        if centres is not None:
            self._bubble = fem.Function(centres.vector_space if is_vector else centres.scalar_space)
        self.ufl = self._nodal if centres is None else self._nodal + self._bubble

    def set(self, values: Array) -> None:
        """Give it values at the points."""
        trace = self._trace
        count = len(trace.nodes)
        self._values[trace.numbers] = values[:count]
        if values.ndim == 2:
            self._nodal.x.array[:] = self._values.reshape(-1)
        else:
            trace.surface.set_scalars(self._nodal, self._values)
        if trace._centres is not None:
            trace._centres.set_correction(self._nodal, self._bubble, values[count:])


def _needs_centres(spaces: Spaces) -> bool:
    return spaces.degree == 2 and spaces.body.mesh.topology.cell_name() == "tetrahedron"
