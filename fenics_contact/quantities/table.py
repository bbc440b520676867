"""The table of quantities, and what is asked of it."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.quantities.names import (
    OF_POINTS,
    REACTION,
    REACTION_MOMENT,
    STRAIN_OF_POINTS,
    STRESS_OF_POINTS,
    TEMPERATURE_OF_POINTS,
)
from fenics_contact.quantities.quantity import Edge, Quantity, Together
from fenics_contact.quantities.rows import ROWS

# Of a quantity: a number, or the components of a vector.
QuantityValue = float | Sequence[float]

#: Quantities of supports.
OF_SUPPORTS = (REACTION, REACTION_MOMENT)
#: What quantities of preloads measure.
MEASURED_BY_PRELOADS = {"force": "force", "elongation": "length"}
# The rows of what each point has.
_OF_POINTS = {
    begin: f"{begin}NAME"
    for begin in (OF_POINTS, STRESS_OF_POINTS, STRAIN_OF_POINTS, TEMPERATURE_OF_POINTS)
}
_POINT = _OF_POINTS[OF_POINTS]

_TABLE = {row.name: row for row in ROWS}


def register(quantity: Quantity) -> None:
    """Add a row to the table.

    Args:
        quantity: The row. ``evaluate.contact_quantities.register`` adds its evaluation, too.

    Raises:
        ValueError: There is a quantity of this name.
    """
    if find(quantity.name) is not None:
        raise ValueError(f"there is a quantity '{quantity.name}'")
    _TABLE[quantity.name] = quantity


def unregister(name: str) -> None:
    """Take out a row that was registered."""
    del _TABLE[name]


def every() -> tuple[Quantity, ...]:
    """All rows, in the order in which they are shown."""
    return tuple(_TABLE.values())


def find(name: str) -> Quantity | None:
    """The row of a quantity; None where there is none of this name.

    >>> find("displacement_tip").unit, find("displacement_tip").is_vector
    ('length', True)
    >>> find("stress_tip_xy").unit, find("stress_tip_xy").is_vector
    ('stress', False)
    >>> find("strain_tip_xy").name, find("strain_energy").name
    ('strain_NAME', 'strain_energy')
    """
    if name in _TABLE:  # such as strain_energy, which is none of a point
        return _TABLE[name]
    rows = (row for begin, row in _OF_POINTS.items() if name.startswith(begin))
    return _TABLE.get(next(rows, ""))


def with_true_value() -> tuple[str, ...]:
    """Names of those that have a true value and the same name in every run."""
    return tuple(
        one.name for one in every() if one.has_true_value and one.name not in _OF_POINTS.values()
    )


def made_as(together: Together) -> tuple[Quantity, ...]:
    """Quantities whose value of the whole model is made of the contacts' in one way."""
    return tuple(one for one in every() if one.together is together)


def resultants_of_contacts() -> tuple[str, ...]:
    """Names of those that the whole model has from its only contact, and several have not."""
    return tuple(one.name for one in made_as(Together.OF_THE_ONLY))


def names_for_contacts() -> tuple[str, ...]:
    """Names of those that a scene can ask of a contact by its name."""
    return tuple(one.name for one in every() if one.is_asked_for and one.together is not None)


def names_for_model() -> tuple[str, ...]:
    """Names of those that a scene can ask of the whole model, but displacements of points."""
    return tuple(one.name for one in every() if one.is_asked_for and one.name != _POINT)


def bounded_by(edge: Edge) -> tuple[str, ...]:
    """Names of those that an edge on a contact surface bounds."""
    return tuple(one.name for one in every() if edge in one.edges)


def edges_of(name: str) -> tuple[Edge, ...]:
    """The edges that an area or a radius ends at, which jumps from cell to cell with them.

    >>> edges_of("slip_area"), edges_of("normal_force")
    ((<Edge.CONTACT: 0>, <Edge.STICK: 1>), ())
    """
    row = find(name)
    return () if row is None else row.edges


def has_true_value(name: str) -> bool:
    """Whether a quantity has a true value to be apart from: then an error bar, or a ``?``."""
    row = find(name)
    return row is not None and row.has_true_value


def is_vector(name: str, dimension: int = 3) -> bool:
    """Whether a quantity has several components.

    Args:
        name: Of the quantity.
        dimension: Number of axes of the model.

    >>> is_vector("reaction", 2), is_vector("reaction_moment", 2), is_vector("reaction_moment", 3)
    (True, False, True)
    """
    row = find(name)
    return row is not None and row.is_vector and not (row.is_moment and dimension == 2)


def measured_by(name: str) -> str:
    """Kind of unit of a quantity, such as ``stress``; empty for a pure number or unknown name."""
    row = find(name)
    return "" if row is None else row.unit
