"""Load steps of several runs on each other: forces and areas, energies, hysteresis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.report.drawing.fields import whole_body
from fenics_contact.report.drawing.figures import (
    legend_beside,
    new_figure,
    plain,
    save_png,
    set_title,
)
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import COLUMN, DOUBLE, LINES, WIDE, labelled
from fenics_contact.report.gallery import points_of, scene_of
from fenics_contact.report.load_steps import time_label
from fenics_contact.report.run_to_draw import axes_of, far_supports
from fenics_contact.results.compared_runs import ComparedRun
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.load_history import Drive, History
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import RunRecord

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid


@dataclass(frozen=True)
class DrawnRun:
    """A run in pictures of several.

    Attributes:
        number: Among those that are compared.
        name: What it is called there.
        result: The content of its ``result.json``.
        table: That of its ``contact.csv``.
        body: A pyvista grid with the fields of the last step.
        far: Names of supports that are no drives.
    """

    number: int
    name: str
    result: RunRecord
    table: ContactTable
    body: UnstructuredGrid
    far: tuple[str, ...]

    @property
    def look(self) -> dict[str, Any]:
        """Colour, dashes and name of its curves, for matplotlib."""
        colour, dashes = LINES[self.number % len(LINES)]
        return {"color": colour, "linestyle": dashes, "label": plain(self.name)}

    @property
    def history(self) -> History:
        """Quantities of the run over its load steps."""
        return History.of(self.result)

    @property
    def drives(self) -> list[Drive]:
        """Drives of the run."""
        return self.history.drives(self.result.contacts, self.far)

    @property
    def axes(self) -> str:
        """Letters of the model's axes."""
        return axes_of(self.result.model.kinematics)

    def contact(self, name: str) -> tuple[ContactTable, ContactRecord] | None:
        """Points and entry of a contact; None where it has none of this name."""
        found = [one for one in self.result.contacts if one.name == name]
        return (self.table.of(name), found[0]) if found else None


def drawn_runs(runs: Sequence[ComparedRun]) -> list[DrawnRun]:
    """Return the runs that have fields: others have no answer.

    Raises:
        InputError: A file is damaged, or missing beside others.
    """
    found = []
    for number, run in enumerate(runs):
        result = run.result
        if not (result.quantities and (run.folder / "fields.pvd").exists()):
            continue
        body, table = whole_body(run.folder), points_of(run.folder, result)
        far = far_supports(scene_of(run.folder, result))
        found.append(DrawnRun(number, run.name, result, table, body, far))
    return found


def contact_names(runs: Sequence[DrawnRun]) -> list[str]:
    """Names of contacts that two runs or more have."""
    names = [one.name for run in runs for one in run.result.contacts]
    return [name for name in dict.fromkeys(names) if names.count(name) > 1]


_HEIGHT, _MARGIN, _MANY = 1.5, 0.45, 60
_MOST_DRIVES = 6
# Axis label → curve of each run that has one: places and values.
_Panels: TypeAlias = dict[str, list[tuple[DrawnRun, Array, Array]]]
_ENERGIES = {
    EXTERNAL_WORK: "work done, $W$",
    STRAIN_ENERGY: "strain energy, $E$",
    FRICTION_WORK: "dissipated, $D$",
}


def draw_histories(runs: Sequence[DrawnRun], folder: Path) -> Iterator[Picture]:
    """Pictures over the load steps, if any run has several."""
    if len(runs) < 2 or all(len(run.history.steps) < 2 for run in runs):
        return
    for number, name in enumerate(contact_names(runs)):
        title = f"Contact '{name}' over the load steps"
        yield _over_time(_of_contact(runs, name), title, folder / f"history_{number}.png")
    title = "Work and energies over the load steps"
    yield _over_time(_energies(runs), title, folder / "history_energy.png")
    loops = _drives(runs)
    if loops:
        yield _draw_loops(loops, folder / "history_loops.png")


