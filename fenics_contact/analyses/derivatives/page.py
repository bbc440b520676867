"""Derivatives, and what tolerances make of quantities, on the page of a run."""

from __future__ import annotations

from collections.abc import Iterator

from markupsafe import Markup

from fenics_contact.analyses.derivatives.words import (
    derivative_rows,
    notes_on_derivatives,
    uncertainty_rows,
)
from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from fenics_contact.report.page.templates import bar, table
from fenics_contact.results.records.run import Outcome, RunRecord


class _DerivativePage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if not result.derivatives:
            return None
        values = {
            "charts": list(sensitivity_charts(result)),
            "derivatives": derivative_rows(result),
            "notes_on_derivatives": notes_on_derivatives(result),
            "uncertainties": uncertainty_rows(result),
        }
        return AnalysisSection("sensitivities", "Sensitivities", values)


def sensitivity_charts(result: Outcome) -> Iterator[tuple[str, Markup]]:
    """Return a table of bars of the normalised derivatives of each quantity, the largest first."""
    for name, slopes in result.derivatives.items():
        sizes = {key: found.normalised for key, found in slopes.items()}
        known = {key: size for key, size in sizes.items() if size is not None}
        rows: list[list[str]] = [["number of the scene", "percent for a percent", ""]]
        most = max(map(abs, known.values()), default=0.0)
        for key, size in sorted(known.items(), key=lambda entry: -abs(entry[1])):
            rows.append([key, f"{size:+.3g}", bar(abs(size) / most if most else 0.0, "")])
        if known:
            yield name, table(rows, f"Normalised derivatives of {name}")


PAGE = _DerivativePage()
