"""Maps of a contact surface in 3D: pressure and friction traction as colours."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_table import ContactTable
from fenics_contact.figures import new_figure, save, title_of
from fenics_contact.picture_style import COLOUR_MAP, COLOURS, marks, neighbourhood

Array = NDArray[np.float64]

_PANEL = (6.0, 5.0)


@dataclass(frozen=True)
class Surface:
    """A contact surface, seen along the axis across which it extends least.

    Attributes:
        rows: Its points, those that are shown.
        axes: Numbers of the two axes of the map.
        points: Coordinates on these, shape (points, 2).
        shown: Which of all points these are.
    """

    rows: ContactTable
    axes: NDArray[np.int64]
    points: Array
    shown: NDArray[np.bool_]

    @classmethod
    def of(cls, rows: ContactTable, contact: dict[str, Any]) -> Surface:
        """The whole surface where its pressure is given, else the zone's neighbourhood."""
        points = rows.vectors("x", "y", "z")
        axes = np.sort(np.argsort(np.ptp(points, axis=0))[-2:])
        points, shown = points[:, axes], np.ones(len(points), dtype=bool)
        if contact["contact"] != "prescribed":
            low, high = neighbourhood(points, rows.closed)
            shown = ((points >= low) & (points <= high)).all(axis=1)
            rows, points = rows.rows(shown), points[shown]
        return cls(rows, axes, points, shown)


def draw_maps(rows: ContactTable, contact: dict[str, Any], path: Path) -> None:
    """Draw what happens on a contact surface.

    Args:
        rows: Its points.
        contact: The contact's entry in ``result.json``.
        path: PNG file to write.
    """
    surface = Surface.of(rows, contact)
    found, frictional = contact["contact"] != "prescribed", contact["law"] != "none"
    draw = {
        **({"contact pressure": _pressure} if found or not frictional else {}),
        **({"friction traction": _friction} if frictional else {}),
    }
    figure, panels = new_figure(
        title_of(list(draw), contact), (_PANEL[0] * len(draw), _PANEL[1]), ncols=len(draw)
    )
    for draw_panel, panel in zip(draw.values(), panels, strict=True):
        draw_panel(figure, panel, surface, contact)
        panel.set_aspect("equal")
        panel.set_xlabel(f"${'xyz'[surface.axes[0]]}$")
        panel.set_ylabel(f"${'xyz'[surface.axes[1]]}$")
        panel.legend(
            frameon=False,
            fontsize=9,
            markerscale=0.8,
            loc="upper left",
            bbox_to_anchor=(0, -0.1),
            ncols=3,
        )
    save(figure, path)


def _pressure(figure: Any, panel: Any, surface: Surface, contact: dict[str, Any]) -> None:
    pressure = surface.rows.numbers["contact_pressure"]
    _scatter(figure, panel, surface, contact, pressure, "contact pressure, $p$")


def _friction(figure: Any, panel: Any, surface: Surface, contact: dict[str, Any]) -> None:
    traction = surface.rows.vectors("traction_x", "traction_y", "traction_z")
    size = np.linalg.norm(traction, axis=1)
    _scatter(figure, panel, surface, contact, size, r"friction traction, $|\sigma_T|$")
    arrows = traction[:, surface.axes]
    if size.any():  # else their scale would be none
        panel.quiver(*surface.points.T, *arrows.T, color="0.2", width=0.003)


def _scatter(
    figure: Any,
    panel: Any,
    surface: Surface,
    contact: dict[str, Any],
    values: Array,
    label: str,
) -> None:
    """Values as colours of the closed points; open points as crosses."""
    closed = surface.rows.closed
    width = float(np.clip(120 / np.sqrt(len(closed)), 3, 12))  # of a marker, in points
    for mark in marks(contact["law"]):
        mine = np.isin(surface.rows.status, mark.status)
        if not mine.any():
            continue
        first, second = surface.points[mine].T
        name = f"{mark.label} ({int(mine.sum())} points)"
        if mark.label == "open":
            panel.scatter(first, second, c=COLOURS["OPEN"], marker="x", s=width**2 / 3, label=name)
            continue
        colours = panel.scatter(
            first,
            second,
            c=values[mine],
            s=width**2,
            marker=mark.shape,
            vmin=min(values[closed].min(), 0),
            vmax=values[closed].max() or 1,
            cmap=COLOUR_MAP,
            label=name,
        )
    if closed.any():
        figure.colorbar(colours, label=label)
