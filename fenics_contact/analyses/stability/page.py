"""Modes of steady sliding on the page of a run: curves over friction, and growing shapes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.analyses.stability.record import ModesAtCoefficient, StabilityRecord
from fenics_contact.analyses.stability.words import stability_rows, stability_words
from fenics_contact.common.arrays import Array
from fenics_contact.report.bodies.mode_shapes import figure_of_shapes
from fenics_contact.report.drawing.fields import read_modes
from fenics_contact.report.drawing.figures import legend_beside, new_figure, save
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import LINES, WIDE, labelled, with_unit
from fenics_contact.report.page.page import AnalysisPage, AnalysisSection
from fenics_contact.report.run_to_draw import RunToDraw
from fenics_contact.results.records.run import Outcome, RunRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import UnstructuredGrid


class _StabilityPage(AnalysisPage):
    def section(self, result: RunRecord) -> AnalysisSection | None:
        if result.stability is None:
            return None
        said = stability_words(result.stability, result.units)
        values = {"stability": stability_rows(result), "stability_words": said}
        return AnalysisSection("stability", "Steady sliding", values)

    def pictures(self, run: RunToDraw) -> Iterator[Picture]:
        yield from draw_stability(run.folder, run.result)
        yield from draw_squeal_shapes(run.folder, run.result)


PAGE = _StabilityPage()


_HEIGHTS, _MARGIN = (2.6, 1.6), 0.6
# Of a growth rate over the angular frequency, below which it is round-off.
_NO_GROWTH = 1e-6


def draw_stability(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``stability.png`` of a run that followed modes over the friction coefficient.

    Args:
        folder: Where to.
        result: The content of its ``result.json``.
    """
    found = result.stability
    if found is None or len(found.curve) < 2:
        return []
    figure, panels = new_figure(
        "Modes of steady sliding",
        (WIDE, sum(_HEIGHTS) + _MARGIN),
        nrows=2,
        sharex=True,
        height_ratios=_HEIGHTS,
    )
    _frequencies(panels[0], found.curve)
    _growth(panels[1], found.curve)
    for panel in panels:
        _mark(panel, found)
    panels[0].set_ylabel(labelled("frequency, $f$", "cycles/time"))
    panels[1].set_ylabel(labelled("growth rate", "1/time"))
    panels[1].set_xlabel("friction coefficient, $\\mu$")
    panels[1].set_xlim(left=0)
    legend_beside(panels[0])
    figure.align_ylabels(panels)
    path = folder / "stability.png"
    save(figure, path)
    said = (
        "Modes of small vibrations about steady sliding. Where two frequencies merge, one of the "
        "two modes grows and the other decays: flutter, which is heard as squeal."
    )
    return [Picture(path, "Squeal over the friction coefficient", said)]


def _frequencies(panel: Axes, curve: Sequence[ModesAtCoefficient]) -> None:
    """Each mode's, those that grow apart from the others."""
    ranks = min(len(point.frequencies) for point in curve)
    coefficients = [point.friction_coefficient for point in curve]
    for rank in range(ranks):
        heights = [point.frequencies[rank] for point in curve]
        panel.plot(coefficients, heights, color="0.75", linewidth=0.8, zorder=1)
    points = np.concatenate([_rows(point) for point in curve])
    grows = points[:, 2] > 0
    looks = (("steady", LINES[0][0], ".", ~grows), ("grows", LINES[1][0], "s", grows))
    for name, colour, marker, which in looks:
        if which.any():
            panel.plot(
                *points[which, :2].T, color=colour, linestyle="none", marker=marker, label=name
            )


def _rows(point: ModesAtCoefficient) -> Array:
    """Coefficient, frequency and whether it grows, of every mode that does not decay by itself."""
    frequencies, rates = np.array(point.frequencies), np.array(point.growth_rates)
    sizes = np.hypot(2 * np.pi * frequencies, rates)
    grows = rates > _NO_GROWTH * sizes
    found = np.column_stack([np.full(len(rates), point.friction_coefficient), frequencies, grows])
    return np.asarray(found[np.argsort(grows, kind="stable")])


def _growth(panel: Axes, curve: Sequence[ModesAtCoefficient]) -> None:
    """The growth rates of all modes."""
    colour = LINES[1][0]
    for point in curve:
        rates = np.array(point.growth_rates)
        grows = _rows(point)[:, 2].sum()
        shown = np.sort(rates)[::-1][: int(grows)]
        places = np.full(len(shown), point.friction_coefficient)
        panel.plot(places, shown, color=colour, linestyle="none", marker="s")
    coefficients = [point.friction_coefficient for point in curve]
    largest = [point.largest_growth_rate for point in curve]
    panel.plot(coefficients, largest, color=colour, linewidth=0.8)
    panel.set_ylim(bottom=0)


def _mark(panel: Axes, found: StabilityRecord) -> None:
    """The critical coefficient, and that of the scene."""
    critical = found.critical_coefficient
    if critical is not None:
        label = f"critical, {critical:.4g}"
        panel.axvline(critical, color="0.3", linestyle="--", linewidth=0.8, label=label)
    own = found.friction_coefficient
    if own <= found.curve[-1].friction_coefficient:
        label = f"of the scene, {own:g}"
        panel.axvline(own, color="0.3", linestyle=":", linewidth=0.8, label=label)


_MOST_SHAPES = 3
_MOMENTS = {"displacement": "", "displacement_quarter_later": ", a quarter of a period later"}


def draw_squeal_shapes(folder: Path, result: Outcome) -> list[Picture]:
    """Draw ``squeal.png``, the modes of a run that grow fastest while its contacts slide.

    Args:
        folder: Of the run, which holds ``squeal.pvd``.
        result: The content of its ``result.json``.

    Raises:
        InputError: A display is missing for bodies in space; says what to install.
    """
    modes = [] if result.stability is None else list(result.stability.modes)
    growing = sorted((mode for mode in modes if mode.grows), key=lambda mode: -mode.growth_rate)
    growing = growing[:_MOST_SHAPES]
    if not growing or not (folder / "squeal.pvd").exists():
        return []
    bodies = list(read_modes(folder, "squeal"))
    shapes: dict[str, UnstructuredGrid] = {}
    for mode in growing:
        named = f"Mode {mode.number}, f = {with_unit(f'{mode.frequency:.5g}', 'cycles/time')}"
        for name, moment in _MOMENTS.items():
            shapes[f"{named}{moment}"] = _at_moment(bodies[mode.number - 1], name)
    path = folder / "squeal.png"
    save(figure_of_shapes(shapes, result.model.kinematics == "3D"), path, tight=True)
    said = (
        "Shapes of the modes that grow fastest while the contact slides, at two moments, any size. "
        "Coloured by the size of the displacement over the largest of the period; grey, the body "
        "at rest."
    )
    return [Picture(path, "Shapes of what squeals", said)]


def _at_moment(body: UnstructuredGrid, name: str) -> UnstructuredGrid:
    """The body with the displacement at one moment of the period, whose largest is 1."""
    found = body.copy()
    found["displacement"] = np.asarray(body[name])
    found["largest"] = np.ones(body.n_points)
    return found
