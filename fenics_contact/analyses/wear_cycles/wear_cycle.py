"""The results of cycles of loads that wear, and their tables: ``wear.csv`` and profiles."""

from __future__ import annotations

import csv
import dataclasses
import io
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from fenics_contact.common.atomic_files import append, make_folder, replace_file
from fenics_contact.common.errors import InputError
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
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.scene.loading.load_paths import require_back
from fenics_contact.scene.scene import Scene

# Of a cycle: so much before its begin stands the step after which what was worn is in the gap.
SETTLING = 1e-6


@dataclass(frozen=True, eq=False)
class WearCycle:
    """A cycle that was computed.

    Attributes:
        number: Of the cycle, from 1.
        passed_over: How many cycles before it were not computed, since the last one that was.
        pressure_change: Largest change of a pressure since then, over the largest pressure.
        errors: Estimated error of all jumps so far: ``worn_volume`` (volume) and
            ``max_wear_depth`` (length), absolute.
        losses: What friction dissipates in it at each contact (energy).
        friction_work: To the end of the cycle (energy).
        stick_areas: Of each contact what touched in the cycle and never slipped (area).
        depth_over_width: Deepest wear over half the width that is worn, about a slope; beyond .1
            the linear theory of gaps ends.
        contacts: Quantities of each contact at its end, in scene order.
        points: The contact points then.
    """

    number: int
    passed_over: int
    pressure_change: float
    errors: dict[str, float]
    losses: list[float]
    friction_work: float
    stick_areas: list[float]
    depth_over_width: float
    contacts: list[dict[str, Any]]
    points: ContactPoints

    @property
    def worn_volume(self) -> float:
        """Worn volume of all contacts (volume)."""
        return float(sum(found.get(WORN_VOLUME, 0.0) for found in self.contacts))

    @property
    def max_wear_depth(self) -> float:
        """The deepest (length)."""
        return float(max(found.get(MAX_WEAR_DEPTH, 0.0) for found in self.contacts))


def one_cycle(scene: Scene, begin: float | None, cycles: int | None) -> tuple[Scene, float, int]:
    """A scene whose load steps end with the first of its cycles; their begin, and how many.

    Cycles begin at the end of a load step, and something wears.

    Args:
        scene: Any.
        begin: In place of that of its ``cycles``.
        cycles: In place of their number.

    Raises:
        InputError: They are not given, and the scene has none; or a load is at the end of the
            cycle not as at its begin.
    """
    said = scene.cycles
    if said is not None:
        first = dataclasses.replace(said, number=1, jumps=None, until="end")
        once = dataclasses.replace(scene, cycles=first)
        scene = dataclasses.replace(scene, cycles=None, steps=once.load_steps)
        begin = said.begin if begin is None else begin
        cycles = said.number if cycles is None else cycles
    if begin is None or cycles is None:
        raise InputError("begin and cycles are missing, and the scene has no [cycles]")
    if cycles < 1:
        raise InputError(f"cycles = {cycles}: must be >= 1")
    _require_cycle(scene, begin)
    return scene, begin, cycles


def _require_cycle(scene: Scene, begin: float) -> None:
    """Refuse load steps that do not end with a cycle at whose end loads are as at its begin.

    Raises:
        InputError: They do not, or nothing wears.
    """
    times = np.array(scene.steps.all_times)
    close = SETTLING * (times[-1] - begin)
    if scene.steps.automatic or not (np.abs(times - begin) <= close).any() or begin >= times[-1]:
        raise InputError(
            f"begin = {begin:g}: a cycle begins at the end of a load step and has others to "
            "its own end, the last of all, none of them automatic"
        )
    if not any(contact.wear for contact in scene.contact):
        raise InputError("contact.wear is missing: nothing changes from cycle to cycle")
    try:
        require_back(scene, begin, scene.steps.last)
    except ValueError as error:
        raise InputError(str(error)) from None


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
    """Keep the rows of a table up to a cycle; whether there are any."""
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
