"""The picture of docs/solve_cost.md: ratio over dofs, with the limits.

A panel a dimension, one of two bodies, and one of full contact.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cost_measure import is_wide, limit_of

from fenics_contact.report.drawing.figures import new_figure, save_png, style
from fenics_contact.report.drawing.style import DOUBLE, LINES

MARKERS = {"Q2": "o", "P1 tets": "^", "P2 tets": "v", "Q1 hexes": "s", "Q2 hexes": "D"}
COLOURS = dict(zip(MARKERS, (colour for colour, _ in LINES), strict=False))
APPLIES_TO = {
    1.4: ",\ncontact ≤ 2.5 %",
    2.0: ",\ncontact 8 %",
    3.0: ",\niterative",
    3.5: ",\nfull contact",
    4.0: ",\nfull contact",
    5.5: ",\nslipping",
}


def plot(rows: list[dict[str, Any]], path: Path) -> None:
    """Draw the rows of one load step, but for those that others show or are far above them."""
    with style():
        _plot(rows, path)


def _plot(rows: list[dict[str, Any]], path: Path) -> None:
    from matplotlib.ticker import LogLocator

    shown = [row for row in rows if row["steps"] == 1 and not _is_left_out(row)]
    titles = sorted({_title(row) for row in shown})
    size = (DOUBLE * max(1.0, len(titles) / 3), 3.0)
    figure, panels = new_figure("", size, ncols=len(titles), sharey=True)
    figure.suptitle("Frictional solve over linear solve", x=0.01, ha="left", fontsize=8.5)
    for panel, title in zip(panels, titles, strict=True):
        chosen = [row for row in shown if _title(row) == title]
        for label, points in _lines(chosen).items():
            panel.semilogx(*points, markersize=4.5, linewidth=0.9, label=label, **_style(label))
        _draw_limits(panel, chosen)
        panel.set_title(title)
        panel.set_xlabel("dofs")
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        panel.xaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}k")
        panel.xaxis.set_minor_formatter("")
        panel.legend(loc="lower right")
    panels[0].set_ylabel("ratio")
    panels[0].set_ylim(0.0, 1.05 * max([3.0, *(row["ratio"] for row in shown)]))
    save_png(figure, path)


def _is_left_out(row: dict[str, Any]) -> bool:
    if row["solver"] in ("full", "auto"):  # the latter are among the others
        return True
    return row["solver"] == "iterative" and row["bodies"] > 1 and not row["full_contact"]


def _title(row: dict[str, Any]) -> str:
    """Of the panel that a row is in."""
    if row["full_contact"]:
        return "full contact, 3D"
    return "two bodies, 2D and 3D" if row["bodies"] > 1 else f"{row['dimension']}D"


def _lines(rows: list[dict[str, Any]]) -> dict[str, tuple[list[float], list[float]]]:
    """Dofs and ratios by what a line is called."""
    found: dict[str, tuple[list[float], list[float]]] = {}
    for row in sorted(rows, key=lambda row: row["dofs"]):
        label = row["element"]
        if row["full_contact"]:
            label += ", two bodies" if row["bodies"] > 1 else ""
            label += ", slipping" if row["case"].endswith("slipping") else ""
        elif "half-space" in row["case"]:
            label += ", half-space"
        elif is_wide(row) and row["bodies"] == 1:
            label += ", 8 % contact"
        if row["solver"] != "condensed":
            label += f", {row['solver']}"
        points = found.setdefault(label, ([], []))
        points[0].append(row["dofs"])
        points[1].append(row["ratio"])
    return found


def _style(label: str) -> dict[str, Any]:
    element, *special = label.split(", ")
    return {
        "marker": MARKERS[element],
        "color": COLOURS[element],
        "markerfacecolor": "white" if special else COLOURS[element],
        "linestyle": "--" if special else "-",
    }


def _draw_limits(panel: Any, rows: list[dict[str, Any]]) -> None:
    limits = {limit for row in rows if (limit := limit_of(row)) is not None}
    for limit in sorted(limits):
        panel.axhline(limit, color="0.3", linewidth=0.8, linestyle=":", zorder=0)
        panel.annotate(
            f"limit {limit:g}{APPLIES_TO.get(limit, '') if len(limits) > 1 else ''}",
            (1.01, limit),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize=7,
            color="0.3",
        )
