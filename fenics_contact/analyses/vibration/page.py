"""Vibration on the page of a run: natural modes, and damping of joints over amplitude."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.analyses.vibration.record import DampingRecord, ModeRecord
from fenics_contact.analyses.vibration.words import damping_rows, mode_rows
from fenics_contact.report.bodies.mode_shapes import MOVE, figure_of_shapes
from fenics_contact.report.contacts.film import write_gif
from fenics_contact.report.drawing.fields import read_modes
from fenics_contact.report.drawing.figures import legend_beside, new_figure, plain, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import LINES, WIDE, labelled, with_unit
from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import Outcome, RunRecord

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


class _VibrationPage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if not result.modes:
            return None
        values = {"modes": mode_rows(result), "damping": damping_rows(result)}
        return AnalysisSection("vibration", "Vibration", values)

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        yield from draw_mode_shapes(run.folder, run.result)
        yield from draw_damping(run.folder, run.result)

    def animations(self, run: RunToDraw) -> Iterator[Picture]:
        yield from draw_mode_film(run.folder, run.result)


PAGE = _VibrationPage()


_HEIGHT, _MARGIN = 2.0, 0.6


def draw_damping(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``damping.png`` of a run that drove modes to several amplitudes.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    curves: dict[str, list[DampingRecord]] = {}
    for row in result.damping:
        by = "".join(f", {key} = {value:g}" for key, value in row.by.items())
        curves.setdefault(f"mode {row.mode}{by}", []).append(row)
    if not any(len(rows) > 1 for rows in curves.values()):
        return []
    figure, panels = new_figure(
        "What the joints damp", (WIDE, 2 * _HEIGHT + _MARGIN), nrows=2, sharex=True
    )
    for number, (name, rows) in enumerate(curves.items()):
        colour, dashes = LINES[number % len(LINES)]
        look = {"color": colour, "linestyle": dashes, "marker": ".", "label": plain(name)}
        amplitudes = [row.amplitude for row in rows]
        for panel, quantity in zip(panels, ("natural_frequency", "damping_ratio"), strict=True):
            values = np.array([row[quantity] for row in rows])
            panel.plot(amplitudes, values, **look)
            bars = [row.errors.get(quantity, {}).get("total") for row in rows]
            known = [place for place, bar in enumerate(bars) if bar is not None]
            if known:
                panel.errorbar(
                    np.array(amplitudes)[known],
                    values[known],
                    [bars[place] for place in known],
                    fmt="none",
                    ecolor=colour,
                    capsize=2,
                )
    panels[0].set_ylabel(labelled("natural frequency, $f$", "cycles/time"))
    panels[1].set_ylabel("damping ratio, $\\zeta$")
    panels[1].set_xlabel(labelled("amplitude, $a$", "length"))
    panels[1].set_xscale("log")
    panels[1].set_ylim(bottom=0)
    if len(curves) > 1:
        for panel in panels:
            legend_beside(panel)
    figure.align_ylabels(panels)
    path = folder / "damping.png"
    save(figure, path)
    said = (
        "Natural frequency f, by the secant of the loop, and damping ratio ζ = D/(4πU) over the "
        "amplitude a of a mode."
    )
    if any(row.errors for row in result.damping):
        said += " Bars are estimated errors."
    return [Picture(path, "Damping over amplitude", said)]


_MOST_SHAPES = 6
# Of a whole swing.
_FRAMES_OF_SWING, _DPI = 24, 110


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
    modes = list(result.modes)[:_MOST_SHAPES]
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
    swings = np.cos(2 * np.pi * np.arange(_FRAMES_OF_SWING // 2 + 1) / _FRAMES_OF_SWING)
    there = [_frame(shapes, float(swing)) for swing in swings]
    write_gif([*there, *there[-2:0:-1]], path)  # the way back shows the same
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
