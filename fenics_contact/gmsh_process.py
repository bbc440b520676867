"""The room for Gmsh: a program of its own, which meshes or reads one file.

``fenics_contact.gmsh_files`` starts it with a job (JSON) as its argument and reads
the mesh as an ``.npz`` from its standard output. A damaged file can crash Gmsh, a
geometry script can end the process or fill the memory: here that costs one process,
not the run. It imports nothing of this package, whose import would start MPI.
"""

import contextlib
import io
import json
import os
import resource
import signal
import sys
from typing import Any

import gmsh
import numpy as np

Job = dict[str, Any]
Arrays = dict[str, np.ndarray]

_RECOMBINE = {"triangle": 0, "quadrilateral": 1}  # Gmsh's Mesh.RecombineAll


class RefusedError(Exception):
    """What is wrong with the scene's [mesh], to follow the name of its key."""


def main() -> None:
    """Do the job and write the answer, which holds either a mesh or an error."""
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # Gmsh and OpenCASCADE print; standard output is for the mesh alone
    job = json.loads(sys.argv[1])
    _restrict(job)
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    arrays: Arrays = {}
    try:
        _READERS[job["kind"]](job)
        description, arrays = _describe(), _elements()
    except RefusedError as error:
        description = {"refused": str(error)}
    except Exception as error:  # Gmsh raises plain Exceptions
        description = {"gmsh": " ".join(str(error).split())}
    buffer = io.BytesIO()
    arrays["description"] = np.array(json.dumps(description))
    np.savez(buffer, **arrays)  # type: ignore[arg-type]
    output.write(buffer.getbuffer())
    output.close()


def _restrict(job: Job) -> None:
    """No file may grow from here on, and reading a mesh may not take all the memory."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if job["memory"]:
        with contextlib.suppress(ValueError):  # a lower limit is in force already
            resource.setrlimit(resource.RLIMIT_AS, (job["memory"], job["memory"]))


def _read_mesh(job: Job) -> None:
    gmsh.merge(job["file"])
    if job["version"] == 2 and _parts_share_groups():
        # Other programs number parts anyhow, and only the group tells the elements apart.
        gmsh.clear()
        gmsh.option.setNumber("Mesh.SwitchElementTags", 1)
        gmsh.merge(job["file"])


def _parts_share_groups() -> bool:
    """Whether some part belongs to several physical groups."""
    found = [
        (dimension, int(part))
        for dimension, tag in gmsh.model.getPhysicalGroups()
        for part in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
    ]
    return len(found) > len(set(found))


def _mesh_script(job: Job) -> None:
    key, parameters = job["key"], job["parameters"]
    known = _constants(job["file"]) if parameters else []
    for name, value in parameters.items():
        if name not in known:
            raise RefusedError(
                f"{key}.parameters.{name} = {value:g}: {job['file']} defines no such constant; "
                f"it has: {', '.join(known) or 'none'}"
            )
        gmsh.parser.setNumber(name, [value])
    _set_options(job)
    gmsh.merge(job["file"])  # unlike `open`, it keeps the values just set
    for name, value in parameters.items():
        if list(gmsh.parser.getNumber(name)) != [value]:
            raise RefusedError(
                f"{key}.parameters.{name} = {value:g}: {job['file']} overwrites it; "
                "let the file set it with DefineConstant"
            )
    _generate(job)


def _constants(file: str) -> list[str]:
    """Names of the variables of a geometry, found by reading it once."""
    gmsh.merge(file)
    names = list(gmsh.parser.getNames())
    gmsh.clear()
    gmsh.parser.clear()
    gmsh.onelab.clear()  # it remembers the constants' own values and would restore them
    return names


def _mesh_cad(job: Job) -> None:
    _set_options(job)
    if job["unit"]:  # Gmsh converts to millimetres; the numbers of the file are wanted
        gmsh.option.setString("Geometry.OCCTargetUnit", job["unit"])
    gmsh.model.occ.importShapes(job["file"], format=job["format"])
    gmsh.model.occ.synchronize()
    _generate(job)


def _set_options(job: Job) -> None:
    if job["cell"] != "as meshed":
        gmsh.option.setNumber("Mesh.RecombineAll", _RECOMBINE[job["cell"]])
    gmsh.option.setNumber("Mesh.ElementOrder", job["order"])
    if job["size"] is not None:
        gmsh.option.setNumber("Mesh.MeshSizeMax", job["size"])
    if job["curvature"] is not None:
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", job["curvature"])


def _generate(job: Job) -> None:
    """Mesh, if the model has parts of the dimension asked for; the caller sees if not."""
    if gmsh.model.getDimension() == job["dimension"]:
        gmsh.model.mesh.generate(job["dimension"])


_READERS = {"msh": _read_mesh, "geo": _mesh_script, "cad": _mesh_cad}


def _describe() -> dict[str, Any]:
    """Dimension, physical groups, parts with their centres, and names of element types."""
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
        "groups": groups,
        "parts": [
            {"dimension": dimension, "tag": tag, "centre": _centre(dimension, tag)}
            for dimension, tag in gmsh.model.getEntities()
            if dimension >= 1
        ],
        "types": {kind: gmsh.model.mesh.getElementProperties(kind)[0] for kind in types},
    }


def _centre(dimension: int, tag: int) -> list[float]:
    """Middle of a part's bounding box."""
    try:
        box = np.array(gmsh.model.getBoundingBox(dimension, tag)).reshape(2, 3)
    except Exception:  # a part without nodes has none
        return []
    return [float(value) for value in box.mean(axis=0)]


def _elements() -> Arrays:
    """Node tags and coordinates; the nodes and the part of every element, by type."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    arrays = {"node_tags": tags, "points": coordinates.reshape(-1, 3)}
    nodes: dict[int, list[np.ndarray]] = {}
    parts: dict[int, list[np.ndarray]] = {}
    for dimension, part in gmsh.model.getEntities():
        kinds, elements, element_nodes = gmsh.model.mesh.getElements(dimension, part)
        for kind, found, found_nodes in zip(kinds, elements, element_nodes, strict=True):
            nodes.setdefault(int(kind), []).append(found_nodes.reshape(len(found), -1))
            parts.setdefault(int(kind), []).append(np.full(len(found), part, dtype=np.int64))
    for kind in nodes:
        arrays[f"nodes_{kind}"] = np.concatenate(nodes[kind])
        arrays[f"parts_{kind}"] = np.concatenate(parts[kind])
    return arrays


if __name__ == "__main__":
    main()
