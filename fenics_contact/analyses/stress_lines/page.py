"""Stress along lines on the page of a run: a table, and a chart of each line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fenics_contact.analyses.stress_lines.record import StressLineRecord
from fenics_contact.analyses.stress_lines.words import line_rows
from fenics_contact.report.drawing.figures import legend_beside, line, new_figure, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import WIDE, labelled
from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import RunRecord

_HEIGHT = 2.8
# Of the largest von Mises stress: a component that is smaller everywhere is not drawn.
_SMALL = 1e-6


class _LinePage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if not result.lines:
            return None
        return AnalysisSection("lines", "Stress along lines", {"lines": line_rows(result)})

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        for number, found in enumerate(run.result.lines):
            yield draw_line(found, run.folder / f"line_{number}.png")


PAGE = _LinePage()


def draw_line(found: StressLineRecord, path: Path) -> Picture:
    """Draw the components of the stress along a line, and the von Mises stress.

    Args:
        found: The stress.
        path: Of the PNG; a PDF is written beside it.
    """
    figure, (panel,) = new_figure(f"Stress along '{found.name}'", (WIDE, _HEIGHT))
    sizes, along = found.von_mises, np.array(found.distances)
    least = _SMALL * np.nanmax(sizes, initial=0.0)
    drawn = {r"$\sigma_\mathrm{VM}$": sizes}
    drawn |= {
        rf"$\sigma_{{{component}}}$": np.array(values, dtype=float)
        for component, values in found.stress.items()
    }
    for number, (label, values) in enumerate(drawn.items()):
        if np.nanmax(np.abs(values), initial=0.0) > least or number == 0:
            line(panel, along, values, label, number)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    panel.set_xlabel(labelled("distance along the line, $s$", "length"))
    panel.set_ylabel(labelled("stress", "stress"))
    legend_beside(panel)
    save(figure, path)
    begin, end = (", ".join(f"{x:g}" for x in found.places[place]) for place in (0, -1))
    said = (
        f"Stress along the line '{found.name}' from ({begin}) to ({end}) of the undeformed body, "
        "without error bars. It is averaged at the nodes, so that it is continuous inside a "
        "material; at a sharp inner corner no mesh is fine enough for it."
    )
    return Picture(path, f"Stress along '{found.name}'", said)
