"""Numbers of a scene that are moved on the page, and their ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from annotated_types import Ge, Le

from fenics_contact.common.errors import InputError
from fenics_contact.explore.numbers import SceneNumber, number_at, numbers_of
from fenics_contact.simulation.studies.study import Study

# What is done to the body: what else a scene has makes another one, or is of the solver.
_TABLES = ("contact", "load", "preload", "support")
_MOST = 24  # sliders on a page that chooses them itself


@dataclass(frozen=True)
class MovedKey:
    """A number that is moved.

    Attributes:
        number: Of the scene.
        low: The smallest value.
        high: The largest value.
        makes_anew: Whether it makes the body anew, so that an answer takes long.
    """

    number: SceneNumber
    low: float
    high: float
    makes_anew: bool = False

    @property
    def key(self) -> str:
        """Key as of ``--set``."""
        return self.number.key

    @property
    def start(self) -> float:
        """Where the slider begins: at the scene's value, or as near as its range has it."""
        return min(max(self.number.value, self.low), self.high)

    def taken(self, value: object) -> float:
        """A value that somebody asks for, as the scene takes it.

        Raises:
            ValueError: It is no number in the range; says what is accepted.
        """
        if not isinstance(value, int | float) or isinstance(value, bool):
            raise ValueError(f"{self.key}: not a number")
        if not self.low <= value <= self.high:  # nor is one that is not a number
            raise ValueError(f"{self.key}: must be between {self.low:g} and {self.high:g}")
        if self.number.is_whole:
            if value != int(value):
                raise ValueError(f"{self.key}: must be a whole number")
            return int(value)
        return float(value)


def moved_keys(study: Study, asked: Sequence[str] | Mapping[str, Any] = ()) -> list[MovedKey]:
    """The numbers that a page moves.

    Args:
        study: What is explored.
        asked: ``KEY=LOW:HIGH`` each, or key → (low, high); by default the page chooses them.

    Raises:
        InputError: A key is not known or no number, or a range is none; or there is nothing to
            choose.
    """
    if not asked:
        return _chosen(study)
    if isinstance(asked, Mapping):
        ranges = [(f"'{key}'", key, _pair(key, between)) for key, between in asked.items()]
    else:
        ranges = [(f"--vary {text}", *_parsed(text)) for text in asked]
    found: dict[str, MovedKey] = {}
    for said, key, (low, high) in ranges:
        try:
            one = _moved(study, number_at(study.scene, key), low, high)
        except InputError as error:
            raise InputError(f"{said}: {error}") from None
        if one.key in found:
            raise InputError(f"{said}: the key is there twice")
        found[one.key] = one
    return list(found.values())


def _pair(key: str, between: Any) -> tuple[float, float]:
    """A range as Python has it.

    Raises:
        InputError: It is none.
    """
    try:
        low, high = (float(end) for end in between)
    except (TypeError, ValueError):
        raise InputError(f"'{key}': give its range as (low, high)") from None
    return low, high


def _parsed(text: str) -> tuple[str, tuple[float, float]]:
    """Key and range of ``KEY=LOW:HIGH``.

    Raises:
        InputError: It is not written so.
    """
    key, equals, between = text.partition("=")
    low, colon, high = between.partition(":")
    if not (equals and colon and key.strip()):
        raise InputError(f"--vary {text}: write it as KEY=LOW:HIGH")
    try:
        return key.strip(), (float(low), float(high))
    except ValueError:
        raise InputError(f"--vary {text}: '{between}' are not two numbers LOW:HIGH") from None


def _moved(study: Study, number: SceneNumber, low: float, high: float) -> MovedKey:
    """A key with the range that somebody gave.

    Raises:
        InputError: The range is none, or the scene does not take its ends.
    """
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError("both ends must be finite numbers")
    if low >= high:
        raise InputError(f"the low end, {low:g}, must be less than the high one, {high:g}")
    if number.is_whole:
        if low != int(low) or high != int(high):
            raise InputError("both ends must be whole numbers")
        low, high = int(low), int(high)
    makes_anew = False
    for end in (low, high):
        study.changed({number.key: end})
        makes_anew |= end != number.value and bool(study.other_parts({number.key: end}))
    return MovedKey(number, low, high, makes_anew)


def _chosen(study: Study) -> list[MovedKey]:
    """Return numbers of contacts, loads, preloads and supports with a scale of their own.

    Raises:
        InputError: There is none.
    """
    found = []
    for number in numbers_of(study.scene).values():
        between = _usual(number)
        if between is None or number.key.partition(".")[0] not in _TABLES:
            continue
        try:
            one = _moved(study, number, *between)
        except InputError:  # such as a time at which no load step ends
            continue
        if not one.makes_anew:
            found.append(one)
    if not found:
        raise InputError(
            "there is no number of contacts, loads, preloads or supports to move: name keys by "
            "--vary KEY=LOW:HIGH"
        )
    return sorted(found[:_MOST], key=lambda one: _TABLES.index(one.key.partition(".")[0]))


def _usual(number: SceneNumber) -> tuple[float, float] | None:
    """Between what a number is usually moved; None of directions, places and what is zero."""
    value, dimension = number.value, number.dimension
    if number.is_whole:
        return None
    if dimension is not None:
        if not value or dimension.is_place:
            return None
        low, high = sorted((0.5 * value, 1.5 * value))
        return low, high
    if number.is_entry or value < 0:
        return None
    marks = number.field.metadata
    least = max((float(str(mark.ge)) for mark in marks if isinstance(mark, Ge)), default=0.0)
    most = min((float(str(mark.le)) for mark in marks if isinstance(mark, Le)), default=math.inf)
    return least, min(max(1.0, 2 * value), most)