def _of_contact(runs: Sequence[DrawnRun], name: str) -> _Panels:
    """Forces and areas of a contact."""
    panels: _Panels = {}
    for run in runs:
        number = next((n for n, c in enumerate(run.result.contacts) if c.name == name), None)
        if number is None:
            continue
        history, rough = run.history, run.result.contacts[number].carries_shear
        labels = {
            NORMAL_FORCE: labelled("normal force, $P$", "force"),
            CONTACT_AREA: labelled("contact area, $A$", "area"),
        }
        if history.of_contact(number, NORMAL_FORCE) is None:
            labels = {PRESSURE_INTEGRAL: labelled(r"$\int p\,dA$", "force"), **labels}
        if rough:
            labels[STICK_AREA] = labelled("stick area", "area")
        for key, label in labels.items():
            values = history.of_contact(number, key)
            if values is not None:
                panels.setdefault(label, []).append((run, history.time, values))
        friction = history.of_contact(number, FRICTION_FORCE)
        if rough and friction is not None and np.abs(friction).any():
            axis = int(np.abs(friction).max(axis=0).argmax())
            label = labelled(f"friction force, $Q_{run.axes[axis]}$", "force")
            panels.setdefault(label, []).append((run, history.time, friction[:, axis]))
    return panels


def _energies(runs: Sequence[DrawnRun]) -> _Panels:
    panels: _Panels = {}
    for run in runs:
        for key, label in _ENERGIES.items():
            values = run.history.quantity(key)
            if np.isnan(values).any():  # of cycles that were passed over
                continue
            panels.setdefault(labelled(label, "energy"), []).append((run, run.history.time, values))
    return {
        label: curves
        for label, curves in panels.items()
        if any(np.abs(values).any() for *_, values in curves)
    }


def _over_time(panels: _Panels, title: str, path: Path) -> Picture:
    figure, axes = new_figure(
        title, (WIDE, _HEIGHT * len(panels) + _MARGIN), nrows=len(panels), sharex=True
    )
    for panel, (label, curves) in zip(axes, panels.items(), strict=True):
        for run, time, values in curves:
            mark = "." if len(time) <= _MANY else ""
            panel.plot(time, values, marker=mark, **run.look)
        panel.set_ylabel(label)
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    legend_beside(axes[0])
    clocks = sorted({run.history.clock for curves in panels.values() for run, *_ in curves})
    clock = " or ".join(clocks)
    axes[-1].set_xlabel(time_label(clock))
    figure.align_ylabels(axes)
    save_png(figure, path)
    return Picture(path, title, f"All runs over the {clock} t.")


def _drives(runs: Sequence[DrawnRun]) -> dict[tuple[str, str, str], list[tuple[DrawnRun, Drive]]]:
    """Return drives of two runs or more: title, words of displacement and force → their paths."""
    found: dict[tuple[str, str, str], list[tuple[DrawnRun, Drive]]] = {}
    for run in runs:
        for drive in run.drives if len(run.history.steps) > 1 else []:
            key = (drive.title, drive.moved, drive.force)
            found.setdefault(key, []).append((run, drive))
    several = {key: paths for key, paths in found.items() if len(paths) > 1}
    return dict(list(several.items())[:_MOST_DRIVES])


def _draw_loops(
    drives: dict[tuple[str, str, str], list[tuple[DrawnRun, Drive]]], path: Path
) -> Picture:
    """Force against displacement, a panel for each thing that is moved."""
    columns = min(len(drives), 2)
    rows = -(-len(drives) // columns)
    size = (DOUBLE if columns > 1 else COLUMN + 1.4, 2.7 * rows + 0.2)
    figure, panels = new_figure("", size, nrows=rows, ncols=columns)
    for panel, ((title, moved, force), paths) in zip(panels, drives.items(), strict=False):
        for run, drive in paths:
            panel.plot(drive.x, drive.y, **run.look)
            end = {"color": run.look["color"], "markersize": 5, "zorder": 4}
            panel.plot(drive.x[-1:], drive.y[-1:], "o", **end)
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
        panel.locator_params(axis="x", nbins=5)
        panel.set_xlabel(labelled(moved, "length"))
        panel.set_ylabel(labelled(force, "force"))
        set_title(panel, title[0].upper() + title[1:])
    for panel in panels[len(drives) :]:
        panel.set_axis_off()
    legend_beside(panels[columns - 1])
    save_png(figure, path)
    said = "Force against displacement of all runs; dots are the ends of the paths."
    return Picture(path, plain("Force against displacement"), said)
