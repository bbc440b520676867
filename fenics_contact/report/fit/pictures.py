"""Pictures of a fit: both curves, and what lies between them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.figures import legend_beside, new_figure, plain, save, style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOURS, WIDE
from fenics_contact.report.drawing.units import in_units, labelled, unit_of
from fenics_contact.report.fit.files import FittedCurve
from fenics_contact.report.fit.tables import TIME, measured_as
from fenics_contact.report.sweep.columns import unit_of_key
from fenics_contact.results.fit_record import FitRecord
from fenics_contact.scene.quantity_names import in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_fit(folder: Path, record: FitRecord, curve: FittedCurve) -> list[Picture]:
    """Draw ``fit.png`` and ``residual.png``, each with a PDF of its name.

    Args:
        folder: Where to.
        record: Of the fit.
        curve: Both curves.
    """
    with style(), in_units(record.units):
        return [
            _curves(folder / "fit.png", record, curve),
            _residual(folder / "residual.png", record, curve),
        ]


def _abscissa(record: FitRecord, curve: FittedCurve) -> tuple[str, Array]:
    """Return the abscissa of a curve: its only one, else the number of the row."""
    if len(curve.over) > 1:
        return "row of the data", np.arange(1, record.rows + 1, dtype=np.float64)
    ((name, values),) = curve.over.items()
    if name == TIME:
        return "time", values
    unit = unit_of_key(name, record.units) or unit_of(measured_as(name))
    words = name if "." in name and not measured_as(name) else in_words(name)
    return plain(f"{words} ({unit})" if unit else words), values


def _curves(path: Path, record: FitRecord, curve: FittedCurve) -> Picture:
    figure, (panel,) = new_figure("", (WIDE, 3.0))
    name, x = _abscissa(record, curve)
    panel.plot(x, curve.run, "-", color=COLOURS["STICK"], label="run", zorder=2)
    _data(panel, x, curve.measured, curve, "measured")
    panel.set_xlabel(name)
    words = in_words(record.quantity)
    panel.set_ylabel(plain(labelled(words, measured_as(record.quantity))))
    legend_beside(panel)
    save(figure, path)
    return Picture(
        path,
        "Measured curve and run",
        f"The {words} that was measured, and that of the run with the values found.",
    )


def _residual(path: Path, record: FitRecord, curve: FittedCurve) -> Picture:
    figure, (panel,) = new_figure("", (WIDE, 2.2))
    name, x = _abscissa(record, curve)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    _data(panel, x, curve.residual, curve, "run less data")
    panel.set_xlabel(name)
    panel.set_ylabel(plain(labelled("residual", measured_as(record.quantity))))
    save(figure, path)
    bars = "" if curve.uncertainties is None else " Bars are the standard uncertainties."
    return Picture(
        path,
        "Residual",
        "The run less the data. Without an order it is noise; with one, the model lacks "
        f"something.{bars}",
    )


def _data(panel: Axes, x: Array, y: Array, curve: FittedCurve, label: str) -> None:
    """Rows of the data as points, with their uncertainties if these are known."""
    look = {"color": COLOURS["SLIP"], "markersize": 3.0, "elinewidth": 0.6, "zorder": 3}
    panel.errorbar(x, y, yerr=curve.uncertainties, fmt="o", label=label, **look)
