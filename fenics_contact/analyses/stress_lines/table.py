"""The tables of a scene that ask for the stress along lines."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import Field

from fenics_contact.scene.core_scene import CoreScene
from fenics_contact.scene.units.dimensions import PLACE
from fenics_contact.scene.values import PER_AXIS, Integer, Number, Text, scene_class

_MOST_POINTS = 10_000
_Place = tuple[Annotated[Number, PLACE], ...]


@scene_class
class Line:
    """A straight line through the undeformed body, along which a run writes stress and strain.

    ``lines.csv`` has a row for each point. In Python ``from`` is written ``from_``, because
    ``from`` is a keyword there.

    >>> Line("ligament", from_=(0, 0), to=(0, 5)).points
    51
    """

    name: Annotated[Text, Field(description="its name in `lines.csv`: letters, digits, `-`, `_`")]
    from_: Annotated[
        _Place,
        PER_AXIS,
        Field(
            alias="from", description="where it begins in the undeformed body, one entry an axis"
        ),
    ]
    to: Annotated[
        _Place,
        PER_AXIS,
        Field(description="where it ends, in the undeformed body"),
    ]
    points: Annotated[
        Integer,
        Field(
            ge=2,
            le=_MOST_POINTS,
            description="number of points on it, evenly spaced, both ends included",
        ),
    ] = 51

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[\w-]+", self.name):
            raise ValueError(f"name = '{self.name}' may have only letters, digits, '-' and '_'")
        if self.from_ == self.to:
            raise ValueError(f"to = {list(self.to)}: must differ from `from`, or it is no line")


class _AskingForLines(CoreScene):
    """A scene with such tables."""

    line: tuple[Line, ...]


def require(scene: _AskingForLines) -> None:
    """Refuse lines of one name, and ends that do not have the axes of the model.

    Raises:
        ValueError: In words that begin with the key.
    """
    seen: set[str] = set()
    for number, line in enumerate(scene.line):
        if line.name in seen:
            raise ValueError(f"line[{number}].name = '{line.name}': another line has this name")
        seen.add(line.name)
        for key, place in (("from", line.from_), ("to", line.to)):
            if len(place) != scene.dimension:
                raise ValueError(
                    f"line[{number}].{key} has {len(place)} entries; a {scene.kinematics} model "
                    f"needs {scene.dimension}"
                )
