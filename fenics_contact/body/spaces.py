"""The finite element space and the measures on named groups (paper, Section 3).

Every measure carries the subdomain id 1 and its own entities, so that compiled
code does not depend on tags: two contacts, or two scenes, share it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.common import IndexMap
from mpi4py import MPI
from numpy.typing import NDArray
from ufl.core.expr import Expr

from fenics_contact.body.connected_parts import Parts
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elasticity import measure_weight
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.errors import FenicsContactError, InputError
from fenics_contact.common.parallel import largest, raise_together, smallest, total
from fenics_contact.mesh.tagged_mesh import CLOSE, Body, Group
from fenics_contact.scene.values import Value


class Spaces:
    """Displacement space, its nodes, and measures.

    Attributes:
        displacement_space: Blocked Lagrange space of the scene's degree.
        components: Displacement components a node (2 or 3).
        coordinates: Nodes of this rank, owned then ghost, shape (nodes, 3).
        owned_nodes: How many of them this rank owns.
        parts: The connected parts of the body.
        weight: UFL factor of every integral (2πr where axisymmetric).
        thickness: As the scene says.
    """

    def __init__(self, description: BodyDescription, body: Body) -> None:
        self._nodes: dict[Group, NDArray[np.int32]] = {}
        self.body = body
        self.comm: MPI.Comm = body.mesh.comm
        self.kinematics = description.kinematics
        self.degree = description.degree
        if body.dimension != description.dimension:
            raise InputError(
                f"kinematics = '{description.kinematics}' needs cells of dimension "
                f"{description.dimension}; those of {body.source} have {body.dimension}"
            )
        body.require_made_for(description.kinematics)
        if description.kinematics == "axisymmetric":
            body.require_radii()
        if self.degree < self.geometry_order:
            body.require_straight()
        self.components = description.dimension
        self.displacement_space = fem.functionspace(
            body.mesh, ("Lagrange", self.degree, (self.components,))
        )
        self.coordinates = self.displacement_space.tabulate_dof_coordinates()
        self.owned_nodes = self.displacement_space.dofmap.index_map.size_local
        self.parts = Parts(body, self.displacement_space)
        self.position = ufl.SpatialCoordinate(body.mesh)
        self._scalar: tuple[fem.FunctionSpace, Integers] | None = None
        thickness = self._thickness(description)
        self.weight = measure_weight(description.kinematics, self.position, thickness)
        body.mesh.topology.create_connectivity(body.dimension - 1, body.dimension)
        body.mesh.topology.create_connectivity(body.dimension, body.dimension - 1)
        body.mesh.topology.create_connectivity(body.dimension, body.dimension)

    @property
    def bulk(self) -> ufl.Measure:
        """Measure of the whole body, exact for the stiffness of undistorted cells."""
        metadata = {"quadrature_degree": self.bulk_degree}
        return ufl.Measure("dx", domain=self.body.mesh, metadata=metadata)

    @property
    def bulk_degree(self) -> int:
        """Quadrature degree of integrals over the body.

        Distorted cells have rational integrands, which this rule does not integrate exactly: it
        changes the solution by less than a hundredth of the discretisation error.
        """
        return 2 * self.degree + 2 * (self.geometry_order - 1) + self._extra_degree

    @property
    def geometry_order(self) -> int:
        """Order of the cells' geometry."""
        return int(self.body.mesh.ufl_domain().ufl_coordinate_element().degree)

    @property
    def _extra_degree(self) -> int:
        """Degree that the weight, 2πr or a varying thickness, adds to an integrand."""
        if self.kinematics == "axisymmetric":
            return 1
        return self.degree if callable(self.thickness) else 0

    def _thickness(self, description: BodyDescription) -> Expr | float:
        """The scene's thickness as a coefficient, or None."""
        self.thickness = description.thickness
        if description.thickness is None:
            return None
        nodes = np.arange(len(self.coordinates), dtype=np.int32)
        values = self.evaluate(description.thickness, nodes, "thickness")
        if smallest(self.comm, values) <= 0:
            raise InputError(
                f"thickness: its smallest value is {smallest(self.comm, values):g}, "
                "but it must be greater than 0"
            )
        return self.coefficient(values, nodes)

    def part(self, group: Group, metadata: Mapping[str, str | int] | None = None) -> ufl.Measure:
        """Measure of a group of cells."""
        return self.over_cells(self.body.entities(group), metadata)

    def over_cells(
        self, cells: AnyIntegers, metadata: Mapping[str, str | int] | None = None
    ) -> ufl.Measure:
        """Measure of cells, of which those that this rank owns count."""
        owned = cells[cells < self.body.mesh.topology.index_map(self.body.dimension).size_local]
        entities = [(1, owned.astype(np.int32))]
        return ufl.Measure("dx", domain=self.body.mesh, subdomain_data=entities, metadata=metadata)(
            1
        )

    def boundary(
        self, group: Group, metadata: Mapping[str, str | int] | None = None
    ) -> ufl.Measure:
        """Measure of a group of boundary facets."""
        entities = compat.boundary_entities(self.body.mesh.topology, self.body.entities(group))
        return ufl.Measure(
            "ds", domain=self.body.mesh, subdomain_data=[(1, entities)], metadata=metadata
        )(1)

    def facets(self, group: Group) -> NDArray[np.int32]:
        """(cell, local facet) of this rank's facets of a boundary group, shape (facets, 2)."""
        found = compat.boundary_entities(self.body.mesh.topology, self.body.entities(group))
        return np.asarray(found).reshape(-1, 2)

    @cached_property
    def size(self) -> float:
        """Largest extent of the body along an axis (length); collective when first asked for."""
        columns = self.coordinates.T
        return max(largest(self.comm, x) - smallest(self.comm, x) for x in columns)

    def nodes(self, group: Group) -> NDArray[np.int32]:
        """Local indices (owned and ghost) of the nodes on a group; collective."""
        if group not in self._nodes:
            entities, dimension = self.body.entities(group), group.dimension
            if group.places:
                places = group.at(self.coordinates, CLOSE * self.size)
                found = np.flatnonzero(places).astype(np.int32)
            else:
                found = fem.locate_dofs_topological(self.displacement_space, dimension, entities)
            self._nodes[group] = np.sort(found)
        return self._nodes[group]

    def evaluate(self, value: Value, nodes: NDArray[np.int32], key: str) -> Array:
        """A scene's value at nodes, shape (nodes,); collective (see ``evaluate_at``)."""
        return self.evaluate_at(value, self.coordinates[nodes].T, key)

    def evaluate_at(self, value: Value, points: Array, key: str) -> Array:
        """A scene's value at points of shape (3, n), shape (n,); collective.

        Raises:
            InputError: On every rank, if a function fails or gives what is not finite.
        """
        error: FenicsContactError | None = None
        values = np.zeros(points.shape[1])
        try:
            found = value(points) if callable(value) else value
            values[:] = np.broadcast_to(np.asarray(found, dtype=np.float64), values.shape)
            if not np.isfinite(values).all():
                error = InputError(f"{key}: its function gives values that are not finite")
        except Exception as caught:  # whatever a user's function raises
            said = " ".join(str(caught).split())
            error = InputError(f"{key}: its function fails: {type(caught).__name__}: {said}")
        raise_together(self.comm, error)
        return values

    def coefficient(self, values: Array, nodes: NDArray[np.int32]) -> fem.Function:
        """Nodal values as a UFL coefficient: a constant where they are, else a function.

        Args:
            values: Scalars of shape (nodes,), or vectors of shape (nodes, components).
            nodes: The nodes that hold them; the coefficient is used only there.
        """
        columns = values.T if values.ndim == 2 else [values]
        least = [smallest(self.comm, column) for column in columns]
        if least == [largest(self.comm, column) for column in columns]:
            constant = np.array(least) if values.ndim == 2 else least[0]
            return fem.Constant(self.body.mesh, constant)
        if values.ndim == 2:
            function = fem.Function(self.displacement_space)
            function.x.array.reshape(-1, self.components)[nodes] = values
            return function
        space, scalar_of_node = self.scalar_space()
        function = fem.Function(space)
        function.x.array[scalar_of_node[nodes]] = values
        return function

    def scalar_space(self) -> tuple[fem.FunctionSpace, Integers]:
        """The space of one component, and its dof at every node."""
        if self._scalar is None:
            space = fem.functionspace(self.body.mesh, ("Lagrange", self.degree))
            scalar_of_node = np.empty(len(self.coordinates), dtype=np.int64)
            scalar_of_node[self.displacement_space.dofmap.list] = space.dofmap.list
            self._scalar = (space, scalar_of_node)
        return self._scalar

    def summed(self, nodal: Array) -> Array:
        """Contributions of all ranks added up at shared nodes, (nodes, columns); collective."""
        if self.comm.size == 1:  # nothing is shared, and a vector would take longer than all else
            return nodal.astype(np.float64)
        return summed_over_ranks(self.displacement_space.dofmap.index_map, nodal)

    def assemble(self, form: fem.Form) -> Array:
        """A compiled linear form as nodal values, shape (nodes, components); collective."""
        vector = fem.assemble_vector(form)
        vector.scatter_reverse(la.InsertMode.add)
        vector.scatter_forward()
        return np.asarray(vector.array.reshape(-1, self.components).copy())


