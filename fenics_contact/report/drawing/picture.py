"""A picture that was drawn from a run, and what VTK draws on where there is no display."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import replaced_file
from fenics_contact.common.errors import InputError
from fenics_contact.report.drawing.figures import plain_ticks, style, tight_box

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

_PLATFORM_DEVICE = 0x313F  # EGL_PLATFORM_DEVICE_EXT
_NO_DISPLAY = (
    "pictures of bodies in space need a display: install libEGL with Mesa's drivers, or Xvfb "
    "(Debian: apt install libegl1 libgl1-mesa-dri, or apt install xvfb)"
)


@contextmanager
def display() -> Iterator[None]:
    """Within it, VTK can draw: by EGL, on the display that is there, or on an Xvfb of its own.

    Raises:
        InputError: There is none of these.
    """
    if sys.platform != "linux":
        yield
    elif _draws_by_egl():
        with _environment("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow"):
            yield
    elif _display_answers():
        yield
    else:
        with _virtual_display() as name, _environment("DISPLAY", name):
            yield


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    """An environment variable, and afterwards what it was."""
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before


def _display_answers() -> bool:
    """Whether there is an X server behind DISPLAY: VTK ends the process where there is none."""
    if not os.environ.get("DISPLAY"):
        return False
    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return False
    open_display = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_char_p)(("XOpenDisplay", x11))
    close_display = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)(("XCloseDisplay", x11))
    screen = open_display(None)
    if screen:
        close_display(screen)
    return bool(screen)


def _draws_by_egl() -> bool:
    """Whether VTK was built for EGL, and EGL finds something to draw on."""
    from vtkmodules import vtkRenderingOpenGL2

    if not hasattr(vtkRenderingOpenGL2, "vtkEGLRenderWindow"):
        return False
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return any(
        egl.eglInitialize(ctypes.c_void_p(screen), None, None) for screen in _screens(egl) if screen
    )


def _screens(egl: ctypes.CDLL) -> Iterator[int | None]:
    """EGL's displays: the default one, and those of its devices (EGL_EXT_device_enumeration)."""
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    yield ctypes.CFUNCTYPE(pointer, pointer)(("eglGetDisplay", egl))(None)
    address_of = ctypes.CFUNCTYPE(pointer, ctypes.c_char_p)(("eglGetProcAddress", egl))
    query, get = (address_of(name) for name in (b"eglQueryDevicesEXT", b"eglGetPlatformDisplayEXT"))
    if not (query and get):
        return
    devices, count = (pointer * 16)(), integer(0)
    ctypes.CFUNCTYPE(integer, integer, pointer, pointer)(query)(
        16, ctypes.cast(devices, pointer), ctypes.cast(ctypes.byref(count), pointer)
    )
    screen_of = ctypes.CFUNCTYPE(pointer, integer, pointer, pointer)(get)
    for device in devices[: count.value]:
        yield screen_of(_PLATFORM_DEVICE, device, None)


@contextmanager
def _virtual_display() -> Iterator[str]:
    """An Xvfb, for as long as it is wanted; what DISPLAY has to be for it."""
    program = shutil.which("Xvfb")
    if program is None:
        raise InputError(_NO_DISPLAY)
    server = subprocess.Popen(
        [program, "-displayfd", "1", "-nolisten", "tcp", "-screen", "0", "1600x1200x24"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert server.stdout is not None
        number = server.stdout.readline().strip()
        if not number:
            raise InputError(f"{_NO_DISPLAY}; the Xvfb that is there did not start")
        yield f":{number}"
    finally:
        server.terminate()
        server.wait()


_POINTS = 72  # of an inch


@dataclass(frozen=True)
class Panel:
    """A panel of a picture.

    Attributes:
        box: Its left side and its top, its width and its height, as shares of the picture's.
        x: Numbers at its left and its right side.
        y: At its bottom and its top.
    """

    box: tuple[float, float, float, float]
    x: tuple[float, float]
    y: tuple[float, float]

    def as_dict(self) -> dict[str, Any]:
        """For a page."""
        return {name: [float(n) for n in getattr(self, name)] for name in ("box", "x", "y")}


@dataclass(frozen=True)
class Frame:
    """A picture on which a page draws.

    Attributes:
        width: In points, as sizes of letters and lines are.
        panels: Those that are drawn into.
    """

    width: float
    panels: list[Panel]


def frame_of(figure: Figure, panels: Sequence[Axes], box: Bbox | None = None) -> Frame:
    """Where panels of a figure are that has been saved.

    Args:
        figure: Matplotlib's; laid out.
        panels: Of it.
        box: What was saved of it, in inches; None for all.
    """
    width, height = figure.get_size_inches()
    left, bottom = (0.0, 0.0) if box is None else (box.x0, box.y0)
    across, up = (width, height) if box is None else (box.width, box.height)
    found = []
    for panel in panels:
        place = panel.get_position()
        top = 1 - (place.y1 * height - bottom) / up
        corner = (place.x0 * width - left) / across, top
        size = place.width * width / across, place.height * height / up
        found.append(Panel((*corner, *size), panel.get_xlim(), panel.get_ylim()))
    return Frame(_POINTS * across, found)


def save_frame(figure: Figure, panels: Sequence[Axes], path: Path, tight: bool = False) -> Frame:
    """Write a figure as a PNG that a page draws on.

    Args:
        figure: Matplotlib's.
        panels: Of it, those that are drawn into.
        path: Of the PNG file.
        tight: Whether its margins are cut off.
    """
    with style(), replaced_file(path) as temporary:
        plain_ticks(figure)
        box = tight_box(figure) if tight else None
        figure.savefig(temporary, **({} if box is None else {"bbox_inches": box}))
    return frame_of(figure, panels, box)


def numbers(values: Array, digits: int = 4) -> list[float | None]:
    """For a page, in so many digits; what is no number is null.

    Args:
        values: (points,).
        digits: Of each.
    """
    written = (f"%.{digits}g" % value for value in np.asarray(values, dtype=float).tolist())
    return [float(text) if text[-1].isdigit() else None for text in written]


__all__ = ["Followed", "Picture"]


@dataclass(frozen=True)
class Followed:
    """Where the load steps are in a picture over all of them.

    Attributes:
        frame: Its panels.
        places: Of each panel the numbers of all steps that have an answer, to the right and
            upwards, (steps,) each; None for the second where a step is a line across the panel.
    """

    frame: Frame
    places: list[tuple[Array, Array | None]]


@dataclass(frozen=True)
class Picture:
    """A picture or an animation, with the words that go with it.

    Attributes:
        path: The file.
        title: What it shows, in a few words of plain text.
        caption: What is seen in it, with its symbols: one or two sentences of plain text.
        followed: Where the load steps are in it, if it is over them.
    """

    path: Path
    title: str
    caption: str
    followed: Followed | None = None
