"""The groups that a file names, and those that a scene makes of its parts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.scene import MeshSource

_BOUNDARY_PARTS = {2: "curve", 3: "surface"}
_BODY = "body"  # the whole body's group, where the file names none


@dataclass(frozen=True)
class PartTags:
    """Tags of the parts of a file.

    Attributes:
        dimension: Of the body.
        body: Part of the body → tags of its cells.
        boundary: Part of the boundary → tags of its facets.
        outside: Part of the boundary → how many of its facets are no sides of cells.
    """

    dimension: int
    body: Mapping[int, set[int]]
    boundary: Mapping[int, set[int]]
    outside: Mapping[int, int]

    def group(self, dimension: int, parts: Iterable[int], centre: Sequence[float] = ()) -> Group:
        """The group of some parts of the body, or of its boundary.

        Args:
            dimension: That of the body, or one less.
            parts: Their numbers.
            centre: Where they are, for messages.
        """
        members = self.body if dimension == self.dimension else self.boundary
        tags = {tag for part in parts for tag in members.get(part, ())}
        lost = 0
        if dimension < self.dimension:
            lost = sum(self.outside.get(part, 0) for part in parts)
        return Group(dimension, tuple(sorted(tags)), lost, tuple(centre))


def named_groups(
    key: str, source: MeshSource, description: Mapping[str, Any], tags: PartTags
) -> tuple[dict[str, Group], dict[str, Group], dict[str, Group]]:
    """Groups by name (of the file, of the scene, the whole body), by number, and all sides.

    Args:
        key: Of the mesh in the scene, for messages: ``mesh``, or ``mesh[1]``.
        source: The scene's mesh, with the groups that it names.
        description: Of the process that has read the file.
        tags: Of its parts.

    Raises:
        InputError: Two groups have one name, or the scene names a part that is not there.
    """
    where = f"{key}.file = '{source.file}'"
    groups: dict[str, Group] = {}
    numbers: dict[str, Group] = {}
    has_boundaries = False
    for found in sorted(description["groups"], key=lambda group: group["dimension"]):
        if found["dimension"] < tags.dimension - 1:
            continue
        has_boundaries |= found["dimension"] < tags.dimension and found["tag"] > 0
        group = tags.group(found["dimension"], found["parts"])
        name = found["name"] or str(found["tag"])
        groups[name] = _joined(where, name, groups.get(name), group)
        if found["tag"]:
            numbers.setdefault(str(found["tag"]), group)
    if description.get("whole") or all(
        group.dimension < tags.dimension for group in groups.values()
    ):
        groups.setdefault(_BODY, tags.group(tags.dimension, tags.body))
    sides = {
        str(part["tag"]): tags.group(tags.dimension - 1, [part["tag"]], part["centre"])
        for part in description["parts"]
        if part["dimension"] == tags.dimension - 1
    }
    for name, parts in source.groups.items():
        if name in groups:
            raise InputError(f"{key}.groups.{name}: {where} has a group of that name already")
        for part in parts:
            if str(part) not in sides:
                raise InputError(
                    f"{key}.groups.{name}: {where} has no "
                    f"{_BOUNDARY_PARTS[tags.dimension]} {part}; "
                    f"it has: {', '.join(sides) or 'none'}"
                )
        groups[name] = tags.group(tags.dimension - 1, parts)
    return groups, numbers if has_boundaries else sides, sides


def _joined(where: str, name: str, first: Group | None, second: Group) -> Group:
    """Two groups of one name as one."""
    if first is None:
        return second
    if first.dimension != second.dimension:
        if name.isdigit():  # unnamed groups: a number is first of all the boundary's
            return first
        raise InputError(
            f"{where}: calls a boundary and a part of the body '{name}': give each its own name"
        )
    return Group(
        first.dimension,
        tuple(sorted({*first.tags, *second.tags})),
        first.outside + second.outside,
    )
