"""Geometries and mesh files to a ``Body``, with Gmsh in a process of its own.

Rank 0 has Gmsh mesh or read the file and examines the result; what goes wrong there is
raised on every rank. Then the cells are dealt out.
"""

from __future__ import annotations

import dataclasses
import logging
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root
from fenics_contact.mesh import from_gmsh as mesh_arrays
from fenics_contact.mesh import joining as mesh_join
from fenics_contact.mesh.file_groups import BetweenFiles, no_surface
from fenics_contact.mesh.from_gmsh import MeshArrays
from fenics_contact.mesh.geometry import gmsh_call
from fenics_contact.mesh.geometry.file_kinds import (
    GEOMETRIES,
    MeshFile,
    kind_of,
    mesh_file,
    prepared,
)
from fenics_contact.mesh.joining import Cut, bolts_of, cuts_of
from fenics_contact.mesh.neighbours import Finding, Neighbours
from fenics_contact.mesh.size_field import SizeField
from fenics_contact.mesh.subdivision.collapsed import without_collapsed
from fenics_contact.mesh.subdivision.uniform import Form, common_form, form_of
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.scene import MeshSource, Scene

logger = logging.getLogger(__name__)

# Of reading a mesh that exists; meshing a geometry may take what there is.
_BASE_MEMORY, _MEMORY_PER_BYTE = 4 * 2**30, 100
# Length units of STEP files by their SI prefix, as Gmsh calls them.
_WORDS = {"M": "m", "CM": "cm", "KM": "km", "UM": "µm", "INCH": "inches", "FT": "feet"}
_STEP_UNITS = {"$": "M", ".MILLI.": "MM", ".CENTI.": "CM", ".KILO.": "KM", ".MICRO.": "UM"}


def load_body(
    sources: MeshSource | Sequence[MeshSource],
    dimension: int,
    comm: MPI.Comm,
    sizes: Sequence[SizeField] | None = None,
    curved: bool = False,
    preloads: Sequence[Preload] = (),
    arrays: MeshArrays | None = None,
) -> Body:
    """Mesh geometries, or read meshes, put them together and distribute the whole.

    Args:
        sources: Files and how to mesh them.
        dimension: Dimension of the model, 2 or 3; the meshes must have the same.
        comm: Communicator; collective.
        sizes: Of the cells to be made, one field a source; used on rank 0 only. The sources are
            geometries then, and by default meshed as they say.
        curved: Whether cells of geometries that are not straight get a geometry of order 2.
        preloads: Of the scene; bodies are cut for those that say where.
        arrays: As ``load_arrays`` gives them, if they are made already; used on rank 0 only.

    Raises:
        InputError: A file is missing, Gmsh refuses it, or its mesh is unsound; or the meshes
            are of several kinds of cells.
    """
    if isinstance(sources, MeshSource):
        sources = [sources]
    found: list[MeshArrays] = []  # stays on rank 0

    def prepare() -> tuple[Any, ...]:
        cuts = bolts_of(sources, preloads)
        made = arrays or _load_all(sources, dimension, sizes, curved, cuts)
        found.append(made)
        named = made.named, made.numbers, made.relations, made.kinematics, made.notes
        return made.cell, made.order, made.facets.shape[1], named

    cell, order, facet_nodes, named = on_root(comm, prepare)
    groups, numbers, relations, kinematics, notes = named
    if found:
        made = found.pop()
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
        relations,
        kinematics,
        notes,
    )


def load_arrays(
    sources: Sequence[MeshSource], dimension: int, preloads: Sequence[Preload] = ()
) -> MeshArrays:
    """The meshes of all files as one, not distributed yet; on one rank.

    Args:
        sources: As of ``load_body``.
        dimension: Likewise.
        preloads: Likewise.

    Raises:
        InputError: As of ``load_body``.
    """
    return _load_all(sources, dimension, None, False, bolts_of(sources, preloads))


