"""The next mesh of a body: from the errors of its cells, or fine enough to see what touches.

Geometries are meshed again with sizes of their cells. Triangles and tetrahedra that are a mesh
already are cut in two, and again, where their errors are large; their corners stay.

Estimated errors say nothing of an obstacle between two points of the surface. Where there is one,
or where it touches in too few points, the next mesh is the last one with smaller cells there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gathered_on_root, on_root, total
from fenics_contact.contact.between_points import TooCoarseError
from fenics_contact.evaluate.contact_areas import facet_sizes
from fenics_contact.mesh.loading import is_geometry, load_body
from fenics_contact.mesh.refinement import CORNERS, all_values, is_of_order_1, refined
from fenics_contact.mesh.size_field import Cells, SizeField, finer_at, graded, next_sizes
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.scene_run import Run
from fenics_contact.trust.convergence.coarse_contacts import hidden_obstacles

# Cells that should become smaller than this are cut.
_CUT = 0.7


def hindrance(scene: Scene, body: Body, is_own: bool) -> str:
    """Why there can be no other mesh of a body, or nothing.

    Args:
        scene: With its meshes.
        body: The first mesh.
        is_own: Whether it was passed in place of the scene's.
    """
    cell = body.mesh.topology.cell_name()
    if cell == "hexahedron":
        return (
            "hexahedra cannot be made by sizes that vary: use tetrahedra, or make the mesh "
            "finer yourself"
        )
    if _is_meshed_again(scene, is_own):
        return ""
    if cell == "quadrilateral":
        return (
            "quadrilaterals that are a mesh already cannot be refined: give their geometry (.geo, "
            ".step or .brep), or a mesh of triangles"
        )
    if not is_of_order_1(body.mesh):
        return (
            "cells of order 2 that are a mesh already cannot be refined: give their geometry "
            "(.geo, .step or .brep), or a mesh of order 1"
        )
    return ""


@dataclass(frozen=True, eq=False)
class MeshDensity:
    """Number and distribution of the cells of the next mesh.

    Attributes:
        number: Number of cells, apart from those that ``edges`` ask for.
        squared: Share of the squared error in each own cell of the last mesh, (cells,).
        edges: Rows of x, y, z and a size that cells there are not to exceed, of this rank (length).
    """

    number: float
    squared: Array
    edges: Array


class Meshed(Protocol):
    """Object with a mesh, as a ``Problem``."""

    @property
    def body(self) -> Body:
        """Body with its mesh."""

    @property
    def spaces(self) -> Spaces:
        """Function spaces on the mesh."""

    @property
    def comm(self) -> MPI.Comm:
        """Communicator."""


def next_mesh(scene: Scene, problem: Meshed, density: MeshDensity, is_own: bool) -> Body:
    """A mesh whose cells have errors that are about equal; collective.

    Args:
        scene: With its meshes.
        problem: On the last mesh, which nothing hinders.
        density: Number and distribution of its cells.
        is_own: Whether the first mesh was passed in place of the scene's.

    Raises:
        InputError: Gmsh cannot make it, or it is unsound.
    """
    body, comm = problem.body, problem.comm
    rows = _own_cells(scene, body, density.squared) | {"edges": density.edges}
    gathered = gathered_on_root(comm, rows)

    def found() -> tuple[_All, Array]:
        assert gathered is not None  # on rank 0
        every = _All(body.mesh.topology.cell_name(), gathered)
        return every, _sizes(every, problem.spaces.degree, density.number)

    if not _is_meshed_again(scene, is_own):
        marked: list[Flags] = []  # stay on rank 0
        on_root(comm, lambda: marked.append(_marked(*found(), density.number)))
        return refined(body, marked[0] if marked else None)
    fields: list[SizeField] = []  # stay on rank 0
    on_root(comm, lambda: fields.extend(_fields(*found())))
    curved = scene.discretisation.degree > 1
    return load_body(
        scene.mesh, scene.dimension, comm, fields, curved=curved, preloads=scene.preload
    )


def _is_meshed_again(scene: Scene, is_own: bool) -> bool:
    return not is_own and all(is_geometry(source) for source in scene.mesh)


def _own_cells(scene: Scene, body: Body, squared: Array) -> dict[str, Any]:
    """This rank's cells: vertices with their places, errors, and which mesh and body each is of."""
    mesh = body.mesh
    cells = mesh.topology.index_map(body.dimension).size_local
    corners = CORNERS[mesh.topology.cell_name()]
    nodes = compat.geometry_nodes(mesh)[:cells, :corners]
    sources = np.zeros(cells, dtype=np.int64)
    for number, source in enumerate(scene.mesh if len(scene.mesh) > 1 else ()):
        group = body.find(source.name)
        if group is not None:
            mine = body.entities(group)
            sources[mine[mine < cells]] = number
    return {
        "vertices": np.asarray(mesh.geometry.input_global_indices)[nodes],
        "points": mesh.geometry.x[nodes][:, :, : mesh.geometry.dim],
        "squared": squared,
        "sources": sources,
        "tags": all_values(body.cell_tags, cells),
    }


