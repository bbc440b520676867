"""Options and help of ``fenics-contact explore``."""

from __future__ import annotations

import argparse

_DESCRIPTION = """\
Opens a page of this machine on which numbers of a scene are moved, and its answer follows:
pressure, friction, stick and slip, gaps and the deformed body. When one lets go, quantities come
with error bars and checks. The link has a token that is new each time; nothing leaves the machine,
and no file is written. Ctrl-C ends it, with exit code 0.

Examples:
  fenics-contact explore scene.toml
  fenics-contact explore scene.toml --vary contact.0.friction_coefficient=0:0.6
  fenics-contact explore scene.toml --host 0.0.0.0 --port 8000 --no-browser   # in a container"""

# Its name, what it does, how it is written, and its help.
COMMAND = (
    "explore",
    "move numbers of a scene on a page, and see its answer follow",
    "SCENE.toml [options]",
    _DESCRIPTION,
)


def describe(command: argparse.ArgumentParser) -> None:
    """Add its arguments, but for the scene.

    Args:
        command: Its parser.
    """
    command.add_argument(
        "--vary",
        metavar="KEY=LOW:HIGH",
        action="append",
        default=[],
        help="move this number between these two; may be given several times (by default numbers "
        "of contacts, loads, preloads and supports)",
    )
    page = command.add_argument_group("page")
    page.add_argument(
        "--host", metavar="ADDRESS", default="127.0.0.1", help="address to listen at (127.0.0.1)"
    )
    page.add_argument("--port", metavar="N", type=_port, default=0, help="port (a free one)")
    page.add_argument("--no-browser", action="store_true", help="print the link, open nothing")


def _port(text: str) -> int:
    value = int(text)
    if not 1 <= value <= 65535:
        raise ValueError
    return value