def _load_all(
    sources: Sequence[MeshSource],
    dimension: int,
    sizes: Sequence[SizeField] | None,
    curved: bool,
    cuts: Sequence[Sequence[Cut]],
) -> MeshArrays:
    """The meshes of all files as one; on rank 0."""
    keys = [f"mesh[{number}]" for number in range(len(sources))] if len(sources) > 1 else ["mesh"]
    fields: Sequence[SizeField | None] = sizes or [None] * len(sources)
    answers = [
        _read(key, source, dimension, field, curved, of_source)
        for key, source, field, of_source in zip(keys, sources, fields, cuts, strict=True)
    ]
    form = common_form(form_of(read, said, dimension) for said, read in answers)
    meshes = [
        _load(key, source, dimension, answer, form)
        for key, source, answer in zip(keys, sources, answers, strict=True)
    ]
    if len(sources) == 1:
        return mesh_join.with_name("mesh", sources[0], meshes[0])
    made = mesh_join.joined(sources, meshes)
    return _examined("mesh", made, _between(sources, meshes, made))


def is_geometry(source: MeshSource) -> bool:
    """Whether it can be meshed with other sizes: whether it is no mesh already."""
    return kind_of(source.file) in GEOMETRIES


def _load(
    key: str, source: MeshSource, dimension: int, answer: gmsh_call.Answer, form: Form | None
) -> MeshArrays:
    """The mesh of a file, examined; on rank 0.

    Args:
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
        source: The file and how to mesh it.
        dimension: Of the model.
        answer: What was read of the file.
        form: Of all cells of the model.
    """
    description, read = answer
    made = mesh_arrays.build(read, description, source, dimension, key, form)
    where = f"{key}.file = '{source.file}'"
    found = _examined(where, dataclasses.replace(made, notes=()), _findings(source, made))
    for relation in made.relations:
        if relation.kind == "overlapping":
            logger.warning("%s: %s", where, relation.words)
    return found


def _examined(where: str, mesh: MeshArrays, findings: Iterator[Finding]) -> MeshArrays:
    """A mesh with notes of what was found in it.

    Raises:
        InputError: Something is wrong with it.
    """
    notes = list(mesh.notes)
    for finding in list(findings):
        if finding.is_wrong:
            raise InputError(f"{where}: {finding.words}")
        notes.append(f"{where}: {finding.words}")
    return dataclasses.replace(mesh, notes=tuple(notes))


def _findings(source: MeshSource, mesh: MeshArrays) -> Iterator[Finding]:
    """Notes on a mesh as it was read; Gmsh's own, of a geometry, fit together."""
    yield from (Finding(words, False) for words in mesh.notes)
    if is_geometry(source):
        return
    if mesh.found:
        yield Finding(no_surface(kind_of(source.file), list(mesh.found)), False)
    yield from Neighbours(**_of_neighbours(mesh)).findings()


def _between(
    sources: Sequence[MeshSource], meshes: Sequence[MeshArrays], joined: MeshArrays
) -> Iterator[Finding]:
    """Notes on what several meshes have in one place."""
    names = [source.name or source.file for source in sources]
    file_of_cell = np.repeat(np.arange(len(meshes)), [len(mesh.cells) for mesh in meshes])
    return BetweenFiles(**_of_neighbours(joined), names=names, file_of_cell=file_of_cell).findings()


def _of_neighbours(mesh: MeshArrays) -> dict[str, Any]:
    """The arguments of ``Neighbours``."""
    return {
        "cell": mesh.cell,
        "points": mesh.points,
        "cells": mesh.cells,
        "tags": mesh.cell_tags,
        "elements": mesh.elements,
        "facets": mesh.facets,
        "facet_tags": mesh.facet_tags,
        "groups": _surfaces(mesh),
    }


def _surfaces(mesh: MeshArrays) -> list[Group]:
    """Groups of facets that the file or the scene names."""
    groups = (*mesh.groups.values(), *(() if mesh.found else mesh.numbers.values()))
    return [group for group in groups if group.dimension == mesh.points.shape[1] - 1]


def load_to_look(source: MeshSource) -> tuple[MeshArrays, dict[str, Any]]:
    """The mesh of a file of whatever dimension, to be looked at; on rank 0.

    What no scene could use it for is a note of the mesh, so that one can look at it.

    Args:
        source: The file and how to mesh it.

    Returns:
        The mesh, and the arrays of ``exact_surfaces`` where Gmsh opens the file.

    Raises:
        InputError: As ``load_body``; or the file is neither plane nor of space.
    """
    description, read = _read("mesh", source, 0, None, curved=False, cuts=())
    dimension = max(description["dimension"], 2)
    made = mesh_arrays.build(read, description, source, dimension, "mesh")
    notes = tuple(finding.words for finding in _findings(source, made))
    return dataclasses.replace(made, notes=notes, groups=made.named), read


