"""Error against CPU seconds, a picture a problem: the solve above, the whole process below."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from comparison import BARE, OURS, PROCESS, SOLVE, WHOLE
from problems import Problem
from programs import programs
from rows import Point, Row, answered, program_envelope

from fenics_contact.report.drawing.figures import new_figure, save_png, style
from fenics_contact.report.drawing.style import DOUBLE, LINES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARKERS = "osv^DPX"
_PHASES = {SOLVE: "seconds of solve", PROCESS: "seconds, whole process"}


def picture_of(problem: Problem) -> str:
    """Name of its file."""
    return f"peers_{problem.name.replace(' ', '_')}.png"


def draw(problem: Problem, rows: list[Row], path: Path) -> None:
    """A column a quantity, with the envelope of every program."""
    with style():
        _draw(problem, rows, path)


def _draw(problem: Problem, rows: list[Row], path: Path) -> None:
    quantities = list(problem.references)
    size = (DOUBLE * max(1.0, len(quantities) / 4), 4.6)
    figure, panels = new_figure("", size, nrows=2, ncols=len(quantities), sharey="col")
    figure.suptitle(problem.title, x=0.01, ha="left", fontsize=8.5)
    for panel, (phase, quantity) in zip(
        panels, ((phase, quantity) for phase in _PHASES for quantity in quantities), strict=True
    ):
        _fill(panel, problem, rows, quantity, phase)
        panel.set_xlabel(_PHASES[phase])
        if phase == SOLVE:
            panel.set_title(quantity)
    for row in (0, len(quantities)):
        panels[row].set_ylabel("relative error")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), 4))
    save_png(figure, path)


def _fill(panel: Axes, problem: Problem, rows: list[Row], quantity: str, phase: str) -> None:
    from matplotlib.ticker import LogLocator

    of = answered(rows, problem=problem.name)
    for index, program in enumerate(programs()):
        chosen = [row for row in of if row["program"] == program.NAME]
        colour, marker = LINES[index % len(LINES)][0], _MARKERS[index % len(_MARKERS)]
        look = {"color": colour, "marker": marker, "linewidth": 1.0}
        if program.NAME == OURS:
            bare, whole = ([r for r in chosen if r["setting"] == s] for s in (BARE, WHOLE))
            _line(panel, problem, bare, quantity, phase, label=OURS, **look)
            label = f"{OURS}, with error bars"
            look |= {"markerfacecolor": "white", "linestyle": ":"}
            _line(panel, problem, whole, quantity, phase, label=label, **look)
        else:
            _line(panel, problem, chosen, quantity, phase, label=program.NAME, **look)
    panel.xaxis.set_major_locator(LogLocator(subs=(1,)))
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_minor_formatter("")


def _line(
    panel: Axes, problem: Problem, rows: list[Row], quantity: str, phase: str, **look: object
) -> None:
    found: list[Point] = program_envelope(rows, quantity, problem.references[quantity], phase)
    if found:
        panel.loglog([each.seconds for each in found], [each.error for each in found], **look)
