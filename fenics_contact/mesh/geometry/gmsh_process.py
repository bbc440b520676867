"""The room for Gmsh: a program of its own, which meshes or reads one file.

``gmsh_call`` starts it with a job (JSON) and the number of a pipe as its arguments,
gives it sizes of cells by its standard input, if it has some, and reads the mesh as an ``.npz``
from its standard output; on standard error Gmsh says how far it is. A damaged file can crash Gmsh,
a geometry script can end the process or fill the memory: here that costs one process, not the run.
It imports nothing that would start MPI.
"""

import io
import os
import signal
import sys
from collections.abc import Sequence
from typing import Any

import gmsh
import numpy as np

from fenics_contact.mesh.geometry import process_room as room
from fenics_contact.mesh.geometry.bodies import (
    Bodies,
    exact_surfaces,
    name_bodies,
    name_surfaces,
    relate,
)
from fenics_contact.mesh.geometry.preparations import (
    cut_bodies,
    fields_of_bodies,
    largest_size,
    least_curvature,
    lift_constraints,
    limit_sizes,
    limiting_fields,
    set_least,
)
from fenics_contact.mesh.geometry.process_room import Arrays, Job, RefusedError

# What is done with a geometry before it is meshed, in this order. Each takes the job and the
# bodies, and may change both the bodies and the model that is open.
_PREPARATIONS = (name_bodies, name_surfaces, relate, cut_bodies, limit_sizes)
_RECOMBINE = {"triangle": 0, "quadrilateral": 1}  # Gmsh's Mesh.RecombineAll
# Gmsh's letters for elements on which sizes are given.
_ON_ELEMENTS = {"triangle": "T", "quadrilateral": "Q", "tetrahedron": "S"}
# Gmsh's Mesh.Algorithm and Mesh.RecombinationAlgorithm by cell, tried in this order: which of
# them leaves a bad cell depends on the geometry.
_WAYS = {
    "triangle": ((6, 1), (5, 1)),
    "quadrilateral": ((8, 0), (8, 1), (6, 1), (5, 1)),
    "tetrahedron": ((6, 1), (5, 1)),
}
# Least scaled Jacobian of a mesh's cells from which no other way is tried.
_GOOD = 0.2
_UNROLLED = 2**28  # bytes of a geometry as plain statements, at the most


def main() -> None:
    """Do the job and write the answer, which holds either a mesh or an error."""
    room.answer(_mesh, writes=_UNROLLED)


def _mesh(job: Job) -> tuple[dict[str, Any], Arrays]:
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # PETSc, in Gmsh, dies of what nobody reads
    gmsh.option.setNumber("General.Terminal", 1)
    if job.get("surface"):
        return {}, _surface(job)
    bodies = _READERS[job["kind"]](job)
    arrays = _elements(bodies)
    if not job["dimension"]:
        arrays |= exact_surfaces(gmsh.model.getDimension())
    return _describe(bodies), arrays


def _read_mesh(job: Job) -> Bodies:
    """A mesh, whose groups say all that is known of its bodies."""
    gmsh.merge(job["file"])
    if job["version"] == 2 and _parts_share_groups():
        # Other programs number parts anyhow, and only the group tells the elements apart.
        gmsh.clear()
        gmsh.option.setNumber("Mesh.SwitchElementTags", 1)
        gmsh.merge(job["file"])
    return Bodies(gmsh.model.getDimension(), are_groups=True)


def _parts_share_groups() -> bool:
    """Whether some part belongs to several physical groups."""
    found = [
        (dimension, int(part))
        for dimension, tag in gmsh.model.getPhysicalGroups()
        for part in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
    ]
    return len(found) > len(set(found))


def _mesh_script(job: Job) -> Bodies:
    key, parameters, name_of_file = job["key"], job["parameters"], job["name"]
    known = _constants(job["file"]) if parameters else []
    for name, value in parameters.items():
        if name not in known:
            raise RefusedError(
                f"{key}.parameters.{name} = {value:g}: {name_of_file} defines no such constant; "
                f"it has: {', '.join(known) or 'none'}"
            )
        gmsh.parser.setNumber(name, [value])
    _set_options(job)
    gmsh.merge(job["file"])  # unlike `open`, it keeps the values just set
    for name, value in parameters.items():
        if list(gmsh.parser.getNumber(name)) != [value]:
            raise RefusedError(
                f"{key}.parameters.{name} = {value:g}: {name_of_file} overwrites it; "
                "let the file set it with DefineConstant"
            )
    return _generate(job)


def _constants(file: str) -> list[str]:
    """Names of the variables of a geometry, found by reading it once."""
    gmsh.merge(file)
    names = list(gmsh.parser.getNames())
    gmsh.open(os.devnull)  # that nothing else is open: Gmsh then forgets macros, too
    gmsh.clear()
    gmsh.parser.clear()
    gmsh.onelab.clear()  # it remembers the constants' own values and would restore them
    return names


