"""Options and help of ``fenics-contact sweep``."""

from __future__ import annotations

import argparse
from pathlib import Path

_DESCRIPTION = """\
Solves a scene for all combinations of values of some of its keys, on all cores, and writes a table,
sweep.csv, with a row for each. A row is what `run --set` of the same values gives. A body is
factorised only where something changes that it depends on. What fails is a row, too, with its exit
code. Points that are done are kept at once: --resume goes on after an interrupt or a kill.

Values are numbers or words between commas, or a range START:END:HOW_MANY. Keys are those of --set,
as contact.0.friction_coefficient.

Examples:
  fenics-contact sweep scene.toml --vary contact.0.friction_coefficient=0.1,0.2,0.3
  fenics-contact sweep scene.toml --vary load.0.pressure=0:10:11 --vary contact.0.law=static,none
  fenics-contact sweep scene.toml --vary "load.0.traction=[1, 0],[2, 0]" --jobs 2 --out here
  fenics-contact sweep scene.toml --vary load.0.pressure=0:10:11 --resume"""

# Its name, what it does, how it is written, and its help.
COMMAND = (
    "sweep",
    "solve a scene for all combinations of values of its keys",
    "SCENE.toml --vary KEY=VALUES [options]",
    _DESCRIPTION,
)

EPILOG = """\
Exit codes: 0 if that of every row is; else the first of 5, 130, 3 and 4 that stands for a row,
where a point whose values the scene refuses counts as 3; 2 if nothing could be solved, and nothing
was written. See fenics-contact --help."""


def describe(command: argparse.ArgumentParser) -> None:
    """Add its arguments.

    Args:
        command: Its parser, which has those of the scene already.
    """
    command.add_argument(
        "--vary",
        metavar="KEY=VALUES",
        action="append",
        default=[],
        help="a key and its values; several make all combinations, and the last runs fastest",
    )
    command.add_argument(
        "--out", metavar="DIR", type=Path, help="folder (results/ and the scene's name, _sweep)"
    )
    command.add_argument(
        "--jobs",
        metavar="N",
        type=_number,
        help="processes side by side, each with a body of its own (one a core, if memory has room)",
    )
    command.add_argument(
        "--resume", action="store_true", help="go on with the sweep that is in the folder"
    )


def _number(text: str) -> int:
    value = int(text)
    if value < 1:
        raise ValueError
    return value
