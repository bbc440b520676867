"""How to cite: the paper whose method this is, and this program, as ``CITATION.cff`` has them."""

from __future__ import annotations

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
