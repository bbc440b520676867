"""Dimensions of the numbers of a scene, with which its keys are marked, and names of units.

Dimensions of the numbers of a scene, with which its keys are marked. A key is marked in its
annotation, ``Annotated[Number, LENGTH]``. Its description, the schema of scenes and the values
that it takes with a unit follow from that.
"""

from __future__ import annotations

import re
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic.fields import FieldInfo
from pydantic_core import core_schema


@dataclass(frozen=True)
class UnitNames:
    """Names of units.

    Attributes:
        length: Such as ``mm``.
        force: Such as ``N``.
        stress: Such as ``MPa``.
        energy: Such as ``mJ``.
        per_unit_thickness: Whether forces, areas and energies of the model are per length.
        temperature: ``K`` or ``°C``.

    >>> names = UnitNames("mm", "N", "MPa", "mJ")
    >>> names.of("force"), names.of("area"), names.of("length/stress"), names.of("")
    ('N', 'mm²', 'mm/MPa', '')
    >>> UnitNames("mm", "N", "MPa", "mJ", per_unit_thickness=True).of("force")
    'N/mm'
    """

    length: str
    force: str
    stress: str
    energy: str
    per_unit_thickness: bool = False
    temperature: str = "K"

    def of(self, words: str) -> str:
        """The unit of what is measured.

        Args:
            words: Such as ``stress/length``; empty of a pure number.
        """
        if self.per_unit_thickness and words == SPRING.words:
            return self._of_all("force/area")
        if self.per_unit_thickness and words in _RESULTANTS:
            return self._of_all(f"{words}/length")
        return self._of_all(_PER_THICKNESS.get(words, words) if self.per_unit_thickness else words)

    def _of_all(self, words: str) -> str:
        if words in ("mass", "mass/volume"):
            return f"{self.force}·s²/{self.length}{'' if words == 'mass' else '⁴'}"
        if words == "cycles/time":
            return "Hz"
        if words == "power":
            return f"{self.energy}/s"
        if words.startswith("power/"):
            units = {"area": f"{self.length}²", "length": self.length}
            below = words.removeprefix("power/")
            for measured, unit in {**units, "temperature": self.temperature}.items():
                below = below.replace(measured, unit)
            return f"{self.energy}/s/{below}"
        over, slash, under = words.partition("/")
        power = {"area": "²", "volume": "³", "length^m": "^m"}
        named = {"length": self.length, "force": self.force}
        named |= {"stress": self.stress, "energy": self.energy, "": "", "1": "1"}
        named |= {"time": "s", "time²": "s²", "impulse": f"{self.force}·s"}
        named |= {"temperature": self.temperature}
        named |= {"force·length": f"{self.force}·{self.length}"}
        name = named[over] if over in named else self.length + power[over]
        if not slash:
            return name
        below = self._of_all(under)
        return f"{name}/{f'({below})' if set(below) & set('/·') else below}"


# What models of unit thickness have per length; and what they have in place of areas and volumes.
_RESULTANTS = ("force", "energy", "impulse", "force·length", "power")
_PER_THICKNESS = {"area": "length", "volume": "area"}


#: Of a number and a unit, in the schema of scenes and wherever such a text is told from others.
QUANTITY = (
    r"^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*(1\s*/\s*)?[^0-9\s.,;:'_+\-].*$"
)
# What a text with a unit may have at the most.
_LONGEST = 60


@dataclass(frozen=True)
class Dimension:
    """Dimension of a number, as powers of length, force, time and temperature.

    The unit of time is the second.

    In an annotation it lets a key also take a text with a unit, which is kept as it was written
    until the scene knows its own units.

    Attributes:
        words: As descriptions have it, such as ``stress/length``.
        length: Power of length.
        force: Power of force.
        time: Power of time.
        is_resultant: Whether models of unit thickness have it per length.
        is_said: Whether descriptions say it.
        is_place: Whether it is a coordinate, which says nothing of how far it may be moved.
        temperature: Power of temperature.
    """

    words: str
    length: float
    force: float = 0.0
    time: float = 0.0
    is_resultant: bool = False
    is_said: bool = True
    is_place: bool = False
    temperature: float = 0.0

    @property
    def powers(self) -> tuple[float, float, float, float]:
        """Powers of length, force, time and temperature."""
        return self.length, self.force, self.time, self.temperature

    def of(self, table: Any, outer: Dimension | None) -> Dimension | None:
        """Return the dimension in a table of a scene, where it depends on other keys.

        Args:
            table: Of a scene class.
            outer: What the key measures whose value the table is.
        """
        return self

    def __get_pydantic_core_schema__(
        self, source: Any, handler: Callable[[Any], Any]
    ) -> core_schema.CoreSchema:
        """Return the schema of the key, with texts with a unit kept as they are."""
        return core_schema.no_info_wrap_validator_function(self._kept, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: Callable[[Any], Any]
    ) -> dict[str, Any]:
        """Return the schema of the key, which also takes a text with a unit."""
        found: dict[str, Any] = handler(schema)
        with_unit = {"type": "string", "pattern": QUANTITY, "maxLength": _LONGEST}
        return {"anyOf": [*found.get("anyOf", [found]), with_unit]}

    def _kept(self, value: object, handler: Callable[[Any], Any]) -> Any:
        if isinstance(value, str) and re.match(QUANTITY, value[: 2 * _LONGEST]):
            return WithUnit(value)
        return handler(value)


