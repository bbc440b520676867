"""Options and help of ``fenics-contact fit``."""

from __future__ import annotations

import argparse
from pathlib import Path

_DESCRIPTION = """\
Finds the values of some numbers of a scene for which its run meets a measured curve, by least
squares with exact derivatives. Each value has an interval for 95 %, of the noise of the data and of
what mesh, penalty and regularisation may change. It says which numbers the data cannot tell apart,
and writes fit.json, a table of both curves, pictures, a page, and the scene with these values.
Curves that are solved for are kept at once: --resume goes on after an interrupt or a kill.

MEASURED.csv begins with a line of names: time (the pseudo-time of the load steps), a quantity, or
keys of the scene, as a table of sweep has them; then the quantity that was measured; then, if it is
known, QUANTITY_error, its standard uncertainty. The search begins at the scene's own values.

Examples:
  fenics-contact fit scene.toml loop.csv --parameters contact.0.friction_coefficient=0:1
  fenics-contact fit scene.toml loop.csv --parameters load.0.pressure,material.0.youngs_modulus
  fenics-contact fit scene.toml sweep.csv --of normal_force --parameters load.0.pressure"""

# Its name, what it does, how it is written, and its help.
COMMAND = (
    "fit",
    "find values for which a run meets a measured curve",
    "SCENE.toml MEASURED.csv --parameters KEY[=LOW:HIGH],... [options]",
    _DESCRIPTION,
)


def describe(command: argparse.ArgumentParser) -> None:
    """Add its arguments.

    Args:
        command: Its parser, which has those of the scene already.
    """
    command.add_argument("measured", metavar="MEASURED.csv", type=Path, help="measured curve")
    command.add_argument(
        "--parameters",
        metavar="KEY[=LOW:HIGH],...",
        action="append",
        default=[],
        help="keys whose values are to be found, and their bounds if there are some",
    )
    command.add_argument("--of", metavar="QUANTITY", help="which one, where the table has several")
    command.add_argument(
        "--out", metavar="DIR", type=Path, help="folder (results/ and the scene's name, _fit)"
    )
    command.add_argument(
        "--resume", action="store_true", help="go on with the fit that is in the folder"
    )
