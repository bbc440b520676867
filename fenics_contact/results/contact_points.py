"""Results at the contact points: their arrays, one list for all uses, and `contact.csv`.

The arrays at contact points: one list, from which they are kept, gathered, written and drawn.
Those of every contact are here; what a law keeps of its own, it declares (``ContactLaw.state``).
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers, Words
from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import one_line
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
# Of contacts in finite strains: where points are at the end; pictures do not draw it along a line.
CURRENT_PLACE = PointArray("current", "length", is_vector=True)
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


@dataclass(frozen=True, eq=False)
class ContactPoints:
    """All contact points, sorted by contact and coordinates; arrays of one row a point.

    Attributes:
        contact: Number of the contact, in scene order.
        coordinates: Undeformed, shape (points, 3) (length).
        normals: Outward unit normals of the body, (points, 3).
        gap: Normal distance to the obstacle, > 0 open (length).
        contact_pressure: Of the law at the point, ≥ 0; on quadratic triangles single ones may be
            larger than what the facets carry, which ``max_contact_pressure`` is of (stress).
        friction_traction: Tangential traction on the body, (points, 3) (stress).
        slip: Tangential displacement relative to the obstacle, (points, 3) (length).
        status: OPEN, STICK or SLIP.
        weights: Area that each point stands for.
        own: What the laws of contacts keep of their own, by name, (points,) or (points, 3); not a
            number at the points of contacts whose laws do not.
    """

    contact: Integers
    coordinates: Array
    normals: Array
    gap: Array
    contact_pressure: Array
    friction_traction: Array
    slip: Array
    status: Words
    weights: Array
    own: Mapping[str, Array] = field(default_factory=dict)

    def of(self, contact: int) -> Flags:
        """Return for each row whether it belongs to a contact.

        Args:
            contact: Its number, in scene order.

        Returns:
            A mask, (points,).
        """
        return np.asarray(self.contact == contact)


# Of every run; what laws keep of their own stands behind.
CSV_HEADER = [
    *("contact", "x", "y", "z", "nx", "ny", "nz"),
    *(column for array in WRITTEN for column in array.columns),
    "status",
]
_STATUS = ("OPEN", "STICK", "SLIP")
_TEXTS = ("contact", "status")
_STATUS_AT = CSV_HEADER.index("status")


@dataclass(frozen=True)
class ContactTable:
    """The rows of ``contact.csv`` as columns.

    Attributes:
        contact: Name of each row's contact, in one line and printable.
        status: OPEN, STICK or SLIP.
        numbers: The other columns, by their names in the header.
    """

    contact: Words
    status: Words
    numbers: dict[str, Array]

    @classmethod
    def read(cls, path: Path) -> ContactTable:
        """Read a ``contact.csv``.

        Raises:
            InputError: There is none, or it is damaged; says where.
        """
        try:
            with path.open(newline="", encoding="utf-8") as file:
                head, *rows = list(csv.reader(file)) or [[]]
            _require_whole(head, rows)
            places = [place for place, name in enumerate(head) if name not in _TEXTS]
            numbers = np.array([[float(row[place]) for place in places] for row in rows])
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        except (ValueError, csv.Error) as error:
            raise InputError(f"{path}: damaged: {error}; make the run again") from None
        columns = numbers.reshape(len(rows), len(places)).T
        return cls(
            contact=np.array([one_line(row[0]) for row in rows], dtype=str),
            status=np.array([row[_STATUS_AT] for row in rows], dtype=str),
            numbers=dict(zip((head[place] for place in places), columns, strict=True)),
        )

    @property
    def closed(self) -> Flags:
        """Flags of the points that touch, (points,)."""
        return np.asarray(self.status != "OPEN")

    def of(self, contact: str) -> ContactTable:
        """The rows of one contact."""
        return self.rows(self.contact == one_line(contact))

    def rows(self, wanted: Flags | Integers) -> ContactTable:
        """Some of the rows, or all of them in another order."""
        numbers = {name: column[wanted] for name, column in self.numbers.items()}
        return ContactTable(self.contact[wanted], self.status[wanted], numbers)

    def vectors(self, *names: str) -> Array:
        """Columns side by side, shape (rows, names)."""
        return np.stack([self.numbers[name] for name in names], axis=1)


def _require_whole(head: list[str], rows: list[list[str]]) -> None:
    """Refuse a table whose columns are not those that runs write, or whose rows lack some.

    Raises:
        ValueError: They are not.
    """
    if head[: len(CSV_HEADER)] != CSV_HEADER:
        raise ValueError("its first line does not name the columns")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(head) or row[_STATUS_AT] not in _STATUS:
            raise ValueError(f"line {number} is not whole")
