"""Kinds of values in a scene: numbers, texts, profiles, functions of position."""

from __future__ import annotations

import dataclasses
import functools
import inspect
import textwrap
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Literal, TypeVar, cast, dataclass_transform

import numpy as np
from pydantic import (
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Strict,
    ValidationError,
)
from pydantic.dataclasses import dataclass
from pydantic_core import PydanticKnownError, core_schema

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import SceneError
from fenics_contact.scene.given_keys import key_of
from fenics_contact.scene.messages import sentence
from fenics_contact.scene.units.dimensions import OF_KEY, PLACE, description_of, has_unit

Number = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Integer = Annotated[int, Strict()]
Text = Annotated[str, Field(min_length=1)]
AxisName = Literal["x", "y", "z"]
Kinematics = Literal["plane strain", "plane stress", "axisymmetric", "3D"]
Strains = Literal["small", "finite"]


@dataclasses.dataclass(frozen=True)
class OneOf:
    """Marks a text that is one of some names, of which there can be more later.

    Attributes:
        names: Gives all of them.
    """

    names: Callable[[], tuple[str, ...]]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_after_validator_function(self._known, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {**handler(schema), "enum": list(self.names())}

    def _known(self, text: str) -> str:
        names = [f"'{name}'" for name in self.names()]
        if text not in self.names():
            said = {"expected": f"{', '.join(names[:-1])} or {names[-1]}"}
            raise PydanticKnownError("literal_error", said)
        return text


AXES: tuple[AxisName, ...] = ("x", "y", "z")
# Index pairs of a stress or strain in the order of a 6 × 6 stiffness matrix.
VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
Class = TypeVar("Class", bound=type)


@dataclass_transform(frozen_default=True, field_specifiers=(Field,))
def scene_class(plain: Class) -> Class:
    """A frozen dataclass that validates what it is given, and knows no other keys.

    What it refuses in Python is a ``SceneError`` of one sentence; in a file, ``load_scene`` says
    where.
    """
    _check_only_numbers(plain)
    made: Any = dataclass(frozen=True, config=ConfigDict(extra="forbid", populate_by_name=True))(
        plain
    )
    validate = made.__init__

    @functools.wraps(validate)
    def checked(self: Any, *values: Any, **named: Any) -> None:
        by_key = {key_of(made, name): value for name, value in named.items()}
        try:
            validate(self, *values, **by_key)
        except ValidationError as error:
            names = [key_of(made, field.name) for field in dataclasses.fields(made)]
            given = dict(zip(names, values, strict=False)) | by_key
            words = sentence(error, given, made, names)
            raise SceneError(f"{made.__name__}: {words}") from None

    made.__init__ = checked
    made.__doc__ = f"{inspect.getdoc(plain)}\n\n{_attributes(made)}"
    return cast(Class, made)


def _check_only_numbers(plain: Any) -> None:
    """Have the checks of a class wait where it has texts with a unit, until they are numbers."""
    check = getattr(plain, "__post_init__", None)
    if check is None:
        return

    @functools.wraps(check)
    def with_numbers(self: Any) -> None:
        if isinstance(self, HasUnits):
            self.use_units()
        if not any(has_unit(value) for value in vars(self).values()):
            check(self)

    plain.__post_init__ = with_numbers


class HasUnits:
    """Base class of the table that has the units of all its values, and of those of its parts."""

    def use_units(self) -> None:
        """Put numbers where there are texts with a unit."""
        raise NotImplementedError


def _attributes(made: Any) -> str:
    """The part of a docstring that says what the keys are, as their fields describe them."""
    lines = ["Attributes:"]
    for name, field in made.__pydantic_fields__.items():
        said = description_of(field)
        text = f"{name}: {said[0].upper()}{said[1:]}."
        lines += textwrap.wrap(text, 92, initial_indent=" " * 4, subsequent_indent=" " * 8)
    return "\n".join(
        [
            *lines,
            "",
            "Raises:",
            "    SceneError: A value is none that is accepted, or keys contradict each other.",
        ]
    )


def as_list(value: Any) -> Any:
    """One table as a list of one."""
    return value if isinstance(value, list | tuple) else (value,)


@scene_class
class Profile:
    """A value that varies along one axis, linear between the listed points.

    >>> import numpy as np
    >>> pressure = Profile(along="x", at=(0, 2, 4), values=(100, 300, 0))
    >>> pressure(np.array([[-1, 1, 3, 9], [0, 0, 0, 0], [0, 0, 0, 0]])).tolist()
    [100.0, 200.0, 150.0, 0.0]
    """

    along: Annotated[AxisName, Field(description="axis of the mesh along which it varies")]
    at: Annotated[
        tuple[Annotated[Number, PLACE], ...],
        Field(min_length=2, description="increasing coordinates"),
    ]
    values: Annotated[
        tuple[Annotated[Number, OF_KEY], ...],
        Field(min_length=2, description="the value at each; constant beyond the ends"),
    ]

    def __post_init__(self) -> None:
        if len(self.at) != len(self.values):
            raise ValueError(f"at has {len(self.at)} entries and values {len(self.values)}")
        if any(b <= a for a, b in zip(self.at, self.at[1:], strict=False)):
            raise ValueError("the coordinates in at must increase")

    def __call__(self, points: Array) -> Array:
        """Values at points.

        Args:
            points: Coordinates in the mesh's axes, (3, points) (length).

        Returns:
            A value for each, (points,) (the unit of ``values``).
        """
        return np.asarray(np.interp(points[AXES.index(self.along)], self.at, self.values))


PositionFunction = Callable[[Array], Any]
Value = Number | Profile | PositionFunction
# Of a list with an entry per axis.
PER_AXIS = Field(min_length=2, max_length=3)


@dataclasses.dataclass(frozen=True)
class Repetition:
    """A piece of pseudo-time that runs again and again.

    Attributes:
        begin: Pseudo-time at which it runs first.
        period: How long it is (pseudo-time).
        number: How often it runs.

    >>> three = Repetition(begin=1.0, period=4.0, number=3)
    >>> [three.first_time(time) for time in (0.5, 2.0, 5.0, 6.0, 13.0, 14.0)]
    [0.5, 2.0, 1.0, 2.0, 5.0, 6.0]
    >>> three.ends
    (5.0, 9.0, 13.0)
    """

    begin: float
    period: float
    number: int

    def first_time(self, time: float) -> float:
        """The pseudo-time in the first run, or before or beyond all, at which the same acts."""
        passed = min(max((time - self.begin) // self.period, 0), self.number - 1)
        return time - self.period * passed

    @property
    def starts(self) -> tuple[float, ...]:
        """Pseudo-time at which each run begins."""
        return tuple(self.begin + self.period * run for run in range(self.number))

    @property
    def ends(self) -> tuple[float, ...]:
        """Pseudo-time at which each run ends."""
        return tuple(self.begin + self.period * (run + 1) for run in range(self.number))


@scene_class
class Path:
    """How a quantity grows with the pseudo-time of the load steps, linear between the points.

    In Python a function of the pseudo-time may stand in its place.

    >>> there_and_back = Path(time=(0, 1, 2), factor=(0, 1, 0), cycles=3)
    >>> [there_and_back(time) for time in (0.5, 1, 2, 3, 5.5, 9)]
    [0.5, 1.0, 0.0, 1.0, 0.5, 0.0]
    """

    time: Annotated[
        tuple[Number, ...], Field(min_length=1, description="increasing pseudo-times, ≥ 0")
    ]
    factor: Annotated[
        tuple[Number, ...],
        Field(min_length=1, description="share of the value at each; constant beyond the ends"),
    ]
    cycles: Annotated[
        Integer,
        Field(
            ge=1,
            le=1_000_000,
            description="how often the table runs, one cycle after the other; its last time is "
            "the period, and its last factor must be the first",
        ),
    ] = 1

    def __post_init__(self) -> None:
        if len(self.time) != len(self.factor):
            raise ValueError(f"time has {len(self.time)} entries and factor {len(self.factor)}")
        if any(b <= a for a, b in zip(self.time, self.time[1:], strict=False)):
            raise ValueError("the times must increase")
        if self.time[0] < 0:
            raise ValueError(f"the first time, {self.time[0]:g}, must be ≥ 0")
        if self.cycles == 1:
            return
        if self.time[-1] <= 0:
            raise ValueError("cycles: the last time is the period, which must be > 0")
        if self.factor[0] != self.factor[-1]:
            raise ValueError(
                f"cycles: the last factor, {self.factor[-1]:g}, must be the first, "
                f"{self.factor[0]:g}, or every cycle would begin with a jump"
            )

    def __call__(self, time: float) -> float:
        """Share of the value at a pseudo-time.

        Args:
            time: Pseudo-time, that of the load steps.
        """
        first = self.repetition.first_time(time) if self.cycles > 1 else time
        return float(np.interp(first, self.time, self.factor))

    @property
    def repetition(self) -> Repetition:
        """When the table runs."""
        return Repetition(0.0, self.time[-1], self.cycles)

    @property
    def knots(self) -> tuple[float, ...]:
        """Pseudo-times at which it may change its slope."""
        return tuple(sorted({begin + t for begin in self.repetition.starts for t in self.time}))


# Its factor at a pseudo-time; in scenes made in Python.
PathFunction = Callable[[float], Any]
LoadPath = Path | PathFunction

# From nothing at time 0 to all at time 1, and from then on.
RAMP = Path(time=(0.0, 1.0), factor=(0.0, 1.0))
# All from the start.
CONSTANT = Path(time=(0.0,), factor=(1.0,))


def differing(one: Any, other: Any) -> set[str]:
    """Names of the keys in which two tables of one class differ.

    Args:
        one: A table of a scene, or a scene.
        other: The other one.
    """
    values = ((name, value, getattr(other, name)) for name, value in vars(one).items())
    return {name for name, value, against in values if not (value is against or value == against)}


# What has no parts: most of a scene, which is looked through whenever it is changed.
PLAIN: frozenset[type] = frozenset((str, int, float, bool, type(None)))


def profiles_of(part: object) -> Iterator[Profile]:
    """All profiles inside a scene or a part of it."""
    if type(part) in PLAIN:
        return
    if isinstance(part, Profile):
        yield part
    elif dataclasses.is_dataclass(part):
        for value in vars(part).values():
            yield from profiles_of(value)
    elif isinstance(part, Mapping):
        for value in part.values():
            yield from profiles_of(value)
    elif isinstance(part, tuple):
        for value in part:
            yield from profiles_of(value)
