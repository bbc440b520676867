"""Folders that one long job at a time writes to, and the journal of its parts.

Every part that is done is kept at once, so that a killed job goes on: records one after the other,
each with its length and checksum. The first says what the others depend on. What a kill has cut
off at the end is noticed by the checksum, and done again.
"""

from __future__ import annotations

import fcntl
import json
import logging
import os
import struct
import weakref
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.atomic_files import append, make_folder, replace_file, replaced_file
from fenics_contact.common.errors import InputError

logger = logging.getLogger(__name__)


class FolderLock:
    """Keeps other runs and sweeps out of a folder; a process that ends, in any way, gives it up.

    The system keeps the lock, on the folder itself: nothing is left behind in it.

    Args:
        folder: That is written to; it need not be there yet.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._give_up: weakref.finalize[[int], FolderLock] | None = None

    def __enter__(self) -> FolderLock:
        return self

    def __exit__(self, *error: object) -> None:
        self.give_up()

    def take(self, make: bool = False) -> None:
        """Keep others out from now on, once the folder is there.

        Args:
            make: Whether to make the folder, if it is not.

        Raises:
            InputError: Another run, sweep or fit is at work there.
        """
        if make:
            make_folder(self._folder)
        if self._give_up is not None or not self._folder.is_dir():
            return
        opened = os.open(self._folder, os.O_RDONLY)
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(opened)
            raise InputError(
                f"'{self._folder}': another run, sweep or fit is at work there; wait until it has "
                "ended, or give another --out"
            ) from None
        except OSError as error:  # of file systems that have no locks
            logger.info("'%s' cannot be locked: %s", self._folder, error.strerror)
        self._give_up = weakref.finalize(self, os.close, opened)

    def give_up(self) -> None:
        """Let others in again."""
        if self._give_up is not None:
            self._give_up()
            self._give_up = None


_FORMAT = 1
_HEAD = struct.Struct("<8sQI")  # a mark, the length and the checksum of what follows
_ELSEWHERE = "leave --resume out, or give another --out"


class JournalFile:
    """A journal in the folder of a job, which is made with its first records; on one rank.

    Attributes:
        path: Of the file.
        is_there: Whether there is one of this job.
        lock: Held while the job goes on.

    Args:
        path: Of the file.
        job: What it is of, in a word: ``sweep`` or ``fit``.
        parts: What every record depends on, in words → its digest.
    """

    def __init__(self, path: Path, job: str, parts: Mapping[str, str] | None = None) -> None:
        self.path, self._job = path, job
        self._mark = f"fc{job}\n".encode()
        self.lock = FolderLock(path.parent)
        self.is_there = False
        self._parts = dict(parts or {})
        self._waiting = [self.record(json.dumps(_made_by() | {"parts": self._parts}).encode())]

    def resume(self, is_kept: Callable[[bytes], bool]) -> None:
        """Go on with the file of an earlier job, if there is one.

        Args:
            is_kept: Called with every record; whether it stays in the file.

        Raises:
            InputError: It is of another job or another version, or damaged; or another job is being
                solved there.
        """
        self.lock.take()
        if not self.path.exists():
            logger.info("there is no '%s' to resume from: beginning at the start", self.path)
            return
        with replaced_file(self.path) as new, new.open("wb") as kept, self._opened() as file:
            records = self._records(file)
            heading = next(records, b"")
            self._require_same(heading)
            kept.write(self.record(heading))
            for content in records:
                if self._understood(is_kept, content):
                    kept.write(self.record(content))
        self._waiting, self.is_there = [], True

    def add(self, content: bytes, clear: Callable[[Path], None], waits: bool = False) -> None:
        """Keep a record.

        Args:
            content: Of it.
            clear: Removes the files of an earlier job from the folder; called before the first.
            waits: Whether it makes no file by itself, but is written with the next that does.

        Raises:
            InputError: Another job has begun in the folder meanwhile.
            MachineError: The file could not be written; what was there stays.
        """
        self._waiting.append(self.record(content))
        if not self.is_there and waits:
            return
        if not self.is_there:
            make_folder(self.path.parent)
            self.lock.take()
            clear(self.path.parent)
            replace_file(self.path, b"")
            self.is_there = True
        append(self.path, b"".join(self._waiting))
        self._waiting = []

    def contents(self) -> Iterator[bytes]:
        """All records but the first, which says what they depend on."""
        with self._opened() as file:
            records = self._records(file)
            next(records)
            yield from records

    def record(self, content: bytes) -> bytes:
        """A record as it stands in the file."""
        return _HEAD.pack(self._mark, len(content), zlib.crc32(content)) + content

    def _opened(self) -> BinaryIO:
        try:
            return self.path.open("rb")
        except OSError as error:
            raise InputError(f"--resume: '{self.path}' cannot be read: {error.strerror}") from None

    def _require_same(self, heading: bytes) -> None:
        """The first record must be of this program, and depend on the same."""
        if not heading:
            raise InputError(f"--resume: '{self.path}' is damaged, or no journal of a {self._job}")
        found = json.loads(heading)
        versions = [name for name, here in _made_by().items() if found.get(name) != here]
        if versions:
            raise InputError(
                f"--resume: '{self.path}' was written with another version of "
                f"{', '.join(versions)}; {_ELSEWHERE}"
            )
        parts = found.get("parts")
        if not isinstance(parts, dict):
            raise InputError(f"--resume: '{self.path}' is damaged, or no journal of a {self._job}")
        names = {**self._parts, **parts}
        others = [name for name in names if parts.get(name) != self._parts.get(name)]
        if others:
            raise InputError(
                f"--resume: '{self.path}' is of another {self._job}: what differs is "
                f"{', '.join(others)}; {_ELSEWHERE}"
            )

    def _understood(self, is_kept: Callable[[bytes], bool], content: bytes) -> bool:
        try:
            return is_kept(content)
        except (ValueError, KeyError, TypeError, zipfile.BadZipFile):
            raise InputError(f"--resume: '{self.path}' is damaged") from None

    def _records(self, file: BinaryIO) -> Iterator[bytes]:
        """All records that are whole, up to the first that is not."""
        while len(head := file.read(_HEAD.size)) == _HEAD.size:
            mark, length, checksum = _HEAD.unpack(head)
            is_ours = mark.rstrip(b"\0") == self._mark
            content = file.read(length) if is_ours else b""
            if not is_ours or len(content) != length or zlib.crc32(content) != checksum:
                return
            yield content


def _made_by() -> dict[str, Any]:
    """Return the versions that numbers depend on besides the scene."""
    return {"format": _FORMAT, **compat.versions()}
