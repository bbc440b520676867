"""The files of a sweep: its journal, ``sweep.csv``, ``sweep.json`` and ``states.npz``.

Every point that is done is kept in the journal at once, so that a killed sweep goes on. A record
is an ``.npz`` that holds a row, as JSON, and the contact points of its answer. Only the process
that leads a sweep writes it.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.atomic_files import naming, replace_file, replaced_file
from fenics_contact.common.errors import InputError, MachineError, StoppedError
from fenics_contact.results.records.record import plain
from fenics_contact.simulation.output.journal_file import JournalFile
from fenics_contact.simulation.sweeps.rows import STATES, Row, columns_of

TABLE, SUMMARY, STATES_FILE, PAGE = "sweep.csv", "sweep.json", "states.npz", "sweep.html"


def clear(folder: Path) -> None:
    """Remove the files of an earlier sweep.

    Raises:
        MachineError: They cannot be removed.
    """
    with naming(folder):
        for name in (TABLE, SUMMARY, STATES_FILE, PAGE):
            (folder / name).unlink(missing_ok=True)


def write_table(
    folder: Path, keys: Sequence[str], points: Sequence[tuple[Sequence[Any], int, Row]]
) -> None:
    """Write the table of a sweep, ``sweep.csv``.

    Args:
        folder: Of the sweep.
        keys: That are varied.
        points: Of each, in the order of the grid: values of the keys, exit code, and numbers of
            the answer, none where there is no answer.

    Raises:
        MachineError: It could not be written.
    """
    names = columns_of(row for _, _, row in points)
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow([*keys, "exit_code", *names])
    for values, code, row in points:
        numbers = (row.get(name) for name in names)
        writer.writerow([*map(_field, values), code, *map(_field, numbers)])
    replace_file(folder / TABLE, text.getvalue().encode())


def _field(value: Any) -> str:
    """A value as spreadsheets and Python read it; nothing where there is none."""
    if value is None or isinstance(value, str):
        return value or ""
    return json.dumps(plain(value), default=str)


def write_summary(folder: Path, content: Mapping[str, Any]) -> None:
    """Write the summary of a sweep, ``sweep.json``.

    Args:
        folder: Of the sweep.
        content: Of the file.

    Raises:
        MachineError: It could not be written.
    """
    text = json.dumps(plain(content), indent=2, ensure_ascii=False, allow_nan=False, default=str)
    replace_file(folder / SUMMARY, f"{text}\n".encode())


def write_states(folder: Path, states: Iterable[tuple[int, Mapping[str, Any]]]) -> None:
    """Write ``states.npz``: the contact points of all answers, one after the other.

    Args:
        folder: Of the sweep.
        states: Row of each answer, and its arrays.

    Raises:
        MachineError: It could not be written.
    """
    found = sorted(((n, arrays) for n, arrays in states if arrays), key=lambda one: one[0])
    points = [np.full(len(arrays["contact"]), number) for number, arrays in found]
    whole = {"point": _joined(points, np.int64)}
    for name, kind in STATES.items():
        whole[name] = _joined([arrays[name] for _, arrays in found], kind)
    with replaced_file(folder / STATES_FILE) as temporary, temporary.open("wb") as file:
        np.savez(file, allow_pickle=False, **whole)


def _joined(parts: Sequence[Any], kind: Any) -> Any:
    return np.concatenate([np.zeros(0, dtype=kind), *parts]).astype(kind)


NAME = "sweep.journal"
_ROW = "row"
# A row with these is solved again when a sweep goes on.
_TRIED_AGAIN = (MachineError.exit_code, StoppedError.exit_code)


@dataclass(frozen=True)
class Done:
    """Outcome of a point.

    Attributes:
        digest: Of the point.
        exit_code: As of a run.
        said: What a run says of it: the verdict, or why there is no answer.
        row: The numbers of an answer, by their names; empty without one.
        units: As of ``result.json``, where the scene has some.
        factorisations: How many were made for it.
        warnings: What was said meanwhile.
    """

    digest: str
    exit_code: int
    said: str
    row: Mapping[str, float | None] = field(default_factory=dict)
    units: Mapping[str, Any] | None = None
    factorisations: int = 0
    warnings: tuple[str, ...] = ()

    def packed(self, states: Mapping[str, Any]) -> bytes:
        """With the contact points of the answer, for the journal.

        Args:
            states: Name → array.
        """
        text = json.dumps(plain(dataclasses.asdict(self)))
        file = io.BytesIO()
        np.savez(file, allow_pickle=False, **{_ROW: np.array(text)}, **states)
        return file.getvalue()

    @classmethod
    def unpacked(cls, content: bytes) -> tuple[Done, dict[str, Any]]:
        """The point, and its contact points."""
        with np.load(io.BytesIO(content), allow_pickle=False) as found:
            states = dict(found)
        return cls(**json.loads(str(states.pop(_ROW)))), states


class Journal:
    """The journal in a sweep's folder, which is made once a point is more than bad input.

    Attributes:
        lock: Held while the sweep goes on.

    Args:
        folder: Of the sweep.
    """

    def __init__(self, folder: Path) -> None:
        self._file = JournalFile(folder / NAME, "sweep")
        self.lock = self._file.lock

    @property
    def is_there(self) -> bool:
        """Whether there is one of this sweep."""
        return self._file.is_there

    def resume(self, known: Mapping[str, int]) -> dict[int, Done]:
        """Return the points that an earlier sweep solved, by number; its file is continued.

        Args:
            known: Digest → number of every point.

        Raises:
            InputError: It is of another sweep or another version, or damaged; or another sweep is
                being solved there.
        """
        found: dict[int, Done] = {}

        def is_kept(content: bytes) -> bool:
            done, _ = Done.unpacked(content)
            if done.digest not in known:
                raise InputError(
                    f"--resume: '{self._file.path}' is of another sweep, or its scene or mesh has "
                    "changed since; leave --resume out, or give another --out"
                )
            if done.exit_code in _TRIED_AGAIN:
                return False
            found[known[done.digest]] = done
            return True

        self._file.resume(is_kept)
        return found

    def add(self, done: Done, content: bytes) -> None:
        """Keep a point that is done.

        Args:
            done: The point.
            content: The same, packed.

        Raises:
            InputError: Another sweep has begun in the folder meanwhile.
            MachineError: The file could not be written; what was there stays.
        """
        self._file.add(content, clear, waits=done.exit_code == InputError.exit_code)

    def states(self) -> Iterator[tuple[Done, dict[str, Any]]]:
        """All points that are done, with the contact points of their answers."""
        return map(Done.unpacked, self._file.contents())
