"""The finite element space on a contact surface: a mesh of its facets, and where it lies.

Contact and friction live here, so that what they cost grows with the surface alone.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.fem import Form as CompiledForm
from dolfinx.fem import Function
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import SuperLU, splu
from ufl import Measure
from ufl.core.expr import Expr

from fenics_contact.body.elasticity import measure_weight
from fenics_contact.body.spaces import Spaces, of_owners, summed_over_ranks
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Integers, Kind
from fenics_contact.common.parallel import gather_rows, largest, smallest
from fenics_contact.mesh.tagged_mesh import Group

# Of a quadrature rule, as a measure's metadata.
Rule = dict[str, Any]


class SurfaceSpace:
    """Blocked Lagrange space of the body's degree on the facets of a boundary group.

    A facet belongs to one rank; nodes at the seam between ranks are shared, as in the body.
    A node's owner here may be another rank than its owner in the body.

    Attributes:
        spaces: Those of the body.
        mesh: The facets, a mesh of their own.
        space: Displacements on it.
        scalar_space: One component.
        parents: (cell, local facet) in the body of every facet here.
        facet_nodes: Nodes of every facet.
        coordinates: Nodes of this rank, owned then ghost, (nodes, 3) (length).
        body_nodes: The body's local number of each node.
        owned_nodes: How many of the nodes this rank owns.
        weight: UFL factor of integrals (2πr where axisymmetric, else a thickness or 1).
        factors: The same at the nodes, (nodes,).
    """

    def __init__(self, spaces: Spaces, group: Group) -> None:
        self.spaces = spaces
        self.comm = spaces.comm
        self.components = spaces.components
        parents = spaces.facets(group)
        body = spaces.body.mesh
        dimension = body.topology.dim
        cells = body.topology.index_map(dimension)
        facets = body.topology.connectivity(dimension, dimension - 1).array
        width = len(facets) // max(cells.size_local + cells.num_ghosts, 1)
        numbers = facets[parents[:, 0] * width + parents[:, 1]]
        chosen, first = np.unique(numbers, return_index=True)
        self.mesh, order = compat.create_submesh(body, dimension - 1, chosen)
        self.parents = parents[first][np.searchsorted(chosen, order)]
        self.space = fem.functionspace(self.mesh, ("Lagrange", spaces.degree, (self.components,)))
        self.scalar_space = fem.functionspace(self.mesh, ("Lagrange", spaces.degree))
        self.coordinates = self.space.tabulate_dof_coordinates()
        self.owned_nodes = self.space.dofmap.index_map.size_local
        self.facet_nodes = self.space.dofmap.list
        self._scalar_of_node = np.empty(len(self.coordinates), dtype=np.int64)
        self._scalar_of_node[self.facet_nodes] = self.scalar_space.dofmap.list
        self.body_nodes = self._nodes_in_body()
        self.position = ufl.SpatialCoordinate(self.mesh)
        thickness = self._thickness()
        self.factors = np.ones(len(self.coordinates)) if thickness is None else thickness
        if spaces.kinematics == "axisymmetric":
            self.factors = 2 * np.pi * self.coordinates[:, 0]
        varying = None if thickness is None else self.coefficient(thickness)
        self.weight = measure_weight(spaces.kinematics, self.position, varying)

    def stretch_by(self, stretch: Expr) -> None:
        """Let integrals be over current areas from now on, in forms that are made later.

        Args:
            stretch: Current area over that of the mesh, in UFL; it may change.
        """
        self.weight = self.weight * stretch
        self.__dict__.pop("mass", None)
        self.follow_stretch()

    def follow_stretch(self) -> None:
        """Forget what was worked out before the areas changed."""
        self.__dict__.pop("mass_factor", None)

    @cached_property
    def mass(self) -> CompiledForm:
        """∫ N_i N_j of the scalar space, a compiled form."""
        trial, test = ufl.TrialFunction(self.scalar_space), ufl.TestFunction(self.scalar_space)
        return form_cache.form(self.weight * trial * test * self.measure())

    @cached_property
    def mass_factor(self) -> SuperLU:
        """``mass`` of the whole surface, factorised on every rank; collective when first asked for.

        Only contact unknowns are gathered.
        """
        rows, columns, values = (gather_rows(self.comm, part) for part in self._own_mass())
        count = self.scalar_space.dofmap.index_map.size_global
        return splu(coo_matrix((values, (rows, columns)), shape=(count, count)).tocsc())

    def _own_mass(self) -> tuple[Integers, Integers, Array]:
        """Global rows and columns of ``mass``, and values, of owned nodes."""
        matrix = fem.assemble_matrix(self.mass)
        matrix.scatter_reverse()
        entries = matrix.to_scipy().tocoo()
        kept = entries.row < self.scalar_space.dofmap.index_map.size_local
        row, column = entries.row[kept].astype(np.int32), entries.col[kept].astype(np.int32)
        # The matrix may have columns of nodes that the space's own map does not know here.
        rows, columns = matrix.index_map(0), matrix.index_map(1)
        numbers = rows.local_to_global(row), columns.local_to_global(column)
        return *numbers, entries.data[kept]

    @cached_property
    def dofs(self) -> Integers:
        """The body's global number of every dof of the whole surface, by its number here."""
        return gather_rows(self.comm, self.own_dofs)

    @property
    def own_dofs(self) -> Integers:
        """The body's global numbers of the dofs of nodes that this rank owns here."""
        mine = self.body_nodes[: self.owned_nodes]
        index_map = self.spaces.displacement_space.dofmap.index_map
        nodes = np.asarray(index_map.local_to_global(mine), dtype=np.int64)
        return (nodes[:, None] * self.components + np.arange(self.components)).ravel()

    @cached_property
    def numbers(self) -> Integers:
        """Number of each node of this rank on the whole surface."""
        local = np.arange(len(self.coordinates), dtype=np.int32)
        return np.asarray(self.space.dofmap.index_map.local_to_global(local))

    def gathered(self, nodal: NDArray[Kind]) -> NDArray[Kind]:
        """Values at this rank's nodes, first axis nodes, for the whole surface; collective."""
        return gather_rows(self.comm, nodal[: self.owned_nodes])

    def _nodes_in_body(self) -> NDArray[np.int32]:
        """The body's node at the place of each node here, facet by facet."""
        spaces = self.spaces
        dofmap = spaces.displacement_space.dofmap
        closures = [
            dofmap.dof_layout.entity_closure_dofs(self.mesh.topology.dim, facet)
            for facet in range(self.parents[:, 1].max(initial=-1) + 1)
        ]
        found = np.zeros(len(self.coordinates), dtype=np.int32)
        if len(self.parents) == 0:
            return found
        local = np.array(closures)[self.parents[:, 1]]
        candidates = dofmap.list[self.parents[:, :1], local]
        here, there = self.coordinates[self.facet_nodes], spaces.coordinates[candidates]
        distances = np.linalg.norm(here[:, :, None] - there[:, None], axis=-1)
        nearest = distances.argmin(axis=2)
        found[self.facet_nodes] = np.take_along_axis(candidates, nearest, axis=1)
        return found

    def extent(self) -> float:
        """Diagonal of the box around the surface (length); collective when first asked for."""
        return self._extent

    @cached_property
    def _extent(self) -> float:
        columns = self.coordinates.T
        return float(
            np.linalg.norm([largest(self.comm, x) - smallest(self.comm, x) for x in columns])
        )

    def farthest(self) -> float:
        """Largest coordinate of the surface (length); collective when first asked for."""
        return self._farthest

    @cached_property
    def _farthest(self) -> float:
        return largest(self.comm, np.abs(self.coordinates).ravel())

    def _thickness(self) -> Array | None:
        """The scene's thickness at the nodes, or None."""
        value = self.spaces.thickness
        if value is None:
            return None
        return self.spaces.evaluate_at(value, self.coordinates.T, "thickness")

    def measure(self, metadata: Rule | None = None) -> Measure:
        """Measure of the surface."""
        return ufl.Measure("dx", domain=self.mesh, metadata=metadata)

    def coefficient(self, values: Array) -> Expr:
        """Scalars at the nodes in UFL: a constant where they are, else a function; collective."""
        least = smallest(self.comm, values)
        if least == largest(self.comm, values):
            return fem.Constant(self.mesh, least)
        return self.scalar_function(values)

    def scalar_function(self, values: Array, name: str = "values") -> Function:
        """A scalar function with values at all nodes."""
        function = Function(self.scalar_space, name=name)
        self.set_scalars(function, values)
        return function

    def set_scalars(self, function: Function, values: Array) -> None:
        """Set a scalar function at all nodes."""
        function.x.array[self._scalar_of_node] = values

    def scalars(self, function: Function) -> Array:
        """A scalar function's values at all nodes."""
        return np.asarray(function.x.array[self._scalar_of_node])

    def gathered_scalars(self, nodal: Array) -> Array:
        """Columns of values at the nodes, by the scalar space's numbers over all ranks; collective.

        Args:
            nodal: (nodes, columns).
        """
        ordered = np.empty_like(nodal)
        ordered[self._scalar_of_node] = nodal
        owned = self.scalar_space.dofmap.index_map.size_local
        return gather_rows(self.comm, ordered[:owned])

    def scattered_scalars(self, values: Array) -> Array:
        """At this rank's nodes, from ``gathered_scalars``."""
        index_map = self.scalar_space.dofmap.index_map
        local = np.arange(len(self._scalar_of_node), dtype=np.int32)
        return np.asarray(values[index_map.local_to_global(local)][self._scalar_of_node])

    def vector_function(self, values: Array, name: str = "values") -> Function:
        """A vector function with values (nodes, components)."""
        function = Function(self.space, name=name)
        function.x.array[:] = values.reshape(-1)
        return function

    def assemble(self, form: CompiledForm) -> Array:
        """A compiled linear form on ``space`` at the nodes, (nodes, components); collective."""
        vector = fem.assemble_vector(form)
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        return np.array(vector.array).reshape(-1, self.components)

    def summed(self, nodal: Array) -> Array:
        """Contributions of all ranks added up at shared nodes; collective."""
        if self.comm.size == 1:
            return nodal.astype(np.float64)
        return summed_over_ranks(self.space.dofmap.index_map, nodal)

    def of_owners(self, nodal: Array) -> Array:
        """Values at owned nodes, first axis nodes, at this rank's ghosts, too; collective."""
        if self.comm.size == 1:
            return nodal.astype(np.float64)
        return of_owners(self.space.dofmap.index_map, nodal)

    def on_body(self, nodal: Array) -> Array:
        """Values at the nodes as an array of the body's nodes, 0 elsewhere; collective."""
        found = np.zeros((len(self.spaces.coordinates), *nodal.shape[1:]))
        mine = slice(0, self.owned_nodes)
        found[self.body_nodes[mine]] = nodal[mine]
        return self.spaces.summed(found)
