"""Stresses below the surface near a contact: contours of the largest shear, in 3D on a cut."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.cells import contact_pieces
from fenics_contact.report.drawing.charts import Cylinder, chart_of
from fenics_contact.report.drawing.fields import Triangles, largest_shear
from fenics_contact.report.drawing.figures import new_figure, save, surface_of
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOUR_MAP, WIDE, labelled, neighbourhood, with_unit
from fenics_contact.report.recognition import AnalyticContact
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

_LEVELS = 12
_SINGULAR = 1.3  # a peak this many times the 99th percentile is a corner's, not the contact's
_OFF = 1e-3  # of the zone: how far from a plane of symmetry a cut is made
_FACING = 0.8  # of the mean normal along an axis
_HEIGHTS = (1.8, 4.2)


@dataclass(frozen=True)
class Section:
    """A flat piece of the body around a contact zone.

    Attributes:
        axes: Numbers of the two axes that it lies in.
        across: The coordinate of the third (length); None of flat models.
        triangles: With the field ``shear``.
        low: Lowest coordinates shown, (2,) (length).
        high: Highest, (2,).
        contact: Ends of the lines along which the surfaces touch, (lines, 2, 2) (length).
    """

    axes: tuple[int, int]
    across: float | None
    triangles: Triangles
    low: Array
    high: Array
    contact: Array

    @property
    def peak(self) -> tuple[float, Array]:
        """The largest shear stress, and where it is, (2,)."""
        points = self.triangles.points[:, list(self.axes)]
        inside = ((points >= self.low) & (points <= self.high)).all(axis=1)
        number = int(np.argmax(np.where(inside, self.triangles.fields["shear"], -1.0)))
        size = float((self.high - self.low).max())
        place = np.where(np.abs(points[number]) < 1e-9 * size, 0.0, points[number])
        return float(self.triangles.fields["shear"][number]), place


def section_at(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord, flat: bool
) -> Section | None:
    """The neighbourhood of the closed points of a contact, in 3D where the friction acts along.

    Args:
        body: A pyvista grid with the field ``stress``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
        flat: Whether the model is.

    Returns:
        None where nothing touches, or a surface in 3D faces several ways and is no cylinder along
        an axis.
    """
    if not rows.closed.any():
        return None
    points, surface = rows.vectors("x", "y", "z"), contact_pieces(body, rows, contact)
    if flat:
        axes, place, cut = (0, 1), None, body
        touching = surface.rows.vectors("x", "y")[surface.pieces[surface.closed]]
    else:
        plane = _plane(rows)
        if plane is None:
            return None
        axes, place = plane
        third = 3 - sum(axes)
        origin = np.zeros(3)
        origin[third] = place
        cut = body.slice(normal=np.eye(3)[third], origin=origin)
        touching = surface.cut(third, place)[:, :, list(axes)]
    if cut.n_cells == 0:
        return None
    cut = cut.copy(deep=False)
    cut["shear"] = largest_shear(np.asarray(cut["stress"]))
    triangles = Triangles.of(cut, "shear")
    low, high = neighbourhood(points[:, list(axes)], rows.closed)
    bounds = triangles.points[:, list(axes)]
    low, high = np.maximum(low, bounds.min(axis=0)), np.minimum(high, bounds.max(axis=0))
    return Section(axes, place, triangles, low, high, touching)


def _plane(rows: ContactTable) -> tuple[tuple[int, int], float] | None:
    """The axes of a cut, and where it crosses the third: in the middle of the contact zone."""
    chart = chart_of(rows)
    if isinstance(chart, Cylinder) and chart.axis.max() == 1:  # across it
        third = int(np.argmax(chart.axis))
        along, normal = (axis for axis in range(3) if axis != third)
        return (along, normal), _middle(rows, third)
    mean = rows.vectors("nx", "ny", "nz")[rows.closed].mean(axis=0)
    normal = int(np.argmax(np.abs(mean)))
    if abs(mean[normal]) < _FACING:
        return None
    tangential = [axis for axis in range(3) if axis != normal]
    friction = rows.vectors("traction_x", "traction_y", "traction_z").sum(axis=0)
    along = max(tangential, key=lambda axis: abs(friction[axis]))
    (third,) = {0, 1, 2} - {normal, along}
    return (along, normal), _middle(rows, third)


def _middle(rows: ContactTable, third: int) -> float:
    """Return the middle of the contact zone along an axis; at a plane of symmetry, next to it."""
    place = rows.numbers["xyz"[third]]
    closed = place[rows.closed]
    low, high, size = closed.min(), closed.max(), max(np.ptp(closed), _OFF * np.ptp(place))
    at_low, at_high = (
        abs(end - edge) < 0.02 * size for end, edge in ((low, place.min()), (high, place.max()))
    )
    middle = (low + high) / 2
    if at_low and not at_high:  # half of a zone that a plane of symmetry cuts
        middle = low + _OFF * size
    elif at_high and not at_low:
        middle = high - _OFF * size
    return float(middle)


def draw_section(
    body: UnstructuredGrid,
    result: Outcome,
    rows: ContactTable,
    contact: ContactRecord,
    path: Path,
    analytic: AnalyticContact | None = None,
) -> Picture | None:
    """Draw contours of the largest shear stress near a contact, with its maximum.

    Args:
        body: A pyvista grid with the field ``stress``.
        result: The content of its ``result.json``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
        path: PNG file to write.
        analytic: What formulas give, where there are some.

    Returns:
        None where there is nothing to show.
    """
    flat = result.model.kinematics != "3D"
    section = section_at(body, rows, contact, flat)
    if section is None:
        return None
    value, place = section.peak
    shear = section.triangles.fields["shear"]
    points = section.triangles.points[:, list(section.axes)]
    inside = ((points >= section.low) & (points <= section.high)).all(axis=1)
    high = float(np.percentile(shear[inside], 99))
    capped = value > _SINGULAR * high
    high = high if capped else value
    if high <= 0:
        return None
    across, up = section.high - section.low
    height = float(np.clip(0.8 * WIDE * up / across, *_HEIGHTS))
    title = f"Stress near {surface_of(contact)}"
    figure, (panel,) = new_figure(title, (WIDE, height + 0.45))
    from matplotlib.collections import LineCollection
    from matplotlib.ticker import MaxNLocator

    levels = MaxNLocator(_LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(0, high)
    levels = levels[np.asarray(levels) < (1 if capped else 1.2) * high]
    extend = "max" if levels[-1] < value else "neither"
    mesh = (*points.T, section.triangles.corners)
    look = {"levels": levels, "extend": extend}
    colours = panel.tricontourf(*mesh, shear, cmap=COLOUR_MAP, **look)
    panel.tricontour(*mesh, shear, levels=levels, colors="white", linewidths=0.3, alpha=0.7)
    label = labelled(r"largest shear stress, $\tau_{max}$", "stress")
    figure.colorbar(colours, ax=panel, label=label, shrink=0.85, aspect=28, pad=0.02)
    lines = LineCollection(
        list(section.contact), colors="black", linewidths=2.2, capstyle="round", zorder=4
    )
    panel.add_collection(lines)
    letters = "rz" if result.model.kinematics == "axisymmetric" else "xyz"
    _mark(panel, section, value, place, letters)
    panel.set_aspect("equal")
    panel.set_xlim(section.low[0], section.high[0])
    panel.set_ylim(section.low[1], section.high[1])
    panel.set_xlabel(labelled(f"${letters[section.axes[0]]}$", "length"))
    panel.set_ylabel(labelled(f"${letters[section.axes[1]]}$", "length"))
    save(figure, path)
    return Picture(path, title, _caption(section, value, place, letters, analytic, rows))


def _mark(panel: Axes, section: Section, value: float, place: Array, letters: str) -> None:
    """A cross at the maximum, with its value beside it."""
    panel.plot(
        *place, "+", color="white", markersize=9, markeredgewidth=2.6, clip_on=False, zorder=5
    )
    panel.plot(
        *place, "+", color="black", markersize=8, markeredgewidth=1.2, clip_on=False, zorder=6
    )
    middle = (section.low + section.high) / 2
    aside = place[0] > middle[0]
    lower = place[1] > middle[1]
    panel.annotate(
        with_unit(f"max {value:.4g}", "stress"),
        place,
        xytext=(-8 if aside else 8, -9 if lower else 9),
        textcoords="offset points",
        ha="right" if aside else "left",
        va="center",
        bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "alpha": 0.85, "linewidth": 0},
        zorder=7,
    )


def _caption(
    section: Section,
    value: float,
    place: Array,
    letters: str,
    analytic: AnalyticContact | None,
    rows: ContactTable,
) -> str:
    at = ", ".join(
        f"{letters[a]} = {with_unit(x, 'length')}"
        for a, x in zip(section.axes, place.tolist(), strict=True)
    )
    said = "Largest shear stress τ_max = (σ₁ − σ₃)/2 in the undeformed body; "
    said += f"it has its maximum {with_unit(value, 'stress')} at {at}"
    if section.across is not None:
        third = 3 - sum(section.axes)
        said += f", of the plane {letters[third]} = {with_unit(section.across, 'length')}"
    said += "."
    if analytic is not None and analytic.smooth and not analytic.punch:
        depth = np.linspace(0, 2 * analytic.hertz.radius, 2001)
        shear = analytic.axis_shear(depth)
        most = int(np.argmax(shear))
        where = "below the middle" if analytic.line else "on the axis"
        largest = with_unit(float(shear[most]), "stress")
        below = with_unit(float(depth[most]), "length")
        said += f" {analytic.label}: {largest} {where}, at the depth {below}."
    return said + " Thick lines: where the surfaces touch."
