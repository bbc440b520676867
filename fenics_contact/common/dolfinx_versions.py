"""The one place that knows dolfinx 0.9 from 0.10 and 0.11, and Python 3.13.0 from later ones."""

from __future__ import annotations

import functools
import platform
from typing import Any

import basix
import basix.ufl
import dolfinx
import dolfinx.graph
import dolfinx.io
import dolfinx.mesh
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import Mesh, MeshTags, exterior_facet_indices
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common import program
from fenics_contact.common.arrays import Array, Integers

DOLFINX_VERSION = tuple(int(part) for part in dolfinx.__version__.split(".")[:2])


def _let_derivatives_go() -> None:
    """Let UFL's derivatives be freed, where Python would keep each for as long as it runs.

    Python 3.13.0 and 3.13.1 keep every object of which a ``functools.singledispatchmethod`` was
    called (https://github.com/python/cpython/issues/127750). UFL's derivatives are such objects,
    and with their forms they hold meshes and MPI's communicators. Of these there are some 2,000,
    which a long study in one process would use up.
    """
    if not hasattr(functools.singledispatchmethod(_let_derivatives_go), "_method_cache"):
        return
    from ufl.algorithms import apply_coefficient_split, apply_derivatives

    for module in (apply_derivatives, apply_coefficient_split):
        for one in vars(module).values():
            for member in vars(one).values() if isinstance(one, type) else ():
                if isinstance(member, functools.singledispatchmethod):
                    member._method_cache = None  # type: ignore[attr-defined]


_let_derivatives_go()


def create_mesh(
    comm: MPI.Comm,
    cell: str,
    order: int,
    points: Array,
    cells: Integers,
) -> Any:
    """A distributed mesh from the points and cells of rank 0 (none on the others)."""
    element = basix.ufl.element(
        "Lagrange",
        cell,
        order,
        lagrange_variant=basix.LagrangeVariant.equispaced,
        shape=(points.shape[1],),
    )
    # By keywords: the order of the arguments differs between the versions.
    # Fluxes between cells of two ranks need both of them on each.
    facets_of_two = () if DOLFINX_VERSION < (0, 10) else (2,)
    ghosts = dolfinx.mesh.create_cell_partitioner(
        dolfinx.mesh.GhostMode.shared_facet, *facets_of_two
    )
    return dolfinx.mesh.create_mesh(
        comm, cells=cells, x=points, e=ufl.Mesh(element), partitioner=ghosts
    )


def distributed_tags(
    mesh: Mesh, dimension: int, entities: Integers, tags: NDArray[np.int32]
) -> MeshTags:
    """Mesh tags of entities given on rank 0 by their nodes."""
    local, values = dolfinx.io.distribute_entity_data(mesh, dimension, entities, tags)
    mesh.topology.create_connectivity(dimension, mesh.topology.dim)
    adjacency = dolfinx.graph.adjacencylist(local)
    return dolfinx.mesh.meshtags_from_entities(
        mesh, dimension, adjacency, values.astype(np.int32, copy=False)
    )


def refined(
    mesh: Mesh, cells: NDArray[np.int32], tags: list[MeshTags]
) -> tuple[Mesh, list[MeshTags]]:
    """A mesh on one rank with all edges of some cells halved, and its tags of cells or facets."""
    dimension = mesh.topology.dim
    mesh.topology.create_entities(1)
    mesh.topology.create_connectivity(dimension, 1)
    mesh.topology.create_connectivity(1, dimension)
    edges = dolfinx.mesh.compute_incident_entities(mesh.topology, cells, dimension, 1)
    option = dolfinx.mesh.RefinementOption.parent_cell_and_facet
    finer, parents, sides = dolfinx.mesh.refine(mesh, edges, partitioner=None, option=option)
    for made in (mesh, finer):
        made.topology.create_connectivity(dimension, dimension - 1)
        made.topology.create_connectivity(dimension - 1, dimension)
    return finer, [dolfinx.mesh.transfer_meshtag(t, finer, parents, sides) for t in tags]


def nodes_of_entities(mesh: Mesh, dimension: int, entities: NDArray[np.int32]) -> Integers:
    """Numbers of each entity's points in the mesh's geometry, (entities, points)."""
    mesh.topology.create_connectivity(dimension, mesh.topology.dim)
    mesh.topology.create_connectivity(mesh.topology.dim, dimension)
    if len(entities) == 0:  # of which dolfinx 0.9 divides by their number
        return np.zeros((0, 0), dtype=np.int64)
    found = dolfinx.mesh.entities_to_geometry(mesh, dimension, entities.astype(np.int32))
    return np.asarray(found, dtype=np.int64).reshape(len(entities), -1)


