"""Somewhere for VTK to draw: what it does without one is a crash that nothing can catch."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from fenics_contact.common.errors import InputError

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
