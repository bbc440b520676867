"""Whether the files of a run's fields are whole: VTK's readers say so in many lines, or crash."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from fenics_contact.common.errors import InputError
from fenics_contact.report.drawing.fields import read_body

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_END = b"</VTKFile>"
_NEEDED = ("displacement", "stress", "status", "contact_pressure", "friction_traction")


def whole_body(folder: Path) -> UnstructuredGrid:
    """The body as a pyvista grid with the fields of the last step, once all files are looked at.

    Args:
        folder: Of a run, with ``fields.pvd``.

    Raises:
        InputError: A file is missing or damaged; says which.
    """
    grids = list(_named(folder / "fields.pvd", "DataSet", "file"))
    for grid in grids:
        pieces = list(_named(grid, "Piece", "Source"))
        for piece in pieces:
            _require_end(piece)
    for piece in pieces:  # of the last step; what is missing VTK would make up
        content = piece.read_bytes()
        missing = [name for name in _NEEDED if f'Name="{name}"'.encode() not in content]
        if missing:
            raise _damaged(piece, f"it lacks {', '.join(missing)}")
    try:
        return read_body(folder)
    except (KeyError, ValueError) as error:  # of a file that is damaged inside
        raise _damaged(grids[-1], str(error)) from None


def _named(path: Path, tag: str, attribute: str) -> Iterator[Path]:
    """The files that a file names, which lie beside it."""
    _require_end(path)
    try:
        found = [entry.attrib[attribute] for entry in ElementTree.parse(path).iter(tag)]
    except (ElementTree.ParseError, KeyError) as error:
        raise _damaged(path, str(error)) from None
    if not found:
        raise _damaged(path, "it names no files")
    yield from (path.parent / name for name in found)


def _require_end(path: Path) -> None:
    """A file that was cut off has no end."""
    try:
        with path.open("rb") as file:
            file.seek(max(path.stat().st_size - 2 * len(_END), 0))
            rest = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if _END not in rest:
        raise _damaged(path, "its end is missing")


def _damaged(path: Path, why: str) -> InputError:
    return InputError(f"{path}: damaged: {why}; make the run again")
