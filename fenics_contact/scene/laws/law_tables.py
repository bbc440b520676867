"""Tables of laws: those with a kind, bases of users' laws, and ``contact.normal_law``.

A new law across a contact is a class here: what it says of itself are its keys.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Union, get_args

from pydantic import (
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    TypeAdapter,
)
from pydantic_core import core_schema

from fenics_contact.scene.laws.formula import FUNCTIONS, Formula
from fenics_contact.scene.units.dimensions import STIFFNESS_OF_POWER
from fenics_contact.scene.values import Number, Text, Value, scene_class


class TablesByKind:
    """Marks a key that takes a table of one of some classes, whichever its ``kind`` names.

    There can be more classes later. What is wrong with a table is said of its own class, and not of
    all of them.

    Args:
        tables: The classes; the annotation of ``kind`` is a literal with its names, or of one of
            them a text, of a class of the user's own.
    """

    def __init__(self, *tables: Any) -> None:
        self._tables = tables
        self._adapter: TypeAdapter[Any] | None = None

    @property
    def tables(self) -> tuple[Any, ...]:
        """All classes, that of a user's own laws last."""
        return tuple(sorted(self._tables, key=lambda table: not kinds_of(table)))

    def register(self, table: Any) -> None:
        """Accept tables of one more class.

        Args:
            table: A scene class, whose ``kind`` is a literal.

        Raises:
            ValueError: There is a table of this kind.
        """
        known = [kind for other in self._tables for kind in kinds_of(other)]
        if twice := [kind for kind in kinds_of(table) if kind in known]:
            raise ValueError(f"there is a table of the kind '{twice[0]}'")
        self._tables, self._adapter = (*self._tables, table), None

    def unregister(self, table: Any) -> None:
        """Take out a class that was registered."""
        self._tables = tuple(one for one in self._tables if one is not table)
        self._adapter = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._made)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return handler(self._present.core_schema)

    def _made(self, value: Any) -> Any:
        return self._present.validate_python(value)

    @property
    def _present(self) -> TypeAdapter[Any]:
        """One of the present classes, by the kind that is given."""
        if self._adapter is None:
            self._adapter = TypeAdapter(_chosen_by_kind(self.tables))
        return self._adapter


def _chosen_by_kind(tables: tuple[Any, ...]) -> Any:
    of_kind = {kind: table for table in tables for kind in kinds_of(table)}
    own = next((table for table in tables if not kinds_of(table)), None)
    words = ", ".join(f"'{kind}'" for kind in of_kind) + (", 'MODULE:CLASS'" if own else "")
    tagged = tuple(Annotated[table, Tag(table.__name__)] for table in tables)

    def named(value: Any) -> str | None:
        kind = value.get("kind") if isinstance(value, Mapping) else getattr(value, "kind", None)
        table = of_kind.get(kind, own if ":" in kind else None) if isinstance(kind, str) else None
        return None if table is None else table.__name__

    return Annotated[
        Union[tagged],  # noqa: UP007
        Discriminator(
            named,
            custom_error_type="kind",
            custom_error_message=f"a table whose kind is one of {words}",
        ),
    ]


def kinds_of(table: Any) -> tuple[str, ...]:
    """The names that a class takes for its kind; none where it takes any."""
    found: tuple[str, ...] = get_args(table.__pydantic_fields__["kind"].annotation)
    return found


class FrictionLawTable:
    """Base class of the tables of friction laws.

    Attributes:
        kind: By which results and messages name the law.
        is_proportional: Whether it is one coefficient times the pressure.
        needs_steps: Whether it follows the slip of load steps, as the incremental law has it.
        needs_motion: Whether it follows velocities, which there are where bodies move.
        is_regular: Whether its surfaces give way along each other, so that it needs no
            regularisation.
        averages: Whether its bound at a point follows pressures around it.
    """

    kind: str
    is_proportional: ClassVar[bool] = False
    needs_steps: ClassVar[bool] = False
    needs_motion: ClassVar[bool] = False
    is_regular: ClassVar[bool] = False
    averages: ClassVar[bool] = False

    @property
    def fits_motion(self) -> bool:
        """Whether it follows velocities, so that bodies in motion may have it."""
        return self.is_proportional or self.needs_motion

    @property
    def at_rest(self) -> FrictionLawTable | None:
        """The law between bodies that do not slide; None where that is Coulomb's."""
        return self

    @property
    def shown(self) -> str:
        """The law and its numbers in words, for results."""
        keys: Any = self
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(keys)}
        values |= values.pop("parameters", {})
        words = [f"{key} {_shown(value)}" for key, value in values.items() if key != "kind"]
        return f"{self.kind}: {', '.join(words)}" if words else self.kind

    def require_model(self, kinematics: str, key: str) -> None:
        """See that it fits the model.

        Args:
            kinematics: Of the scene.
            key: Of the contact, for messages.

        Raises:
            ValueError: It does not.
        """

    def require_fit(self, kind: str, coefficient: Value) -> None:
        """See that it fits the contact that it is of.

        Args:
            kind: The law across the contact, as results name it.
            coefficient: The contact's friction_coefficient.

        Raises:
            ValueError: It does not.
        """


