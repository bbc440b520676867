"""Lines of a text file and of those that it includes, which must stand in its folder or below."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from fenics_contact.mesh.geometry.process_room import RefusedError

_MOST = 1000  # files, each time that one is included


class Line(NamedTuple):
    """A line, without its end; what messages call its file, and its number there."""

    text: str
    file: str
    number: int

    def error(self, words: str) -> RefusedError:
        """Return the error of this line."""
        return RefusedError(f"{self.file}, line {self.number}: {words}")


class FileLines:
    """Reads a file and what it includes.

    Args:
        key: Of the file in the scene, for messages: ``mesh.file``.
        name: Of the file in the scene, for messages.
        path: The file.
    """

    def __init__(self, key: str, name: str, path: Path) -> None:
        self._key, self._name, self._path = key, name, path
        self._allowed = path.parent.resolve()
        self._open: list[Path] = []
        self._count = 0

    def error(self, words: str) -> RefusedError:
        """Return the error of the file as a whole."""
        return RefusedError(f"{self._key} = '{self._name}': {words}")

    def lines(self) -> Iterator[Line]:
        """Yield the lines of the file itself."""
        return self._lines(self._path, self._name)

    def included(self, line: Line, name: str) -> Iterator[Line]:
        """Lines of a file that a line names, which its folder holds, or one below.

        Args:
            line: The one that names it.
            name: As it is there: relative to the folder of the scene's file.
        """
        path = self._path.parent / name
        said = f"the included file '{name}'"
        if Path(name).is_absolute() or not path.resolve().is_relative_to(self._allowed):
            raise line.error(f"{said} is outside the folder of the mesh, which it may not read")
        if not os.path.isfile(path):
            raise line.error(f"there is no file '{name}' in the folder of the mesh to include")
        self._count += 1
        if path.resolve() in self._open or self._count > _MOST:
            raise line.error(f"{said} includes itself, or more than {_MOST} files are included")
        return self._lines(path, name)

    def _lines(self, path: Path, name: str) -> Iterator[Line]:
        self._open.append(path.resolve())
        with path.open(encoding="utf-8", errors="replace") as file:
            where = f"{self._key} = '{name}'"
            for number, text in enumerate(file, 1):
                yield Line(text.rstrip("\r\n"), where, number)
        self._open.pop()