def _mesh_cad(job: Job) -> Bodies:
    _set_options(job)
    _import_shapes(job)
    return _generate(job)


def _import_shapes(job: Job) -> None:
    """Open a CAD file."""
    if job["unit"]:  # Gmsh converts to millimetres; the numbers of the file are wanted
        gmsh.option.setString("Geometry.OCCTargetUnit", job["unit"])
    gmsh.model.occ.importShapes(job["file"], format=job["format"])
    gmsh.model.occ.synchronize()


def _set_options(job: Job) -> None:
    if job["cell"] in _RECOMBINE:
        gmsh.option.setNumber("Mesh.RecombineAll", _RECOMBINE[job["cell"]])
    gmsh.option.setNumber("Mesh.ElementOrder", job["order"])
    if job["size"] is not None:
        gmsh.option.setNumber("Mesh.MeshSizeMax", job["size"])
    if job["least_size"] is not None:
        gmsh.option.setNumber("Mesh.MeshSizeMin", job["least_size"])
    if job["curvature"] is not None:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", job["curvature"])


def _generate(job: Job) -> Bodies:
    """Mesh, if the model has parts of the dimension asked for; the caller sees if not."""
    dimension = job["dimension"] or gmsh.model.getDimension()
    bodies = Bodies(dimension)
    if gmsh.model.getDimension() != dimension or dimension < 2:
        return bodies
    for prepare in _PREPARATIONS:
        prepare(job, bodies)
    if job["curved"] and _is_curved():
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
    if job["sizes"]:
        _mesh_by_sizes(job, bodies)
    else:
        gmsh.model.mesh.generate(dimension)
    _straighten(dimension)
    return bodies


def _straighten(dimension: int) -> None:
    """Move nodes of curved cells where some are inverted, as coarse ones behind a round side."""
    if gmsh.option.getNumber("Mesh.ElementOrder") > 1:
        _, elements, _ = gmsh.model.mesh.getElements(dimension)
        cells = np.concatenate([np.zeros(0, dtype=np.uint64), *elements])
        if (gmsh.model.mesh.getElementQualities(cells, "minDetJac") <= 0).any():
            gmsh.model.mesh.optimize("HighOrder")


def _is_curved() -> bool:
    """Whether any part is not straight."""
    kinds = {gmsh.model.getType(dim, tag) for dim, tag in gmsh.model.getEntities() if dim in (1, 2)}
    return not kinds <= {"Line", "Plane", "Plane surface"}


def _mesh_by_sizes(job: Job, bodies: Bodies) -> None:
    """Mesh with the sizes that standard input holds; numbers of cells in the file do not count.

    The input is an ``.npz``: ``points`` (cells, vertices, 3), and ``sizes`` at each, (cells,
    vertices) (length); ``parts`` are Gmsh's numbers of the cells' bodies, (cells,) or (0,).
    """
    with np.load(io.BytesIO(sys.stdin.buffer.read()), allow_pickle=False) as data:
        given = dict(data)
    cell, dimension = job["cell"], job["dimension"]
    lift_constraints(job)
    # Quadrilaterals are made by cutting each cell of a coarser mesh: no triangle is left then.
    is_cut = cell == "quadrilateral"
    factor = 2 if is_cut else 1
    rows = np.concatenate(
        [
            given["points"].transpose(0, 2, 1).reshape(len(given["points"]), -1),
            factor * given["sizes"],
        ],
        axis=1,
    )
    fields = fields_of_bodies(f"S{_ON_ELEMENTS[cell]}", rows, given["parts"], dimension)
    set_least([*fields, *limiting_fields(job, bodies, factor)])
    for name, value in {
        "MeshSizeExtendFromBoundary": 0,
        "MeshSizeFromPoints": 0,
        "MeshSizeFromCurvature": least_curvature(job),
        "MeshSizeFactor": 1,
        "MeshSizeMin": 0,
        "MeshSizeMax": factor * largest_size(job, bodies),
        "RecombineAll": int(is_cut),
        "SubdivisionAlgorithm": int(is_cut),
    }.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    _mesh_well(_WAYS[cell], dimension)


def _mesh_well(ways: Sequence[tuple[int, int]], dimension: int) -> None:
    """Mesh in the first way that leaves no bad cell, else in the one that leaves the best."""
    quality: dict[tuple[int, int], float] = {}
    said: Exception | None = None
    for way in ways:
        try:
            quality[way] = _mesh_in_way(way, dimension)
        except Exception as error:  # Gmsh raises plain Exceptions; another way may do
            said = error
            continue
        if quality[way] >= _GOOD:
            return
    if not quality:
        assert said is not None
        raise said
    _mesh_in_way(max(quality, key=lambda way: quality[way]), dimension)


