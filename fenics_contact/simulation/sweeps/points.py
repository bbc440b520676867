"""The points of a sweep: the scene of each, and which of them need the same body."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from fenics_contact.analyses import registry
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.errors import InputError
from fenics_contact.scene.given_keys import default_of
from fenics_contact.scene.reading import SceneFile
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.body_of_study import mesh_key
from fenics_contact.simulation.sweeps.grid import Grid


@dataclass(frozen=True)
class Point:
    """One combination of values.

    Attributes:
        number: Its row, from 0.
        digest: Of its scene and the content of its meshes.
        scene: What to solve; None where there is no such scene.
        refused: Why there is none.
    """

    number: int
    digest: str
    scene: Scene | None
    refused: str = ""


@dataclass(frozen=True)
class Group:
    """Points of one body, neighbours next to each other.

    Attributes:
        mesh: What their mesh follows from.
        points: Their numbers; the first needs all surfaces of the body that any of them needs.
    """

    mesh: str
    points: tuple[int, ...]


def points_of(file: SceneFile, overrides: Sequence[str], grid: Grid) -> list[Point]:
    """The points of a grid, in its order.

    Args:
        file: Of the scene.
        overrides: Settings of all points.
        grid: What is varied.

    Raises:
        InputError: The scene cannot have any of the values; as a run of the first would say.
    """
    points, contents, first = [], Contents(), None
    for number, settings in enumerate(grid.settings()):
        try:
            data = file.data(overrides, settings)
            scene = without_analyses(file.scene(overrides, settings))
        except InputError as error:
            first = first or error
            points.append(Point(number, digest_of(settings), None, str(error)))
            continue
        points.append(Point(number, digest_of([data, contents.of(scene)]), scene))
    if first is not None and all(point.scene is None for point in points):
        raise first
    return points


def without_analyses(scene: Scene) -> Scene:
    """The scene for its answer alone."""
    tables = [key for analysis in registry.asked_by(scene) for key in analysis.tables]
    return replace(scene, **{key: default_of(scene, key) for key in tables})


def groups_of(points: Sequence[Point], grid: Grid, left: set[int]) -> list[Group]:
    """Points that are to be solved, by the bodies that they need.

    Of a scene that asks for an accuracy each point has meshes of its own.

    Args:
        points: All of them.
        grid: Theirs.
        left: Numbers of those to be solved.
    """
    found: dict[tuple[str, str], list[Point]] = {}
    for number in grid.snake():
        point = points[number]
        if point.scene is not None and number in left:
            found.setdefault(_body_of(point), []).append(point)
    return [Group(mesh, _opened(members)) for (mesh, _), members in found.items()]


def _body_of(point: Point) -> tuple[str, str]:
    """Return texts that a point's mesh and its body follow from."""
    assert point.scene is not None
    if point.scene.accuracy is not None:
        return f"of point {point.number}", ""
    return repr(mesh_key(point.scene)), repr(BodyDescription.of(point.scene))


def _opened(members: Sequence[Point]) -> tuple[int, ...]:
    """A point of most contacts with friction first.

    A body is condensed onto the surfaces that exert forces at the first point, and again where
    others do later. Those under a given pressure do by their friction alone.
    """
    most = max(members, key=_frictional)
    others = [point.number for point in members if point is not most]
    return most.number, *others


def _frictional(point: Point) -> int:
    assert point.scene is not None
    return sum(contact.is_rough for contact in point.scene.contact)


class Contents:
    """Digests of mesh files, each read once."""

    def __init__(self) -> None:
        self._found: dict[str, str] = {}

    def of(self, scene: Scene) -> list[str]:
        """Return digests of a scene's mesh files; empty for one that cannot be read."""
        return [self._of_file(mesh.file) for mesh in scene.mesh]

    def _of_file(self, file: str) -> str:
        if file not in self._found:
            try:
                with Path(file).open("rb") as opened:
                    self._found[file] = hashlib.file_digest(opened, "sha256").hexdigest()
            except (OSError, ValueError):
                self._found[file] = ""
        return self._found[file]


def digest_of(value: Any) -> str:
    """A digest of what JSON can hold, the same for the same content."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()
