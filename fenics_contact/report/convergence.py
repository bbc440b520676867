"""How a run converged: residuals and iterations, and, if it adapted its mesh, errors and meshes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.fields import flat_sides
from fenics_contact.report.drawing.figures import legend_beside, new_figure, plain, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import (
    COLOURS,
    DOUBLE,
    FORMULA,
    LINES,
    WIDE,
    labelled,
    marks,
    neighbourhood,
)
from fenics_contact.report.load_steps import time_label
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.load_history import clock_of
from fenics_contact.results.records.run import LevelRecord, Outcome
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.quantity_names import in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid

_MARKS = "os^vDP"
_FEWEST = 3
_TINY = 1e-18  # of the largest residual: what 0 is drawn as


def draw_convergence(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``convergence.png``, and ``accuracy.png`` of an adaptive run.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    steps = [step for step in result.steps if _shows(step.imbalances)]
    drawn = [_iterations(steps, folder / "convergence.png")] if steps else []
    if result.accuracy is not None and len(result.levels) > 1:
        drawn.append(_levels(result.levels, result.accuracy.asked, folder / "accuracy.png"))
    return drawn


def _shows(residuals: list[float]) -> bool:
    """Whether residuals say more than that a linear system was solved."""
    return len(residuals) >= _FEWEST and max(residuals) > 0


def _iterations(steps: list[StepRecord], path: Path) -> Picture:
    """Residuals of the load step that took most, and the iterations of all steps."""
    hardest = max(steps, key=lambda step: len(step.imbalances))
    several = len(steps) > 1
    figure, panels = new_figure("", (DOUBLE if several else WIDE, 2.5), ncols=1 + several)
    residuals = np.array(hardest.imbalances, dtype=float)
    residuals = np.maximum(residuals, _TINY * residuals.max())
    numbers = np.arange(len(residuals))
    colour = COLOURS["STICK"]
    panels[0].semilogy(numbers, residuals, "o-", color=colour, linewidth=0.8, markersize=2.5)
    panels[0].set_xlabel("iteration of Newton's method")
    panels[0].set_ylabel(labelled("residual, $|F(u)|$", "force"))
    panels[0].xaxis.get_major_locator().set_params(integer=True)
    title = "Convergence" + (f" of the load step at t = {hardest.load_factor:.4g}" * several)
    panels[0].set_title(title)
    if several:
        _per_step(panels[1], steps)
    save(figure, path)
    caption = (
        "Residual of the balance of forces at every iteration of Newton's method"
        + (" in the load step that took most" if several else "")
        + "; it jumps up where an outer iteration or a smaller step begins anew."
        + (" On the right, iterations of every load step." if several else "")
    )
    return Picture(path, "Convergence", caption)


def _per_step(panel: Axes, steps: list[StepRecord]) -> None:
    """Newton's and outer iterations over the pseudo-time."""
    time = np.array([step.load_factor for step in steps])
    newton = [step.newton_iterations for step in steps]
    outer = [step.outer_iterations for step in steps]
    style = {"where": "mid"} if len(time) > 2 else {"where": "post"}
    panel.step(time, newton, color=COLOURS["STICK"], label="Newton", **style)
    panel.plot(time, newton, "o", color=COLOURS["STICK"], markersize=2.5)
    panel.plot(time, outer, "s", color=COLOURS["SLIP"], markersize=2.5, label="outer")
    panel.set_ylim(bottom=0, top=1.25 * max([1, *newton, *outer]))
    panel.yaxis.get_major_locator().set_params(integer=True)
    panel.set_xlabel(time_label(clock_of(steps)))
    panel.set_ylabel("iterations")
    panel.set_title("Iterations of every load step")
    panel.legend(ncols=2, loc="upper left")


