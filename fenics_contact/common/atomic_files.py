"""Files that are whole or not there: written beside their place, then moved to it.

A full disk, a folder that is gone or that may not be written to: one sentence that names the file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from fenics_contact.common.errors import MachineError


def replace_file(path: Path, content: bytes | memoryview, durable: bool = False) -> None:
    """Write a file in one move, so that it is whole at any moment; what was there stays if not.

    Args:
        path: Of the file; its folder is there.
        content: All of it.
        durable: Whether it is to outlive a power cut, which takes its time.

    Raises:
        MachineError: It could not be written.
    """
    with replaced_file(path) as temporary, temporary.open("wb") as file:
        file.write(content)
        if durable:
            file.flush()
            os.fsync(file.fileno())


@contextmanager
def replaced_file(path: Path) -> Iterator[Path]:
    """A path to write to; what is there in the end is moved to its place.

    Args:
        path: Of the file; its folder is there.

    Raises:
        MachineError: It could not be written, or moved.
    """
    # The kind of a file may follow from how its name ends.
    temporary = path.with_name(f".{path.name}")
    try:
        with naming(path):
            yield temporary
            temporary.replace(path)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise


def append(path: Path, content: bytes) -> None:
    """Add to a file that is there, all or nothing.

    Raises:
        MachineError: It could not be written.
    """
    with naming(path), path.open("r+b", buffering=0) as file:
        before = file.seek(0, os.SEEK_END)
        try:
            while content:  # a disk that has room for a part takes it, and then says why
                content = content[file.write(content) :]
        except OSError:
            file.truncate(before)
            raise


def make_folder(path: Path) -> None:
    """Make a folder and those above it, where there is none.

    Raises:
        MachineError: It could not be made.
    """
    with naming(path):
        path.mkdir(parents=True, exist_ok=True)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Say of which file an error of the system is.

    Raises:
        MachineError: In place of it.
    """
    try:
        yield
    except OSError as error:
        why = error.strerror or str(error)
        if not path.parent.exists():
            why += "; its folder is gone"
        raise MachineError(f"'{path}' cannot be written: {why}") from None
