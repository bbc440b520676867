"""The journal of a sweep: every point that is done, kept at once, so that a killed sweep goes on.

A record is an ``.npz`` that holds a row, as JSON, and the contact points of its answer. Only the
process that leads a sweep writes it.
"""

from __future__ import annotations

import dataclasses
import io
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.errors import InputError, MachineError, StoppedError
from fenics_contact.results.records.record import plain
from fenics_contact.simulation.output.journal_file import JournalFile
from fenics_contact.simulation.sweeps.tables import clear

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
