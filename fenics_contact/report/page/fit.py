"""``fit.html``: the page of a fit, in one file: both curves, their difference, and intervals."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import one_line
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, measured_by
from fenics_contact.report.drawing.figures import legend_beside, new_figure, plain, save, style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOURS,
    WIDE,
    in_units,
    labelled,
    unit_of,
    with_unit,
)
from fenics_contact.report.gallery import require
from fenics_contact.report.page.sweep_columns import unit_of_key
from fenics_contact.report.page.templates import render, style_sheet, table
from fenics_contact.results.fit_record import CURVE, PAGE, RECORD, FitRecord
from fenics_contact.results.rounding import bar_in_words, rounded
from fenics_contact.scene.quantity_names import in_words
from fenics_contact.scene.values import AXES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_UNCERTAINTY = "_error"


@dataclass(frozen=True, eq=False)
class FittedCurve:
    """The content of ``fit.csv``.

    Attributes:
        over: Name of what the curve is over → its values, (rows,).
        measured: (rows,).
        uncertainties: Standard uncertainties, (rows,); None where they are not known.
        run: Of the run with the values found, (rows,).
    """

    over: dict[str, Array]
    measured: Array
    uncertainties: Array | None
    run: Array

    @property
    def residual(self) -> Array:
        """Difference of the run and the data, (rows,)."""
        return np.asarray(self.run - self.measured)


def read_fit(folder: Path) -> tuple[FitRecord, FittedCurve]:
    """Read the files of a fit from its folder.

    Args:
        folder: With ``fit.json`` and ``fit.csv``.

    Raises:
        InputError: A file is missing or damaged, or they are of different fits.
    """
    path = folder / RECORD
    try:
        reader: TypeAdapter[FitRecord] = TypeAdapter(FitRecord)
        record = reader.validate_python(json.loads(path.read_text(encoding="utf-8")))
        path = folder / CURVE
        return record, _curve(path, record)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        said = f"{'.'.join(map(str, first['loc'])) or 'the whole'}: {first['msg']}"
        raise InputError(f"{path}: damaged: {said}; fit again") from None
    except (ValueError, KeyError, RecursionError, csv.Error) as error:
        raise InputError(f"{path}: damaged: {error}; fit again") from None


def _curve(path: Path, record: FitRecord) -> FittedCurve:
    """The table, whose columns and rows the record says.

    Raises:
        ValueError: They are others.
    """
    with path.open(newline="", encoding="utf-8") as file:
        head, *rows = list(csv.reader(file)) or [[]]
    known = record.quantity + _UNCERTAINTY in head
    bars = [record.quantity + _UNCERTAINTY] if known else []
    if head != [*record.over, record.quantity, *bars, "run", "residual"]:
        raise ValueError(f"its first line is not that of a fit of {record.quantity}")
    if len(rows) != record.rows:
        raise ValueError(f"it has {len(rows)} rows, but the fit has {record.rows}")
    columns = dict(zip(head, np.array(rows, dtype=np.float64).T, strict=True))
    return FittedCurve(
        over={name: columns[name] for name in record.over},
        measured=columns[record.quantity],
        uncertainties=columns[bars[0]] if known else None,
        run=columns["run"],
    )


TIME = "time"


def measured_as(name: str) -> str:
    """Return the dimension of a quantity by its name; empty for others.

    >>> measured_as("top.friction_force_x"), measured_as("time")
    ('force', '')
    """
    owner, _, quantity = name.rpartition(".")
    if quantity[-2:-1] == "_" and quantity[-1] in AXES:
        quantity = quantity[:-2]
    if owner and quantity in MEASURED_BY_PRELOADS:
        return MEASURED_BY_PRELOADS[quantity]
    return measured_by(quantity)


def interval_in_words(record: FitRecord, key: str) -> str:
    """A value and its interval, such as ``0.299, 95 %: 0.295 to 0.303``."""
    found, unit = record.parameters[key], unit_of_key(key, record.units)
    unit = f" {unit}" if unit else ""
    if found.low is None or found.high is None:
        return f"{found.value:.6g}{unit}, not determined by the data"
    half = max(found.high - found.value, found.value - found.low)
    value = rounded(found.value, {"total": half})[0]
    ends = [rounded(end, {"total": half / 10})[0] for end in (found.low, found.high)]
    return f"{value}{unit}, {record.confidence:.0%}: {ends[0]} to {ends[1]}{unit}"


def parameter_rows(record: FitRecord) -> list[list[str]]:
    """A row a parameter, after one of heads."""
    head = ["parameter", "value and interval", "by the noise", "by mesh, ε₁ and ε", "start"]
    rows = [
        [
            key,
            interval_in_words(record, key),
            _part(one.noise),
            _part(one.discretisation),
            f"{one.start:.6g}",
        ]
        for key, one in record.parameters.items()
    ]
    return [head, *rows]


def _part(half: float | None) -> str:
    words = bar_in_words(half)
    return words if half is None else f"± {words}"


def correlation_rows(record: FitRecord) -> list[list[str]]:
    """A row a parameter, after one of heads."""
    keys = list(record.parameters)
    rows = zip(keys, record.correlations, strict=True)
    return [["", *keys], *([key, *(f"{one:.3f}" for one in row)] for key, row in rows)]


def draw_fit(folder: Path, record: FitRecord, curve: FittedCurve) -> list[Picture]:
    """Draw ``fit.png`` and ``residual.png``, each with a PDF of its name."""
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
