"""Cycles that wear as tables: ``wear.csv``, a row a cycle, and the profiles at their ends."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.analyses.wear_cycles.wear_cycle import WearCycle
from fenics_contact.common.atomic_files import append, make_folder, replace_file
from fenics_contact.common.parallel import on_root
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_WORK,
    MAX_CONTACT_PRESSURE,
    MAX_WEAR_DEPTH,
    NORMAL_FORCE,
    STICK_AREA,
    WORN_VOLUME,
)

#: A row a cycle that was computed.
HISTORY = "wear.csv"
#: A row a contact point of each of them.
PROFILES = "wear_profiles.csv"
_OF_CONTACTS = (NORMAL_FORCE, MAX_CONTACT_PRESSURE, CONTACT_AREA, STICK_AREA)


class WornFiles:
    """The tables of a folder; a run that is killed leaves whole rows of whole cycles.

    Args:
        comm: Ranks that have the cycles; collective, as all.
        folder: Where to.
        kept: Number of the cycle up to which tables that are there are kept; 0 to replace them.

    Raises:
        MachineError: It cannot be made.
    """

    def __init__(self, comm: MPI.Comm, folder: Path, kept: int = 0) -> None:
        self._comm, self._folder = comm, folder

        def begin() -> bool:
            make_folder(folder)
            return all([_kept(folder / name, kept) for name in (HISTORY, PROFILES)])

        self._is_begun = on_root(comm, begin)

    def add(self, cycle: WearCycle) -> None:
        """Append a cycle.

        Args:
            cycle: The next one that was computed.

        Raises:
            MachineError: It could not be written.
        """
        tables = {PROFILES: list(_profiles(cycle)), HISTORY: [_row(cycle)]}

        def write() -> None:
            for name, rows in tables.items():
                self._write(self._folder / name, rows)

        on_root(self._comm, write)
        self._is_begun = True

    def _write(self, path: Path, rows: list[dict[str, Any]]) -> None:
        text = io.StringIO()
        table = csv.DictWriter(text, list(rows[0]))
        if not self._is_begun:
            table.writeheader()
        table.writerows(rows)
        (append if self._is_begun else replace_file)(path, text.getvalue().encode())


def _kept(path: Path, last: int) -> bool:
    """Keep the rows of a table up to a cycle; whether there are any.

    Args:
        path: Of the table.
        last: Number of the cycle.
    """
    if last == 0 or not path.exists():
        return False
    head, *rows = path.read_text(encoding="utf-8").splitlines(keepends=True) or [""]
    kept = [row for row in rows if row.endswith("\n") and int(row.partition(",")[0]) <= last]
    replace_file(path, "".join([head, *kept]).encode())
    return bool(kept)


def _row(cycle: WearCycle) -> dict[str, Any]:
    return {
        "cycle": cycle.number,
        "passed_over": cycle.passed_over,
        "pressure_change": cycle.pressure_change,
        WORN_VOLUME: cycle.worn_volume,
        "worn_volume_error": cycle.errors[WORN_VOLUME],
        MAX_WEAR_DEPTH: cycle.max_wear_depth,
        "max_wear_depth_error": cycle.errors[MAX_WEAR_DEPTH],
        "depth_over_width": cycle.depth_over_width,
        FRICTION_WORK: cycle.friction_work,
        **_of_contacts(cycle),
    }


def _of_contacts(cycle: WearCycle) -> Mapping[str, Any]:
    """Return the quantities of contacts by name, of several with the contact's number."""
    row: dict[str, Any] = {}
    several = len(cycle.contacts) > 1
    of_all = zip(cycle.contacts, cycle.stick_areas, cycle.losses, strict=True)
    for number, (found, sticks, loss) in enumerate(of_all):
        own = {name: found[name] for name in _OF_CONTACTS}
        own |= {"stick_area_of_cycle": sticks, "friction_loss": loss}
        row |= {f"contact.{number}.{name}" if several else name: own[name] for name in own}
    return row


def _profiles(cycle: WearCycle) -> Iterator[dict[str, Any]]:
    points = cycle.points
    for place, where in enumerate(points.coordinates.tolist()):
        yield {
            "cycle": cycle.number,
            "contact": int(points.contact[place]),
            **dict(zip("xyz", where, strict=True)),
            **dict(zip(("nx", "ny", "nz"), points.normals[place].tolist(), strict=True)),
            "gap": float(points.gap[place]),
            "worn_depth": float(points.own["worn_depth"][place]),
            "contact_pressure": float(points.contact_pressure[place]),
            "status": str(points.status[place]),
        }
