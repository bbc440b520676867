"""The process of the command ``fenics-contact``: it ends as soon as all is written."""

from __future__ import annotations

import atexit
import logging
import os
import sys
from typing import Any, NoReturn

from fenics_contact.cli.program import main


def run_as_process() -> NoReturn:
    """Run the command of this process, and end it by its exit code; collective.

    Python would take a third of a second to free, one by one, what the system frees at once.
    """
    # pydantic would look through all packages of the environment for plugins of its own.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    try:
        code: Any = main()
    except SystemExit as end:
        code = end.code
    if isinstance(code, str):
        print(code, file=sys.stderr)
        code = 1
    _close_libraries()
    os._exit(code or 0)


def _close_libraries() -> None:
    """Remove temporary folders, write out what waits to be, and leave PETSc and MPI; collective."""
    atexit._run_exitfuncs()
    logging.shutdown()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (BrokenPipeError, ValueError):  # whoever read it is gone, or it was closed
            continue
    petsc, mpi = (sys.modules.get(name) for name in ("petsc4py.PETSc", "mpi4py.MPI"))
    if petsc is not None:
        petsc._finalize()  # which also prints what options such as -log_view ask for
    if mpi is not None and mpi.Is_initialized() and not mpi.Is_finalized():
        mpi.Finalize()
