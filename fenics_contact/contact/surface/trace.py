"""The points of a boundary at which contact acts, what lives on them, and what supports hold."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from dolfinx import fem
from dolfinx.fem import Form as CompiledForm
from dolfinx.fem import Function
from numpy.typing import NDArray
from ufl import Measure
from ufl.core.expr import Expr

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers, Kind, in_3d
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.contact.surface.facets import NodalNormals, SurfacePieces
from fenics_contact.contact.surface.point_rule import (
    AT_CENTRE,
    SEVEN_POINTS,
    FacetCentres,
    TraceFunction,
    needs_centres,
    nodal_rule,
    node_form,
    point_weight,
)
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.contact.surface.symmetry import SurfaceSymmetry
from fenics_contact.mesh.tagged_mesh import Group


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
        cut: The cut faces of a sector, beyond which it goes on, or None.
        averaged: From which these are: those of the facets around each node, and their mean.
        symmetry: The planes of symmetry, and the walls, that it meets.
        area: Of the surface.
        owned: Which points this rank counts.
    """

    def __init__(
        self,
        spaces: Spaces,
        group: Group,
        flat_sides: Sequence[tuple[int, float]] = (),
        walls: Sequence[tuple[int, float]] = (),
        cut: CutFaces | None = None,
    ) -> None:
        self.spaces = spaces
        self.group = group
        self.surface = SurfaceSpace(spaces, group)
        self.cut = cut
        self._pieces: SurfacePieces | None = None
        self._centres = FacetCentres(self.surface) if needs_centres(spaces) else None
        self.weight: Expr | float = point_weight(self.surface)
        weights = self._areas(node_form(self.surface, self.weight, self._nodal_measure))
        self.averaged = NodalNormals(self.surface, group, cut)
        averaged = self.averaged.normals
        self.symmetry = SurfaceSymmetry(self.surface, flat_sides, walls, averaged)
        normals = self.symmetry.mirrored(averaged)
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
        self._counted: Function | None = None
        self._area_form: CompiledForm | None = None
        self._whole_weights = self.weights
        self._current = self.surface.coordinates
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
            self._counted = Function(space)
            self.weight = self.weight * self._counted
            self._area_form = node_form(self.surface, self.weight, self._nodal_measure)
        cells = self._counted.function_space.dofmap.list[: len(shares), 0]
        self._counted.x.array[cells] = shares
        weights = self._areas(self._area_form)[self.numbers]
        if self._centres is not None:
            weights = np.concatenate([weights, self._centres.weights * shares])
        counts = weights > 1e-6 * self._whole_weights
        self.weights = np.where(counts, weights, self._whole_weights)
        return counts

    def stretch_by(self, stretch: Expr) -> None:
        """Weigh points by current areas from now on; all points must be nodes.

        Args:
            stretch: Current area over that of the mesh, in UFL.
        """
        self.surface.stretch_by(stretch)
        self.weight = self.weight * stretch
        self._area_form = node_form(self.surface, self.weight, self._nodal_measure)

    def follow_stretch(self, displacement: Array) -> None:
        """Take areas and pieces as they are now; collective.

        Args:
            displacement: At all nodes of the surface, (nodes, components) (length).
        """
        self.surface.follow_stretch()
        self.weights = self._areas(self._area_form)[self.numbers]
        self._current = self.surface.coordinates + in_3d(displacement)
        self._pieces = None

    @property
    def measure(self) -> Measure:
        """Measure with the points of this trace."""
        return self._nodal_measure if self._centres is None else self.surface.measure(SEVEN_POINTS)

    @property
    def _nodal_measure(self) -> Measure:
        """Measure with the nodes alone."""
        return self.surface.measure(nodal_rule(self.spaces))

    def _areas(self, form: CompiledForm) -> Array:
        """Areas of all nodes by the rule of the points, from ``node_form``; collective."""
        area = self.surface.assemble(form)[:, 0]
        return area if self._centres is None else area * self._centres.node_factor

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

    def fitted(self, values: Array, known: Flags) -> Array:
        """Scalars at the points as a function of the facets' space, the nearest one; collective.

        Only nodes move the centres of facets: a gap that is no such function cannot be closed at
        all points, and would be pressed out by pressures that make no force at any node. Where all
        points are nodes, every gap is such a function.

        Args:
            values: At the points, (points,).
            known: Points that have one. A facet with one that has none keeps its values.
        """
        if self._centres is None:
            return values
        count = len(self.nodes)
        within = known[count:] & known[:count][self._centres.nodes].all(axis=1)
        return self._centres.fitted(values, self._whole_weights, within)

    def onto_nodes(self, values: Array) -> Array:
        """Transpose of ``at_points``: Σ N_i × vectors over the points, at all nodes.

        Collective.

        Args:
            values: At the points, (points, components).
        """
        found = self.at_all_nodes(values[: len(self.nodes)])
        if self._centres is not None:
            found += self._centres.collected(values[len(self.nodes) :])
        return found

    @property
    def point_rows(self) -> tuple[Integers, Integers, Array]:
        """Rows of ``at_points`` as a matrix: points, nodes of the surface, and shares of these."""
        points = np.arange(len(self.nodes))
        rows, columns, shares = points, self.numbers, np.ones(len(points))
        if self._centres is None:
            return rows, columns, shares
        nodes = self._centres.nodes
        centres = len(points) + np.repeat(np.arange(len(nodes)), nodes.shape[1])
        return (
            np.concatenate([rows, centres]),
            np.concatenate([columns, nodes.ravel()]),
            np.concatenate([shares, np.tile(AT_CENTRE, len(nodes))]),
        )

    def to_nodes(self, values: Array) -> Array:
        """Σ |N_i| × values over the points, at ``nodes``: what points give to nodes at most."""
        if self._centres is None:
            return values
        count = len(self.nodes)
        return values[:count] + self._centres.spread(values[count:])[self.numbers]

    def at_all_nodes(self, values: NDArray[Kind]) -> NDArray[Kind]:
        """Values at ``nodes`` as an array of all nodes of the surface, 0 elsewhere."""
        nodal = np.zeros((len(self.all_nodes), *values.shape[1:]), values.dtype)
        nodal[self.numbers] = values
        return nodal

    def at_every_node(self, values: Array) -> Array:
        """Scalars at the points that are even in the radius, at all nodes of the surface.

        A node on the axis of revolution is no point, as no area belongs to it. It has the value of
        the nearest one in its facet, which is right but for a term of second order.
        """
        nodal = self.at_all_nodes(values[: len(self.nodes)])
        nodal[self._on_axis[0]] = nodal[self._on_axis[1]]
        return nodal

    @cached_property
    def _on_axis(self) -> tuple[Integers, Integers]:
        """Nodes of the surface that are no points, and the nearest point of each."""
        nearest: dict[int, int] = {}
        is_point = np.zeros(len(self.all_nodes), dtype=bool)
        is_point[self.numbers] = True
        known = is_point[self.surface.facet_nodes]
        for facet in self.surface.facet_nodes[known.any(axis=1) & ~known.all(axis=1)]:
            points = facet[is_point[facet]]
            for node in facet[~is_point[facet]]:
                away = self.surface.coordinates[points] - self.surface.coordinates[node]
                nearest[int(node)] = int(points[np.linalg.norm(away, axis=1).argmin()])
        return np.array([*nearest], dtype=np.int64), np.array([*nearest.values()], dtype=np.int64)

    def coefficient(self, values: Array) -> Expr:
        """Scalars at the points in UFL: a constant where they are, else a function."""
        least = smallest(self.spaces.comm, values)
        if least == largest(self.spaces.comm, values):
            return fem.Constant(self.surface.mesh, least)
        return self.function(values).ufl

    def function(self, values: Array, empty: float = 0.0) -> TraceFunction:
        """A function of values at the points, scalars (points,) or vectors."""
        is_vector = values.ndim == 2
        function = TraceFunction(self.surface, self.numbers, self._centres, is_vector, empty)
        function.set(values)
        return function

    def integral(self, values: Array) -> Any:
        """∫ of values at the points, first axis (points), by the trace's rule; collective."""
        weighted = np.tensordot(self.weights[self.owned], values[self.owned], axes=(0, 0))
        return total(self.spaces.comm, weighted)

    def extent(self) -> float:
        """Diagonal of the box around the surface (length); collective."""
        return self.surface.extent()

    @property
    def pieces(self) -> SurfacePieces:
        """This rank's facets in segments or triangles between neighbouring nodes."""
        if self._pieces is None:
            self._pieces = SurfacePieces(self.surface, self.numbers, self._current)
        return self._pieces


