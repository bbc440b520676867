"""Options and help of ``fenics-contact look``."""

from __future__ import annotations

import argparse
from pathlib import Path

_DESCRIPTION = """\
Shows a CAD file, a geometry or a mesh as a page, look.html, that needs no network: bodies and
surfaces by number, what they are and where. It finds surfaces of different bodies that face each
other, and writes scene.toml beside the page with a contact for each pair, an example material and
an example support, which `check` accepts as it is.

Examples:
  fenics-contact look joint.step
  fenics-contact look joint.step --out joint --tolerance 0.2"""

# Its name, what it does, how it is written, and its help.
COMMAND = (
    "look",
    "show a CAD or mesh file, and write a scene for it",
    "FILE [options]",
    _DESCRIPTION,
)


def describe(command: argparse.ArgumentParser) -> None:
    """Add its arguments.

    Args:
        command: Its parser.
    """
    command.add_argument("file", metavar="FILE", type=Path, help="CAD file, geometry or mesh")
    command.add_argument(
        "--out", metavar="DIR", type=Path, help="folder (results/ and the file's name, _look)"
    )
    command.add_argument(
        "--tolerance",
        metavar="LENGTH",
        type=_length,
        help="largest gap between surfaces of a pair (1/1000 of the diagonal of all)",
    )


def _length(text: str) -> float:
    value = float(text)
    if not 0 <= value < float("inf"):
        raise ValueError
    return value
