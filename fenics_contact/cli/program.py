"""The command ``fenics-contact``, and the same for scripts that build their own scene.

FEniCSx is loaded once it is known that there is something to do: help is to come at once.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from fenics_contact.cli.options import parse, parse_script
from fenics_contact.cli.versions import print_versions

if TYPE_CHECKING:
    from fenics_contact.scene.scene import Scene


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
        return print_versions()
    is_text = options.command in ("schema", "completion")
    if is_text and not getattr(options, "laws", ()):  # nothing need be loaded
        from fenics_contact.cli.completion.printed import print_text

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
