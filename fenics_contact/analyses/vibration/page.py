"""Natural modes, and what joints damp of them, on the page of a run."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analyses.vibration.damping_curves import draw_damping
from fenics_contact.analyses.vibration.mode_pictures import draw_mode_film, draw_mode_shapes
from fenics_contact.analyses.vibration.words import damping_rows, mode_rows
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.page.analysis_page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import RunRecord


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
