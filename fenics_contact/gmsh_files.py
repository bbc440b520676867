"""Geometries and mesh files to a ``Body``, with Gmsh in a process of its own.

Rank 0 has Gmsh mesh or read the file and examines the result; what goes wrong there is
raised on every rank. Then the cells are dealt out.
"""

from __future__ import annotations

import io
import json
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact import compat, mesh_arrays, mesh_join
from fenics_contact.errors import InputError
from fenics_contact.geometry_script import require_harmless, require_mesh
from fenics_contact.mesh import Body
from fenics_contact.mesh_arrays import MeshArrays
from fenics_contact.mesh_sizes import SizeField
from fenics_contact.parallel import on_root
from fenics_contact.scene import MeshSource

_KINDS = {".geo": "geo", ".msh": "msh", ".step": "cad", ".stp": "cad", ".brep": "cad"}
_CAD_FORMATS = {".step": "step", ".stp": "step", ".brep": "brep"}
# Of reading a mesh that exists; meshing a geometry may take what it needs.
_BASE_MEMORY, _MEMORY_PER_BYTE = 4 * 2**30, 100
_BASE_SECONDS, _SECONDS_PER_BYTE = 60.0, 2e-6
# Length units of STEP files by their SI prefix, as Gmsh calls them.
_STEP_UNITS = {"$": "M", ".MILLI.": "MM", ".CENTI.": "CM", ".KILO.": "KM", ".MICRO.": "UM"}


def load_body(
    sources: MeshSource | Sequence[MeshSource],
    dimension: int,
    comm: MPI.Comm,
    sizes: Sequence[SizeField] | None = None,
    curved: bool = False,
) -> Body:
    """Mesh geometries, or read meshes, put them together and distribute the whole.

    Args:
        sources: Files and how to mesh them.
        dimension: Dimension of the model, 2 or 3; the meshes must have the same.
        comm: Communicator; collective.
        sizes: Of the cells to be made, one field a source; used on rank 0 only. The sources are
            geometries then, and by default meshed as they say.
        curved: Whether cells of geometries that are not straight get a geometry of order 2.

    Raises:
        InputError: A file is missing, Gmsh refuses it, or its mesh is unsound; or the meshes
            are of several kinds of cells.
    """
    if isinstance(sources, MeshSource):
        sources = [sources]
    arrays: list[MeshArrays] = []  # stays on rank 0

    def prepare() -> tuple[Any, ...]:
        made = _load_all(sources, dimension, sizes, curved)
        arrays.append(made)
        return made.cell, made.order, made.facets.shape[1], made.groups, made.numbers

    cell, order, facet_nodes, groups, numbers = on_root(comm, prepare)
    if arrays:
        made = arrays.pop()
        points, cells, cell_tags = made.points, made.cells, made.cell_tags
        facets, facet_tags = made.facets, made.facet_tags
    else:
        nodes = mesh_arrays.nodes_of(cell, order)
        points, cells = np.zeros((0, dimension)), np.zeros((0, nodes), dtype=np.int64)
        facets = np.zeros((0, facet_nodes), dtype=np.int64)
        cell_tags, facet_tags = np.zeros(0, dtype=np.int32), np.zeros(0, dtype=np.int32)
    mesh = compat.create_mesh(comm, cell, order, points, cells)
    return Body(
        mesh,
        compat.distributed_tags(mesh, dimension, cells, cell_tags),
        compat.distributed_tags(mesh, dimension - 1, facets, facet_tags),
        groups,
        " and ".join(dict.fromkeys(source.file for source in sources)),
        numbers,
    )


def _load_all(
    sources: Sequence[MeshSource],
    dimension: int,
    sizes: Sequence[SizeField] | None,
    curved: bool,
) -> MeshArrays:
    """The meshes of all files as one; on rank 0."""
    keys = [f"mesh[{number}]" for number in range(len(sources))] if len(sources) > 1 else ["mesh"]
    fields: Sequence[SizeField | None] = sizes or [None] * len(sources)
    meshes = [
        _load(key, source, dimension, field, curved)
        for key, source, field in zip(keys, sources, fields, strict=True)
    ]
    if len(sources) == 1:
        return mesh_join.with_name("mesh", sources[0], meshes[0])
    return mesh_join.joined(sources, meshes)


def is_geometry(source: MeshSource) -> bool:
    """Whether it can be meshed with other sizes: whether it is no mesh already."""
    return _KINDS.get(Path(source.file).suffix.lower()) in ("geo", "cad")


