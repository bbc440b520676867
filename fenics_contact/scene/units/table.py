"""The table ``[units]`` of a scene, its values in these units, and the units by pint.

Units by pint, which is loaded when a scene has units, and not before. Of a text only one number
and one unit are taken, by a grammar of our own: pint is given nothing else, and nothing is
computed of it.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping, Sequence
from decimal import Decimal
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import Field
from pydantic.fields import FieldInfo

from fenics_contact.common.errors import SceneError
from fenics_contact.scene.given_keys import key_of
from fenics_contact.scene.messages import written
from fenics_contact.scene.units.dimensions import (
    TEMPERATURE,
    Dimension,
    UnitNames,
    WithUnit,
    dimension_of,
)
from fenics_contact.scene.values import PLAIN, Text, scene_class

# The usual names that a unit of stress or energy may have.
_USUAL = {
    (-2, 1): ("Pa", "kPa", "MPa", "GPa", "psi", "ksi"),
    (1, 1): ("pJ", "nJ", "µJ", "mJ", "J", "kJ", "MJ"),
}
_SAME = Decimal("1e-12")
_LONGEST = 60
_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?"
_NAME = "(?:°C|[A-Za-zµμÅ]+(?:_[A-Za-z]+)*)"
_WORD = rf"{_NAME}(?:(?:\^|\*\*)?-?[0-9](?:\.[0-9]{{1,3}})?|⁻?[¹²³⁴⁵⁶⁷⁸⁹])?"
_UNIT = rf"(?:1?\s*/\s*)?{_WORD}(?:(?:\s*[*/·⋅]\s*|\s+){_WORD}){{0,5}}"
# Of temperatures only differences count, so that a degree Celsius is a kelvin.
_DEGREES = r"°C|\bdegC\b"
_ORDINARY = str.maketrans("¹²³⁴⁵⁶⁷⁸⁹⁻·⋅μ", "123456789-**µ")


class UnknownUnitError(ValueError):
    """A text is no number and unit, or the unit is not known; says so."""


def parts_of(text: str) -> tuple[Decimal, str]:
    """The number and the unit of a text.

    Raises:
        UnknownUnitError: It is not one number and one unit.

    >>> parts_of("210 GPa"), parts_of("5e-3N/mm²")
    ((Decimal('210'), 'GPa'), (Decimal('0.005'), 'N/mm²'))
    >>> parts_of("2*3 mm")
    Traceback (most recent call last):
    fenics_contact.scene.units.table.UnknownUnitError: must be one number and one unit
    """
    found = re.fullmatch(rf"\s*({_NUMBER})\s*({_UNIT})\s*", text) if len(text) <= _LONGEST else None
    if found is None:
        raise UnknownUnitError("must be one number and one unit")
    return Decimal(found[1]), found[2]


def factor(unit: str, length: str, force: str, powers: tuple[float, ...]) -> Decimal:
    """Return how many of other units a unit is.

    Args:
        unit: Such as ``GPa``.
        length: Unit of length, such as ``mm``.
        force: Unit of force, such as ``N``.
        powers: Of length and force, and of second and kelvin if any.

    Returns:
        Of ``length`` to the one power times ``force`` to the other, how many it is.

    Raises:
        UnknownUnitError: It is not known, or measures something else.

    >>> int(factor("GPa", "mm", "N", (-2, 1)))
    1000
    >>> float(factor("kg/m³", "mm", "N", (-4, 1, 2)))
    1e-12
    """
    one, wanted = _parsed(unit), _product(length, force, powers)
    try:
        return Decimal(one.to(wanted).magnitude)
    except _pint().errors.DimensionalityError:
        raise UnknownUnitError(f"'{unit}' measures something else") from None


def symbol(unit: str) -> str:
    """A unit in short, as ``mm`` for ``millimeter``."""
    return f"{_parsed(unit).units:~P}"


def derived(length: str, force: str, powers: tuple[int, int]) -> str:
    """The name of a derived unit: a usual one where there is one that is exactly this.

    Args:
        length: Symbol of the unit of length.
        force: Symbol of the unit of force.
        powers: Of length and force.

    >>> derived("mm", "N", (-2, 1)), derived("mm", "N", (1, 1)), derived("ft", "lbf", (-2, 1))
    ('MPa', 'mJ', 'lbf/ft²')
    """
    for name in _USUAL.get(powers, ()):
        if abs(factor(name, length, force, powers) - 1) < _SAME:
            return name
    return f"{force}·{length}" if powers[0] > 0 else f"{force}/{length}²"


def _product(length: str, force: str, powers: tuple[float, ...]) -> Any:
    units = (length, force, "s", "K")[: len(powers)]
    parts = [
        _parsed(unit).units ** Decimal(str(power))
        for unit, power in zip(units, powers, strict=True)
    ]
    return math.prod(parts[1:], start=parts[0])


@cache
def _parsed(unit: str) -> Any:
    """One of a unit.

    Raises:
        UnknownUnitError: It is not known, or none that is multiplied, as degrees are.
    """
    if len(unit) > _LONGEST or not re.fullmatch(_UNIT, unit):
        raise UnknownUnitError(f"'{unit[:_LONGEST]}' is no unit")
    registry = _registry()
    plain = re.sub(r"([A-Za-zµÅ])(-?[0-9])", r"\1**\2", unit.translate(_ORDINARY))
    try:
        plain = re.sub(_DEGREES, "delta_degC", plain)
        found = registry.parse_units(f"1{plain}" if plain.lstrip().startswith("/") else plain)
        zero = registry.Quantity(Decimal(0), found).to_base_units().magnitude
        one = registry.Quantity(Decimal(1), found)
    except (_pint().errors.PintError, AttributeError, ValueError, TypeError):
        raise UnknownUnitError(f"'{unit}' is no unit that is known") from None
    if zero != 0:
        raise UnknownUnitError(f"'{unit}' has a zero of its own; accepted are K and °C")
    return one


@cache
def _registry() -> Any:
    # In decimals an inch is exactly 25.4 mm, and 210 GPa are 210000 N/mm², not nearly so.
    return _pint().UnitRegistry(non_int_type=Decimal, cache_folder=None)


def _pint() -> Any:
    try:
        import pint
    except ImportError:
        raise ValueError(
            "[units] needs the Python library pint: install it with pip install pint, or on "
            "Debian the package python3-pint"
        ) from None
    return pint


_SMALLEST, _LARGEST = 1e-100, 1e100  # sizes of numbers that a scene may hold
# Keys that one table of a list is given by, without a number.
_ALONE = ("material", "mesh")


@scene_class
class Units:
    """Units of all numbers of a scene and of its results.

    >>> Units("mm", "N").names()
    UnitNames(length='mm', force='N', stress='MPa', energy='mJ', per_unit_thickness=False, temperature='K')
    >>> Units("mm", "kg")
    Traceback (most recent call last):
    fenics_contact.common.errors.SceneError: Units: force = 'kg': must be a unit of force, such as 'N'
    """  # noqa: E501

    length: Annotated[
        Text, Field(description="of lengths, such as `mm`, `m` or `in`; also of the mesh's file")
    ]
    force: Annotated[Text, Field(description="of forces, such as `N`, `kN` or `lbf`")]
    temperature: Annotated[
        Literal["K", "°C"],
        Field(description="of temperatures, of which only differences count: `K` or `°C`"),
    ] = "K"

    def __post_init__(self) -> None:
        for key, example, powers in (("length", "mm", (1, 0)), ("force", "N", (0, 1))):
            try:
                factor(getattr(self, key), "m", "N", powers)
            except UnknownUnitError:
                raise ValueError(
                    f"{key} = {getattr(self, key)!r}: must be a unit of {key}, such as '{example}'"
                ) from None

    def names(self, per_unit_thickness: bool = False) -> UnitNames:
        """Return the names of these units and of those that follow from them.

        Args:
            per_unit_thickness: Whether forces of the model are per length.
        """
        length, force = symbol(self.length), symbol(self.force)
        stress, energy = (derived(length, force, powers) for powers in ((-2, 1), (1, 1)))
        return UnitNames(length, force, stress, energy, per_unit_thickness, self.temperature)


def convert_texts(scene: Any, units: Units | None, per_unit_thickness: bool) -> None:
    """Put numbers in a scene's units where it has texts with a unit.

    Args:
        scene: The scene while it is made.
        units: Its own; None where it has none.
        per_unit_thickness: Whether its forces are per length.

    Raises:
        ValueError: A text has none of these units, or there are none; names the key.
    """
    if units is not None:
        _require_mm_of_step_files(scene, units)
    if not _has_text(scene):
        return
    conversion = _Conversion(units, per_unit_thickness)
    for name, dimension in dimensions(scene):
        value = getattr(scene, name)
        found = conversion.of(value, [name], dimension)
        if found is not value:
            object.__setattr__(scene, name, found)


def _has_text(part: Any) -> bool:
    """Whether a scene, or a part of it, has a text with a unit anywhere: mostly it has none."""
    kind = type(part)
    if kind in PLAIN:
        return False
    if kind is WithUnit:
        return True
    if isinstance(part, tuple):
        return any(map(_has_text, part))
    if isinstance(part, Mapping):
        return any(map(_has_text, part.values()))
    return hasattr(kind, "__pydantic_fields__") and any(map(_has_text, vars(part).values()))


# Of each scene class: its keys, and what their numbers measure. To look that up takes longer than
# what else is done with a scene that has no texts.
_DIMENSIONS: dict[type, list[tuple[str, Dimension | None]]] = {}


def dimensions(table: Any) -> list[tuple[str, Dimension | None]]:
    """Keys of a table of a scene, and what their numbers measure."""
    kind = type(table)
    if kind not in _DIMENSIONS:
        fields: dict[str, FieldInfo] = table.__pydantic_fields__
        _DIMENSIONS[kind] = [(name, dimension_of(field)) for name, field in fields.items()]
    return _DIMENSIONS[kind]


def forget_dimensions(kind: type) -> None:
    """Forget the dimensions of a scene class, whose keys have changed."""
    _DIMENSIONS.pop(kind, None)


def _require_mm_of_step_files(scene: Any, units: Units) -> None:
    """Whatever unit is in a STEP file, Gmsh reads it in mm."""
    files = [file for file in scene.files if file.lower().endswith((".step", ".stp"))]
    if files and factor(units.length, "mm", "N", (1, 0)) != 1:
        raise ValueError(
            f"units.length = {units.length!r}: '{files[0]}' is read in mm, as every STEP file is, "
            "so that length must be 'mm'"
        )


def _require_scale(scale: str, unit: str) -> None:
    """Refuse a temperature on the other scale, whose zero is another one.

    Args:
        scale: Of the scene, ``K`` or ``°C``.
        unit: Of the temperature.

    Raises:
        UnknownUnitError: It is in K where temperatures are in °C, or the other way round.
    """
    other = {"K": "°C", "°C": "K"}[scale]
    if symbol(unit) in (other, f"Δ{other}"):
        raise UnknownUnitError(f"temperatures of the scene are in {scale}, by units.temperature")


@dataclasses.dataclass(frozen=True)
class _Conversion:
    """From texts to numbers.

    Attributes:
        units: Of the scene, if any.
        per_unit_thickness: Whether its forces are per length.
    """

    units: Units | None
    per_unit_thickness: bool

    def of(self, value: Any, path: Sequence[object], dimension: Dimension | None) -> Any:
        """A value of a scene with numbers in place of texts; itself where it has none.

        Args:
            value: Of a scene, or a part of it.
            path: Of its key.
            dimension: What its numbers measure.
        """
        if type(value) in PLAIN:
            return value
        if isinstance(value, WithUnit):
            assert dimension is not None
            return self._number(value.text, path, dimension)
        if isinstance(value, tuple):
            alone = len(value) == 1 and path[-1] in _ALONE
            found = tuple(
                self.of(entry, path if alone else [*path, number], dimension)
                for number, entry in enumerate(value)
            )
            return found if any(a is not b for a, b in zip(found, value, strict=True)) else value
        if isinstance(value, Mapping):
            named = {name: self.of(part, [*path, name], dimension) for name, part in value.items()}
            return named if any(named[name] is not value[name] for name in named) else value
        is_table = hasattr(type(value), "__pydantic_fields__")  # and no function of the user's
        return self._of_table(value, path, dimension) if is_table else value

    def _of_table(self, table: Any, path: Sequence[object], outer: Dimension | None) -> Any:
        """A part of a scene.

        Args:
            table: Of a scene class.
            path: Of its key.
            outer: What the key measures, for a profile in its place.
        """
        changes = {}
        for name, dimension in dimensions(table):
            value = getattr(table, name)
            if type(value) in PLAIN:
                continue
            of_value = dimension.of(table, outer) if dimension is not None else None
            found = self.of(value, [*path, key_of(type(table), name)], of_value)
            if found is not value:
                changes[name] = found
        if not changes:
            return table
        try:
            return dataclasses.replace(table, **changes)
        except SceneError as error:
            words = str(error).removeprefix(f"{type(table).__name__}: ")
            raise ValueError(f"{written(path)}: {words}") from None

    def _number(self, text: str, path: Sequence[object], dimension: Dimension) -> float:
        """Return the number, in the scene's units, of a text with a unit."""
        key = f"{written(path)} = {text[:60]!r}"
        if self.units is None:
            raise ValueError(
                f"{key}: a value with a unit needs the scene's own units, such as [units] with "
                'length = "mm" and force = "N"; without them write a number'
            )
        per_length = self.per_unit_thickness and dimension.is_resultant
        length, *others = dimension.powers
        powers = (length - per_length, *others)
        try:
            number, unit = parts_of(text)
            if dimension.powers == TEMPERATURE.powers:
                _require_scale(self.units.temperature, unit)
            value = float(number * factor(unit, self.units.length, self.units.force, powers))
        except UnknownUnitError as error:
            name = self.units.names(self.per_unit_thickness).of(dimension.words)
            what = dimension.words + (" per length" if per_length else "")
            raise ValueError(
                f"{key}: {error}; accepted here is a {what}, as a number (in {name}) or as one "
                f"number and one unit in quotes, such as '1 {name}'"
            ) from None
        if value and not _SMALLEST < abs(value) < _LARGEST:
            raise ValueError(
                f"{key}: must be a finite number, and 0 or of a size between {_SMALLEST:g} and "
                f"{_LARGEST:g}, in the scene's units"
            )
        return value
