"""The arrays at contact points: one list, from which they are kept, gathered, written and drawn.

Those of every contact are here; what a law keeps of its own, it declares (``ContactLaw.state``).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from fenics_contact.common.plain_text import one_line
from fenics_contact.quantities.names import PENALTY_ENERGY


@dataclass(frozen=True)
class PointArray:
    """A named array at the contact points.

    Attributes:
        name: Of the attribute that it is, where points are; of the field in ``fields.pvd``.
        unit: Such as ``length``.
        is_vector: Whether it is (points, components), not (points,).
        column: Its name in ``contact.csv``; by default the same.
        is_written: Whether results have it.
    """

    name: str
    unit: str
    is_vector: bool = False
    column: str = ""
    is_written: bool = True

    @property
    def columns(self) -> tuple[str, ...]:
        """Columns of ``contact.csv``: one, three of a vector, none if it is not written."""
        if not self.is_written:
            return ()
        column = self.column or self.name
        return tuple(f"{column}_{axis}" for axis in "xyz") if self.is_vector else (column,)

    @property
    def words(self) -> str:
        """Name in pictures."""
        return self.name.replace("_", " ")


# Numbers of ``ContactState``, beside the status.
AT_POINTS = (
    PointArray("gap", "length"),
    PointArray("contact_pressure", "stress"),
    PointArray("friction_traction", "stress", is_vector=True, column="traction"),
    PointArray("slip", "length", is_vector=True),
    PointArray(PENALTY_ENERGY, "energy/area", is_written=False),
)
WRITTEN = tuple(array for array in AT_POINTS if array.is_written)
# Other names of columns, of fields and of what is saved with a load step.
_TAKEN = {
    *("contact", "x", "y", "z", "nx", "ny", "nz", "status", "traction"),
    *("displacement", "stress", "reaction_pressure", "obstacle_gap"),
}
# Of the fields' cells: the number of the connected part that a cell is of.
BODY_OF_CELLS = "body"


def facet_flags(contact: str) -> str:
    """Name of the cells' array that says which of their facets are of a contact.

    Its values are sums of 2^i over the facets i, as the reference cell numbers them, that carry
    the contact's points.

    Args:
        contact: The contact's name, any text.
    """
    return f"facets of {one_line(contact)}"


def of_one_contact(*declared: Iterable[PointArray]) -> tuple[PointArray, ...]:
    """The arrays that the laws of a contact declare and results have.

    Args:
        declared: Of each law.

    Raises:
        ValueError: A name is another array's already.
    """
    arrays = [array for state in declared for array in state]
    taken = {*_TAKEN, *(array.name for array in AT_POINTS)}
    for array in arrays:
        names = {array.name, array.column or array.name}
        if names & taken:
            raise ValueError(f"a law declares the array '{array.name}', a name that is taken")
        taken |= names
    return tuple(array for array in arrays if array.is_written)


def of_several_contacts(arrays: Iterable[PointArray]) -> tuple[PointArray, ...]:
    """Each array once that laws of several contacts declare.

    Args:
        arrays: Of all contacts.

    Raises:
        ValueError: Two of the same name are not the same.
    """
    found: dict[str, PointArray] = {}
    for array in arrays:
        if found.setdefault(array.name, array) != array:
            raise ValueError(f"two laws declare the array '{array.name}' differently")
    return tuple(found.values())