def _levels(levels: list[LevelRecord], asked: Mapping[str, float], path: Path) -> Picture:
    """Estimated errors against dofs with their orders, or where dofs also fall, mesh by mesh."""
    dofs = np.array([level.dofs for level in levels], dtype=float)
    grows = bool((np.diff(dofs) > 0).all())
    along = dofs if grows else np.arange(1.0, len(dofs) + 1)
    figure, (panel,) = new_figure("Estimated errors of the meshes", (WIDE, 2.8))
    panel.set_yscale("log")
    for number, name in enumerate(asked):
        errors = np.array([level.errors[name] or np.nan for level in levels], dtype=float)
        colour, dashes = LINES[number % len(LINES)]
        order = _order(dofs, errors) if grows else None
        label = plain(in_words(name)) + ("" if order is None else f", order {order:.2g}")
        mark = _MARKS[number % len(_MARKS)]
        panel.plot(along, errors, mark, linestyle=dashes, color=colour, label=label)
    limits = sorted(set(asked.values()))
    for limit in limits:
        panel.axhline(limit, color="0.4", linewidth=0.8, linestyle=":", zorder=0)
    words = ", ".join(f"{100 * limit:g} %" for limit in limits)
    panel.plot([], [], ":", color="0.4", linewidth=0.8, label=f"asked for: {words}")
    if grows:
        _along_dofs(panel, dofs)
    else:
        panel.set_xticks(
            along, [f"{n:.0f}\n{d / 1000:.3g}k" for n, d in zip(along, dofs, strict=True)]
        )
        panel.set_xlabel("mesh, and its degrees of freedom")
    panel.set_ylabel("estimated relative error")
    legend_beside(panel)
    save(figure, path)
    caption = (
        "Estimated relative errors of the quantities, mesh after mesh, and what was asked for."
    )
    if grows:
        caption = (
            "Estimated relative errors of the quantities against the degrees of freedom N, and "
            "what was asked for. An order is the power of 1/N by which they fall, by least "
            "squares; the triangle has the order 1."
        )
    return Picture(path, "Estimated errors of the meshes", caption)


def _order(dofs: Array, errors: Array) -> float | None:
    """Return the power of dofs by which errors fall, by least squares; None if they do not."""
    known = np.isfinite(errors) & (errors > 0)
    if known.sum() < 2:
        return None
    order = -float(np.polyfit(np.log(dofs[known]), np.log(errors[known]), 1)[0])
    return order if order > 0 else None


def _along_dofs(panel: Axes, dofs: Array) -> None:
    """A logarithmic axis with a triangle of the slope −1 below the curves."""
    from matplotlib.ticker import LogLocator, NullFormatter

    panel.set_xscale("log")
    panel.set_xlabel("degrees of freedom, $N$")
    panel.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    panel.xaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}k")
    panel.xaxis.set_minor_formatter(NullFormatter())
    lowest = panel.get_ylim()[0]
    start, end = (float(np.quantile(np.log(dofs), q)) for q in (0.0, 0.6))
    start, end = np.exp(start), np.exp(end)
    top = 0.8 * lowest
    bottom = top * start / end
    panel.plot([start, start, end, start], [top, bottom, bottom, top], **FORMULA)
    panel.annotate(
        "1", (start, np.sqrt(top * bottom)), xytext=(-3, 0), textcoords="offset points",
        ha="right", va="center",
    )  # fmt: skip
    panel.set_ylim(bottom=0.7 * bottom)


def draw_mesh(body: UnstructuredGrid, result: Outcome, table: ContactTable, path: Path) -> Picture:
    """Draw the mesh of a flat model: all of it, and around the contact with its points.

    Args:
        body: A pyvista grid.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
        path: PNG file to write.
    """
    from matplotlib.collections import LineCollection

    points = np.column_stack([table.numbers["x"], table.numbers["y"]])
    low, high = neighbourhood(points, table.closed)
    model = result.model
    title = f"Mesh {len(result.levels)}: {model['cells']} cells, {model['dofs']} dofs"
    figure, panels = new_figure("", (DOUBLE, 3.6), ncols=2)
    figure.set_layout_engine("compressed")  # for panels of equal scales
    figure.suptitle(title, x=0.01, ha="left", fontsize=8.5)
    lines = np.asarray(body.points)[flat_sides(body)[0]][:, :, :2]
    for panel, width in zip(panels, (0.15, 0.3), strict=True):
        panel.add_collection(
            LineCollection(lines, colors="#566573", linewidths=width, rasterized=True)
        )
        panel.set_aspect("equal")
        panel.autoscale()
    for mark in marks(*result.contacts):
        mine = np.isin(table.status, mark.status)
        look = {"markersize": 3.0, "zorder": 3, "clip_on": False}
        if mine.any():
            panels[1].plot(*points[mine].T, **mark.look | look)
    ends = np.asarray(body.bounds)[:4].reshape(2, 2)
    margin = 0.02 * (high - low)
    panels[1].set_xlim(max(low[0], ends[0, 0]) - margin[0], min(high[0], ends[0, 1]) + margin[0])
    panels[1].set_ylim(max(low[1], ends[1, 0]) - margin[1], min(high[1], ends[1, 1]) + margin[1])
    panels[1].legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, handletextpad=0.1)
    axes = "rz" if model.kinematics == "axisymmetric" else "xy"
    for panel in panels:
        panel.set_xlabel(labelled(f"${axes[0]}$", "length"))
    panels[0].set_ylabel(labelled(f"${axes[1]}$", "length"))
    save(figure, path, tight=True)
    caption = (
        f"The mesh that the estimated errors led to, the last of {len(result.levels)}: all of "
        "it, and around the contact with its points."
    )
    return Picture(path, title, caption)
