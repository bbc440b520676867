"""Somewhere for VTK to draw."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from fenics_contact.errors import InputError


@contextmanager
def display() -> Iterator[None]:
    """A display while drawing: without one, Debian's build of VTK crashes beyond catching.

    Raises:
        InputError: There is none, and no Xvfb to make one.
    """
    from vtkmodules import vtkRenderingOpenGL2

    has_own = hasattr(vtkRenderingOpenGL2, "vtkEGLRenderWindow")
    if has_own or os.environ.get("DISPLAY") or sys.platform != "linux":
        if has_own and not os.environ.get("DISPLAY"):
            os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
        yield
        return
    program = shutil.which("Xvfb")
    if program is None:
        raise InputError("pictures need a display: install Xvfb (Debian: apt install xvfb)")
    server = subprocess.Popen(
        [program, "-displayfd", "1", "-nolisten", "tcp", "-screen", "0", "1600x1200x24"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert server.stdout is not None
        os.environ["DISPLAY"] = f":{server.stdout.readline().strip()}"
        yield
    finally:
        os.environ.pop("DISPLAY", None)
        server.terminate()
        server.wait()
