"""The rows of ``contact.csv``, for pictures."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers, Words
from fenics_contact.common.errors import InputError
from fenics_contact.common.plain_text import one_line
from fenics_contact.results.point_arrays import WRITTEN

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
