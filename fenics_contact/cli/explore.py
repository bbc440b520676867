"""Action of ``fenics-contact explore``: it serves the page, and answers until Ctrl-C."""

from __future__ import annotations

import argparse
import logging
import os
import signal
import sys
import webbrowser

from mpi4py import MPI

from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import original
from fenics_contact.explore.exploration import Exploration
from fenics_contact.scene.reading import load_scene
from fenics_contact.simulation.studies.study import Study

logger = logging.getLogger(__name__)


def explore(options: argparse.Namespace) -> int:
    """Serve a scene's page until Ctrl-C, which is its ordinary end.

    Args:
        options: Of the command line.

    Raises:
        InputError: The scene, a key or the address cannot be used, or there are several ranks; or
            the scene as it is has no equilibrium.
        NotConvergedError: It has no answer.
        MachineError: The machine failed.
    """
    ranks = MPI.COMM_WORLD.size
    if ranks > 1:  # before each of them reads the scene
        raise InputError(
            f"explore answers on one rank, and there are {ranks}: start it without mpirun"
        )
    study = Study(load_scene(options.scene, options.overrides), MPI.COMM_SELF)
    folder = options.scene.parent
    page = Exploration(study, options.vary, options.host, options.port, folder)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # of `docker stop`, for instance
    try:
        _announce(page, options)
        page.serve()
    except BaseException as error:
        if not isinstance(original(error), KeyboardInterrupt):
            raise
    finally:
        page.close()
    return 0


def _announce(page: Exploration, options: argparse.Namespace) -> None:
    """Print the link, and open it."""
    print(page.address, flush=True)
    if not page.is_local:
        logger.warning(
            "Whoever reaches %s and has the link can move these numbers; what is sent is not "
            "encrypted.",
            options.host,
        )
    if not options.quiet:
        print("Ctrl-C ends it.", flush=True)
    if not options.no_browser and _has_window():
        webbrowser.open(page.address)


def _has_window() -> bool:
    """Whether a browser could open one: not in a terminal alone, where it would take its place."""
    has_display = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return has_display or not sys.platform.startswith("linux")
