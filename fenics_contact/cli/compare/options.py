"""Options and help of ``fenics-contact compare``."""

from __future__ import annotations

import argparse
from pathlib import Path

_DESCRIPTION = """\
Shows two runs or more side by side: what differs in their scenes, models and quantities, and by
how many error bars (of both runs together: at 1 the two intervals just touch). The first one is
what the others are compared with. Curves of all runs are in a page, compare.html.

Examples:
  fenics-contact compare results/before results/after
  fenics-contact compare results/coarse results/fine results/finer --out meshes.html
  fenics-contact compare results/one_rank results/four_ranks --all"""

# Its name, what it does, how it is written, and its help.
COMMAND = (
    "compare",
    "two runs or more side by side",
    "DIR DIR ... [options]",
    _DESCRIPTION,
)


def describe(command: argparse.ArgumentParser) -> None:
    """Add its arguments.

    Args:
        command: Its parser.
    """
    command.add_argument(
        "folders", metavar="DIR", nargs="+", type=Path, help="results of runs, two or more"
    )
    page = Path("compare.html")
    command.add_argument(
        "--out", metavar="FILE", type=Path, default=page, help="page to write (compare.html)"
    )
    command.add_argument("--all", action="store_true", help="show also what does not differ")
