"""The area on the page of a run."""

from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from tests.analyses.pressed_area.words import area_rows


class _Page(AnalysisPage):
    def section(self, result):
        return AnalysisSection("pressed_area", "Pressed area", {"areas": area_rows(result)})


PAGE = _Page()
