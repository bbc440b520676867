"""Options of ``fenics-contact report`` for figures of papers; nothing of FEniCSx, to start fast."""

from __future__ import annotations

import argparse
import re

FORMATS = ("pdf", "svg")
# Millimetres in a unit.
_UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.27}
# Narrower than this no curve is left beside the numbers of its axis; wider is no page.
_NARROWEST, _WIDEST = 40.0, 1000.0


def describe(command: argparse.ArgumentParser) -> None:
    """Add the options."""
    command.add_argument(
        "--figures",
        choices=FORMATS,
        help="in place of the page, figures of a run as vectors, with the data of their curves as "
        "CSV, into the folder figures of DIR",
    )
    command.add_argument(
        "--width",
        metavar="LENGTH",
        type=width,
        help="of --figures, such as 86mm, 3.4in or 246pt (by default as in the page); letters keep "
        "their size",
    )


def width(text: str) -> float:
    """A width in millimetres.

    Args:
        text: A number and a unit.

    Raises:
        argparse.ArgumentTypeError: It is no such width.
    """
    found = re.fullmatch(r"(\d+\.?\d*|\.\d+) ?(mm|cm|in|pt)", text.strip())
    if found is None:
        raise argparse.ArgumentTypeError(
            f"'{text}' is no width: write a number and mm, cm, in or pt, such as 86mm"
        )
    value = float(found[1]) * _UNITS[found[2]]
    if not _NARROWEST <= value <= _WIDEST:
        raise argparse.ArgumentTypeError(
            f"'{text}' is {value:.3g} mm; figures are {_NARROWEST:g} to {_WIDEST:g} mm wide"
        )
    return value
