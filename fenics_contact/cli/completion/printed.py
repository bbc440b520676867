"""``fenics-contact schema`` and ``completion``: texts on standard output, of one rank."""

from __future__ import annotations

import argparse
import json
import os
import sys

from fenics_contact.cli.options import is_first_rank

_READER_LEFT = 141  # as the shell has it


def print_text(options: argparse.Namespace) -> int:
    """Print what a command line asks for, and return the exit code.

    Args:
        options: As ``options.parse`` finds them.
    """
    if not is_first_rank():
        return 0
    try:
        print(_schema() if options.command == "schema" else _script(options.shell))
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _READER_LEFT
    return 0


def _schema() -> str:
    from fenics_contact.scene.schema import scene_schema

    return json.dumps(scene_schema(), indent=2, ensure_ascii=True)


def _script(shell: str) -> str:
    from fenics_contact.cli.completion.scripts import script

    return script(shell)
