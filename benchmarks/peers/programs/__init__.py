"""The programs that are compared: a file each, which says what it installs and solves.

A file is read in two Pythons: by ``run.py`` for all but ``solve``, and by ``worker.py``, in the
program's own, for ``solve``; so it imports its program inside of functions.

- ``NAME``: what the program is called.
- ``INSTALL``: ``("pip", requirements)``, with an older Python ``("pip, older Python", …)``,
  ``("apt", packages)``, or ``("here", ())`` for the Python that runs all this.
- ``SETTINGS``: by problem, the settings that are tried, by label; the best ones make its envelope.
- ``solve(problem, level, setting)``: an ``Answer``.
- ``ABOUT``: how it is set up, and what its time goes to, for the page.
"""

from __future__ import annotations

import importlib
from types import ModuleType

# A new program is a file of this folder and its name here.
PROGRAMS = (
    "fenics_contact_run",
    "ngsolve_energies",
    "getfem_multipliers",
    "calculix_penalty",
    "kratos_mortar",
    "tamaas_half_space",
)


def program_in(file: str) -> ModuleType:
    """A program by the name of its file."""
    return importlib.import_module(f"programs.{file}")


def programs() -> list[ModuleType]:
    """All of them, ours first."""
    return [program_in(file) for file in PROGRAMS]
