"""Where bodies of CAD files are cut for preloads, file by file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.common.wording.suggestions import question
from fenics_contact.mesh.geometry.file_kinds import MeshFile
from fenics_contact.scene.loading.conditions import Preload
from fenics_contact.scene.scene import MeshSource


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
