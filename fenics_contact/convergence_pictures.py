"""How a run converged: residuals and iterations, and errors over the meshes of an adaptive run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.figures import new_figure, save
from fenics_contact.picture import Picture
from fenics_contact.picture_style import COLOURS, DOUBLE, FORMULA, LINES, WIDE

Array = NDArray[np.float64]

_MARKS = "os^vDP"
_FEWEST = 3
_TINY = 1e-18  # of the largest residual: what 0 is drawn as


def draw_convergence(folder: Path, result: dict[str, Any]) -> list[Picture]:
    """Draw ``convergence.png``, and ``accuracy.png`` of an adaptive run.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    steps = [step for step in result["steps"] if _shows(step.get("residual_history") or [])]
    drawn = [_iterations(steps, folder / "convergence.png")] if steps else []
    if len(result.get("levels", [])) > 1:
        drawn.append(_levels(result, folder / "accuracy.png"))
    return drawn


def _shows(residuals: list[float]) -> bool:
    """Whether residuals say more than that a linear system was solved."""
    return len(residuals) >= _FEWEST and max(residuals) > 0


def _iterations(steps: list[dict[str, Any]], path: Path) -> Picture:
    """Residuals of the load step that took most, and the iterations of all steps."""
    hardest = max(steps, key=lambda step: len(step["residual_history"]))
    several = len(steps) > 1
    figure, panels = new_figure("", (DOUBLE if several else WIDE, 2.5), ncols=1 + several)
    residuals = np.array(hardest["residual_history"], dtype=float)
    residuals = np.maximum(residuals, _TINY * residuals.max())
    numbers = np.arange(len(residuals))
    colour = COLOURS["STICK"]
    panels[0].semilogy(numbers, residuals, "o-", color=colour, linewidth=0.8, markersize=2.5)
    panels[0].set_xlabel("iteration of Newton's method")
    panels[0].set_ylabel("residual, $|F(u)|$")
    panels[0].xaxis.get_major_locator().set_params(integer=True)
    title = "Convergence" + (f" of the load step at t = {hardest['load_factor']:.4g}" * several)
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


def _per_step(panel: Any, steps: list[dict[str, Any]]) -> None:
    """Newton's and outer iterations over the pseudo-time."""
    time = np.array([step["load_factor"] for step in steps])
    newton = [step["newton_iterations"] for step in steps]
    outer = [step["outer_iterations"] for step in steps]
    style = {"where": "mid"} if len(time) > 2 else {"where": "post"}
    panel.step(time, newton, color=COLOURS["STICK"], label="Newton", **style)
    panel.plot(time, newton, "o", color=COLOURS["STICK"], markersize=2.5)
    panel.plot(time, outer, "s", color=COLOURS["SLIP"], markersize=2.5, label="outer")
    panel.set_ylim(bottom=0, top=1.25 * max([1, *newton, *outer]))
    panel.yaxis.get_major_locator().set_params(integer=True)
    panel.set_xlabel("pseudo-time, $t$")
    panel.set_ylabel("iterations")
    panel.set_title("Iterations of every load step")
    panel.legend(ncols=2, loc="upper left")


def _levels(result: dict[str, Any], path: Path) -> Picture:
    """Estimated errors against dofs, with what was asked for and the observed orders."""
    levels, asked = result["levels"], result["accuracy"]["asked"]
    dofs = np.array([level["dofs"] for level in levels], dtype=float)
    figure, (panel,) = new_figure("Estimated errors of the meshes", (WIDE, 3.0))
    last: list[tuple[float, float]] = []
    for number, name in enumerate(asked):
        errors = np.array([level["errors"][name] or np.nan for level in levels], dtype=float)
        colour, dashes = LINES[number % len(LINES)]
        known = np.isfinite(errors) & (errors > 0)
        if not known.any():
            continue
        order = _order(dofs[known], errors[known])
        label = name.replace("_", " ") + ("" if order is None else rf", $N^{{-{order:.2g}}}$")
        mark = _MARKS[number % len(_MARKS)]
        panel.loglog(dofs, errors, mark, linestyle=dashes, color=colour, label=label)
        last.append((float(dofs[known][-1]), float(errors[known][-1])))
    for limit in sorted(set(asked.values())):
        panel.axhline(limit, color="0.4", linewidth=0.8, linestyle=":", zorder=0)
        panel.annotate(
            f"asked for: {100 * limit:g} %", (0.01, limit), xycoords=("axes fraction", "data"),
            va="bottom", color="0.3", fontsize=7,
        )  # fmt: skip
    if last:
        _triangle(panel, dofs, min(error for _, error in last))
    panel.set_xlabel("degrees of freedom, $N$")
    panel.set_ylabel("estimated relative error")
    panel.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, path)
    caption = (
        "Estimated relative errors of the quantities against the degrees of freedom N of the "
        "meshes, with their orders by least squares. The triangle has the slope of N⁻¹, "
        "second order in the size of flat cells; dotted, what was asked for."
    )
    return Picture(path, "Estimated errors of the meshes", caption)


def _order(dofs: Array, errors: Array) -> float | None:
    """By which power of the dofs errors fall, by least squares; None if they do not."""
    if len(dofs) < 2 or dofs[-1] <= dofs[0]:
        return None
    order = -float(np.polyfit(np.log(dofs), np.log(errors), 1)[0])
    return order if order > 0 else None


def _triangle(panel: Any, dofs: Array, lowest: float) -> None:
    """A triangle with the slope −1, below the curves."""
    start = float(np.sqrt(dofs[0] * dofs[-1]))
    end = start * (dofs[-1] / dofs[0]) ** 0.3
    top = 0.6 * lowest
    bottom = top * start / end
    panel.plot([start, end, start, start], [top, bottom, bottom, top], **FORMULA)
    panel.annotate(
        "1", (start, np.sqrt(top * bottom)), xytext=(-3, 0), textcoords="offset points",
        ha="right", va="center", fontsize=7,
    )  # fmt: skip
    panel.annotate(
        "1", (np.sqrt(start * end), bottom), xytext=(0, -3), textcoords="offset points",
        ha="center", va="top", fontsize=7,
    )  # fmt: skip