def _read(
    key: str,
    source: MeshSource,
    dimension: int,
    sizes: SizeField | None,
    curved: bool,
    cuts: Sequence[Cut],
) -> gmsh_call.Answer:
    """The description and the arrays of a file; dimension 0 is that of the file."""
    file = mesh_file(f"{key}.file", source.file)
    _check_settings(key, source, file)
    job = _job(key, source, file, dimension) | {"cuts": cuts_of(file, source, cuts)}
    if not file.is_mesh:
        job |= {"curved": curved, "sizes": sizes is not None}
    if sizes is not None:
        job["cell"] = sizes.cell
    memory = 0.0
    if file.is_mesh:
        memory = _BASE_MEMORY + _MEMORY_PER_BYTE * file.path.stat().st_size
    limits = gmsh_call.Limits(key, source.time_limit, memory, not file.is_of_gmsh)
    with tempfile.TemporaryDirectory(prefix="fenics_contact_") as folder:
        ready = prepared(file, Path(folder))
        job |= {"file": str(ready.path), "version": ready.version, "folder": folder}
        given = b"" if sizes is None else sizes.as_bytes()
        description, arrays = gmsh_call.call(ready, job, given, limits)
    read, said = without_collapsed(arrays, description)
    return {**said, "is_cut": bool(cuts)}, dict(read)


def _check_settings(key: str, source: MeshSource, file: MeshFile) -> None:
    """Settings that the kind of file has no use for are mistakes."""
    meshing = {
        "cell": source.cell != "as meshed",
        "order": source.order != 1,
        "size": source.size is not None,
        "curvature": source.curvature is not None,
        "least_size": source.least_size is not None,
        "sizes": bool(source.sizes),
    }
    given = [name for name, is_given in meshing.items() if is_given]
    if file.is_mesh and (given or source.parameters):
        raise InputError(
            f"{key}.file = '{source.file}' is a mesh already: "
            f"{', '.join(given or ['parameters'])} cannot change it"
        )
    if file.kind == "cad" and source.parameters:
        raise InputError(f"{key}.parameters: only .geo files have parameters, not '{source.file}'")


def _job(key: str, source: MeshSource, file: MeshFile, dimension: int) -> dict[str, Any]:
    """Return the job of ``gmsh_process``, without the files."""
    job: dict[str, Any] = {"key": key, "kind": file.kind, "name": source.file}
    job["dimension"] = dimension
    if file.is_mesh:
        return job
    job |= {
        "cell": source.cell,
        "order": source.order,
        "size": source.size,
        "curvature": source.curvature,
        "least_size": source.least_size,
        "body_sizes": dict(source.sizes),
        "groups": list(source.groups),
    }
    if file.kind == "geo":
        return job | {"parameters": dict(source.parameters)}
    return job | {"format": file.form, "unit": unit_of(file)}


def require_units(scene: Scene, comm: MPI.Comm) -> None:
    """Refuse STEP files in other units than the scene's: their numbers come in as they are.

    Collective.

    Args:
        scene: Its meshes and obstacles name the files; without units nothing is refused.
        comm: Of the ranks.

    Raises:
        InputError: On every rank.
    """
    if scene.units is not None:
        on_root(comm, lambda: _require_mm(scene.files))


def _require_mm(files: Sequence[str]) -> None:
    """Scenes with units and a STEP file are in mm, as they know without opening it."""
    steps = [name for name in files if Path(name).suffix.lower() in (".step", ".stp")]
    for name in filter(os.path.isfile, steps):  # what is not there is told where it is read
        unit = unit_of(mesh_file("mesh.file", name))
        if unit not in ("", "MM"):
            raise InputError(
                f"units.length: the numbers of '{name}' are taken as they are, and its unit is "
                f"{_WORDS[unit]}, not mm: save it in mm, or leave [units] out"
            )


def unit_of(file: MeshFile) -> str:
    """The length unit of a STEP file, so that its numbers come in as they are; empty of others."""
    if file.form != "step":
        return ""
    text = file.path.read_bytes().decode("latin-1")
    found = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'(INCH|FOOT|FT)'", text, re.IGNORECASE)
    if found is not None:
        return "INCH" if found[1].upper() == "INCH" else "FT"
    si = re.search(r"SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.\s*\)", text)
    return _STEP_UNITS.get(si[1], "") if si is not None else ""
