"""Meshes that are XML, as of ParaView (``.vtu``) and FEniCS (``.xdmf``), read by meshio.

Integer cell data are groups: ``NAME.VALUE``; or those names that the file itself gives the values,
as meshio does for Gmsh's.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.geometry.process_room import RefusedError
from fenics_contact.mesh.readers.element_kinds import as_gmsh, dimension_of
from fenics_contact.mesh.readers.found_mesh import FoundMesh, require_whole

# Gmsh's types by meshio's names.
_KINDS = {
    "vertex": 15,
    "line": 1,
    "line3": 8,
    "triangle": 2,
    "triangle6": 9,
    "quad": 3,
    "quad8": 16,
    "quad9": 10,
    "tetra": 4,
    "tetra10": 11,
    "hexahedron": 5,
    "hexahedron20": 17,
    "hexahedron27": 12,
    "wedge": 6,
    "wedge15": 18,
    "pyramid": 7,
    "pyramid13": 19,
}
# What VTK's cells of any order are with so many nodes, where the order of nodes is the same.
_LAGRANGE = {
    ("VTK_LAGRANGE_CURVE", 2): 1,
    ("VTK_LAGRANGE_CURVE", 3): 8,
    ("VTK_LAGRANGE_TRIANGLE", 3): 2,
    ("VTK_LAGRANGE_TRIANGLE", 6): 9,
    ("VTK_LAGRANGE_QUADRILATERAL", 4): 3,
    ("VTK_LAGRANGE_QUADRILATERAL", 9): 10,
    ("VTK_LAGRANGE_TETRAHEDRON", 4): 4,
    ("VTK_LAGRANGE_TETRAHEDRON", 10): 11,
    ("VTK_LAGRANGE_HEXAHEDRON", 8): 5,
}
_MOST_VALUES = 200  # of cell data that are groups; numbers of cells have more
_PIECE = 2**20  # bytes


def read_vtu(job: dict[str, Any]) -> FoundMesh:
    """The mesh of a ``.vtu`` file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    where = f"{job['key']}.file = '{job['name']}'"
    return _found(where, mesh_of_vtu(where, Path(job["file"])))


def read_xdmf(job: dict[str, Any]) -> FoundMesh:
    """The mesh of an ``.xdmf`` file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    where = f"{job['key']}.file = '{job['name']}'"
    return _found(where, mesh_of_xdmf(where, Path(job["file"])))


def mesh_of_vtu(where: str, path: Path) -> Any:
    """What meshio finds in a ``.vtu`` file, once it is known to be sound.

    Args:
        where: What begins a message.
        path: Of the file.

    Raises:
        RefusedError: It is not.
    """
    found = _Scan(where)
    found.read(path)
    if found.counts["Piece"] > 1:  # meshio keeps the cells of the last one
        raise RefusedError(f"{where}: has {found.counts['Piece']} pieces; save it as one")
    from meshio.vtu import read

    return read(path)


def mesh_of_xdmf(where: str, path: Path) -> Any:
    """What meshio finds in an ``.xdmf`` file; as ``mesh_of_vtu``."""
    path = path.resolve()  # meshio looks beside the file itself
    found = _Scan(where)
    found.read(path)
    if found.counts["Grid"] != 1:
        raise RefusedError(
            f"{where}: has {found.counts['Grid']} grids; it must have one, with groups as cell data"
        )
    for name in found.files:
        _require_inside(where, path.parent, name)
    from meshio.xdmf import read

    return read(str(path))


def _require_inside(where: str, folder: Path, name: str) -> None:
    """A file of data must be in the mesh's folder or below, and whole."""
    path = folder / name
    if Path(name).is_absolute() or not path.resolve().is_relative_to(folder):
        raise RefusedError(
            f"{where}: its data in '{name}' are outside the folder of the mesh, which it "
            "may not read"
        )
    if not os.path.isfile(path):
        raise RefusedError(f"{where}: its data in '{name}' are missing: there is no such file")
    require_whole(f"{where}: '{name}'", path)


