"""Pressure and friction of a contact in 3D beside their formulas."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.contacts.curves import formula_words
from fenics_contact.report.drawing.figures import legend_in_headroom, new_figure, save, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLUMN, DOUBLE, FORMULA, marks
from fenics_contact.report.drawing.units import labelled
from fenics_contact.report.formulas.recognition import AnalyticContact
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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