def _mesh_in_way(way: tuple[int, int], dimension: int) -> float:
    """Mesh anew; the least scaled Jacobian of its cells."""
    gmsh.model.mesh.clear()
    gmsh.option.setNumber("Mesh.Algorithm", way[0])
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", way[1])
    gmsh.model.mesh.generate(dimension)
    _, elements, _ = gmsh.model.mesh.getElements(dimension)
    found = [gmsh.model.mesh.getElementQualities(tags, "minSICN") for tags in elements]
    return float(np.min(np.concatenate(found)))


def _surface(job: Job) -> Arrays:
    """Triangles of the surface of an obstacle, their normals out of the solids that there are."""
    if job["kind"] == "stl":
        gmsh.open(job["file"])
    else:
        _import_shapes(job)
        corners = np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
        largest = float(np.ptp(corners, axis=0).max()) / job["across"]
        gmsh.option.setNumber("Mesh.MeshSizeMax", largest)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", job["curvature"])
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.model.mesh.generate(2)
    solids = gmsh.model.getEntities(3)
    # Gmsh numbers the nodes of a solid's faces so that their normals point out of it.
    sides = gmsh.model.getBoundary(solids, oriented=False) if solids else gmsh.model.getEntities(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    triangles = [np.zeros((0, len(_OF_BASIX[job["kind"]])), dtype=np.int64)]
    for dimension, side in sides:
        for nodes in gmsh.model.mesh.getElements(dimension, side)[2]:
            rows = order[np.searchsorted(tags, nodes, sorter=order)]
            triangles.append(rows.reshape(-1, triangles[0].shape[1])[:, _OF_BASIX[job["kind"]]])
    return {"points": coordinates.reshape(-1, 3), "triangles": np.concatenate(triangles)}


# Nodes of Gmsh's triangles in the order of basix: straight ones of a list, curved ones of a mesh.
_OF_BASIX = {"stl": [0, 1, 2], "cad": [0, 1, 2, 4, 5, 3]}

_READERS = {"msh": _read_mesh, "geo": _mesh_script, "cad": _mesh_cad}


def _describe(bodies: Bodies) -> dict[str, Any]:
    """Dimension, groups, parts with their centres, how bodies lie, and names of element types."""
    switched = bool(gmsh.option.getNumber("Mesh.SwitchElementTags"))
    groups = []
    for dimension, tag in gmsh.model.getPhysicalGroups() if not switched else []:
        parts = [int(p) for p in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)]
        name = gmsh.model.getPhysicalName(dimension, tag)
        groups.append({"dimension": dimension, "tag": tag, "name": name, "parts": parts})
    for dimension, tag in gmsh.model.getEntities() if switched else []:
        name = gmsh.model.getPhysicalName(dimension, tag)
        groups.append({"dimension": dimension, "tag": tag, "name": name, "parts": [tag]})
    types = {int(kind) for kind in gmsh.model.mesh.getElementTypes()}
    return {
        "dimension": gmsh.model.getDimension(),
        "groups": groups + bodies.groups(),
        "whole": not bodies.are_groups,
        "relations": bodies.relations,
        "parts": [
            {"dimension": dimension, "tag": number, "centre": _centre(dimension, tags)}
            for (dimension, number), tags in _numbered(bodies).items()
            if dimension >= 1
        ],
        "types": {kind: gmsh.model.mesh.getElementProperties(kind)[0] for kind in types},
    }


def _numbered(bodies: Bodies) -> dict[tuple[int, int], list[int]]:
    """Parts by dimension and the number that users know them by."""
    found: dict[tuple[int, int], list[int]] = {}
    for dimension, tag in gmsh.model.getEntities():
        number = bodies.number(dimension, tag)
        if number is not None:
            found.setdefault((dimension, number), []).append(tag)
    return found


def _centre(dimension: int, tags: Sequence[int]) -> list[float]:
    """Middle of the box around some parts."""
    try:
        boxes = np.array([gmsh.model.getBoundingBox(dimension, tag) for tag in tags])
    except Exception:  # a part without nodes has none
        return []
    return [float(x) for x in (boxes[:, :3].min(axis=0) + boxes[:, 3:].max(axis=0)) / 2]


def _elements(bodies: Bodies) -> Arrays:
    """Node tags and coordinates; nodes, part and tag of every element, by type."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    arrays = {"node_tags": tags, "points": coordinates.reshape(-1, 3)}
    found: dict[str, list[np.ndarray]] = {}
    for dimension, part in gmsh.model.getEntities():
        number = bodies.number(dimension, part)
        if number is None:
            continue
        kinds, elements, element_nodes = gmsh.model.mesh.getElements(dimension, part)
        for kind, of_kind, nodes in zip(kinds, elements, element_nodes, strict=True):
            found.setdefault(f"nodes_{kind}", []).append(nodes.reshape(len(of_kind), -1))
            parts = np.full(len(of_kind), number, dtype=np.int64)
            found.setdefault(f"parts_{kind}", []).append(parts)
            found.setdefault(f"numbers_{kind}", []).append(of_kind)
    arrays |= {name: np.concatenate(several) for name, several in found.items()}
    return arrays


if __name__ == "__main__":
    main()
