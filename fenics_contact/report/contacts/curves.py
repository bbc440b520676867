"""Curves of contacts: along lines of plane models (Fig. 2), and against formulas in 3D."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.contacts.line import (
    BOUND,
    FRICTION,
    GAP,
    PRESSURE,
    LineValues,
    SurfaceLine,
    line_values,
)
from fenics_contact.report.drawing.figures import (
    in_words,
    legend_beside,
    legend_in_headroom,
    new_figure,
    save,
    surface_of,
    title_of,
)
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLUMN,
    DOUBLE,
    FORMULA,
    WIDE,
    labelled,
    marks,
    with_unit,
)
from fenics_contact.report.recognition import AnalyticContact
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from pyvista import UnstructuredGrid

_MARGIN, _STRIP = 0.45, 0.16
_HEIGHTS = {PRESSURE: 1.9, FRICTION: 1.9, GAP: 1.05}
_OWN_HEIGHT = 1.05  # of what a law keeps of its own
_SYMBOLS = {PRESSURE: " p", FRICTION: " σ_T"}
_POINTS = 400  # of a formula's curve


def draw_curves(
    body: UnstructuredGrid,
    rows: ContactTable,
    contact: ContactRecord,
    axes: str,
    path: Path,
    analytic: AnalyticContact | None = None,
) -> Picture:
    """Draw what happens along a contact line.

    Args:
        body: A pyvista grid with its fields.
        rows: Its points.
        contact: The contact's entry in ``result.json``.
        axes: Letters of the model's axes.
        path: PNG file to write.
        analytic: What formulas give, where there are some.
    """
    line = SurfaceLine.of(body, rows, contact)
    every = line_values(line, contact)
    names = [found.name for found in every]
    title = title_of(names, contact)
    figure, panels = curve_figure(names, contact)
    shown = np.linspace(*line.view, _POINTS)
    for found, panel in zip(every, panels, strict=False):
        _draw_values(panel, line, found)
        if analytic is not None and line.circle is None:
            _formula(panel, found.name, line, analytic, shown)
    draw_strip(panels[-1], line, contact)
    finish_curves(figure, panels, line, axes)
    save(figure, path)
    against = axes[line.axis] if line.circle is None else "the angle around its axis"
    return Picture(path, title, _caption(names, contact, against, analytic))


def curve_figure(names: Sequence[str], contact: ContactRecord) -> tuple[Figure, list[Axes]]:
    """A panel for each of some values, and the strip of the status.

    Args:
        names: Of the values.
        contact: The contact's entry in ``result.json``.
    """
    heights = [*(_HEIGHTS.get(name, _OWN_HEIGHT) for name in names), _STRIP]
    return new_figure(
        f"Along {surface_of(contact)}",
        (WIDE, sum(heights) + _MARGIN),
        nrows=len(heights),
        sharex=True,
        height_ratios=heights,
    )


def finish_curves(figure: Figure, panels: Sequence[Axes], line: SurfaceLine, axes: str) -> None:
    """Legends, the axis along the surface, and how far one sees.

    Args:
        figure: Matplotlib's.
        panels: All of them; the last one is the strip.
        line: The contact line.
        axes: Letters of the model's axes.
    """
    for panel in panels[:-1]:
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    _legends(panels[:-1])
    low, high = line.view
    margin = 0.03 * (high - low)
    panels[-1].set_xlim(low - margin, high + margin)
    line.label(panels[-1], axes)
    figure.align_ylabels(panels[:-1])


def _caption(
    names: list[str], contact: ContactRecord, axis: str, analytic: AnalyticContact | None
) -> str:
    what = in_words([f"{name}{_SYMBOLS.get(name, '')}" for name in names])
    said = f"{what[0].upper()}{what[1:]} along the surface {surface_of(contact)} against {axis}."
    status = "in contact and open" if not contact.carries_shear else "that stick, slip and are open"
    said += f" The strip below shows the parts {status}."
    if analytic is not None:
        said += f" Black lines: {formula_words(analytic)}."
    return said


def formula_words(analytic: AnalyticContact) -> str:
    """Return the name of the formulas, with the size of the contact."""
    size = "half-width" if analytic.line else "radius"
    radius, peak = analytic.hertz.radius, analytic.hertz.peak
    words = f"{analytic.label}, for the force that was found "
    words += f"({size} a = {with_unit(radius, 'length')}"
    words += "" if analytic.punch else f", peak p₀ = {with_unit(peak, 'stress')}"
    if analytic.stick:
        words += f"; Cattaneo and Mindlin: sticks up to c = {with_unit(analytic.stick, 'length')}"
    return words + ")"


def draw_strip(panel: Axes, line: SurfaceLine, contact: ContactRecord) -> None:
    """A strip in the colours of the status along the surface."""
    colours = {status: mark.colour for mark in line.marks for status in mark.status}
    for start, end, status in line.runs():
        panel.axvspan(start, end, color=colours[status], linewidth=0)
    bare_strip(panel)


def bare_strip(panel: Axes) -> None:
    """A strip without numbers and a line beside it."""
    panel.set_yticks([])
    panel.spines["left"].set_visible(False)


def _legends(panels: Sequence[Axes]) -> None:
    """Each label once, in the first panel that has it."""
    said: set[str] = set()
    for panel in panels:
        entries = dict(zip(*reversed(panel.get_legend_handles_labels()), strict=True))
        new = {label: handle for label, handle in entries.items() if label not in said}
        if new:
            legend_beside(panel, handles=list(new.values()), labels=list(new))
        said |= set(new)


def _draw_values(panel: Axes, line: SurfaceLine, found: LineValues) -> None:
    """A panel's curves, with their axis named."""
    _plot(panel, line, found.values)
    if found.is_peaked:
        cut_peaks(panel, found.values[line.rows.closed])
    panel.set_ylabel(found.label)
    for number, bound in enumerate(found.bounds):
        words = BOUND if number == 0 else None
        panel.plot(*line.curve(bound), ":", color="0.3", label=words, zorder=1)


