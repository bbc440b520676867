"""Arrays and a header in one file, with a checksum, replaced in one move.

Arrays are written and read one at a time, so that no more than one has to be in memory.
"""

from __future__ import annotations

import hashlib
import json
import os
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.atomic_files import naming, replaced_file
from fenics_contact.common.errors import InputError
from fenics_contact.results.records.record import plain

_UNREADABLE = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)
_HEADER, _CHECKSUM = "header", "checksum"


class NewArrays:
    """A file of arrays that is being written.

    Args:
        path: Where it is to be.
        archive: What is written to meanwhile.
    """

    def __init__(self, path: Path, archive: zipfile.ZipFile) -> None:
        self._path, self._archive = path, archive
        self._digest = hashlib.sha256()

    def add(self, name: str, array: NDArray[Any]) -> None:
        """Write an array.

        Raises:
            MachineError: It could not be written.
        """
        _take(self._digest, name, array)
        self._write(name, array)

    def seal(self, header: dict[str, Any]) -> None:
        """Write what is no array, and the checksum of all."""
        self.add(_HEADER, np.frombuffer(json.dumps(plain(header)).encode(), dtype=np.uint8))
        self._write(_CHECKSUM, np.frombuffer(self._digest.digest(), dtype=np.uint8))

    def _write(self, name: str, array: NDArray[Any]) -> None:
        with (
            naming(self._path),
            self._archive.open(f"{name}.npy", "w", force_zip64=True) as member,
        ):
            np.lib.format.write_array(member, array, allow_pickle=False)


@contextmanager
def replaced_arrays(path: Path) -> Iterator[NewArrays]:
    """A file to write arrays to, which takes its place in one move when it is whole.

    Raises:
        MachineError: It could not be written; what was there stays.
    """
    with replaced_file(path) as temporary, temporary.open("wb") as file:
        with zipfile.ZipFile(file, "w") as archive:
            yield NewArrays(path, archive)
        file.flush()
        os.fsync(file.fileno())


def read_header(path: Path) -> dict[str, Any]:
    """Return the header of a file, once its arrays are found to be as they were written.

    Raises:
        InputError: It is damaged, or no such file at all.
    """
    with _unharmed(path), np.load(path, allow_pickle=False) as file:
        digest = hashlib.sha256()
        for name in file.files:
            if name != _CHECKSUM:
                _take(digest, name, file[name])
        if file[_CHECKSUM].tobytes() != digest.digest():
            raise ValueError(_CHECKSUM)
        header: dict[str, Any] = json.loads(file[_HEADER].tobytes())
    return header


def read_arrays(path: Path, names: list[str]) -> list[NDArray[Any]]:
    """Some arrays of a file.

    Raises:
        InputError: It is damaged, or no such file at all.
    """
    with _unharmed(path), np.load(path, allow_pickle=False) as file:
        return [file[name] for name in names]


def replace_header(path: Path, header: dict[str, Any]) -> None:
    """Change what is no array, in one move.

    Raises:
        InputError: It is damaged, or no such file at all.
        MachineError: It could not be written; what was there stays.
    """
    with _unharmed(path):
        old = np.load(path, allow_pickle=False)
    with old, replaced_arrays(path) as new:
        for name in old.files:
            if name not in (_HEADER, _CHECKSUM):
                new.add(name, old[name])
        new.seal(header)


@contextmanager
def _unharmed(path: Path) -> Iterator[None]:
    """Say of a file that cannot be read that it is damaged."""
    try:
        yield
    except _UNREADABLE:
        raise InputError(
            f"--resume: '{path}' is damaged; without --resume the run begins anew"
        ) from None


def _take(digest: Any, name: str, array: NDArray[Any]) -> None:
    """Let a checksum go on with an array."""
    whole = np.ascontiguousarray(array)
    digest.update(f"{name} {whole.dtype} {whole.shape}".encode())
    digest.update(whole.tobytes())
