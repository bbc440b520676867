"""The command ``fenics-contact``, and the same for scripts that build their own scene.

FEniCSx is loaded once it is known that there is something to do: help is to come at once.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from importlib.machinery import PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

from fenics_contact.cli.options import PROGRAM, TEXTS, is_first_rank, parsers, script_parser
from fenics_contact.common.program import VERSION
from fenics_contact.common.wording import did_you_mean

if TYPE_CHECKING:
    from fenics_contact.scene.scene import Scene

_ASSIGNED = re.compile(r"""^__version__ = ["']([^"']+)["']""", re.MULTILINE)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command ``fenics-contact``; collective.

    Args:
        arguments: What follows the command's name; by default that of the process.

    Returns:
        The exit code: 0 converged and every check passed, 2 bad input or no equilibrium, 3 not
        converged, 4 a check failed, 5 the machine failed, 130 interrupted.

    Raises:
        SystemExit: Help was asked for (0), or an option is wrong (2).

    >>> main(["new", "--list", "--quiet"])
    0
    """
    options = parse(sys.argv[1:] if arguments is None else arguments)
    if options.version and not options.all_versions:
        return _print_versions()
    is_text = options.command in TEXTS
    if is_text and not getattr(options, "laws", ()):  # nothing need be loaded
        from fenics_contact.cli.completion import print_text

        return print_text(options)
    from fenics_contact.cli.commands import execute

    return execute(options)


def run_script(
    scene: Scene, default_folder: str, description: str = "", arguments: Sequence[str] | None = None
) -> int:
    """What a demo script does with its scene: solve, write, draw; collective.

    Args:
        scene: What to solve.
        default_folder: Where results go without ``--out``.
        description: Text of ``--help``.
        arguments: Command line; by default that of the process.

    Returns:
        The exit code, as of ``main``.

    Raises:
        SystemExit: Help was asked for (0), or an option is wrong (2).

    A script ends with::

        if __name__ == "__main__":
            sys.exit(run_script(scene, default_folder="results/mine", description=__doc__))
    """
    options = parse_script(arguments, default_folder, description)
    from fenics_contact.cli.commands import execute_script

    return execute_script(scene, options)


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the words after ``fenics-contact``.

    Args:
        arguments: These words.

    Returns:
        ``command``, and the options of that command; ``petsc`` are the words after ``--``.

    Raises:
        SystemExit: Help was asked for (0), or something is wrong (2); it was said.
    """
    parser, commands = parsers()
    words, petsc = _split(arguments)
    first = next((word for word in words if not word.startswith("-")), None)
    if first is not None and first not in commands:
        known = list(commands)
        hint = did_you_mean(first, known) or f"; there are {', '.join(known)}"
        parser.error(f"there is no command '{first}'{hint}")
    options, left = parser.parse_known_args(words, argparse.Namespace(petsc=petsc))
    if left:
        (parser if first is None else commands[first]).refuse_unknown(left)
    if options.command is None and not (options.version or options.all_versions):
        parser.print_help(sys.stderr)
        parser.exit(2)
    if options.all_versions and not options.version:
        parser.error("--verbose belongs to --version, or comes after a command")
    if petsc and options.command != "run":
        parser.error("only the command run takes PETSc options, after --")
    return options


def parse_script(
    arguments: Sequence[str] | None, default_folder: str, description: str
) -> argparse.Namespace:
    """Options of the command line of a demo script; words after ``--`` are PETSc's."""
    parser = script_parser(default_folder, description)
    words, petsc = _split(sys.argv[1:] if arguments is None else arguments)
    options, left = parser.parse_known_args(words, argparse.Namespace(petsc=petsc))
    if left:
        parser.refuse_unknown(left)
    return options


def _split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """The words before and after the first ``--``."""
    words = list(arguments)
    place = words.index("--") if "--" in words else len(words)
    return words[:place], words[place + 1 :]


def _print_versions() -> int:
    """Print the program's version and dolfinx's, on one rank, and return the exit code."""
    if is_first_rank():
        print(f"{PROGRAM} {VERSION}, with dolfinx {dolfinx_version() or '(not found)'}")
    return 0


def dolfinx_version() -> str:
    """Return the version of the installed dolfinx, which is not loaded; empty without one."""
    found = PathFinder.find_spec("dolfinx")
    if found is None:
        return ""
    if found.origin and (said := _ASSIGNED.search(Path(found.origin).read_text("utf-8"))):
        return said[1]
    return _by_metadata()


def _by_metadata() -> str:
    """Where the package's file does not say it."""
    from importlib import metadata

    try:
        return metadata.version("fenics-dolfinx")
    except metadata.PackageNotFoundError:
        import dolfinx

        return str(dolfinx.__version__)
