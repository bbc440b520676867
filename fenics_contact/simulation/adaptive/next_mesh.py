"""The next mesh of a body, from the errors of the cells of the last one.

Geometries are meshed again with sizes of their cells. Triangles and tetrahedra that are a mesh
already are cut in two, and again, where their errors are large; their corners stay.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gathered_on_root, on_root
from fenics_contact.mesh.loading import is_geometry, load_body
from fenics_contact.mesh.refinement import CORNERS, is_of_order_1, refined
from fenics_contact.mesh.size_field import Cells, SizeField, finer_at, graded, next_sizes
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.scene.scene import Scene

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
    """This rank's cells: number and place of the vertices, errors, and which mesh each is of."""
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
    }


class _All:
    """Cells of all ranks, on rank 0, in the order of ranks."""

    def __init__(self, cell: str, gathered: list[dict[str, Any]]) -> None:
        joined = {name: np.concatenate([rows[name] for rows in gathered]) for name in gathered[0]}
        self.squared, self.sources = joined["squared"], joined["sources"]
        self.edges = joined["edges"]
        _, first, vertices = np.unique(joined["vertices"], return_index=True, return_inverse=True)
        points = joined["points"].reshape(-1, joined["points"].shape[2])[first]
        self.cells = Cells(cell, points, vertices.reshape(joined["vertices"].shape))


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
        part, used = found.cells.part(found.sources == source)
        fields.append(SizeField.of(part, sizes[used]).finer_at(places, wanted))
    return fields


def _marked(found: _All, sizes: Array, number: float) -> Flags:
    """Cells that are to be cut, in the order of ranks: those that should become the smallest.

    Cutting makes four cells of a triangle, and eight of a tetrahedron.
    """
    ratio = np.log(sizes)[found.cells.vertices].mean(axis=1) - np.log(found.cells.sizes())
    most = max(int((number - len(ratio)) / (2**found.cells.dimension - 1)), 1)
    limit = np.sort(ratio)[min(most, len(ratio)) - 1]
    return np.asarray(ratio <= max(min(limit, np.log(_CUT)), ratio.min()))
