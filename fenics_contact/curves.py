"""Curves along the contact line of a flat model: pressure, friction traction (Fig. 2), gap."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_table import ContactTable
from fenics_contact.figures import new_figure, save, title_of
from fenics_contact.surface_line import SurfaceLine

Array = NDArray[np.float64]

_WIDTH, _MARGIN = 7.2, 0.6
_HEIGHTS = {"contact pressure": 3.0, "friction traction": 3.0, "gap": 1.6}


def draw_curves(rows: ContactTable, contact: dict[str, Any], axes: str, path: Path) -> None:
    """Draw what happens along a contact line.

    Args:
        rows: Its points.
        contact: The contact's entry in ``result.json``.
        axes: Letters of the model's axes.
        path: PNG file to write.
    """
    line = SurfaceLine.of(rows, contact)
    names = _panels(line, contact)
    heights = [_HEIGHTS[name] for name in names]
    figure, panels = new_figure(
        title_of(names, contact),
        (_WIDTH, sum(heights) + _MARGIN),
        nrows=len(names),
        sharex=True,
        height_ratios=heights,
    )
    draw = {"contact pressure": _pressure, "friction traction": _friction, "gap": _gap}
    for name, panel in zip(names, panels, strict=True):
        draw[name](panel, line, contact)
        panel.axhline(0, color="black", linewidth=0.6)
        if contact["contact"] != "prescribed" and not rows.closed.all():
            _shade(panel, line)
    _legends(panels)
    low, high = line.view
    margin = 0.045 * (high - low)
    panels[-1].set_xlim(low - margin, high + margin)
    panels[-1].set_xlabel(f"position along the surface, ${axes[line.axis]}$")
    save(figure, path)


def _legends(panels: list[Any]) -> None:
    """Each label once, in the first panel that has it."""
    said: set[str] = set()
    for panel in panels:
        entries = dict(zip(*reversed(panel.get_legend_handles_labels()), strict=True))
        new = {label: handle for label, handle in entries.items() if label not in said}
        if new:
            panel.legend(list(new.values()), list(new), frameon=False, fontsize=9)
        said |= set(new)


def _panels(line: SurfaceLine, contact: dict[str, Any]) -> list[str]:
    """The curves worth drawing: what is found, and what is not zero all along."""
    found, frictional = contact["contact"] != "prescribed", contact["law"] != "none"
    apart = np.isfinite(line.rows.numbers["gap"]) & ~line.rows.closed
    return [
        *(["contact pressure"] if found or not frictional else []),
        *(["friction traction"] if frictional else []),
        *(["gap"] if found and apart.any() else []),
    ]


def _pressure(panel: Any, line: SurfaceLine, contact: dict[str, Any]) -> None:
    _plot(panel, line, line.rows.numbers["contact_pressure"])
    cut_peaks(panel, line.rows.numbers["contact_pressure"][line.rows.closed])
    panel.set_ylabel("contact pressure, $p$")


def _friction(panel: Any, line: SurfaceLine, contact: dict[str, Any]) -> None:
    """With the friction bound ±g, on the side (or sides) where the traction lies."""
    traction = line.traction
    _plot(panel, line, traction)
    cut_peaks(panel, traction[line.rows.closed])
    panel.set_ylabel(r"friction traction on the body, $\sigma_T$")
    coefficient = contact["parameters"]["friction_coefficient"]
    if not isinstance(coefficient, float | int) or coefficient == 0:
        return
    bound = coefficient * line.rows.numbers["contact_pressure"]
    label: str | None = r"bound $\pm g = \pm\mu p$"
    for side in (1, -1):
        if (side * traction > 0.02 * bound.max()).any():
            panel.plot(line.position, side * bound, "--", color="0.3", linewidth=1, label=label)
            label = None


def _gap(panel: Any, line: SurfaceLine, contact: dict[str, Any]) -> None:
    gap = line.rows.numbers["gap"]
    _plot(panel, line, np.where(np.isfinite(gap), gap, np.nan))
    panel.set_ylabel("gap")


def _plot(panel: Any, line: SurfaceLine, values: Array) -> None:
    """Values at the points shown, marked by their kind."""
    shown = (line.position >= line.view[0]) & (line.position <= line.view[1])
    panel.plot(line.position[shown], values[shown], color="0.6", linewidth=1, zorder=1)
    for mark in line.marks:
        mine = np.isin(line.rows.status, mark.status)
        if not (mine & shown).any():
            continue
        panel.plot(
            line.position[mine & shown],
            values[mine & shown],
            mark.shape,
            color=mark.colour,
            markerfacecolor=mark.colour if mark.filled else "white",
            markersize=5 if shown.sum() < 60 else 3.5,
            label=f"{mark.label} ({int(mine.sum())} points)",
            zorder=2,
        )


def cut_peaks(panel: Any, values: Array) -> None:
    """Cut off what a few points have alone, such as those at the edge of a punch, and say so."""
    most = float(np.percentile(np.abs(values), 90)) if len(values) else 0.0
    if np.abs(values).max(initial=0.0) <= 4 * most:
        return
    low, high = np.clip([values.min(), values.max()], -2 * most, 2 * most)
    panel.set_ylim(min(low, 0) - 0.1 * most, max(high, 0) + 0.1 * most)
    beyond = [f"{value:.3g}" for value in (values.min(), values.max()) if abs(value) > 2 * most]
    text = f"peaks cut off ({', '.join(beyond)})"
    height = 0.97 if values.max() > 0 else 0.88  # below the line at 0
    panel.text(0.5, height, text, transform=panel.transAxes, ha="center", va="top", fontsize=9)


def _shade(panel: Any, line: SurfaceLine) -> None:
    label: str | None = "contact zone"
    for start, end in line.zones():
        panel.axvspan(start, end, color="0.93", linewidth=0, zorder=0, label=label)
        label = None