# Of a normal: squares of components below it are round-off.
_NONE = 1e-9


class SurfaceSupports:
    """The components of a surface's nodes that supports hold.

    Args:
        trace: The contact points.
        constrained: Dofs that supports prescribe (local indices, owned and ghost).

    Attributes:
        free_along: Components along which nothing but friction acts along the surface,
            (nodes, components).
        movable: Nodes that can move along such a one. A support at an angle to the surface
            counts for all of a node, since its reaction has a part in every direction.
        free_across: Nodes on which no support acts along the surface's normal.
        free_normals: Of each node's normal the components that nothing holds, (nodes, components).
        held_across: Points that supports hold along the normal, (points,).
    """

    def __init__(self, trace: Trace, constrained: Integers) -> None:
        self._trace = trace
        components = trace.spaces.components
        held = np.zeros(len(trace.spaces.coordinates) * components, dtype=bool)
        held[constrained] = True
        self._held = held.reshape(-1, components)[trace.nodes]
        normals = trace.normals[: len(trace.nodes)]
        squares = normals**2
        along = self._held & (1 - squares > _NONE)
        oblique = (along & (squares > _NONE)).any(axis=1)
        self.free_along = ~along
        self.movable = (along.sum(axis=1) < components - 1) & ~oblique
        self.free_across = ~(self._held & (squares > _NONE)).any(axis=1)
        self.free_normals = np.where(self._held, 0.0, normals)
        self.held_across = np.zeros(len(trace.normals), dtype=bool)
        self.held_across[: len(trace.nodes)] = (squares * ~self._held).sum(axis=1) <= _NONE

    def held_axes(self) -> Flags:
        """Along which axes supports hold more than a tenth of the nodes; collective."""
        comm, owned = self._trace.spaces.comm, self._trace.owned[: len(self._held)]
        return np.asarray(
            total(comm, self._held[owned].sum(axis=0)) > 0.1 * total(comm, owned.sum())
        )