class _All:
    """Cells of all ranks, on rank 0, in the order of ranks."""

    def __init__(self, cell: str, gathered: list[dict[str, Any]]) -> None:
        joined = {name: np.concatenate([rows[name] for rows in gathered]) for name in gathered[0]}
        self.squared, self.sources = joined["squared"], joined["sources"]
        self.edges, self._tags = joined["edges"], joined["tags"]
        _, first, vertices = np.unique(joined["vertices"], return_index=True, return_inverse=True)
        points = joined["points"].reshape(-1, joined["points"].shape[2])[first]
        self.cells = Cells(cell, points, vertices.reshape(joined["vertices"].shape))

    def of_source(self, source: int) -> tuple[Flags, Integers]:
        """Flags of the cells of one mesh of the scene, and Gmsh's numbers of their bodies.

        Meshes that are joined have tags that begin behind those of the mesh before.
        """
        mine = self.sources == source
        before = self._tags[self.sources < source].max(initial=0)
        return mine, (self._tags[mine] - before).astype(np.int64)


def _sizes(found: _All, order: int, number: float) -> Array:
    """At the vertices of all cells, graded (length)."""
    cells = found.cells
    sizes = next_sizes(cells, found.squared, order, number)
    places, wanted = found.edges[:, : cells.dimension], found.edges[:, 3]
    return graded(cells.points, cells.edges(), finer_at(cells, sizes, places, wanted))


def _fields(found: _All, sizes: Array) -> list[SizeField]:
    """Sizes for every mesh of the scene; all cells together are so many."""
    places, wanted = found.edges[:, : found.cells.dimension], found.edges[:, 3]
    fields = []
    for source in range(int(found.sources.max(initial=0)) + 1):
        mine, bodies = found.of_source(source)
        part, used = found.cells.part(mine)
        fields.append(SizeField.of(part, sizes[used], bodies).finer_at(places, wanted))
    return fields


def _marked(found: _All, sizes: Array, number: float) -> Flags:
    """Cells that are to be cut, in the order of ranks: those that should become the smallest.

    Cutting makes four cells of a triangle, and eight of a tetrahedron.
    """
    ratio = np.log(sizes)[found.cells.vertices].mean(axis=1) - np.log(found.cells.sizes())
    most = max(int((number - len(ratio)) / (2**found.cells.dimension - 1)), 1)
    limit = np.sort(ratio)[min(most, len(ratio)) - 1]
    return np.asarray(ratio <= max(min(limit, np.log(_CUT)), ratio.min()))


# Meshes before the first one that is solved, at the most.
_MOST = 8


@dataclass(frozen=True, eq=False)
class _Meshed:
    """A mesh of a scene, as ``next_mesh`` takes one."""

    body: Body
    spaces: Spaces
    comm: MPI.Comm


def first_run(scene: Scene, comm: MPI.Comm, body: Body | None = None) -> Run:
    """A scene made ready; if it asks for an accuracy, on a mesh that shows its obstacles.

    Collective.

    Args:
        scene: What to solve.
        comm: Communicator.
        body: The mesh, if not the one the scene names.

    Raises:
        InputError: As ``Run``.
        MachineError: As ``Run``.
    """
    is_own, meshes = body is not None, 0
    while True:
        try:
            run = Run(scene, comm, body, own_mesh=is_own)
        except TooCoarseError as error:
            mesh, rows = error.spaces, error.finer
            if not _may_be_finer(scene, mesh.body, is_own) or meshes == _MOST:
                raise
        else:
            if not _may_be_finer(scene, run.problem.body, is_own) or meshes == _MOST:
                return run
            mesh, rows = run.problem.spaces, _of_hidden(run)
            if total(comm, len(rows)) == 0:
                return run
        body = finer_there(scene, mesh, rows, is_own)
        meshes += 1


def finer_there(scene: Scene, spaces: Spaces, rows: Array, is_own: bool) -> Body:
    """A mesh as the last one, with smaller cells at some places; collective.

    Args:
        scene: With its meshes.
        spaces: On the last mesh.
        rows: Of x, y, z and a size that cells there are not to exceed, of this rank (length).
        is_own: Whether the first mesh was passed in place of the scene's.

    Raises:
        InputError: Gmsh cannot make it, or it is unsound.
    """
    body, comm = spaces.body, spaces.comm
    cells = body.mesh.topology.index_map(body.dimension)
    alike = np.ones(cells.size_local)
    density = MeshDensity(float(cells.size_global), alike / cells.size_global, rows)
    return next_mesh(scene, _Meshed(body, spaces, comm), density, is_own)


def sizes_by_curvature(run: Run) -> list[Array]:
    """Sizes of cells at contacts that ``mesh.curvature`` asks for, and errors of cells do not.

    Where surfaces are far from contacts, errors alone decide how many cells are around a radius.

    Args:
        run: On the first mesh.

    Returns:
        Of each contact rows of x, y, z and a size, on this rank; none without curvature (length).
    """
    is_asked = any(source.curvature is not None for source in run.scene.mesh)
    found = []
    for contact in run.problem.contacts:
        traces = [contact.trace, contact.sides.opposite] if is_asked else []
        rows = [facet_sizes(trace) for trace in traces if trace is not None]
        found.append(np.concatenate([np.zeros((0, 4)), *rows]))
    return found


def _may_be_finer(scene: Scene, body: Body, is_own: bool) -> bool:
    return scene.accuracy is not None and not hindrance(scene, body, is_own)


def _of_hidden(run: Run) -> Array:
    """Rows for ``finer_there``, of rank 0."""
    rows = [[*one.place, one.wanted] for one in hidden_obstacles(run.problem)]
    mine = rows if run.problem.comm.rank == 0 else []
    return np.array(mine, dtype=np.float64).reshape(-1, 4)
