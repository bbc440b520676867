"""Modes of steady sliding on the page of a run."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analyses.stability.curves import draw_stability
from fenics_contact.analyses.stability.shapes import draw_squeal_shapes
from fenics_contact.analyses.stability.words import stability_rows, stability_words
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.page.analysis_page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import RunRecord


class _StabilityPage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if result.stability is None:
            return None
        said = stability_words(result.stability, result.units)
        values = {"stability": stability_rows(result), "stability_words": said}
        return AnalysisSection("stability", "Steady sliding", values)

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        yield from draw_stability(run.folder, run.result)
        yield from draw_squeal_shapes(run.folder, run.result)


PAGE = _StabilityPage()
