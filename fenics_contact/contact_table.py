"""The rows of ``contact.csv``, for pictures."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fenics_contact.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactTable:
    """The rows of ``contact.csv`` as columns.

    Attributes:
        contact: Name of each row's contact.
        status: OPEN, STICK or SLIP.
        numbers: The other columns, by their names in the header.
    """

    contact: NDArray[np.str_]
    status: NDArray[np.str_]
    numbers: dict[str, Array]

    @classmethod
    def read(cls, path: Path) -> ContactTable:
        """Read a ``contact.csv``.

        Raises:
            InputError: There is none, or it cannot be read.
        """
        try:
            with path.open(newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        words = ("contact", "status")
        names = [name for name in (rows[0] if rows else {}) if name not in words]
        return cls(
            contact=np.array([row["contact"] for row in rows]),
            status=np.array([row["status"] for row in rows]),
            numbers={name: np.array([float(row[name]) for row in rows]) for name in names},
        )

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Which points touch the obstacle."""
        return np.asarray(self.status != "OPEN")

    def of(self, contact: str) -> ContactTable:
        """The rows of one contact."""
        return self.rows(self.contact == contact)

    def rows(self, wanted: NDArray[np.bool_] | NDArray[np.int64]) -> ContactTable:
        """Some of the rows, or all of them in another order."""
        numbers = {name: column[wanted] for name, column in self.numbers.items()}
        return ContactTable(self.contact[wanted], self.status[wanted], numbers)

    def vectors(self, *names: str) -> Array:
        """Columns side by side, shape (rows, names)."""
        return np.stack([self.numbers[name] for name in names], axis=1)
