"""``fenics-contact --version``: at once, so without loading FEniCSx."""

from __future__ import annotations

import re
from importlib.machinery import PathFinder
from pathlib import Path

from fenics_contact.cli.options import PROGRAM, is_first_rank
from fenics_contact.common.program import VERSION

_ASSIGNED = re.compile(r"""^__version__ = ["']([^"']+)["']""", re.MULTILINE)


def print_versions() -> int:
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
