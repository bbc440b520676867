"""Nodal fields in VTK's XML files, binary: as text they took half as long as a 2D solve."""

from __future__ import annotations

import base64
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from dolfinx import plot
from numpy.typing import NDArray

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import MachineError
from fenics_contact.common.parallel import on_root, raise_together

_ORDER = {"little": "LittleEndian", "big": "BigEndian"}[sys.byteorder]
# Before 2.1 the nodes of hexahedra of degree 2 had another order.
_VERSION = "2.2"
_TYPES = {"float64": "Float64", "int64": "Int64", "int16": "Int16", "uint8": "UInt8"}


def write_grid(
    folder: Path,
    stem: str,
    number: int,
    space: Any,
    fields: Mapping[str, Array],
    of_cells: Mapping[str, NDArray[Any]],
) -> str:
    """Write a grid with its fields, in one piece a rank; collective.

    Args:
        folder: Where to.
        stem: With which the names of the files begin.
        number: With which they end.
        space: Lagrange space whose nodes are the grid's points.
        fields: Values at the nodes of this rank, (nodes,) or (nodes, components).
        of_cells: Values of the cells that this rank owns, (cells,).

    Returns:
        The name of the file that holds the pieces together.

    Raises:
        MachineError: A file could not be written; on every rank.
    """
    comm = space.mesh.comm
    pieces = [f"{stem}_p{rank}_{number:06d}.vtu" for rank in range(comm.size)]
    cells, kinds, points = plot.vtk_mesh(space)
    # Cells that this rank owns, and only the nodes that these have.
    width = space.dofmap.dof_layout.num_dofs
    used, cells = np.unique(cells.reshape(-1, width + 1)[:, 1:], return_inverse=True)
    ends = (np.arange(len(kinds)) + 1) * width
    topology = {
        "connectivity": cells.reshape(-1).astype(np.int64),
        "offsets": ends.astype(np.int64),
        "types": np.asarray(kinds, dtype=np.uint8),
    }
    body = (
        f'<Piece NumberOfPoints="{len(used)}" NumberOfCells="{len(kinds)}">\n'
        + _block("Points", {"points": points[used]})
        + _block("Cells", topology)
        + _block("PointData", {name: values[used] for name, values in fields.items()})
        + _block("CellData", of_cells)
        + "</Piece>\n"
    )
    error: MachineError | None = None
    try:
        _write(folder / pieces[comm.rank], "UnstructuredGrid", body)
    except MachineError as caught:
        error = caught
    raise_together(comm, error)  # they are held together when all are written
    whole = f"{stem}{number:06d}.pvtu"
    on_root(comm, lambda: _write_whole(folder / whole, pieces, fields, of_cells))
    return whole


def _write_whole(
    path: Path,
    pieces: list[str],
    fields: Mapping[str, Array],
    of_cells: Mapping[str, NDArray[Any]],
) -> None:
    """The file that names the pieces of a grid."""
    names = "".join(f'<Piece Source="{piece}"/>\n' for piece in pieces)
    empty = {name: values[:0] for name, values in fields.items()}
    kinds = _block("PPoints", {"points": np.zeros((0, 3))}) + _block("PPointData", empty)
    kinds += _block("PCellData", of_cells)
    _write(path, "PUnstructuredGrid", kinds + names)


def write_collection(path: Path, grids: Mapping[str, float]) -> None:
    """Write a ``.pvd``, in one move: which grid is of which pseudo-time.

    Args:
        path: Of the file.
        grids: Names of the grids' files beside it → pseudo-time.
    """
    entries = (
        f'<DataSet timestep="{time!r}" part="0" file="{name}"/>\n' for name, time in grids.items()
    )
    _write(path, "Collection", "".join(entries))


def read_collection(path: Path) -> dict[str, float]:
    """Grids of a ``.pvd`` and their pseudo-times; none where there is no such file."""
    if not path.exists():
        return {}
    found = ElementTree.parse(path).getroot().iter("DataSet")
    return {entry.attrib["file"]: float(entry.attrib["timestep"]) for entry in found}


def _write(path: Path, kind: str, content: str) -> None:
    text = (
        f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="{_VERSION}" byte_order="{_ORDER}" '
        f'header_type="UInt64">\n<{kind}>\n{content}</{kind}>\n</VTKFile>\n'
    )
    replace_file(path, text.encode("ascii"))


def _block(name: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    """A block of arrays; those whose name begins with P only announce them."""
    tag = "PDataArray" if name.startswith("PP") else "DataArray"
    lines = [f"<{name}>\n"]
    for key, values in arrays.items():
        width = values.shape[1] if values.ndim == 2 else 1
        kind = f'type="{_TYPES[values.dtype.name]}" Name={_quoted(key)}'
        kind += f' NumberOfComponents="{width}"'
        content = "" if tag.startswith("P") else _encoded(values)
        lines.append(f'<{tag} {kind} format="binary">{content}</{tag}>\n')
    return "".join([*lines, f"</{name}>\n"])


def _quoted(text: str) -> str:
    """Any text as an attribute of ASCII letters."""
    return quoteattr(text).encode("ascii", "xmlcharrefreplace").decode("ascii")


def _encoded(values: NDArray[Any]) -> str:
    """An array's bytes behind their number, as VTK's binary arrays are."""
    raw = np.ascontiguousarray(values).tobytes()
    return base64.b64encode(np.uint64(len(raw)).tobytes() + raw).decode("ascii")
