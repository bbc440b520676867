"""Files that readers open, text and HDF5, and others that these name."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

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


def require_whole(where: str, path: Path) -> None:
    """Refuse a file that cannot be read, or that refers to another one.

    Args:
        where: What begins a message.
        path: The file.
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            outside = _outside(h5py, file)
            file.visititems(lambda name, found: outside.extend(_outside(h5py, found)))
    except (OSError, RuntimeError, ValueError) as error:
        said = " ".join(str(error).split())
        raise RefusedError(f"{where}: is no sound HDF5 file ({said})") from None
    if outside:
        raise RefusedError(
            f"{where}: '{outside[0]}' in it refers to another file, which a mesh may not; write "
            "all into one file"
        )


def _outside(h5py: Any, found: Any) -> list[str]:
    """Return the parts of a group or a data set that are kept in another file."""
    if isinstance(found, h5py.Dataset):
        return [found.name] if found.external or found.is_virtual else []
    links = {name: found.get(name, getlink=True) for name in found}
    own = (h5py.HardLink, h5py.SoftLink)
    return [f"{found.name}/{name}" for name, link in links.items() if not isinstance(link, own)]
