"""An animation of a contact line that wears: what is lost, and the pressure, cycle by cycle."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fenics_contact.analyses.wear_cycles.pictures import KINDS, kinds_of, name_axis, view_of
from fenics_contact.analyses.wear_cycles.worn_history import WornHistory
from fenics_contact.common.arrays import Array
from fenics_contact.report.contacts.film import frame_numbers, write_gif
from fenics_contact.report.contacts.line import positions
from fenics_contact.report.drawing.figures import new_figure, set_title
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOURS, LINES, WIDE
from fenics_contact.report.drawing.units import labelled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Cycles from which there is something to be seen moving.
FEWEST_CYCLES = 5
_DPI, _HEIGHT, _HEADROOM = 120, 4.2, 1.08


def draw_wear_film(history: WornHistory, number: int, path: Path) -> Picture:
    """Write the cycles that were computed as a GIF.

    Args:
        history: The cycles.
        number: Of the contact, whose points lie on a line.
        path: Where to.
    """
    line = _Line(history, number)
    figure, panels = new_figure("", (WIDE, _HEIGHT), nrows=2, sharex=True, dpi=_DPI)
    frames = frame_numbers(len(history.cycles))
    pictures: list[NDArray[np.uint8]] = []
    for frame in frames:
        for panel in panels:
            panel.clear()
        line.draw(panels, int(frame))
        set_title(panels[0], f"cycle {history.cycles[frame]}")
        if not pictures:
            for _ in range(2):  # then nothing moves any more
                figure.canvas.draw()
            figure.set_layout_engine("none")
        figure.canvas.draw()
        pictures.append(np.asarray(figure.canvas.buffer_rgba())[..., :3].copy())
    write_gif(pictures, path)
    said = (
        "What is worn off, downwards, in the colours of what the points do up to the next cycle, "
        "and below it the contact pressure, grey that of the first cycle."
    )
    return Picture(path, f"{history.title(number) or 'the contact'} wears".capitalize(), said)


class _Line:
    """A contact line, cycle by cycle."""

    def __init__(self, history: WornHistory, number: int) -> None:
        tables = history.worn[number]
        _, self._circle, position = positions(tables[-1])
        order = np.argsort(position, kind="stable")
        self._position = position[order]
        rows = [table.rows(order) for table in tables]
        self._kinds = kinds_of(rows)
        self._view = view_of(self._position, rows)
        self._depths = np.stack([table.numbers["worn_depth"] for table in rows])
        self._pressures = np.stack([table.numbers["contact_pressure"] for table in rows])

    def draw(self, panels: list[Axes], frame: int) -> None:
        """Draw the state at the end of a cycle."""
        depth, pressure = panels
        x, worn = self._position, self._depths[frame]
        for kind, (label, status) in enumerate(KINDS):
            mine = self._kinds[frame] == kind
            where = mine | np.roll(mine, 1) | np.roll(mine, -1)
            depth.fill_between(x, worn, where=where, color=COLOURS[status], lw=0, label=label)
        depth.plot(x, worn, color="black", linewidth=0.8)
        depth.set_ylabel(labelled("worn depth, $h$", "length"))
        depth.set_ylim(_top(self._depths), 0)
        pressure.plot(x, self._pressures[0], color="0.7", linewidth=0.8)
        pressure.plot(x, self._pressures[frame], color=LINES[0][0])
        pressure.set_ylabel(labelled("contact pressure, $p$", "stress"))
        pressure.set_ylim(0, _top(self._pressures))
        pressure.set_xlim(*self._view)
        name_axis(pressure, self._circle)


def _top(values: Array) -> float:
    return _HEADROOM * float(values.max()) or 1.0
