"""``fit.html``: the page of a fit, one file that needs nothing else to be shown."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.wording import one_line
from fenics_contact.report.drawing.units import in_units, with_unit
from fenics_contact.report.fit.files import read_fit
from fenics_contact.report.fit.pictures import draw_fit
from fenics_contact.report.fit.tables import correlation_rows, measured_as, parameter_rows
from fenics_contact.report.gallery import require
from fenics_contact.report.page.page import style_sheet
from fenics_contact.report.page.templates import render, table
from fenics_contact.results.fit_record import PAGE, FitRecord
from fenics_contact.scene.quantity_names import in_words


def write_fit_page(folder: Path) -> Path:
    """Write the page of a fit and its pictures, from its files.

    Args:
        folder: With ``fit.json`` and ``fit.csv``.

    Returns:
        The path of the page.

    Raises:
        InputError: A file is missing or damaged, or a library is.
        MachineError: The page could not be written.
    """
    record, curve = read_fit(folder)
    require("matplotlib")
    pictures = draw_fit(folder, record, curve)
    several = len(record.parameters) > 1
    page = render(
        "fit.html",
        title=one_line(record.title) or "Fit",
        style=style_sheet(),
        passed=record.exit_code == 0,
        verdict=record.verdict,
        notes=record.notes,
        parameters=table(parameter_rows(record), "Values found, and their intervals"),
        facts=list(_facts(record)),
        correlations=(
            table(correlation_rows(record), "Correlations of the values") if several else ""
        ),
        singular_values=", ".join(f"{one:.3g}" for one in record.singular_values),
        pictures=pictures,
    )
    path = folder / PAGE
    replace_file(path, page.encode())
    return path


def _facts(record: FitRecord) -> Iterator[str]:
    """The data, and how near the run comes to them."""
    over = ", ".join(in_words(name) if name != "time" else name for name in record.over)
    yield (
        f"Data: {in_words(record.quantity)} over {over}, {record.rows} rows of "
        f"{one_line(record.measured)}."
    )
    with in_units(record.units):
        size = with_unit(record.residual, measured_as(record.quantity))
    yield f"Residual, root mean square: {size}."
    if record.misfit is not None:
        yield (
            f"Misfit: {record.misfit:.3g}, the squares of residuals over uncertainties, over the "
            "degrees of freedom: about 1 where run and data agree."
        )
    yield f"Curves that were solved for: {record.evaluations}."
    yield f"Scene: {one_line(record.scene)}."