def _shown(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_shown, value))}]"
    return f"{value:.4g}" if isinstance(value, float) else "varies" if callable(value) else value


def require_increase(key: str, places: Sequence[float], shares: Sequence[float]) -> None:
    """See that a table has as many places as shares, from 0 or more, one after the other.

    Args:
        key: Of the places.
        places: At which shares are given.
        shares: Given there.

    Raises:
        ValueError: It has not.
    """
    if len(places) != len(shares):
        raise ValueError(f"{key} has {len(places)} entries and shares {len(shares)}")
    if places[0] < 0 or any(b <= a for a, b in pairwise(places)):
        raise ValueError(f"{key} must be ≥ 0 and increase")


#: The kind of a law of a user's own: the name of its class.
ClassName = Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")]
Parameters = Annotated[
    Mapping[str, Number],
    Field(description="name → number, in the scene's units; such as `{ c = 2e4 }`"),
]
#: What a formula may have, for descriptions of keys.
LANGUAGE = (
    "+ - * / ^, brackets, numbers, parameters and `sqrt`, `exp`, `ln`, `min`, `max`; it is read, "
    "and never run as Python"
)


def require_formula(
    key: str, text: str, parameters: Mapping[str, float], zero: Mapping[str, float]
) -> None:
    """See that a formula is one, has all parameters, and is 0 where it has to be.

    Args:
        key: That has the formula.
        text: Of the formula.
        parameters: That it is given.
        zero: Its variables, at which it must be 0.

    Raises:
        ValueError: It is not.
    """
    for name in parameters:
        if not name.isidentifier() or name in zero or name in FUNCTIONS:
            raise ValueError(f"parameters: '{name}' is no name that a formula could use")
    formula = Formula(text, (*zero, *parameters))
    for name in parameters:
        if name not in formula.used:
            raise ValueError(f"parameters.{name} does not stand in the formula")
    if found := formula.number({**zero, **parameters}):
        first = next(iter(zero))
        raise ValueError(f"{key} = '{text}' is {found:g} at {first} = 0, not 0")


class NormalLawTable:
    """Base class of the tables of laws across a contact, which results name by ``kind``.

    Attributes:
        kind: By which results and messages name the law.
        fits_motion: Whether bodies in motion may have it.
    """

    kind: str
    fits_motion: ClassVar[bool] = False


@scene_class
class NormalCompliance(NormalLawTable):
    """Normal compliance: surfaces that give way, p = c d^m at a depth d (Oden and Martins 1985).

    >>> NormalCompliance(kind="normal compliance", coefficient=4e4, exponent=2).exponent
    2.0
    """

    fits_motion: ClassVar[bool] = True
    kind: Annotated[Literal["normal compliance"], Field(description="which law it is")]
    coefficient: Annotated[Value, STIFFNESS_OF_POWER, Field(description="c ≥ 0")]
    exponent: Annotated[
        Number, Field(ge=1, description="m ≥ 1; 1 is a `winkler` foundation of stiffness c")
    ]

    def __post_init__(self) -> None:
        if isinstance(self.coefficient, float | int) and self.coefficient < 0:
            raise ValueError(f"coefficient = {self.coefficient} must be ≥ 0")


@scene_class
class PressureFormula(NormalLawTable):
    """A pressure of your own: a formula of the depth d, which is read and never run as Python.

    >>> PressureFormula(kind="formula", pressure="c * d^1.5", parameters={"c": 2e4}).pressure
    'c * d^1.5'
    """

    kind: Annotated[Literal["formula"], Field(description="which law it is")]
    pressure: Annotated[
        Text, Field(description=f"the pressure at a depth `d` > 0, 0 at d = 0: {LANGUAGE}")
    ]
    parameters: Parameters = Field(default_factory=dict)

    def __post_init__(self) -> None:
        require_formula("pressure", self.pressure, self.parameters, {"d": 0.0})


@scene_class
class OwnNormalLaw(NormalLawTable):
    """A law of a module of yours, which the command line must allow: ``--laws MODULE``.

    >>> OwnNormalLaw(kind="my_laws:Springs", parameters={"k": 2e4}).kind
    'my_laws:Springs'
    """

    kind: Annotated[
        ClassName, Field(description="`MODULE:CLASS`, derived from `UserContactEnergy`")
    ]
    parameters: Parameters = Field(default_factory=dict)


#: All of them, of which there can be more later.
NORMAL_LAWS = TablesByKind(*NormalLawTable.__subclasses__())
if TYPE_CHECKING:
    AnyNormalLaw = NormalLawTable
else:
    AnyNormalLaw = Annotated[Any, NORMAL_LAWS]
