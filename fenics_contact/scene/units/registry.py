"""Units by pint, which is loaded when a scene has units, and not before.

Of a text only one number and one unit are taken, by a grammar of our own: pint is given nothing
else, and nothing is computed of it.
"""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import cache
from typing import Any

# The usual names that a unit of stress or energy may have.
_USUAL = {
    (-2, 1): ("Pa", "kPa", "MPa", "GPa", "psi", "ksi"),
    (1, 1): ("pJ", "nJ", "µJ", "mJ", "J", "kJ", "MJ"),
}
_SAME = Decimal("1e-12")
_LONGEST = 60
_NUMBER = r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?"
_NAME = "[A-Za-zµμÅ]+(?:_[A-Za-z]+)*"
_WORD = rf"{_NAME}(?:(?:\^|\*\*)?-?[0-9](?:\.[0-9]{{1,3}})?|⁻?[¹²³⁴⁵⁶⁷⁸⁹])?"
_UNIT = rf"{_WORD}(?:(?:\s*[*/·⋅]\s*|\s+){_WORD}){{0,5}}"
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
    fenics_contact.scene.units.registry.UnknownUnitError: must be one number and one unit
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
        powers: Of length and force, and of seconds if any.

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
    units = (length, force, "s")[: len(powers)]
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
        found = registry.parse_units(plain)
        return registry.Quantity(Decimal(1), found)
    except (_pint().errors.PintError, AttributeError, ValueError, TypeError):
        raise UnknownUnitError(f"'{unit}' is no unit that is known") from None


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
