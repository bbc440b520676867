"""The table ``fretting.csv`` of a run."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError


@dataclass(frozen=True)
class FrettingTable:
    """Criteria at the nodes near contacts.

    Attributes:
        contact: Name of the contact on whose surface each lies; empty elsewhere.
        points: Undeformed, (places, 3) (length).
        values: Column → values, those that are missing not a number.
    """

    contact: list[str]
    points: Array
    values: dict[str, Array]

    @classmethod
    def read(cls, path: Path) -> FrettingTable | None:
        """Return the places of a run; None where it looked for no fretting.

        Args:
            path: The file.

        Raises:
            InputError: The file is damaged.
        """
        if not path.exists():
            return None
        try:
            with path.open(encoding="utf-8", newline="") as file:
                rows = list(csv.DictReader(file))
            names = list(rows[0]) if rows else []
            columns = {
                name: np.array([float(row[name] or "nan") for row in rows])
                for name in names
                if name not in ("body", "contact")
            }
            points = np.zeros((0, 3))
            if rows:
                points = np.stack([columns.pop(axis) for axis in "xyz"], axis=1)
            return cls([row["contact"] for row in rows], points, columns)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path}: damaged: {error}; make the run again") from None

    def on(self, contact: str) -> Flags:
        """Return whether each place lies on the surface of a contact, (places,)."""
        return np.array([name == contact for name in self.contact], dtype=bool)
