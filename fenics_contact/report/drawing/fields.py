"""The fields of a run from its files: whole or damaged, the body, and its surface as triangles."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.results.contact_points import BODY_OF_CELLS

if TYPE_CHECKING:
    from pyvista import PolyData, UnstructuredGrid

# Curved cells are drawn as 64, 16 or 4 triangles each: so many cells at most as 64, as 16.
_FEW, _MANY = 300, 2_000
# Shares of the largest that nodes of two ranks may differ by, and are still one.
_SAME = 1e-8
# The sides of a cell in space are drawn curved up to so many cells.
_CURVED = 1_000
# Corners of flat cells, by VTK's types: triangles of 3 and 6 nodes and quadrilaterals of 4, 8 and
# 9, and both with nodes in Lagrange's order. A node on each side follows where there are more.
_CORNERS = {5: 3, 22: 3, 69: 3, 9: 4, 23: 4, 28: 4, 70: 4}
# Cells in space by VTK's types: corners, and the type of a cell of corners alone.
_LINEAR = {
    10: (4, 10),
    24: (4, 10),
    71: (4, 10),
    12: (8, 12),
    25: (8, 12),
    29: (8, 12),
    72: (8, 12),
}


def read_body(folder: Path) -> UnstructuredGrid:
    """The body as a pyvista grid with the fields of the last step in ``fields.pvd``."""
    ((_, body),) = read_series(folder, [len(times_of_fields(folder)) - 1])
    return body


def times_of_fields(folder: Path) -> list[float]:
    """Pseudo-times of the steps in ``fields.pvd``."""
    import pyvista

    return list(pyvista.get_reader(str(folder / "fields.pvd")).time_values)


def read_series(folder: Path, numbers: Iterable[int]) -> Iterator[tuple[float, UnstructuredGrid]]:
    """Pseudo-times of steps in ``fields.pvd``, by number, and the body with their fields."""
    for time, body in _grids(folder / "fields.pvd", numbers):
        body["von Mises stress"] = von_mises(np.asarray(body["stress"]))
        yield time, body


def read_modes(folder: Path, name: str = "modes") -> Iterator[UnstructuredGrid]:
    """The body with the displacement of each mode in ``modes.pvd``, or another collection."""
    import pyvista

    path = folder / f"{name}.pvd"
    count = len(pyvista.get_reader(str(path)).time_values)
    for _, body in _grids(path, range(count)):
        yield body


def _grids(path: Path, numbers: Iterable[int]) -> Iterator[tuple[float, UnstructuredGrid]]:
    """Yield the times and grids of a collection, by number."""
    import pyvista

    reader = pyvista.get_reader(str(path))
    for number in numbers:
        time = reader.time_values[number]
        reader.set_active_time_value(time)
        body = reader.read().combine()
        files = [path.parent / data.path for data in reader.active_datasets]
        if sum(file.read_bytes().count(b"<Piece ") for file in files) > 1:
            body = joined(body)
        yield time, body


def joined(grid: UnstructuredGrid) -> UnstructuredGrid:
    """The grid without the nodes that pieces of several ranks share, which each of them has.

    Nodes of two bodies that lie at the same place stay apart.
    """
    size = np.ptp(grid.points, axis=0).max()
    apart = body_of_nodes(grid).astype(float)
    shared = np.round(np.column_stack([grid.points / size, apart]) / _SAME)
    _, first, where = np.unique(shared, axis=0, return_index=True, return_inverse=True)
    nodes = where.reshape(-1)[grid.cell_connectivity].reshape(grid.n_cells, -1)  # of one type
    sizes = np.full((grid.n_cells, 1), nodes.shape[1])
    whole = type(grid)(np.hstack([sizes, nodes]).ravel(), grid.celltypes, grid.points[first])
    for name in grid.point_data:
        whole.point_data[name] = grid.point_data[name][first]
    for name in grid.cell_data:
        whole.cell_data[name] = grid.cell_data[name]
    return whole


def body_of_nodes(grid: UnstructuredGrid) -> Integers:
    """Number of the connected part of each node, (nodes,)."""
    found = np.zeros(grid.n_points, dtype=np.int64)
    nodes = grid.cell_connectivity.reshape(grid.n_cells, -1)  # all cells are of one type
    found[nodes] = np.asarray(grid.cell_data[BODY_OF_CELLS])[:, None]
    return found


def von_mises(stress: Array) -> Array:
    """Return the von Mises stress of stresses (points, 9), (points,) (stress)."""
    tensor = stress.reshape(-1, 3, 3)
    deviator = tensor - np.trace(tensor, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    found: Array = np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator))
    return found


def largest_shear(stress: Array) -> Array:
    """Half of the largest less the smallest principal stress, of stresses (points, 9) (stress)."""
    tensor = stress.reshape(-1, 3, 3)
    principal = np.linalg.eigvalsh((tensor + tensor.transpose(0, 2, 1)) / 2)
    shear: Array = (principal[:, 2] - principal[:, 0]) / 2
    return shear


@dataclass(frozen=True)
class Triangles:
    """A surface as triangles between points that carry fields.

    Attributes:
        points: Undeformed, (points, 3) (length).
        corners: Numbers of each triangle's points, (triangles, 3).
        fields: Values at the points, by name.
    """

    points: Array
    corners: Integers
    fields: dict[str, Array]

    @classmethod
    def of(cls, grid: UnstructuredGrid, *names: str) -> Triangles:
        """The surface of a grid, or all of a flat one; curved cells become several triangles."""
        whole = surface(grid, _level(grid.n_cells)).triangulate()
        corners = np.asarray(whole.faces).reshape(-1, 4)[:, 1:].astype(np.int64)
        fields = {name: np.asarray(whole[name]) for name in names}
        return cls(np.asarray(whole.points, dtype=float), corners, fields)

    def moved(self, factor: float) -> Array:
        """The points where they moved to, displacements magnified, (points, 3) (length)."""
        return self.points + factor * self.fields["displacement"]

    def inside(self, low: Array, high: Array) -> Triangles:
        """The triangles that reach into a box; coordinates as many as wanted."""
        axes = len(low)
        span = self.points[self.corners][:, :, :axes]
        kept = ((span.max(axis=1) >= low) & (span.min(axis=1) <= high)).all(axis=1)
        used, corners = np.unique(self.corners[kept], return_inverse=True)
        fields = {name: values[used] for name, values in self.fields.items()}
        return Triangles(self.points[used], corners.reshape(-1, 3).astype(np.int64), fields)


def _level(cells: int) -> int:
    return 3 if cells < _FEW else 2 if cells < _MANY else 1


def surface(grid: UnstructuredGrid, subdivision: int = 1) -> PolyData:
    """Surface of a grid; curved cells are subdivided."""
    import pyvista
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    found = vtkDataSetSurfaceFilter()
    found.SetInputData(grid)
    found.SetNonlinearSubdivisionLevel(subdivision)
    found.Update()
    return pyvista.wrap(found.GetOutput())


def outline(grid: UnstructuredGrid, subdivision: int = 3) -> PolyData:
    """Boundary lines, and in space sharp edges, as a pyvista surface of lines."""
    return surface(grid, subdivision).extract_feature_edges(
        boundary_edges=True, feature_edges=True, manifold_edges=False, non_manifold_edges=False
    )


def flat_sides(grid: UnstructuredGrid) -> tuple[Integers, Flags]:
    """Nodes of every side of every cell of a flat grid once: ends, and one between where it has it.

    Returns:
        Shape (sides, 2) or (sides, 3), as all cells are of one degree; and which of them lie on
        the boundary.
    """
    found = []
    for kind, nodes in grid.cells_dict.items():
        corners = _CORNERS[int(kind)]
        start = nodes[:, :corners]
        sides = [start, np.roll(start, -1, axis=1)]
        if nodes.shape[1] > corners:
            sides.insert(1, nodes[:, corners : 2 * corners])
        found.append(np.stack(sides, axis=2).reshape(-1, len(sides)))
    every = np.concatenate(found).astype(np.int64)
    ends = np.sort(every[:, [0, -1]], axis=1)
    _, first, count = np.unique(ends, axis=0, return_index=True, return_counts=True)
    return every[first], count == 1


def flat_outline(grid: UnstructuredGrid) -> list[Array]:
    """The boundary of a flat grid as lines, the points of each, (points, 3) (length)."""
    sides, outer = flat_sides(grid)
    onwards: dict[int, list[list[int]]] = {}
    for side in sides[outer].tolist():
        onwards.setdefault(side[0], []).append(side[1:])
    points, lines = np.asarray(grid.points, dtype=float), []
    while onwards:  # the cells are on the left all along
        line = [next(iter(onwards))]
        while line[-1] in onwards:
            nexts = onwards[line[-1]]
            end = nexts.pop()
            if not nexts:
                del onwards[line[-1]]
            line += end
        lines.append(points[line])
    return lines


def surface_edges(grid: UnstructuredGrid) -> PolyData:
    """Return the edges of faces on a body's surface, as a surface of lines.

    Those of a few cells may be curved; of many cells they are straight.
    """
    if grid.n_cells < _CURVED:
        return outline(grid.separate_cells())
    import pyvista

    nodes = grid.cell_connectivity.reshape(grid.n_cells, -1)  # all cells are of one type
    count, kind = _LINEAR[int(grid.celltypes[0])]
    cells = np.hstack([np.full((grid.n_cells, 1), count), nodes[:, :count]]).ravel()
    straight = pyvista.UnstructuredGrid(cells, np.full(grid.n_cells, kind), grid.points)
    straight["displacement"] = grid["displacement"]
    return surface(straight).extract_all_edges()


def segments(lines: PolyData) -> Array:
    """Ends of the pieces of lines, (pieces, 2, 3) (length)."""
    ends = np.asarray(lines.lines).reshape(-1, 3)[:, 1:]
    found: Array = np.asarray(lines.points, dtype=float)[ends]
    return found


_END = b"</VTKFile>"
_NEEDED = ("displacement", "stress", "status", "contact_pressure", "friction_traction")


def whole_body(folder: Path) -> UnstructuredGrid:
    """The body as a pyvista grid with the fields of the last step, once all files are looked at.

    Args:
        folder: Of a run, with ``fields.pvd``.

    Raises:
        InputError: A file is missing or damaged; says which.
    """
    grids = list(_named(folder / "fields.pvd", "DataSet", "file"))
    for grid in grids:
        pieces = list(_named(grid, "Piece", "Source"))
        for piece in pieces:
            _require_end(piece)
    for piece in pieces:  # of the last step; what is missing VTK would make up
        content = piece.read_bytes()
        missing = [name for name in _NEEDED if f'Name="{name}"'.encode() not in content]
        if missing:
            raise _damaged(piece, f"it lacks {', '.join(missing)}")
    try:
        return read_body(folder)
    except (KeyError, ValueError) as error:  # of a file that is damaged inside
        raise _damaged(grids[-1], str(error)) from None


def _named(path: Path, tag: str, attribute: str) -> Iterator[Path]:
    """The files that a file names, in the same folder."""
    _require_end(path)
    try:
        found = [entry.attrib[attribute] for entry in ElementTree.parse(path).iter(tag)]
    except (ElementTree.ParseError, KeyError) as error:
        raise _damaged(path, str(error)) from None
    if not found:
        raise _damaged(path, "it names no files")
    yield from (path.parent / name for name in found)


def _require_end(path: Path) -> None:
    """A file that was cut off has no end."""
    try:
        with path.open("rb") as file:
            file.seek(max(path.stat().st_size - 2 * len(_END), 0))
            rest = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if _END not in rest:
        raise _damaged(path, "its end is missing")


def _damaged(path: Path, why: str) -> InputError:
    return InputError(f"{path}: damaged: {why}; make the run again")
