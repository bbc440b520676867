"""Several files in one model: their meshes joined, and where preloads cut their bodies.

Several meshes as one with disconnected parts, and what their groups are then called. Everything
here happens on one rank, before the mesh is distributed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import question
from fenics_contact.mesh.from_gmsh import MeshArrays
from fenics_contact.mesh.geometry.file_kinds import MeshFile
from fenics_contact.mesh.tagged_mesh import Group, Relation
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.scene import MeshSource

Tags = NDArray[np.int32]


def with_name(key: str, source: MeshSource, mesh: MeshArrays) -> MeshArrays:
    """A single mesh: its groups as they are, and all its cells under its name, if it has one.

    Raises:
        InputError: A group of another kind has that name.
    """
    name, whole = source.name, _all_cells(mesh)
    if not name:
        return mesh
    if mesh.named.get(name, whole) != whole:
        raise InputError(
            f"{key}.name = '{name}': a group of '{source.file}' has that name already; "
            "give the mesh another"
        )
    return dataclasses.replace(mesh, groups={name: whole} | dict(mesh.groups))


def joined(sources: Sequence[MeshSource], meshes: Sequence[MeshArrays]) -> MeshArrays:
    """Meshes beside each other: none shares a node with another, wherever they touch.

    Args:
        sources: Of the meshes, with their names.
        meshes: At least one, all of one type of cells and one order.
    """
    shifts = np.cumsum([0] + [len(mesh.points) for mesh in meshes[:-1]])
    cell_shifts = _shifts([mesh.cell_tags for mesh in meshes])
    facet_shifts = _shifts([mesh.facet_tags for mesh in meshes])
    groups: dict[str, Group] = {}
    found: dict[str, Group] = {}
    numbers: dict[str, Group] = {}
    sides: dict[str, Group] = {}
    relations: list[Relation] = []
    for source, mesh, cells, facets in zip(sources, meshes, cell_shifts, facet_shifts, strict=True):
        dimension = mesh.points.shape[1]
        moved = {dimension: cells, dimension - 1: facets}
        groups |= {source.name: _moved(_all_cells(mesh), moved)}
        groups |= _prefixed(source.name, mesh.groups, moved)
        found |= _prefixed(source.name, mesh.found, moved)
        numbers |= _prefixed(source.name, mesh.numbers, moved)
        sides |= _prefixed(source.name, mesh.sides, moved)
        relations += [_named(source.name, relation) for relation in mesh.relations]
    return MeshArrays(
        meshes[0].cell,
        meshes[0].order,
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.cells + by for mesh, by in zip(meshes, shifts, strict=True)]),
        _concatenated([mesh.cell_tags for mesh in meshes], cell_shifts),
        np.concatenate([mesh.facets + by for mesh, by in zip(meshes, shifts, strict=True)]),
        _concatenated([mesh.facet_tags for mesh in meshes], facet_shifts),
        groups,
        numbers,
        tuple(relations),
        sides,
        np.concatenate([mesh.elements for mesh in meshes]),
        {kind: said for mesh in meshes for kind, said in mesh.kinematics.items()},
        tuple(note for mesh in meshes for note in mesh.notes),
        found,
    )


def _shifts(tags: Sequence[Tags]) -> list[int]:
    """Return shifts by which each mesh's tags differ from those of all before it."""
    ends = np.cumsum([int(values.max(initial=0)) for values in tags])
    return [0, *ends[:-1].tolist()]


def _concatenated(tags: Sequence[Tags], shifts: Sequence[int]) -> Tags:
    moved = [values + by for values, by in zip(tags, shifts, strict=True)]
    return np.concatenate(moved).astype(np.int32)


def _all_cells(mesh: MeshArrays) -> Group:
    return Group(mesh.points.shape[1], tuple(np.unique(mesh.cell_tags).tolist()))


def _prefixed(
    name: str, groups: Mapping[str, Group], shifts: Mapping[int, int]
) -> dict[str, Group]:
    return {f"{name}.{group}": _moved(found, shifts) for group, found in groups.items()}


def _named(name: str, relation: Relation) -> Relation:
    first, second = relation.bodies
    return dataclasses.replace(relation, bodies=(f"{name}.{first}", f"{name}.{second}"))


def _moved(group: Group, shifts: Mapping[int, int]) -> Group:
    """A group after its tags were shifted, by the dimension of what they mark."""
    by = shifts.get(group.dimension, 0)  # points, and edges in space, have none
    return dataclasses.replace(group, tags=tuple(tag + by for tag in group.tags))


@dataclass(frozen=True)
class Cut:
    """A body that is cut in two places.

    Attributes:
        key: Of the preload in the scene, for messages.
        on: Name of the body in its file.
        axis: Of any length.
        between: Positions along it (length).
        group: Name of what is between.
    """

    key: str
    on: str
    axis: tuple[float, ...]
    between: tuple[float, float]
    group: str


def bolts_of(sources: Sequence[MeshSource], preloads: Sequence[Preload]) -> list[list[Cut]]:
    """The cuts of each file.

    Raises:
        InputError: There is no such mesh.
    """
    found: list[list[Cut]] = [[] for _ in sources]
    names = [source.name for source in sources]
    for number, preload in enumerate(preloads):
        if preload.between is None:
            continue
        key, place, prefix = f"preload[{number}]", 0, ""
        if len(sources) > 1:
            name = preload.on.partition(".")[0]
            if name not in names:
                raise InputError(
                    f"{key}.on = '{preload.on}': there is no mesh '{name}'{question(name, names)}; "
                    "with several meshes a body is called by its mesh's name, a dot, and its own"
                )
            place, prefix = names.index(name), f"{name}."
        on, group = (text.removeprefix(prefix) for text in (preload.on, preload.group))
        found[place].append(Cut(key, on, preload.axis, preload.between, group))
    return found


def cuts_of(file: MeshFile, source: MeshSource, cuts: Sequence[Cut]) -> list[dict[str, Any]]:
    """The cuts as ``gmsh_process`` takes them.

    Raises:
        InputError: The file is none that can be cut.
    """
    if cuts and file.kind != "cad":
        what = "is a mesh already" if file.is_mesh else "is a script"
        raise InputError(
            f"{cuts[0].key}.between: only bodies of CAD files (.step, .stp, .brep) can be cut, but "
            f"'{source.file}' {what}; make the part a group of cells there, and give its name as on"
        )
    return [asdict(cut) for cut in cuts]
