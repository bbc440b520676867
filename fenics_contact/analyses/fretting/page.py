"""Fretting on the page of a run: words, and criteria of fatigue drawn along and below contacts."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.analyses.fretting.words import fretting_rows
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.contacts.map_values import MapValues, Surface
from fenics_contact.report.contacts.maps import draw_map, finish_maps, map_figure
from fenics_contact.report.drawing.cells import TRIANGLES, cells_of
from fenics_contact.report.drawing.figures import legend_in_headroom, new_figure, save, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOUR_MAP,
    COLOURS,
    DOUBLE,
    LINES,
    labelled,
    neighbourhood,
)
from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid


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


# What is drawn: its column, its name (SWT: Smith, Watson and Topper), and its sign.
CRITERIA = (
    ("swt", "SWT", r"$\sigma_n \Delta\epsilon_n/2$"),
    ("crossland", "Crossland", r"$\sqrt{J_2} + \alpha p$"),
    ("dang_van", "Dang Van", r"$\tau + \alpha p$"),
)
_ROW, _MARGIN = 1.7, 0.5
_BAND = {"color": LINES[0][0], "linewidth": 0.6, "linestyle": ":"}
_SAME_PLACE = 1e-6  # of the extent: nodes at the same place


def draw_fretting(
    body: UnstructuredGrid,
    contacts: Sequence[tuple[ContactTable, ContactRecord]],
    table: FrettingTable,
    axes: str,
    folder: Path,
) -> list[Picture]:
    """Draw ``fretting_NUMBER.png`` of each contact that something lies near, with PDFs.

    Args:
        body: A pyvista grid with the fields of the last step.
        contacts: Points and entries in ``result.json`` of the contacts.
        table: The criteria.
        axes: Letters of the model's axes.
        folder: Where to.
    """
    found = []
    for number, (rows, contact) in enumerate(contacts):
        if table.on(contact.name).any() and rows.closed.any():
            path = folder / f"fretting_{number}.png"
            flat = bool(cells_of(body)[0].whole)
            draw = _draw_flat if flat else _draw_in_space
            found.append(draw(body, rows, contact, table, axes, path))
    return found


def _draw_flat(
    body: UnstructuredGrid,
    rows: ContactTable,
    contact: ContactRecord,
    table: FrettingTable,
    axes: str,
    path: Path,
) -> Picture:
    """Draw each criterion as a curve along the surface, and as a map below it."""
    line = SurfaceLine.of(body, rows, contact)
    drawn = [one for one in CRITERIA if one[0] in table.values]
    place_of_node = _matched(np.asarray(body.points), table.points)
    place_of_point = _matched(line.rows.vectors("x", "y", "z"), table.points)
    triangles = _triangles(body)
    triangles = triangles[(place_of_node[triangles] >= 0).all(axis=1)]
    figure, panels = new_figure(
        f"Fretting at {surface_of(contact)}", (DOUBLE, _ROW * len(drawn) + _MARGIN),
        nrows=len(drawn), ncols=2, sharex="col",
    )  # fmt: skip
    for (name, words, letters), (left, right) in zip(drawn, _pairs(panels), strict=True):
        values = table.values[name]
        _draw_curve(left, line, values, table.values[f"{name}_error"], place_of_point)
        left.set_ylabel(labelled(f"{words},\n{letters}", "stress"))
        _draw_map(figure, right, body, triangles, values[place_of_node])
        right.set_ylabel(labelled(f"${axes[1]}$", "length"))
    legend_in_headroom(panels[0], 3)
    line.label(panels[-2], axes)
    panels[-1].set_xlabel(labelled(f"${axes[0]}$", "length"))
    _show_same(panels, rows, table)
    figure.align_ylabels(panels[::2])
    save(figure, path)
    said = (
        f"On the left criteria of fatigue along {surface_of(contact)}, by the stress over the last "
        "cycle, with what the recovery of the stress leaves open as dots, and what sticks and "
        "slips at the end; on the right the same in the body, its largest value marked."
    )
    return Picture(path, "Fretting", said)


def _draw_curve(
    panel: Axes, line: SurfaceLine, values: Array, bars: Array, places: Integers
) -> None:
    """A criterion along the surface with its bar, above what sticks and slips."""
    shown = places >= 0
    at_points, off = values[places], np.nan_to_num(bars[places])
    for sign, look in ((0, {"color": LINES[0][0]}), (-1, _BAND), (1, _BAND)):
        panel.plot(*line.curve(at_points + sign * off, shown), **look)
    seen = set()
    for begin, end, status in line.runs():
        if status in ("STICK", "SLIP"):
            label = None if status in seen else status.lower()
            look = {"color": COLOURS[status], "alpha": 0.25, "linewidth": 0}
            panel.axvspan(begin, end, label=label, zorder=0, **look)
            seen.add(status)
    low, high = (float(f(at_points[shown], initial=0.0)) for f in (np.nanmin, np.nanmax))
    panel.set_ylim(1.1 * low, 1.15 * high if high > low else low + 1.0)
    panel.axhline(0, color="black", linewidth=0.5, zorder=0)


def _draw_map(
    figure: Figure, panel: Axes, body: UnstructuredGrid, triangles: Integers, values: Array
) -> None:
    """A criterion in the body, with a cross where it is largest."""
    points = np.asarray(body.points)[:, :2]
    look = {"shading": "gouraud", "cmap": COLOUR_MAP, "rasterized": True}
    colours = panel.tripcolor(*points.T, triangles, values, **look)
    used = np.unique(triangles)
    worst = points[used[np.argmax(values[used])]]
    for colour, width in (("white", 2.6), ("black", 1.2)):
        panel.plot(*worst, "+", color=colour, markersize=8, markeredgewidth=width, clip_on=False)
    figure.colorbar(colours, ax=panel, aspect=14, pad=0.02)
    panel.set_aspect("equal")


def _show_same(panels: Sequence[Axes], rows: ContactTable, table: FrettingTable) -> None:
    """The neighbourhood of the contact, as far as there are places in it."""
    low, high = neighbourhood(rows.vectors("x", "y"), rows.closed)
    points = table.points[:, :2]
    inside = ((points >= low) & (points <= high)).all(axis=1)
    if inside.any():
        low, high = points[inside].min(axis=0), points[inside].max(axis=0)
    for left, right in _pairs(panels):
        right.set_xlim(low[0], high[0])
        right.set_ylim(low[1], high[1])
        left.margins(x=0)


def _draw_in_space(
    body: UnstructuredGrid,
    rows: ContactTable,
    contact: ContactRecord,
    table: FrettingTable,
    axes: str,
    path: Path,
) -> Picture:
    """Draw each criterion as a map of the surface."""
    surface = Surface.of(body, rows, contact)
    drawn = [one for one in CRITERIA if one[0] in table.values]
    places = _matched(surface.rows.vectors("x", "y", "z"), table.points)
    kept = (places[surface.triangles] >= 0).all(axis=1)
    surface = replace(surface, triangles=surface.triangles[kept], corners=surface.corners[kept])
    # As many panels as criteria: that of the status, which comes first, is one of them.
    every = [
        MapValues(
            name,
            labelled(f"{words}, {letters}", "stress"),
            np.where(places >= 0, table.values[name][places], np.nan),
        )
        for name, words, letters in drawn
    ]
    figure, panels = map_figure(surface, every[1:])
    for panel, found in zip(panels, every, strict=True):
        draw_map(figure, panel, surface, found, (0.0, float(np.nanmax(found.values, initial=0.0))))
    finish_maps(figure, panels, surface, contact)
    save(figure, path, tight=True)
    said = f"Criteria of fatigue on {surface_of(contact)}, by the stress over the last cycle."
    return Picture(path, "Fretting", f"{said} {surface.chart.words}".strip())


def _pairs(panels: Sequence[Axes]) -> list[tuple[Axes, Axes]]:
    """The two panels of each row."""
    return list(zip(panels[::2], panels[1::2], strict=True))


def _matched(points: Array, places: Array) -> Integers:
    """Number of the place at each point, −1 where there is none."""
    if len(places) == 0:
        return np.full(len(points), -1)
    size = float(np.ptp(points, axis=0).max())
    distance, found = cKDTree(places).query(points)
    return np.where(distance <= _SAME_PLACE * size, found, -1)


def _triangles(body: UnstructuredGrid) -> Integers:
    """Return the triangles between all nodes of a flat grid, (triangles, 3)."""
    cell, cells = cells_of(body)
    corners = cells[:, list(cell.whole)][:, TRIANGLES[len(cell.whole)]]
    return np.asarray(corners.reshape(-1, 3))


@dataclass(frozen=True)
class FrettingTable:
    """Criteria at the nodes near contacts.

    Attributes:
        contact: Name of the contact on whose surface each lies; empty elsewhere.
        points: Undeformed, (places, 3) (length).
        values: Column → values, those that are missing not a number.
    """

    contact: list[str]
    points: Array
    values: dict[str, Array]

    @classmethod
    def read(cls, path: Path) -> FrettingTable | None:
        """Return the places of a run; None where it looked for no fretting.

        Raises:
            InputError: The file is damaged.
        """
        if not path.exists():
            return None
        try:
            with path.open(encoding="utf-8", newline="") as file:
                rows = list(csv.DictReader(file))
            names = list(rows[0]) if rows else []
            columns = {
                name: np.array([float(row[name] or "nan") for row in rows])
                for name in names
                if name not in ("body", "contact")
            }
            points = np.zeros((0, 3))
            if rows:
                points = np.stack([columns.pop(axis) for axis in "xyz"], axis=1)
            return cls([row["contact"] for row in rows], points, columns)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path}: damaged: {error}; make the run again") from None

    def on(self, contact: str) -> Flags:
        """Return whether each place lies on the surface of a contact, (places,)."""
        return np.array([name == contact for name in self.contact], dtype=bool)