@dataclass(frozen=True)
class WithUnit:
    """A text with a unit, in the place of a number until the scene's own units are known.

    Attributes:
        text: As it was written.
    """

    text: str


@dataclass(frozen=True)
class _OfKey(Dimension):
    """Dimension of the key for which a table is given, such as a profile of a pressure."""

    def of(self, table: Any, outer: Dimension | None) -> Dimension | None:
        """Return the dimension of the outer key."""
        return outer


@dataclass(frozen=True)
class _OfPower(Dimension):
    """Stress over a power of length, the exponent of a law."""

    def of(self, table: Any, outer: Dimension | None) -> Dimension | None:
        """Return the dimension with the exponent in the law's table."""
        return Dimension(self.words, -2.0 - table.exponent, 1.0)


LENGTH = Dimension("length", 1)
PLACE = Dimension("length", 1, is_place=True)
LENGTH_OR_NUMBER = Dimension("length", 1, is_said=False)
STRESS = Dimension("stress", -2, 1)
FORCE = Dimension("force", 0, 1, is_resultant=True)
BODY_FORCE = Dimension("force/volume", -3, 1)
MOMENT = Dimension("force·length", 1, 1, is_resultant=True)
ACCELERATION = Dimension("length/time²", 1, 0, -2)
DENSITY = Dimension("mass/volume", -4, 1, 2)
MASS = Dimension("mass", -1, 1, 2, is_resultant=True)
TIME = Dimension("time", 0, 0, 1)
RATE = Dimension("1/time", 0, 0, -1)
TEMPERATURE = Dimension("temperature", 0, temperature=1)
EXPANSION = Dimension("1/temperature", 0, temperature=-1)
CONDUCTIVITY = Dimension("power/(length·temperature)", 0, 1, -1, temperature=-1)
CONDUCTANCE = Dimension("power/(area·temperature)", -1, 1, -1, temperature=-1)
HEAT_FLUX = Dimension("power/area", -1, 1, -1)
VELOCITY = Dimension("length/time", 1, 0, -1)
COMPLIANCE = Dimension("length/stress", 3, -1)
PER_STRESS = Dimension("1/stress", 2, -1)
STIFFNESS = Dimension("stress/length", -3, 1)
SPRING = Dimension("force/length", -1, 1, is_resultant=True)
STIFFNESS_OF_POWER = _OfPower("stress/length^m", -2, 1)
OF_KEY = _OfKey("", 0, is_said=False)


def dimension_of(field: FieldInfo) -> Dimension | None:
    """Return the dimension of a key's numbers, also inside its lists and tables; None without one.

    Args:
        field: Of a scene class.
    """
    marks = [mark for mark in field.metadata if isinstance(mark, Dimension)]
    return next(iter([*marks, *_marks_in(field.annotation)]), None)


def _marks_in(hint: Any) -> list[Dimension]:
    marks = [mark for mark in getattr(hint, "__metadata__", ()) if isinstance(mark, Dimension)]
    parts = () if typing.get_origin(hint) is Callable else typing.get_args(hint)
    inner = [part for part in parts if typing.get_origin(part) or hasattr(part, "__metadata__")]
    return marks + [mark for part in inner for mark in _marks_in(part)]


def description_of(field: FieldInfo) -> str:
    """Return a key's description, with its dimension after the first part of the sentence.

    Args:
        field: Of a scene class.
    """
    dimension, words = dimension_of(field), field.description or ""
    if dimension is None or not dimension.is_said:
        return words
    first, semicolon, rest = words.partition(";")
    return f"{first} ({dimension.words}){semicolon}{rest}"


def has_unit(part: object) -> bool:
    """Whether a value of a scene has a text with a unit anywhere inside its lists and tables."""
    if isinstance(part, Mapping):
        return any(has_unit(entry) for entry in part.values())
    if isinstance(part, tuple):
        return any(has_unit(entry) for entry in part)
    return isinstance(part, WithUnit)
