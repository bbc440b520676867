"""Gmsh geometry scripts that a scene may use: those that only describe a geometry.

A ``.geo`` file is a program. It can start others, write files and read any, so the
commands for that are refused before Gmsh sees the file. They are refused wherever the
word stands, even in a comment or a text: what Gmsh skips depends on its conditionals,
and a refusal that a trick gets round is none.
"""

from __future__ import annotations

import re
from pathlib import Path

from fenics_contact.errors import InputError

_COMMANDS = (
    "System",
    "SystemCall",
    "NonBlockingSystemCall",
    "OnelabRun",
    "OnelabAction",
    "Plugin",
    "Save",
    "Print",
    "CreateDir",
    "CreateDirectory",
    "Open",
    "MergeWithBoundingBox",
    "ListFromFile",
    "S2N",  # these two make a command of a text
    "StringToName",
    "Exit",
    "Abort",
)
# A digit may stand before a command: Gmsh then sees a number and the command. A point
# after it makes it a table of options, such as Print.Background.
_COMMAND = re.compile(rf"(?<![A-Za-z_])(?:{'|'.join(_COMMANDS)})(?![A-Za-z0-9_]|\s*\.)")
_PRINTF_TO_FILE = re.compile(r'Printf(?:"[^"]*"|[^";])*>')
_COMMENT = re.compile(r'("[^"]*")|//[^\n]*|/\*.*?\*/', re.DOTALL)
_READS = re.compile(r"(?<![A-Za-z_])(Include|Merge|MergeFile|ShapeFromFile)(?![A-Za-z0-9_])")
_LITERAL = re.compile(r'\s*\(?\s*"([^"\n]*)"\s*\)?\s*[;\n]')
_READABLE = (".geo", ".msh", ".step", ".stp", ".brep")


def require_harmless(path: Path, key: str) -> None:
    """Refuse a file whose scripts do more than describe a geometry.

    Files that a script includes or merges are examined likewise, and must be in its
    folder or below. With any file Gmsh also reads a script of options beside it.

    Args:
        path: The file.
        key: The scene's key that names it, such as ``mesh.file``.

    Raises:
        InputError: Naming the file, the line and the command.
    """
    folder = path.parent.resolve()
    seen: set[Path] = set()
    waiting = [path]
    while waiting:
        file = waiting.pop()
        if file.resolve() in seen:
            continue
        seen.add(file.resolve())
        options = file.with_name(f"{file.name}.opt")
        if options.is_file():
            waiting.append(options)
        if file.suffix == ".msh":
            require_mesh(file, key)
        elif file.suffix in (".geo", ".opt"):
            text = _read(file, key)
            _refuse_commands(file, text, key)
            waiting += _files_read(file, text, folder, key)


def require_mesh(path: Path, key: str) -> int:
    """Refuse a ``.msh`` that does not start as one: Gmsh would run it as a script.

    Args:
        path: The file.
        key: The scene's key that names it.

    Returns:
        The format's major version.
    """
    try:
        with path.open("rb") as file:
            start = file.read(4096)
    except OSError as error:
        raise InputError(f"{key}: {path}: cannot be read: {error.strerror}") from None
    found = re.match(rb"\s*\$MeshFormat\s+(\d+)\.?\d*\s+[01]\s+\d+", start)
    if found is None or int(found[1]) not in (2, 4):
        raise InputError(
            f"{key} = '{path}': does not start as a Gmsh mesh of version 2 or 4 does ($MeshFormat)"
        )
    return int(found[1])


def _read(script: Path, key: str) -> str:
    try:
        return script.read_bytes().decode("latin-1")  # as Gmsh: commands are ASCII
    except OSError as error:
        raise InputError(f"{key}: {script}: cannot be read: {error.strerror}") from None


def _refuse_commands(script: Path, text: str, key: str) -> None:
    found = _COMMAND.search(text)
    if found is not None:
        raise InputError(
            f"{key}: {_line(script, text, found)}: the word '{found[0]}' is not allowed, not "
            "even in a comment; a scene's geometry may not run programs nor write files"
        )
    for version in (text, _COMMENT.sub(lambda match: match[1] or " ", text)):
        found = _PRINTF_TO_FILE.search(version)
        if found is not None:
            raise InputError(
                f"{key}: {script}: Printf(…) > is not allowed; "
                "a scene's geometry may not write files"
            )


def _files_read(script: Path, text: str, folder: Path, key: str) -> list[Path]:
    """Files that a script reads; each must be named outright, and be in the folder."""
    files = []
    for found in _READS.finditer(text):
        literal = _LITERAL.match(text, found.end())
        where = _line(script, text, found)
        if literal is None:
            raise InputError(
                f'{key}: {where}: {found[0]} must be followed by a file name, {found[0]} "…";, '
                "not an expression, and may not stand in a comment"
            )
        # Gmsh takes a name from the file that reads it, and from the working folder.
        file = script.parent / literal[1]
        if Path(literal[1]).is_absolute() or not file.resolve().is_relative_to(folder):
            raise InputError(
                f'{key}: {where}: {found[0]} "{literal[1]}" is outside the folder of the '
                "geometry, which it may not read"
            )
        if file.suffix not in _READABLE:
            raise InputError(
                f'{key}: {where}: {found[0]} "{literal[1]}" must end in {", ".join(_READABLE)}'
            )
        files.append(file)
    return files


def _line(script: Path, text: str, found: re.Match[str]) -> str:
    return f"{script}, line {text.count(chr(10), 0, found.start()) + 1}"