def input_nodes(mesh: Mesh) -> Integers:
    """Numbers that the geometry nodes of each cell had where the mesh was made, (cells, nodes)."""
    geometry = mesh.geometry
    nodes = geometry.dofmaps[0] if DOLFINX_VERSION >= (0, 11) else geometry.dofmap
    return np.asarray(geometry.input_global_indices[nodes])


def exterior_facets(mesh: Mesh) -> NDArray[np.int32]:
    """Owned facets on the boundary of the body."""
    mesh.topology.create_connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    return np.asarray(dolfinx.mesh.exterior_facet_indices(mesh.topology))


def create_submesh(
    mesh: Mesh, dimension: int, entities: NDArray[np.int32]
) -> tuple[Any, NDArray[np.int32]]:
    """A mesh of some entities, and the entity that each of its cells is."""
    submesh, entity_map = dolfinx.mesh.create_submesh(mesh, dimension, entities)[:2]
    if not isinstance(entity_map, np.ndarray):
        cells = submesh.topology.index_map(dimension)
        numbers = np.arange(cells.size_local + cells.num_ghosts, dtype=np.int32)
        entity_map = entity_map.sub_topology_to_topology(numbers, False)
    return submesh, np.asarray(entity_map)


def boundary_entities(topology: Any, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """(cell, local facet) pairs of the owned exterior facets, as measures take them."""
    kind = fem.IntegralType.exterior_facet
    # From 0.10 on, facets inside the body are not left out by themselves.
    facets = np.intersect1d(facets, exterior_facet_indices(topology)).astype(np.int32)
    if DOLFINX_VERSION >= (0, 10):
        return np.asarray(fem.compute_integration_domains(kind, topology, facets))
    return np.asarray(fem.compute_integration_domains(kind, topology, facets, topology.dim - 1))


def interpolation_points(element: Any) -> Array:
    """Reference points at which the element interpolates."""
    points = element.interpolation_points
    return np.asarray(points() if callable(points) else points)


def interior_element(mesh: Mesh, degree: int) -> Any:
    """Discontinuous Lagrange element with all its nodes inside the cell.

    On quadrilaterals and hexahedra they are Gauss points.
    """
    if degree == 0:
        return ("DG", 0)
    variant = basix.LagrangeVariant.gl_warped
    return basix.ufl.element(
        "P", mesh.basix_cell(), degree, lagrange_variant=variant, discontinuous=True
    )


def quadrature_rule(mesh: Mesh, degree: int) -> tuple[Array, Array]:
    """Points and weights of the rule that integrals over cells use, on the reference cell."""
    cell = getattr(basix.CellType, mesh.topology.cell_name())
    points, weights = basix.make_quadrature(cell, degree)
    return np.asarray(points), np.asarray(weights)


def quadrature_points(mesh: Mesh, degree: int) -> Array:
    """Points of that rule."""
    return quadrature_rule(mesh, degree)[0]


def geometry_nodes(mesh: Mesh) -> NDArray[np.int32]:
    """Numbers of each cell's points in the mesh's geometry, (cells, points)."""
    geometry = mesh.geometry
    return np.asarray(geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap)


def geometry_layout(mesh: Mesh) -> Any:
    """Return the layout of a cell's geometry: which of its points are on which of its sides."""
    geometry = mesh.geometry
    element = geometry.cmaps[0] if DOLFINX_VERSION >= (0, 11) else geometry.cmap
    return element.create_dof_layout()


def is_tensor_cell(mesh: Mesh) -> bool:
    """Whether the cells are quadrilaterals or hexahedra."""
    return mesh.topology.cell_name() in ("quadrilateral", "hexahedron")


def integral_types(form: Any) -> list[str]:
    """Names of the integrals that a compiled form really holds."""
    return sorted(kind.name for kind in form._cpp_object.integral_types)


def versions() -> dict[str, str]:
    """Versions of all that a number depends on."""
    import petsc4py

    return {
        "fenics_contact": program.VERSION,
        "dolfinx": dolfinx.__version__,
        "ufl": ufl.__version__ if hasattr(ufl, "__version__") else "",
        "petsc4py": petsc4py.__version__,
        "numpy": np.__version__,
        "python": platform.python_version(),
        "mpi": MPI.Get_library_version().splitlines()[0].strip("\x00 "),
    }
