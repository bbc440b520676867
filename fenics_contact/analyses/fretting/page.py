"""Fretting on the page of a run."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.analyses.fretting.pictures import draw_fretting
from fenics_contact.analyses.fretting.places_file import FrettingTable
from fenics_contact.analyses.fretting.words import fretting_rows
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.page.analysis_page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import RunRecord


def _values(result: RunRecord) -> dict[str, object]:
    return {"fretting": fretting_rows(result.fretting, result.units)}


class _FrettingPage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if not fretting_rows(result.fretting):
            return None
        return AnalysisSection("fretting", "Fretting", _values(result))

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        found = FrettingTable.read(run.folder / "fretting.csv")
        if found is not None:
            yield from draw_fretting(run.body, run.contacts, found, run.axes, run.folder)


PAGE = _FrettingPage()
