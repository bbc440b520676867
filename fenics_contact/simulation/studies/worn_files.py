"""Cycles that wear as tables: ``wear.csv``, a row a cycle, and the profiles at their ends."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.common.atomic_files import append, make_folder, replace_file
from fenics_contact.common.parallel import on_root
from fenics_contact.simulation.studies.worn_cycle import WornCycle

#: A row a cycle that was computed.
HISTORY = "wear.csv"
#: A row a contact point of each of them.
PROFILES = "wear_profiles.csv"
_OF_CONTACTS = ("normal_force", "max_contact_pressure", "contact_area", "stick_area")


class WornFiles:
    """The tables of a folder; a run that is killed leaves whole rows of whole cycles.

    Args:
        comm: Ranks that have the cycles; collective, as all.
        folder: Where to; tables that are there are replaced.

    Raises:
        MachineError: It cannot be made.
    """

    def __init__(self, comm: MPI.Comm, folder: Path) -> None:
        self._comm, self._folder, self._is_begun = comm, folder, False
        on_root(comm, lambda: make_folder(folder))

    def add(self, cycle: WornCycle) -> None:
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


def _row(cycle: WornCycle) -> dict[str, Any]:
    return {
        "cycle": cycle.number,
        "passed_over": cycle.passed_over,
        "pressure_change": cycle.pressure_change,
        "worn_volume": cycle.worn_volume,
        "worn_volume_error": cycle.errors["worn_volume"],
        "max_wear_depth": cycle.max_wear_depth,
        "max_wear_depth_error": cycle.errors["max_wear_depth"],
        "depth_over_width": cycle.depth_over_width,
        "friction_work": cycle.friction_work,
        **_of_contacts(cycle.contacts),
    }


def _of_contacts(contacts: list[dict[str, Any]]) -> Mapping[str, Any]:
    """Of the only contact by their names, of several by the contact's number as well."""
    several = len(contacts) > 1
    return {
        f"contact.{number}.{name}" if several else name: found[name]
        for number, found in enumerate(contacts)
        for name in _OF_CONTACTS
    }


def _profiles(cycle: WornCycle) -> Iterator[dict[str, Any]]:
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
