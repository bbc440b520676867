"""Options and help of the commands that are tools, and of figures; nothing of FEniCSx.

Of each command: its name, what it does, how it is written, and its help; and what adds its
arguments to its parser, which has those of a scene already, where it takes one.
"""

from __future__ import annotations

import argparse
import re
from pathlib import Path

_LOOK_HELP = """\
Shows a CAD file, a geometry or a mesh as a page, look.html, that needs no network: bodies and
surfaces by number, what they are and where. It finds surfaces of different bodies that face each
other, and writes scene.toml beside the page with a contact for each pair, an example material and
an example support, which `check` accepts as it is.

Examples:
  fenics-contact look joint.step
  fenics-contact look joint.step --out joint --tolerance 0.2"""

LOOK = (
    "look",
    "show a CAD or mesh file, and write a scene for it",
    "FILE [options]",
    _LOOK_HELP,
)


def describe_look(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``look``."""
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


_SWEEP_HELP = """\
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

SWEEP = (
    "sweep",
    "solve a scene for all combinations of values of its keys",
    "SCENE.toml --vary KEY=VALUES [options]",
    _SWEEP_HELP,
)

SWEEP_EPILOG = """\
Exit codes: 0 if that of every row is; else the first of 5, 130, 3 and 4 that stands for a row,
where a point whose values the scene refuses counts as 3; 2 if nothing could be solved, and nothing
was written. See fenics-contact --help."""


def describe_sweep(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``sweep``."""
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


_FIT_HELP = """\
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

FIT = (
    "fit",
    "find values for which a run meets a measured curve",
    "SCENE.toml MEASURED.csv --parameters KEY[=LOW:HIGH],... [options]",
    _FIT_HELP,
)


def describe_fit(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``fit``."""
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


_EXPLORE_HELP = """\
Opens a page of this machine on which numbers of a scene are moved, and its answer follows:
pressure, friction, stick and slip, gaps and the deformed body. When one lets go, quantities come
with error bars and checks. The link has a token that is new each time; nothing leaves the machine,
and no file is written. Ctrl-C ends it, with exit code 0.

Examples:
  fenics-contact explore scene.toml
  fenics-contact explore scene.toml --vary contact.0.friction_coefficient=0:0.6
  fenics-contact explore scene.toml --host 0.0.0.0 --port 8000 --no-browser   # in a container"""

EXPLORE = (
    "explore",
    "move numbers of a scene on a page, and see its answer follow",
    "SCENE.toml [options]",
    _EXPLORE_HELP,
)


def describe_explore(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``explore``."""
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


_COMPARE_HELP = """\
Shows two runs or more side by side: what differs in their scenes, models and quantities, and by
how many error bars (of both runs together: at 1 the two intervals just touch). The first one is
what the others are compared with. Curves of all runs are in a page, compare.html.

Examples:
  fenics-contact compare results/before results/after
  fenics-contact compare results/coarse results/fine results/finer --out meshes.html
  fenics-contact compare results/one_rank results/four_ranks --all"""

COMPARE = (
    "compare",
    "two runs or more side by side",
    "DIR DIR ... [options]",
    _COMPARE_HELP,
)


def describe_compare(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``compare``."""
    command.add_argument(
        "folders", metavar="DIR", nargs="+", type=Path, help="results of runs, two or more"
    )
    page = Path("compare.html")
    command.add_argument(
        "--out", metavar="FILE", type=Path, default=page, help="page to write (compare.html)"
    )
    command.add_argument("--all", action="store_true", help="show also what does not differ")


_FORMATS = ("pdf", "svg")
# Millimetres in a unit.
_UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72.27}
# Narrower than this no curve is left beside the numbers of its axis; wider is no page.
_NARROWEST, _WIDEST = 40.0, 1000.0


def describe_figures(command: argparse.ArgumentParser) -> None:
    """Add the arguments of ``report`` for figures of papers."""
    command.add_argument(
        "--figures",
        choices=_FORMATS,
        help="in place of the page, figures of a run as vectors, with the data of their curves as "
        "CSV, into the folder figures of DIR",
    )
    command.add_argument(
        "--width",
        metavar="LENGTH",
        type=_width,
        help="of --figures, such as 86mm, 3.4in or 246pt (by default as in the page); letters keep "
        "their size",
    )


def _width(text: str) -> float:
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
