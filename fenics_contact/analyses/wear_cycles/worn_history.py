"""Reading the tables of cycles that wear, and refusing those that a page cannot be made of."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_WORK,
    MAX_CONTACT_PRESSURE,
    MAX_WEAR_DEPTH,
    STICK_AREA,
    WORN_VOLUME,
)
from fenics_contact.results.contact_points import ContactTable

HISTORY, PROFILES = "wear.csv", "wear_profiles.csv"
_COLUMNS = (
    *("cycle", "passed_over", WORN_VOLUME, "worn_volume_error"),
    *(MAX_WEAR_DEPTH, "max_wear_depth_error", "depth_over_width", FRICTION_WORK),
)
_OF_CONTACTS = (MAX_CONTACT_PRESSURE, CONTACT_AREA, STICK_AREA)
_OF_POINTS = (
    *("cycle", "contact", "x", "y", "z", "nx", "ny", "nz", "gap"),
    *("worn_depth", "contact_pressure", "status"),
)
_STATUS = ("OPEN", "STICK", "SLIP")


@dataclass(frozen=True, eq=False)
class WornHistory:
    """The content of both tables.

    Attributes:
        columns: Of ``wear.csv``, by its header, (cycles,) each.
        contacts: Numbers of the contacts, in scene order.
        worn: Of each contact that wears, by its number: the points at the ends of the cycles.
        names: Of the contacts, where the folder is that of a run.
    """

    columns: dict[str, Array]
    contacts: list[int]
    worn: dict[int, list[ContactTable]]
    names: Sequence[str] = ()

    @property
    def cycles(self) -> Integers:
        """Numbers of the cycles that were computed."""
        return self.columns["cycle"].astype(np.int64)

    def of_contact(self, number: int, name: str) -> Array:
        """A quantity of a contact at the ends of the cycles, (cycles,)."""
        return self.columns[self._name(number, name)]

    def sticking(self, number: int) -> Array:
        """Area that never slips in a cycle, (cycles,)."""
        return self.of_contact(number, "stick_area_of_cycle")

    def _name(self, number: int, name: str) -> str:
        return name if len(self.contacts) == 1 else f"contact.{number}.{name}"

    def title(self, contact: int) -> str:
        """Return the title of a contact in pictures; empty for the only one."""
        if len(self.contacts) == 1:
            return ""
        return f"'{self.names[contact]}'" if self.names else f"contact {contact}"

    def is_flat(self, contact: int) -> bool:
        """Whether the points of a contact lie on a line.

        Args:
            contact: Its number, of one that wears.
        """
        numbers = self.worn[contact][0].numbers
        return not np.ptp(numbers["z"]) and not numbers["nz"].any()


def read_worn(folder: Path, names: Sequence[str] = ()) -> WornHistory:
    """Read the files of cycles that wear from their folder.

    Args:
        folder: With ``wear.csv`` and ``wear_profiles.csv``.
        names: Of the contacts in scene order, where they are known.

    Raises:
        InputError: A file is missing or damaged, or they are of different cycles.
    """
    path = folder / HISTORY
    try:
        columns = _history(path)
        path = folder / PROFILES
        contacts, tables = _profiles(path, columns["cycle"])
        path = folder / HISTORY
        _require_contacts(columns, contacts)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except (ValueError, csv.Error) as error:
        raise InputError(f"{path}: damaged: {error}; compute the cycles again") from None
    return WornHistory(columns, contacts, tables, names)


def _require_contacts(columns: dict[str, Array], contacts: list[int]) -> None:
    """Refuse cycles without the quantities of the contacts of their points.

    Raises:
        ValueError: They have not.
    """
    for number in contacts:
        for name in _OF_CONTACTS:
            wanted = name if len(contacts) == 1 else f"contact.{number}.{name}"
            if wanted not in columns:
                raise ValueError(f"its first line has no column {wanted}")


def _rows(path: Path, wanted: tuple[str, ...]) -> tuple[list[str], list[list[str]]]:
    """Head and rows of a table that has some columns.

    Raises:
        ValueError: It has them not, or a row is not whole.
    """
    with path.open(newline="", encoding="utf-8") as file:
        head, *rows = list(csv.reader(file)) or [[]]
    missing = [name for name in wanted if name not in head]
    if missing:
        raise ValueError(f"its first line has no column {missing[0]}")
    if not rows:
        raise ValueError("it has no rows")
    for number, row in enumerate(rows, start=2):
        if len(row) != len(head):
            raise ValueError(f"line {number} is not whole")
    return head, rows


def _history(path: Path) -> dict[str, Array]:
    head, rows = _rows(path, _COLUMNS)
    columns = dict(zip(head, np.array(rows, dtype=np.float64).T, strict=True))
    if not (np.diff(columns["cycle"]) > 0).all():
        raise ValueError("its cycles are not in order")
    return columns


def _profiles(path: Path, cycles: Array) -> tuple[list[int], dict[int, list[ContactTable]]]:
    """Numbers of the contacts; of those that wear, their points at the end of each cycle."""
    head, rows = _rows(path, _OF_POINTS)
    texts = dict(zip(head, np.array(rows, dtype=str).T, strict=True))
    status = texts.pop("status")
    if not np.isin(status, _STATUS).all():
        raise ValueError("a status is none")
    numbers = {name: texts[name].astype(np.float64) for name in _OF_POINTS if name in texts}
    table = ContactTable(numbers["contact"].astype(np.int64).astype(str), status, numbers)
    contacts = sorted({int(number) for number in numbers["contact"]})
    worn = {number: list(_at_cycles(table, number, cycles)) for number in contacts}
    return contacts, {number: every for number, every in worn.items() if every}


def _at_cycles(table: ContactTable, contact: int, cycles: Array) -> Iterator[ContactTable]:
    """The points of a contact at the end of each cycle; none where it does not wear."""
    own = table.of(str(contact))
    if np.isnan(own.numbers["worn_depth"]).all():
        return
    count = 0
    for cycle in cycles:
        rows = own.rows(own.numbers["cycle"] == cycle)
        count = count or len(rows.status)
        if not 0 < len(rows.status) == count:
            raise ValueError(
                f"contact {contact} has {len(rows.status)} points in cycle {cycle:.0f}, "
                f"{count} in the first"
            )
        yield rows