def surface_integrals(vector: Expr, measure: ufl.Measure, spaces: Spaces) -> Array:
    """∫ 1 and ∫ v_i over a surface, weighted, by one compiled form; collective.

    Args:
        vector: v in UFL, (components,).
        measure: Of the surface.
        spaces: Those of the body.

    Returns:
        (1 + components,).
    """
    mesh = spaces.body.mesh
    of_one, of_vector = fem.Constant(mesh, 0.0), fem.Constant(mesh, np.zeros(spaces.components))
    density = of_one + ufl.dot(of_vector, vector)
    form, found = form_cache.form(spaces.weight * density * measure), []
    for unit in np.eye(1 + spaces.components):
        of_one.value, of_vector.value[:] = unit[0], unit[1:]
        found.append(float(np.real(fem.assemble_scalar(form))))
    return np.asarray(total(spaces.comm, np.array(found)))


def of_owners(index_map: IndexMap, nodal: Array) -> Array:
    """Values at owned nodes of this rank, first axis nodes, at its ghosts, too; collective.

    Args:
        index_map: Of the nodes.
        nodal: At owned nodes, or at all, of which those at ghosts do not count.
    """
    vector = la.vector(index_map, int(np.prod(nodal.shape[1:])))
    owned = index_map.size_local
    vector.array[: owned * int(np.prod(nodal.shape[1:]))] = nodal[:owned].reshape(-1)
    vector.scatter_forward()
    return np.array(vector.array).reshape(-1, *nodal.shape[1:])


def summed_over_ranks(index_map: IndexMap, nodal: Array) -> Array:
    """Contributions of all ranks, first axis nodes, added up at shared ones; collective."""
    vector = la.vector(index_map, int(np.prod(nodal.shape[1:])))
    vector.array[:] = nodal.reshape(-1)
    vector.scatter_reverse(la.InsertMode.add)
    vector.scatter_forward()
    return np.array(vector.array).reshape(nodal.shape)
