"""Meshes of Salome (``.med``), which Gmsh reads with their groups; those of nodes are read here.

meshio's reader fails on the names of groups that newer versions of the format write.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gmsh
import h5py
import numpy as np

from fenics_contact.common.arrays import Integers
from fenics_contact.mesh.geometry.process_room import RefusedError
from fenics_contact.mesh.readers.element_kinds import NAMES
from fenics_contact.mesh.readers.found_mesh import FoundMesh, require_whole


def read(job: dict[str, Any]) -> FoundMesh:
    """The mesh of a file.

    Args:
        job: With ``file``, its path; and ``key`` and ``name``, of the scene's mesh.
    """
    where = f"{job['key']}.file = '{job['name']}'"
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 1)
    require_whole(where, Path(job["file"]))
    node_sets = _node_groups(where, Path(job["file"]))
    if "Med" not in gmsh.option.getString("General.BuildOptions").split():
        raise RefusedError(
            f"{where}: Gmsh was built without MED here, as Debian's is; save the mesh as .msh "
            "where Gmsh is that of PyPI"
        )
    gmsh.merge(job["file"])
    tags, points, _ = gmsh.model.mesh.getNodes()
    elements: dict[int, list[Integers]] = {}
    numbers: dict[int, list[Integers]] = {}
    places: dict[tuple[int, int], list[tuple[int, Integers]]] = {}
    for entity in gmsh.model.getEntities():
        for kind, found, nodes in zip(*gmsh.model.mesh.getElements(*entity), strict=True):
            kind = int(kind)
            if kind not in NAMES:
                name = gmsh.model.mesh.getElementProperties(kind)[0]
                raise RefusedError(f"{where}: its elements are of the type {name}")
            before = sum(map(len, elements.get(kind, [])))
            elements.setdefault(kind, []).append(nodes.reshape(len(found), -1).astype(np.int64))
            numbers.setdefault(kind, []).append(found.astype(np.int64))
            rows = np.arange(before, before + len(found))
            places.setdefault(entity, []).append((kind, rows))
    sets: dict[str, dict[int, Integers]] = {}
    for group in gmsh.model.getPhysicalGroups():
        rows_of = sets.setdefault(_plain(gmsh.model.getPhysicalName(*group)), {})
        for part in gmsh.model.getEntitiesForPhysicalGroup(*group):
            for kind, rows in places.get((group[0], int(part)), []):
                rows_of[kind] = np.concatenate([rows_of.get(kind, rows[:0]), rows])
    return FoundMesh(
        tags.astype(np.int64),
        points.reshape(-1, 3),
        {kind: np.concatenate(found) for kind, found in elements.items()},
        {kind: np.concatenate(found) for kind, found in numbers.items()},
        sets,
        node_sets=node_sets,
    )


def _plain(name: str) -> str:
    """A name without what fills it up to its length."""
    return name.partition("\0")[0].strip()


def _node_groups(where: str, path: Path) -> dict[str, Integers]:
    """Groups of nodes, by the numbers that Gmsh gives nodes."""
    groups: dict[str, Integers] = {}
    with h5py.File(path, "r") as file:
        meshes = list(file.get("ENS_MAA", ()))
        if len(meshes) != 1:
            raise RefusedError(f"{where}: has {len(meshes)} meshes; it must have one")
        families = file.get(f"FAS/{meshes[0]}/NOEUD", {})
        mesh = file[f"ENS_MAA/{meshes[0]}"]
        while "NOE" not in mesh and len(mesh) == 1:  # steps of time
            mesh = mesh[next(iter(mesh))]
        if "NOE" not in mesh:
            raise RefusedError(f"{where}: has no nodes, or several steps of time")
        nodes = mesh["NOE"]
        if not families or "FAM" not in nodes:
            return groups
        of_nodes = nodes["FAM"][()]
        numbers = nodes["NUM"][()] if "NUM" in nodes else np.arange(1, len(of_nodes) + 1)
        for family in families.values():
            if "GRO" not in family:
                continue
            members = numbers[of_nodes == family.attrs["NUM"]].astype(np.int64)
            for raw in family["GRO/NOM"][()]:
                name = _plain(bytes(raw).decode("utf-8", "replace"))
                groups[name] = np.union1d(groups.get(name, members[:0]), members)
    return groups
