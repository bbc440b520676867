"""Curves of flat models: stresses on the axis (Fig. 9), displacements of surfaces (Fig. 12)."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.quantities.names import CONTACT_AREA, MAX_CONTACT_PRESSURE, PRESSURE_INTEGRAL
from fenics_contact.report.contacts.curves import draw_strip, formula_words
from fenics_contact.report.contacts.line import SurfaceLine
from fenics_contact.report.drawing.cells import nodes_at
from fenics_contact.report.drawing.figures import (
    in_words,
    legend_beside,
    new_figure,
    save,
    set_title,
    surface_of,
)
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLOURS, COLUMN, FORMULA, LINES, WIDE, labelled
from fenics_contact.report.recognition import AnalyticContact
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.record import Quantities

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

_LEGEND = 1.5  # its width in inches
_DEPTH = 3.0  # what is shown, in contact radii
_SINGULAR = 3.0  # a peak this many times the mean pressure says nothing: Hertz has 1.5


@dataclass(frozen=True)
class AxisStress:
    """Stresses at the nodes on the axis, the highest first.

    Attributes:
        depth: Below the surface (length), (nodes,).
        axial: σ_zz (stress).
        radial: σ_rr, on the axis also σ_θθ (stress).
    """

    depth: Array
    axial: Array
    radial: Array

    @classmethod
    def of(cls, body: UnstructuredGrid, rows: ContactTable) -> AxisStress | None:
        """None where the body has no axis, or the contact does not lie across it.

        Args:
            body: A pyvista grid with the field ``stress``; it may hold a body opposite, too.
            rows: Points of the contact, which say on which side the surface is.
        """
        points = np.asarray(body.points)
        on_axis = points[:, 0] < 1e-9 * np.ptp(points, axis=0).max()
        up = float(rows.numbers["ny"].mean())
        if on_axis.sum() < 3 or abs(up) < 0.5:
            return None
        heights = np.sign(up) * points[:, 1]
        nearest = np.sign(up) * rows.numbers["y"][np.argmin(rows.numbers["x"])]
        surface = heights[on_axis][np.argmin(np.abs(heights[on_axis] - nearest))]
        on_axis &= _below(body, heights, surface, on_axis)
        depth, first = np.unique(surface - heights[on_axis], return_index=True)
        stress = np.asarray(body["stress"]).reshape(-1, 3, 3)[on_axis][first]
        return cls(depth, stress[:, 1, 1], (stress[:, 0, 0] + stress[:, 2, 2]) / 2)

    @property
    def shear(self) -> Array:
        """Principal shear stress, half the difference of the principal stresses."""
        shear: Array = np.abs(self.axial - self.radial) / 2
        return shear


def _below(body: UnstructuredGrid, heights: Array, surface: float, on_axis: Flags) -> Flags:
    """The nodes of the cells on the axis below a surface: a node there may be on either side."""
    corners = body.cell_connectivity.reshape(body.n_cells, -1)  # all cells are of one type
    below = on_axis[corners].any(axis=1) & (heights[corners].mean(axis=1) < surface)
    found = np.zeros(len(heights), dtype=bool)
    found[corners[below]] = True
    return found


def contact_radius(rows: ContactTable, contact: ContactRecord) -> float:
    """Outer radius of the contact zone, from its area and where it begins (length)."""
    inner = rows.numbers["x"][rows.closed].min()
    return float(np.sqrt(contact.quantities[CONTACT_AREA] / np.pi + inner**2))


def draw_axis_stress(
    body: UnstructuredGrid,
    rows: ContactTable,
    contact: ContactRecord,
    path: Path,
    analytic: AnalyticContact | None = None,
) -> Picture | None:
    """Draw stresses over the contact pressure against depth over the contact's radius.

    Args:
        body: A pyvista grid with the field ``stress``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
        path: PNG file to write.
        analytic: What formulas give, where there are some.

    Returns:
        None where there is no contact or no axis below it.
    """
    stress = AxisStress.of(body, rows) if rows.closed.any() else None
    if stress is None:
        return None
    radius = contact_radius(rows, contact)
    unit, symbol = _unit(contact.quantities)
    shown = stress.depth <= _DEPTH * radius
    title = f"Stresses on the axis below {surface_of(contact)}"
    figure, (panel,) = new_figure(title, (COLUMN + _LEGEND, 3.4))
    labels = (
        r"$\sigma_{zz}$",
        r"$\sigma_{rr} = \sigma_{\theta\theta}$",
        r"$\tau = |\sigma_{zz} - \sigma_{rr}|\,/\,2$",
    )
    computed = (stress.axial, stress.radial, stress.shear)
    joined = "none" if analytic is not None and not analytic.punch else "-"
    for values, label, (colour, _), mark in zip(computed, labels, LINES, "os^", strict=False):
        panel.plot(
            values[shown] / unit,
            stress.depth[shown] / radius,
            marker=mark,
            linestyle=joined,
            color=colour,
            markerfacecolor="white",
            markevery=0.06,
            label=label,
        )
    said = ""
    if analytic is not None and not analytic.punch:
        depth = np.linspace(0, _DEPTH * radius, 200)
        axial, radial = analytic.axis_stress(depth)
        name = analytic.label if analytic.smooth else "Hertz, without friction"
        curves = np.stack([axial, radial, np.abs(axial - radial) / 2], axis=1) / unit
        first, *_ = panel.plot(curves, depth / radius, zorder=1, **FORMULA)
        first.set_label(name)
        said = f" Lines: {formula_words(analytic)}."
    panel.axvline(0, color="black", linewidth=0.5, zorder=0)
    panel.invert_yaxis()
    panel.set_xlabel(f"stress over {symbol}")
    panel.set_ylabel("depth over the radius of the contact, $z\\,/\\,a$")
    legend_beside(panel)
    save(figure, path)
    caption = (
        "Axial stress σ_zz, radial stress σ_rr and the principal shear stress τ on the axis of "
        f"revolution below the contact, against the depth z over the contact radius a.{said}"
    )
    return Picture(path, title, caption)


def _unit(quantities: Quantities) -> tuple[float, str]:
    """The peak of the pressure, or its mean where the peak is singular, and what it is called."""
    peak = quantities[MAX_CONTACT_PRESSURE]
    mean = abs(quantities[PRESSURE_INTEGRAL]) / quantities[CONTACT_AREA]
    if peak > _SINGULAR * mean:
        return mean, "the mean pressure, $p_m$"
    return peak, "the peak of the pressure, $p_0$"


_NEAR = 0.4  # contact zones whose neighbourhood is smaller than this share are looked at alone
_HEIGHT, _STRIP, _MARGIN = 1.5, 0.16, 0.45


@dataclass(frozen=True)
class SurfaceDisplacement:
    """Displacement of the points of a contact line.

    Attributes:
        line: Its points that are nodes of the body.
        vectors: Their displacements (length), (points, 2).
    """

    line: SurfaceLine
    vectors: Array

    @classmethod
    def of(
        cls, body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
    ) -> SurfaceDisplacement:
        """Take the displacement at the body's nodes.

        Args:
            body: A pyvista grid with the fields ``displacement`` and ``status``.
            rows: Points of the contact.
            contact: Its entry in ``result.json``.
        """
        line = SurfaceLine.of(body, nodes_at(body, rows, contact)[0], contact)
        _, nodes = nodes_at(body, line.rows, contact)
        return cls(line, np.asarray(body["displacement"])[nodes, :2])

    @property
    def normal(self) -> Array:
        """u_n, along the outward normal (length)."""
        normal: Array = np.sum(self.vectors * self.line.rows.vectors("nx", "ny"), axis=1)
        return normal

    @property
    def tangential(self) -> Array:
        """u_T, positive along the axis of the plot (length)."""
        tangential: Array = np.sum(self.vectors * self.line.tangents, axis=1)
        return tangential

    @property
    def shown(self) -> Flags:
        """The points near the contact zone if it is small, else all."""
        low, high = self.line.view
        position = self.line.position
        if high - low > _NEAR * np.ptp(position):
            return np.ones(len(position), dtype=bool)
        near: Flags = (position >= low) & (position <= high)
        return near


def draw_surface_displacement(
    body: UnstructuredGrid,
    table: ContactTable,
    contacts: list[ContactRecord],
    axes: str,
    path: Path,
) -> Picture:
    """Draw u_n and u_T over a strip of the status, a column a contact.

    Args:
        body: A pyvista grid with the fields ``displacement`` and ``status``.
        table: The content of ``contact.csv``.
        contacts: The contacts' entries in ``result.json``.
        axes: Letters of the model's axes.
        path: PNG file to write.
    """
    count = len(contacts)
    names = in_words([surface_of(contact) for contact in contacts])
    heights = (_HEIGHT, _HEIGHT, _STRIP)
    title = f"Displacement of {names}"
    figure, panels = new_figure(
        "",
        (WIDE if count == 1 else COLUMN * count, sum(heights) + _MARGIN),
        nrows=3,
        ncols=count,
        height_ratios=heights,
        sharex="col",
    )
    for number, contact in enumerate(contacts):
        found = SurfaceDisplacement.of(body, table.of(contact.name), contact)
        column = panels[number::count]
        _components(column, found)
        draw_strip(column[-1], found.line, contact)
        position = found.line.position[found.shown]
        margin = 0.03 * np.ptp(position)
        column[-1].set_xlim(position.min() - margin, position.max() + margin)
        found.line.label(column[-1], axes)
        set_title(column[0], title if count == 1 else surface_of(contact))
    for panel, label in zip(panels[::count], ("normal, $u_n$", "tangential, $u_T$"), strict=False):
        panel.set_ylabel(labelled(label, "length"))
    figure.align_ylabels(panels[:-1:count])
    save(figure, path)
    return Picture(
        path,
        title,
        "Displacement of the surface along its outward normal, u_n, and along it, u_T, against the "
        "position in the undeformed body. The strip below shows the status.",
    )


def _components(panels: list[Axes], found: SurfaceDisplacement) -> None:
    for panel, component in zip(panels, (found.normal, found.tangential), strict=False):
        panel.plot(*found.line.curve(component, found.shown), color=COLOURS["STICK"])
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
