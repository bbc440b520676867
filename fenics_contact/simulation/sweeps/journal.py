"""The journal of a sweep: every point that is done, kept at once, so that a killed sweep goes on.

Records one after the other: length and checksum, then an ``.npz`` that holds a row, as JSON, and
the contact points of its answer. Only the process that leads a sweep writes it; what a kill has cut
off at its end is noticed by the checksum, and solved again.
"""

from __future__ import annotations

import dataclasses
import io
import json
import logging
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.atomic_files import append, make_folder, replace_file, replaced_file
from fenics_contact.common.errors import InputError, MachineError, StoppedError
from fenics_contact.results.records.record import plain
from fenics_contact.simulation.output.folder_lock import FolderLock
from fenics_contact.simulation.sweeps.tables import clear

logger = logging.getLogger(__name__)

NAME = "sweep.journal"
_FORMAT = 1
_HEAD = struct.Struct("<8sQI")  # a mark, the length and the checksum of what follows
_MARK = b"fcsweep\n"
_ROW = "row"
# A row with these is solved again when a sweep goes on.
_TRIED_AGAIN = (MachineError.exit_code, StoppedError.exit_code)


@dataclass(frozen=True)
class Done:
    """What became of a point.

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
        path: Of the file.
        is_there: Whether there is one of this sweep.
        lock: Held while the sweep goes on.

    Args:
        folder: Of the sweep.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / NAME
        self.lock = FolderLock(folder)
        self._waiting: list[bytes] = [_record(json.dumps(_made_by()).encode())]
        self.is_there = False

    def resume(self, known: Mapping[str, int]) -> dict[int, Done]:
        """What an earlier sweep has done, by number; the file is kept, and goes on.

        Args:
            known: Digest → number of every point.

        Raises:
            InputError: It is of another sweep or another version, or damaged; or another sweep is
                being solved there.
        """
        self.lock.take()
        if not self.path.exists():
            logger.info("there is no '%s' to resume from: beginning at the start", self.path)
            return {}
        found = {}
        with replaced_file(self.path) as new, new.open("wb") as kept, self._opened() as file:
            records = _records(file)
            kept.write(_record(self._made_by_same(next(records, b""))))
            for content in records:
                done, _ = self._unpacked(content)
                if done.digest not in known:
                    raise InputError(
                        f"--resume: '{self.path}' is of another sweep, or its scene or mesh has "
                        "changed since; leave --resume out, or give another --out"
                    )
                if done.exit_code not in _TRIED_AGAIN:
                    kept.write(_record(content))
                    found[known[done.digest]] = done
        self._waiting, self.is_there = [], True
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
        self._waiting.append(_record(content))
        if not self.is_there and done.exit_code == InputError.exit_code:
            return
        if not self.is_there:
            make_folder(self.path.parent)
            self.lock.take()
            clear(self.path.parent)
            replace_file(self.path, b"")
            self.is_there = True
        append(self.path, b"".join(self._waiting))
        self._waiting = []

    def states(self) -> Iterator[tuple[Done, dict[str, Any]]]:
        """All points that are done, with the contact points of their answers."""
        with self._opened() as file:
            records = _records(file)
            next(records)
            for content in records:
                yield Done.unpacked(content)

    def _opened(self) -> BinaryIO:
        try:
            return self.path.open("rb")
        except OSError as error:
            raise InputError(f"--resume: '{self.path}' cannot be read: {error.strerror}") from None

    def _made_by_same(self, record: bytes) -> bytes:
        """The first record, if this program wrote it."""
        if not record:
            raise InputError(f"--resume: '{self.path}' is damaged, or no journal of a sweep")
        made_by, here = json.loads(record), _made_by()
        others = [name for name in here if made_by.get(name) != here[name]]
        if others:
            raise InputError(
                f"--resume: '{self.path}' was written with another version of "
                f"{', '.join(others)}; leave --resume out, or give another --out"
            )
        return record

    def _unpacked(self, content: bytes) -> tuple[Done, dict[str, Any]]:
        try:
            return Done.unpacked(content)
        except (ValueError, KeyError, TypeError, zipfile.BadZipFile):
            raise InputError(f"--resume: '{self.path}' is damaged") from None


def _made_by() -> dict[str, Any]:
    """What numbers depend on besides the scene."""
    return {"format": _FORMAT, **compat.versions()}


def _record(content: bytes) -> bytes:
    return _HEAD.pack(_MARK, len(content), zlib.crc32(content)) + content


def _records(file: BinaryIO) -> Iterator[bytes]:
    """All records that are whole, up to the first that is not."""
    while len(head := file.read(_HEAD.size)) == _HEAD.size:
        mark, length, checksum = _HEAD.unpack(head)
        content = file.read(length) if mark == _MARK else b""
        if mark != _MARK or len(content) != length or zlib.crc32(content) != checksum:
            return
        yield content
