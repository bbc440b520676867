"""The points of a sweep: all combinations of values of its keys, and the scene of each."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.analyses import registry
from fenics_contact.body.description import BodyDescription
from fenics_contact.common.errors import InputError
from fenics_contact.scene.given_keys import default_of
from fenics_contact.scene.reading import SceneFile, keys_of, value_of
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.kept_body import mesh_key

#: Points that a sweep may have.
MOST = 50_000
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_RANGE = re.compile(rf"\s*({_NUMBER})\s*:\s*({_NUMBER})\s*:\s*(\d+)\s*")
_LIKE_RANGE = re.compile(rf"\s*{_NUMBER}\s*:")
_FIGURES = 12  # of the numbers within a range, so that .1 + .2 is .3
_BRACKETS = {"[": 1, "{": 1, "]": -1, "}": -1}


@dataclass(frozen=True)
class Axis:
    """A key and its values.

    Attributes:
        key: As of ``--set``.
        values: As a scene file has them.
        texts: The same as settings have them.
    """

    key: str
    values: tuple[Any, ...]
    texts: tuple[str, ...]

    @classmethod
    def of(cls, setting: str) -> Axis:
        """Return the axis of ``KEY=VALUES``.

        Args:
            setting: After ``--vary``: values between commas, or ranges START:END:HOW_MANY.

        Raises:
            InputError: It is written otherwise, or has a value twice.

        >>> Axis.of("load.0.pressure=0:1:5,2").values
        (0, 0.25, 0.5, 0.75, 1, 2)
        >>> Axis.of("contact.0.law=static,incremental").values
        ('static', 'incremental')
        """
        key, equals, text = setting.partition("=")
        try:
            keys_of(key)
        except ValueError:
            equals = ""
        if not equals or not key.strip():
            raise InputError(f"--vary {setting}: write it as KEY=VALUES")
        pieces = _split(text)
        if not all(piece.strip() for piece in pieces):
            raise InputError(f"--vary {setting}: a value is missing between commas or at an end")
        texts = [one for piece in pieces for one in _texts(piece, setting)]
        values = [value_of(one) for one in texts]
        seen: set[str] = set()
        for value, one in zip(values, texts, strict=True):
            same = _sameness(value)
            if same in seen:
                raise InputError(f"--vary {setting}: {one.strip()} is there twice")
            seen.add(same)
        return cls(key.strip(), tuple(values), tuple(texts))

    @property
    def keys(self) -> list[str]:
        """The keys between the dots."""
        return keys_of(self.key)


class Grid:
    """All combinations of the values of keys; the last key runs fastest.

    Attributes:
        axes: The keys.

    Args:
        settings: Each as of ``Axis.of``.
        overrides: Settings of all points, ``table.key=value``.

    Raises:
        InputError: A setting is wrong; two are of the same key; there are too many points.
    """

    def __init__(self, settings: Sequence[str], overrides: Sequence[str] = ()) -> None:
        self.axes = [Axis.of(setting) for setting in settings]
        self._refuse_twice()
        self._refuse_set(overrides)
        if len(self) > MOST:
            raise InputError(f"--vary: these are {len(self):,} points, and {MOST:,} are the most")

    def __len__(self) -> int:
        return math.prod(len(axis.values) for axis in self.axes)

    def settings(self) -> Iterator[tuple[str, ...]]:
        """Yield the settings of each point."""
        for texts in itertools.product(*(axis.texts for axis in self.axes)):
            pairs = zip(self.axes, texts, strict=True)
            yield tuple(f"{axis.key}={text}" for axis, text in pairs)

    def values(self) -> Iterator[tuple[Any, ...]]:
        """Yield the values of the keys at each point."""
        return itertools.product(*(axis.values for axis in self.axes))

    def snake(self) -> list[int]:
        """The points in an order in which one and the next differ in one key, by one value."""
        order = [0]
        for axis in self.axes:
            count, found = len(axis.values), []
            for number, before in enumerate(order):
                steps = range(count) if number % 2 == 0 else reversed(range(count))
                found += [before * count + step for step in steps]
            order = found
        return order

    def _refuse_twice(self) -> None:
        for one, other in itertools.combinations(self.axes, 2):
            if _within(one.keys, other.keys) or _within(other.keys, one.keys):
                named = one.key if one.key == other.key else f"{one.key} and {other.key}"
                raise InputError(f"--vary {named}: give a key and its values once")

    def _refuse_set(self, overrides: Sequence[str]) -> None:
        """A value that is set would be lost where all of it is varied."""
        for setting in overrides:
            key = setting.partition("=")[0].strip()
            try:
                keys = keys_of(key)
            except ValueError:
                continue  # which is said when it is set
            for axis in self.axes:
                if _within(axis.keys, keys):
                    raise InputError(
                        f"--set {setting}: {axis.key} is varied; leave one of them out"
                    )


def _within(whole: Sequence[str], part: Sequence[str]) -> bool:
    """Whether a key is another one, or in its table."""
    return list(part[: len(whole)]) == list(whole)


def _texts(piece: str, setting: str) -> list[str]:
    """The values of a piece between commas, as settings have them."""
    if not _LIKE_RANGE.match(piece):
        return [piece.strip()]
    found = _RANGE.fullmatch(piece)
    if found is None or int(found[3]) < 2:
        raise InputError(
            f"--vary {setting}: '{piece.strip()}' must be a range START:END:HOW_MANY of at least 2 "
            "numbers, such as 0:1:11"
        )
    start, end, count = found[1], found[2], int(found[3])
    if count > MOST:
        raise InputError(f"--vary {setting}: these are {count:,} values, and {MOST:,} are the most")
    return _range(start, end, count)


def _range(start: str, end: str, count: int) -> list[str]:
    """Evenly spread numbers, whole ones where all of them are."""
    first, last = value_of(start), value_of(end)
    whole = all(isinstance(one, int) for one in (first, last))
    if whole and (last - first) % (count - 1) == 0:
        step = (last - first) // (count - 1)
        return [str(first + step * number) for number in range(count)]
    inner = np.linspace(float(first), float(last), count)[1:-1].tolist()
    return [start, *(repr(float(f"{value:.{_FIGURES}g}")) for value in inner), end]


def _split(text: str) -> list[str]:
    """Pieces between commas that stand in no brackets and no quotes."""
    pieces, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        else:
            depth += _BRACKETS.get(letter, 0)
        if letter == "," and not quote and depth == 0:
            pieces.append("")
        else:
            pieces[-1] += letter
    return pieces


def _sameness(value: Any) -> str:
    """A text that is the same for values that a scene takes to be the same."""
    plain = float(value) if isinstance(value, int) and not isinstance(value, bool) else value
    return json.dumps(plain, sort_keys=True, default=str)


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
class PointGroup:
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


def groups_of(points: Sequence[Point], grid: Grid, left: set[int]) -> list[PointGroup]:
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
    return [PointGroup(mesh, _opened(members)) for (mesh, _), members in found.items()]


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
    """Digests of the files of scenes, each read once."""

    def __init__(self) -> None:
        self._found: dict[str, str] = {}

    def of(self, scene: Scene) -> list[str]:
        """Return digests of a scene's files; empty for one that cannot be read."""
        return [self._of_file(file) for file in scene.files]

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
