"""Force against displacement over the load steps, with the last closed loop and its work."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import EXTERNAL_WORK
from fenics_contact.report.drawing.figures import (
    legend_in_headroom,
    line,
    new_figure,
    save,
    set_title,
)
from fenics_contact.report.drawing.picture import Followed, Picture, frame_of
from fenics_contact.report.drawing.style import COLOURS, COLUMN, DOUBLE, labelled, with_unit
from fenics_contact.results.load_history import Drive, History

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# The ends of a loop are this near to each other, over its extent, in displacement and in force.
_CLOSED = 1e-2
# Loops thinner than this, area over the box around them, are also drawn without what is elastic.
THIN = 0.1
# Work of others over the work of a drive over its loop, below which it is none.
_NO_WORK = 0.01


@dataclass(frozen=True)
class Loop:
    """The last closed loop of a path.

    Attributes:
        first: Number of its first point.
        last: Of its last.
        x: Displacements (length).
        y: Forces.
    """

    first: int
    last: int
    x: Array
    y: Array

    @property
    def work(self) -> float:
        """∮ F du: of the drive, > 0 what it puts in (energy)."""
        return float(np.sum((self.y[1:] + self.y[:-1]) / 2 * np.diff(self.x)))

    @property
    def is_thin(self) -> bool:
        """Whether it looks like a line."""
        return bool(abs(self.work) < THIN * np.ptp(self.x) * np.ptp(self.y))

    @property
    def compliance(self) -> float:
        """Compliance of the straight line between the turning points (length/force)."""
        low, high = int(np.argmin(self.x)), int(np.argmax(self.x))
        return float((self.x[high] - self.x[low]) / (self.y[high] - self.y[low] or 1.0))


def last_loop(x: Array, y: Array) -> Loop | None:
    """The last part of a path that comes back to where it was; None where it never turned twice.

    Args:
        x: Displacements, (points,) (length).
        y: Forces, (points,).
    """
    turns = _turns(x)
    for start in reversed(turns[:-1]):
        for end in reversed([number for number in (*turns, len(x) - 1) if number > start + 2]):
            near = abs(x[end] - x[start]) < _CLOSED * np.ptp(x[start : end + 1])
            near &= abs(y[end] - y[start]) < _CLOSED * np.ptp(y[start : end + 1])
            if near:
                return Loop(start, end, x[start : end + 1], y[start : end + 1])
    return None


def _turns(x: Array) -> list[int]:
    """The points at which the direction changes, with the first one of what moves."""
    steps = np.diff(x)
    moving = np.flatnonzero(np.abs(steps) > 1e-9 * (np.ptp(x) or 1.0))
    if len(moving) == 0:
        return [0]
    signs = np.sign(steps[moving])
    changed = np.flatnonzero(signs[1:] != signs[:-1])
    return [int(moving[0]), *(int(number) for number in moving[changed + 1])]


def draw_loops(history: History, drives: list[Drive], path: Path) -> Picture:
    """Force against displacement, one panel each, with arrows along the path."""
    loops = [last_loop(drive.x, drive.y) for drive in drives]
    shown: list[tuple[Drive, Loop | None, bool]] = []
    for drive, loop in zip(drives, loops, strict=True):
        shown.append((drive, loop, False))
        if loop is not None and loop.is_thin:
            shown.append((drive, loop, True))
    columns = min(len(shown), 2)
    rows = -(-len(shown) // columns)
    size = (DOUBLE if columns > 1 else COLUMN + 0.4, 2.7 * rows + 0.2)
    figure, panels = new_figure("", size, nrows=rows, ncols=columns)
    paths = [
        _loop(panel, drive, loop, is_sheared)
        for (drive, loop, is_sheared), panel in zip(shown, panels, strict=False)
    ]
    for panel in panels[len(shown) :]:
        panel.set_axis_off()
    save(figure, path)
    said = "Force against displacement; arrows follow the path, the dot is its end."
    if any(loops):
        work = "the energy that it dissipates" if _dissipates(history, loops) else "> 0 if put in"
        said += f" Shaded: the last closed loop; ΔW is the work of this drive over it, {work}."
    if any(is_sheared for *_, is_sheared in shown):
        said += " Beside it the same less the straight line C F between its turning points."
    places = Followed(frame_of(figure, panels[: len(paths)]), [(p.x, p.y) for p in paths])
    return Picture(path, "Force against displacement", said, places)


def _dissipates(history: History, loops: list[Loop | None]) -> bool:
    """Whether the work of the only drive over a loop is all work that is done meanwhile."""
    if len(loops) != 1 or loops[0] is None:
        return False
    loop = loops[0]
    done = history.quantity(EXTERNAL_WORK)
    return bool(abs(done[loop.last] - done[loop.first] - loop.work) < _NO_WORK * abs(loop.work))


def _loop(panel: Axes, drive: Drive, loop: Loop | None, is_sheared: bool) -> Drive:
    """Draw a path with its last closed loop; sheared so that a thin one opens."""
    moved = drive.x - (loop.compliance * drive.y if loop and is_sheared else 0.0)
    path = Drive(drive.title, drive.moved, drive.force, moved, drive.y)
    if loop is not None:
        inside = slice(loop.first, loop.last + 1)
        words = with_unit(rf"$\Delta W = {_number(loop.work)}$", "energy")
        panel.fill(moved[inside], drive.y[inside], color=COLOURS["OPEN"], lw=0, label=words)
    line(panel, path.x, path.y, "", 0)
    _arrows(panel, path)
    panel.plot(*(path.x[-1:], path.y[-1:]), "o", color=COLOURS["SLIP"], markersize=5, zorder=4)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    panel.locator_params(axis="x", nbins=6)
    symbol, force = (words.split(", ")[-1].strip("$") for words in (drive.moved, drive.force))
    panel.set_xlabel(
        labelled(
            f"elastic part left out, ${symbol} - C\\,{force}$" if is_sheared else drive.moved,
            "length",
        )
    )
    panel.set_ylabel(labelled(drive.force, "force"))
    set_title(panel, drive.title[0].upper() + drive.title[1:])
    if loop is not None and not is_sheared:
        legend_in_headroom(panel)
    return path


def _number(value: float) -> str:
    """With four digits, for mathtext."""
    mantissa, _, power = f"{value:.4g}".partition("e")
    return mantissa + (rf"\times 10^{{{int(power)}}}" if power else "")


def _arrows(panel: Axes, drive: Drive) -> None:
    """Draw the direction of a path at a few places along it."""
    x, y = (values / (np.ptp(values) or 1.0) for values in (drive.x, drive.y))
    lengths = np.hypot(np.diff(x), np.diff(y))
    reached = np.cumsum(lengths)
    for share in (0.15, 0.35, 0.55, 0.75, 0.95):
        i = int(np.searchsorted(reached, share * reached[-1]))
        start, end = (drive.x[i], drive.y[i]), (drive.x[i + 1], drive.y[i + 1])
        middle = tuple(0.5 * (a + b) for a, b in zip(start, end, strict=True))
        look = {"arrowstyle": "-|>", "color": COLOURS["STICK"], "lw": 0, "mutation_scale": 9}
        panel.annotate("", middle, start, arrowprops=look)