class _Scan:
    """Looks through XML: what it has, the files that it names, and what no mesh needs.

    Attributes:
        counts: How often there is each element.
        files: HDF5 files that it names.

    Args:
        where: What begins a message.
    """

    def __init__(self, where: str) -> None:
        self.counts: Counter[str] = Counter()
        self.files: list[str] = []
        self._where = where
        self._text: list[str] | None = None
        self._format = ""

    def read(self, path: Path) -> None:
        """Look through a file."""
        parser = expat.ParserCreate()
        parser.StartDoctypeDeclHandler = self._doctype
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.CharacterDataHandler = self._characters
        with path.open("rb") as file:
            try:
                while piece := file.read(_PIECE):
                    parser.Parse(piece)
                parser.Parse(b"", True)
            except expat.ExpatError as error:
                # Raw data, which are no XML, may follow all else in a .vtu.
                if not self.counts["AppendedData"]:
                    raise RefusedError(f"{self._where}: is no sound XML ({error})") from None

    def _doctype(self, *_: Any) -> None:
        raise RefusedError(f"{self._where}: has a <!DOCTYPE …>, which a mesh may not; remove it")

    def _start(self, name: str, attributes: Mapping[str, str]) -> None:
        self.counts[name] += 1
        self._format = attributes.get("Format", "")
        if name == "DataItem" and self._format == "Binary":
            raise RefusedError(
                f"{self._where}: keeps data in binary files; write them as HDF5, or into the XML"
            )
        if name == "Information" or (name == "DataItem" and self._format == "HDF"):
            self._text = []

    def _characters(self, text: str) -> None:
        if self._text is not None:
            self._text.append(text)

    def _end(self, name: str) -> None:
        if self._text is None:
            return
        text = "".join(self._text).strip()
        self._text = None
        if name == "DataItem":
            self.files.append(text.partition(":")[0])
        elif "<!" in text:  # meshio takes it for XML in its own right
            self._doctype()


def _found(where: str, mesh: Any) -> FoundMesh:
    """Return the mesh that meshio has read."""
    elements: dict[int, list[Integers]] = {}
    numbers: dict[int, list[Integers]] = {}
    kinds, count = [], 0
    for block in mesh.cells:
        nodes = np.asarray(block.data)
        width = nodes.shape[1] if nodes.ndim == 2 else 0
        kind = _KINDS.get(block.type, _LAGRANGE.get((block.type, width), 0))
        if not kind:
            raise RefusedError(
                f"{where}: its elements are of the type {block.type}; there are: "
                f"{', '.join(_KINDS)}"
            )
        kinds.append(kind)
        elements.setdefault(kind, []).append(as_gmsh(kind, nodes.astype(np.int64)))
        # ParaView counts them from 0 in what it shows, and here 0 is no number of an element.
        numbers.setdefault(kind, []).append(count + 1 + np.arange(len(nodes)))
        count += len(nodes)
    points = np.zeros((len(mesh.points), 3))
    points[:, : mesh.points.shape[1]] = mesh.points
    return FoundMesh(
        np.arange(len(points)),
        points,
        {kind: np.concatenate(found) for kind, found in elements.items()},
        {kind: np.concatenate(found) for kind, found in numbers.items()},
        _sets(mesh, kinds),
    )


def _sets(mesh: Any, kinds: list[int]) -> dict[str, dict[int, Integers]]:
    """Groups by the values of integer cell data."""
    names = {
        (int(value[0]), int(value[1])): name
        for name, value in mesh.field_data.items()
        if np.shape(value) == (2,)
    }
    sets: dict[str, dict[int, Integers]] = {}
    for array, blocks in mesh.cell_data.items():
        blocks = [np.asarray(values) for values in blocks]
        blocks = [
            values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values
            for values in blocks
        ]
        if any(values.ndim != 1 or values.dtype.kind not in "iu" for values in blocks):
            continue
        every = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *blocks]))
        if len(every) > _MOST_VALUES:
            continue
        starts: Counter[int] = Counter()
        for kind, values in zip(kinds, blocks, strict=True):
            for value in np.unique(values):
                named = (
                    names.get((int(value), dimension_of(kind)))
                    if array == "gmsh:physical"
                    else None
                )
                rows_of = sets.setdefault(named or f"{array}.{value}", {})
                rows = starts[kind] + np.flatnonzero(values == value)
                rows_of[kind] = np.concatenate([rows_of.get(kind, rows[:0]), rows])
            starts[kind] += len(values)
    return sets
