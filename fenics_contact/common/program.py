"""The program itself: its version, how to cite it, and the files that come with it.

What is cited, this program and the paper whose method it is, stands in ``CITATION.cff`` as well.
"""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent.parent

PAPER = (
    "L. T. Campos, J. T. Oden and N. Kikuchi. A numerical analysis of a class of contact problems "
    "with friction in elastostatics. Computer Methods in Applied Mechanics and Engineering 34, "
    "821-845, 1982."
)
PAPER_BIBTEX = """\
@article{CamposOdenKikuchi1982,
  author  = {Campos, L. T. and Oden, J. T. and Kikuchi, N.},
  title   = {A numerical analysis of a class of contact problems with friction in elastostatics},
  journal = {Computer Methods in Applied Mechanics and Engineering},
  volume  = {34},
  pages   = {821--845},
  year    = {1982}
}"""
VERSION = "0.1.0"
PROGRAM = f"The fenics_contact developers. fenics_contact, version {VERSION}. LGPL-3.0-or-later."
PROGRAM_BIBTEX = f"""\
@misc{{fenics_contact,
  author = {{{{The fenics\\_contact developers}}}},
  title  = {{fenics\\_contact: contact with friction in elastostatics}},
  note   = {{Version {VERSION}, LGPL-3.0-or-later}}
}}"""


def how_to_cite() -> str:
    """Both, in plain text of one line."""
    return f"{PAPER} {PROGRAM}"


def bibtex() -> str:
    """Both, for BibTeX."""
    return f"{PAPER_BIBTEX}\n\n{PROGRAM_BIBTEX}"


def mesh_file(name: str) -> str:
    """Path of a mesh: inside the installed package, or in the repository around it."""
    installed = _PACKAGE / "meshes" / name
    return str(installed if installed.is_file() else _PACKAGE.parent / "meshes" / name)


def templates() -> dict[str, Path]:
    """Scenes to start from, by their names in alphabetical order."""
    return {path.stem: path for path in sorted((_PACKAGE / "cli" / "templates").glob("*.toml"))}
