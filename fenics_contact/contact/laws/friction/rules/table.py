"""A value that depends on a number by a table, in UFL."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array


def named(places: Sequence[float], values: Sequence[float]) -> dict[str, float]:
    """The table's numbers by the names that ``in_table`` knows.

    Args:
        places: Increasing.
        values: The value at each.
    """
    found = {f"place_{number}": place for number, place in enumerate(places)}
    return found | {f"value_{number}": value for number, value in enumerate(values)}


def names_of(key: str, places: str, ones: Array) -> dict[str, Array]:
    """Slopes at the points in the number of the table under a key; nothing for other keys.

    Args:
        key: Of the contact, such as ``friction_law.shares.1``.
        places: What the scene calls the places.
        ones: 1 at the points.
    """
    table, _, rest = key.partition(".")
    name, _, number = rest.partition(".")
    known = {places: "place", "shares": "value"}
    return {f"{known[name]}_{number}": ones} if table == "friction_law" and name in known else {}


def in_table(where: Expr, numbers: Mapping[str, Expr]) -> Expr:
    """The value at a place: linear between those of the table, constant beyond its ends.

    Args:
        where: The place.
        numbers: Those of the table by name, others among them.
    """
    count = sum(name.startswith("place_") for name in numbers)
    places = [numbers[f"place_{number}"] for number in range(count)]
    values = [numbers[f"value_{number}"] for number in range(count)]
    found = values[0]
    for number in range(count - 1):
        share = (where - places[number]) / (places[number + 1] - places[number])
        between = values[number] + share * (values[number + 1] - values[number])
        found = ufl.conditional(ufl.gt(where, places[number]), between, found)
    return ufl.conditional(ufl.gt(where, places[-1]), values[-1], found)
