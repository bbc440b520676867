"""Pictures of natural modes: the lowest ones, a panel each, at rest and in motion."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.analyses.vibration.record import ModeRecord
from fenics_contact.report.bodies.mode_shapes import MOVE, figure_of_shapes
from fenics_contact.report.contacts.film import write_gif
from fenics_contact.report.drawing.fields import read_modes
from fenics_contact.report.drawing.figures import save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.units import with_unit
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOST = 6
# Of a whole swing.
_FRAMES, _DPI = 24, 110


def draw_mode_shapes(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``modes.png``, the lowest natural modes of a run that looked for some.

    Args:
        folder: Of the run, which holds ``modes.pvd``.
        result: The content of its ``result.json``.

    Raises:
        InputError: A display is missing for bodies in space; says what to install.
    """
    shapes = shapes_of(folder, result)
    if not shapes:
        return []
    path = folder / "modes.png"
    save(figure_of_shapes(shapes, result.model.kinematics == "3D"), path, tight=True)
    return [Picture(path, "Shapes of the natural modes", _caption(len(shapes), result))]


def shapes_of(folder: Path, result: Outcome) -> dict[str, UnstructuredGrid]:
    """The lowest natural modes of a run, by the titles of their panels; none without a file."""
    modes = list(result.modes)[:_MOST]
    if not modes or not (folder / "modes.pvd").exists():
        return {}
    return {_title(mode): shape for mode, shape in zip(modes, read_modes(folder), strict=False)}


def _title(mode: ModeRecord) -> str:
    return f"Mode {mode.number}, f = {with_unit(f'{mode.natural_frequency:.5g}', 'cycles/time')}"


def _caption(count: int, result: Outcome) -> str:
    more = f", the lowest {count} of {len(result.modes)}" if count < len(result.modes) else ""
    return (
        f"Shapes of the natural modes{more}, with what carries pressure stuck; any size. Coloured "
        "by the size of the displacement over the largest; grey, the body at rest."
    )


def draw_mode_film(folder: Path, result: Outcome) -> list[Picture]:
    """Write ``animation_modes.gif`` of a run that looked for natural modes of flat bodies.

    Args:
        folder: Of the run, which holds ``modes.pvd``.
        result: The content of its ``result.json``.
    """
    shapes = shapes_of(folder, result)
    if not shapes or result.model.kinematics == "3D":
        return []
    path = folder / "animation_modes.gif"
    swings = np.cos(2 * np.pi * np.arange(_FRAMES) / _FRAMES)
    write_gif([_frame(shapes, float(swing)) for swing in swings], path)
    said = (
        "The lowest natural modes, each at its largest and back, all at one pace and of any size. "
        "Coloured by the size of the displacement over the largest; grey, the body at rest."
    )
    return [Picture(path, "Natural modes in motion", said)]


def _frame(shapes: Mapping[str, UnstructuredGrid], swing: float) -> NDArray[np.uint8]:
    """The shapes by a factor from −1 to 1, in a frame that has room for all factors."""
    moved = {title: _swung(body, swing) for title, body in shapes.items()}
    figure = figure_of_shapes(moved, in_space=False)
    (body, *_) = shapes.values()
    corners = np.asarray(body.bounds).reshape(3, 2)
    room = MOVE * float(np.linalg.norm(np.ptp(np.asarray(body.points), axis=0)))
    for panel in figure.axes[: len(shapes)]:
        panel.set_xlim(corners[0, 0] - room, corners[0, 1] + room)
        panel.set_ylim(corners[1, 0] - room, corners[1, 1] + room)
    figure.set_dpi(_DPI)
    figure.canvas.draw()
    found: NDArray[np.uint8] = np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
    return found


def _swung(body: UnstructuredGrid, swing: float) -> UnstructuredGrid:
    """A shape by a factor, which remembers how large it can be."""
    found = body.copy()
    whole = np.asarray(body["displacement"])
    found["largest"] = np.full(len(whole), np.linalg.norm(whole, axis=1).max())
    found["displacement"] = swing * whole
    return found