def _load(
    key: str, source: MeshSource, dimension: int, sizes: SizeField | None, curved: bool
) -> MeshArrays:
    """The mesh of a file, examined; on rank 0.

    Args:
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
        source: The file and how to mesh it.
        dimension: Of the model.
        sizes: Of its cells, if not those that it asks for.
        curved: As for ``load_body``.
    """
    where = f"{key}.file = '{source.file}'"
    path = Path(source.file)
    if not path.is_file():
        raise InputError(f"{where}: there is no such file")
    suffix = path.suffix.lower()
    if suffix not in _KINDS:
        raise InputError(f"{where}: must end in {_either(_KINDS)}")
    _check_settings(key, source, _KINDS[suffix])
    job = _job(key, source, path, suffix, dimension)
    if job["kind"] != "msh":
        job |= {"curved": curved, "sizes": sizes is not None}
    if sizes is not None:
        job["cell"] = sizes.cell
    description, read = _run_gmsh(where, job, b"" if sizes is None else sizes.as_bytes())
    return mesh_arrays.build(read, description, source, dimension, key)


def _check_settings(key: str, source: MeshSource, kind: str) -> None:
    """Settings that the kind of file has no use for are mistakes."""
    meshing = {
        "cell": source.cell != "as meshed",
        "order": source.order != 1,
        "size": source.size is not None,
        "curvature": source.curvature is not None,
    }
    given = [name for name, is_given in meshing.items() if is_given]
    if kind == "msh" and (given or source.parameters):
        raise InputError(
            f"{key}.file = '{source.file}' is a mesh already: "
            f"{', '.join(given or ['parameters'])} cannot change it"
        )
    if kind == "cad" and source.parameters:
        raise InputError(f"{key}.parameters: only .geo files have parameters, not '{source.file}'")


def _job(key: str, source: MeshSource, path: Path, suffix: str, dimension: int) -> dict[str, Any]:
    """What ``gmsh_process`` is to do."""
    kind = _KINDS[suffix]
    job: dict[str, Any] = {"key": key, "kind": kind, "file": source.file, "memory": 0}
    job["dimension"] = dimension
    if kind != "cad":  # which is no script, and is read without Gmsh's way of opening files
        require_harmless(path, f"{key}.file")
    if kind == "msh":
        memory = _BASE_MEMORY + _MEMORY_PER_BYTE * path.stat().st_size
        return job | {"version": require_mesh(path, f"{key}.file"), "memory": memory}
    job |= {
        "cell": source.cell,
        "order": source.order,
        "size": source.size,
        "curvature": source.curvature,
    }
    if kind == "geo":
        return job | {"parameters": dict(source.parameters)}
    form = _CAD_FORMATS[suffix]
    return job | {"format": form, "unit": _step_unit(path) if form == "step" else ""}


def _step_unit(path: Path) -> str:
    """The length unit of a STEP file, so that its numbers come in as they are."""
    text = path.read_bytes().decode("latin-1")
    found = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'(INCH|FOOT|FT)'", text, re.IGNORECASE)
    if found is not None:
        return "INCH" if found[1].upper() == "INCH" else "FT"
    si = re.search(r"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.\s*\)", text)
    return _STEP_UNITS.get(si[1], "") if si is not None else ""


def _run_gmsh(
    where: str, job: Mapping[str, Any], sizes: bytes
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Run ``gmsh_process`` on a job: the model's description and the mesh's arrays."""
    program = Path(__file__).with_name("gmsh_process.py")
    # -P: the modules of this package must not stand in for those that Gmsh's imports want.
    command = [sys.executable, "-P", "-B", str(program), json.dumps(job)]
    seconds = None
    if job["kind"] == "msh":
        seconds = _BASE_SECONDS + _SECONDS_PER_BYTE * Path(job["file"]).stat().st_size
    try:
        with tempfile.TemporaryFile() as file:  # unlike a pipe, it may be left unread
            file.write(sizes)
            file.seek(0)
            done = subprocess.run(
                command, stdin=file, capture_output=True, check=False, timeout=seconds
            )
    except subprocess.TimeoutExpired:
        raise InputError(f"{where}: Gmsh cannot read it in {seconds:.0f} s; damaged?") from None
    if done.returncode == -signal.SIGKILL:
        raise MemoryError(f"{where}: Gmsh was killed, most likely for want of memory")
    if done.returncode != 0 or not done.stdout:
        raise InputError(f"{where}: Gmsh {_end(done)}; is the file damaged?")
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as data:
        arrays = dict(data)
    description = json.loads(str(arrays.pop("description")))
    if "refused" in description:
        raise InputError(description["refused"])
    if "gmsh" in description:
        raise InputError(f"{where}: Gmsh says: {description['gmsh']}")
    return description, arrays


def _end(done: subprocess.CompletedProcess[bytes]) -> str:
    """How a process ended that gave no mesh."""
    if done.returncode < 0:
        return f"crashed on it ({signal.Signals(-done.returncode).name})"
    last = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
    return f"gave no mesh ({' '.join(last) or 'it ended early'})"


def _either(words: Mapping[str, str]) -> str:
    *first, last = words
    return f"{', '.join(first)} or {last}"