def _formula(
    panel: Axes, name: str, line: SurfaceLine, analytic: AnalyticContact, shown: Array
) -> None:
    """The formula's curve; it leaves the panel's limits as they are where it is infinite."""
    distance = np.abs(shown - analytic.centre[line.axis])
    limits = panel.get_ylim() if analytic.punch else None
    if name == PRESSURE:
        panel.plot(shown, analytic.pressure(distance), label=analytic.label, **FORMULA)
    elif name == FRICTION and analytic.direction == line.axis:
        friction = analytic.friction(distance)
        panel.plot(shown, friction, "--", label="Cattaneo, Mindlin", **FORMULA)
    if limits:
        panel.set_ylim(limits)


def _plot(panel: Axes, line: SurfaceLine, values: Array) -> None:
    """Values at the points shown, marked by their kind."""
    shown = (line.position >= line.view[0]) & (line.position <= line.view[1])
    panel.plot(*line.curve(values, shown), color="0.6", linewidth=0.7, zorder=1)
    size = 3.5 if shown.sum() < 60 else 2.5
    for mark in line.marks:
        mine = np.isin(line.rows.status, mark.status) & shown
        if mine.any():
            panel.plot(line.position[mine], values[mine], markersize=size, zorder=2, **mark.look)


def cut_peaks(panel: Axes, values: Array) -> None:
    """Cut off what a few points have alone, such as those at the edge of a punch, and say so."""
    most = float(np.percentile(np.abs(values), 90)) if len(values) else 0.0
    if np.abs(values).max(initial=0.0) <= 4 * most:
        return
    low, high = np.clip([values.min(), values.max()], -2 * most, 2 * most)
    panel.set_ylim(min(low, 0) - 0.1 * most, max(high, 0) + 0.1 * most)
    beyond = [f"{value:.3g}" for value in (values.min(), values.max()) if abs(value) > 2 * most]
    text = f"peaks cut off ({', '.join(beyond)})"
    height = 0.97 if values.max() > 0 else 0.88  # below the line at 0
    panel.text(0.5, height, text, transform=panel.transAxes, ha="center", va="top", fontsize=7)


_REACH = 1.4  # what is shown, in radii of the formula's contact


def draw_profile(
    rows: ContactTable, contact: ContactRecord, analytic: AnalyticContact, path: Path
) -> Picture:
    """Draw a point contact's pressure and friction against the distance from its middle.

    Args:
        rows: Its points.
        contact: Its entry in ``result.json``.
        analytic: What formulas give.
        path: PNG file to write.
    """
    distance = np.linalg.norm(rows.vectors("x", "y", "z") - analytic.centre, axis=1)
    near = distance <= _REACH * analytic.hertz.radius
    rows, distance = rows.rows(near), distance[near]
    sheared = analytic.direction is not None
    figure, panels = new_figure(
        f"Beside the formulas, {surface_of(contact)}",
        (DOUBLE if sheared else COLUMN + 0.6, 2.8),
        ncols=2 if sheared else 1,
    )
    shown = np.linspace(0, _REACH * analytic.hertz.radius, 400)
    _points(panels[0], distance, rows.numbers["contact_pressure"], rows, contact)
    panels[0].plot(shown, analytic.pressure(shown), label=analytic.label, **FORMULA)
    panels[0].set_ylabel(labelled("contact pressure, $p$", "stress"))
    said = "Contact pressure p"
    if sheared:
        axis = "xyz"[analytic.direction or 0]
        _points(panels[1], distance, rows.numbers[f"traction_{axis}"], rows, contact)
        formula = analytic.friction(shown)
        panels[1].plot(shown, formula, label="Cattaneo, Mindlin", **FORMULA)
        panels[1].set_ylabel(labelled(rf"friction traction, $\sigma_{{T{axis}}}$", "stress"))
        said += f" and friction traction σ_T along {axis}"
    for panel in panels:
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
        panel.set_xlabel(labelled("distance from the middle, $r$", "length"))
        panel.set_xlim(left=0)
        legend_in_headroom(panel, 4)
    save(figure, path)
    caption = (
        f"{said} at all points of {surface_of(contact)} against their distance r from the middle. "
        f"Lines: {formula_words(analytic)}."
    )
    return Picture(path, "Beside the formulas", caption)


def _points(
    panel: Axes, distance: Array, values: Array, rows: ContactTable, contact: ContactRecord
) -> None:
    for mark in marks(contact):
        mine = np.isin(rows.status, mark.status)
        if mine.any():
            panel.plot(distance[mine], values[mine], **mark.look | {"markersize": 2.5})
