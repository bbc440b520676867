"""Pictures of the damping of joints over amplitude, and of their softening."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fenics_contact.analyses.vibration.record import DampingRecord
from fenics_contact.report.drawing.figures import legend_beside, new_figure, plain, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import LINES, WIDE
from fenics_contact.report.drawing.units import labelled
from fenics_contact.results.records.run import Outcome

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
