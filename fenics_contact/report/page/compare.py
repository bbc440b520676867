"""``compare.html``: several runs side by side, their tables, curves along lines, and maps."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup

from fenics_contact.common.arrays import Array
from fenics_contact.common.atomic_files import make_folder, replace_file
from fenics_contact.report.contacts.curves import cut_peaks
from fenics_contact.report.contacts.line import (
    LineValues,
    SurfaceLine,
    friction_along,
    pressure_along,
    slip_along,
)
from fenics_contact.report.contacts.map_values import Surface, map_values
from fenics_contact.report.contacts.maps import draw_status, draw_values
from fenics_contact.report.drawing.figures import (
    in_words,
    legend_beside,
    new_figure,
    plain,
    save_png,
    set_title,
    style,
    surface_of,
)
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import DOUBLE, WIDE, in_units
from fenics_contact.report.page.compared_histories import (
    DrawnRun,
    contact_names,
    draw_histories,
    drawn_runs,
)
from fenics_contact.report.page.templates import render, style_sheet, table
from fenics_contact.results.compared_runs import units_of
from fenics_contact.results.comparison import Comparison, QuantityGroup
from fenics_contact.results.records.contacts import ContactRecord

_HEIGHT, _MARGIN = 1.7, 0.45
_FEW = 60  # points, up to which each is marked
_MOST_MAPS = 4  # runs beside each other


@dataclass(frozen=True)
class _Along:
    """A contact line of a run.

    Attributes:
        run: The run.
        line: Its points.
        contact: The contact's entry in ``result.json``.
    """

    run: DrawnRun
    line: SurfaceLine
    contact: ContactRecord

    @property
    def values(self) -> dict[str, LineValues]:
        """Values to draw, by name."""
        found = [pressure_along(self.line)]
        if self.contact.carries_shear:
            found += [friction_along(self.line, self.contact), slip_along(self.line)]
        return {one.name: one for one in found}


def draw_contacts(runs: Sequence[DrawnRun], folder: Path) -> Iterator[Picture]:
    """Pictures of the contacts that several runs have."""
    for number, name in enumerate(contact_names(runs)):
        flat = [run for run in runs if run.axes != "xyz" and run.contact(name)]
        lines = list(_comparable(flat, name))
        if len(lines) > 1:
            yield _draw_lines(lines, folder / f"contact_{number}.png")
        in_space = [run for run in runs if run.axes == "xyz" and run.contact(name)]
        if len(in_space) > 1:
            yield _draw_maps(in_space[:_MOST_MAPS], name, folder / f"maps_{number}.png")


def _comparable(runs: Sequence[DrawnRun], name: str) -> Iterator[_Along]:
    """Lines that lie along the same axis as that of the first run, of the same kinematics."""
    first: _Along | None = None
    for run in runs:
        found = run.contact(name)
        assert found is not None
        rows, contact = found
        along = _Along(run, SurfaceLine.of(run.body, rows, contact), contact)
        first = first or along
        same_axis = along.line.axis == first.line.axis and run.axes == first.run.axes
        if same_axis and (along.line.circle is None) == (first.line.circle is None):
            yield along


def _draw_lines(lines: list[_Along], path: Path) -> Picture:
    every = [along.values for along in lines]
    names = list(dict.fromkeys(name for found in every for name in found))
    title = surface_of(lines[0].contact)
    figure, panels = new_figure(
        f"Along {title}",
        (WIDE, _HEIGHT * len(names) + _MARGIN),
        nrows=len(names),
        sharex=True,
    )
    for name, panel in zip(names, panels, strict=True):
        peaked: list[Array] = []
        for along, values in zip(lines, every, strict=True):
            if name not in values:
                continue
            shown = values[name].values
            mark = "." if len(shown) <= _FEW else ""
            panel.plot(*along.line.curve(shown), marker=mark, **along.run.look)
            panel.set_ylabel(values[name].label)
            if values[name].is_peaked:
                peaked.append(shown[along.line.rows.closed])
        if peaked:
            cut_peaks(panel, np.concatenate(peaked))
        panel.axhline(0, color="black", linewidth=0.5, zorder=0)
    legend_beside(panels[0])
    low = min(along.line.view[0] for along in lines)
    high = max(along.line.view[1] for along in lines)
    margin = 0.03 * (high - low)
    panels[-1].set_xlim(low - margin, high + margin)
    lines[0].line.label(panels[-1], lines[0].run.axes)
    figure.align_ylabels(panels)
    save_png(figure, path)
    words = in_words(names)
    return Picture(path, f"Along {title}", f"{words[0].upper()}{words[1:]} of all runs.")


def _draw_maps(runs: Sequence[DrawnRun], name: str, path: Path) -> Picture:
    """Status, pressure and friction traction, a column a run, in the same colours."""
    contacts = [found for run in runs if (found := run.contact(name)) is not None]
    surfaces = [
        Surface.of(run.body, rows, contact)
        for run, (rows, contact) in zip(runs, contacts, strict=True)
    ]
    every = [
        {shown.name: shown for shown in map_values(surface, surface.rows, contact)}
        for surface, (_, contact) in zip(surfaces, contacts, strict=True)
    ]
    kinds = list(dict.fromkeys(name for values in every for name in values))
    across, up = surfaces[0].size
    width = DOUBLE / len(runs)
    height = float(np.clip((width - 0.4) * up / across + 0.5, 1.4, 4.0))
    figure, panels = new_figure(
        "", (DOUBLE, height * (len(kinds) + 1) + 0.4), nrows=len(kinds) + 1, ncols=len(runs)
    )
    for run, surface, panel, (_, contact) in zip(runs, surfaces, panels, contacts, strict=False):
        draw_status(panel, surface, surface.rows.status, contact)
        surface.label(panel, panel is panels[0])
        set_title(panel, run.name)
    panels[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.12), ncols=3, handletextpad=0.1)
    for row, kind in enumerate(kinds, start=1):
        own = panels[row * len(runs) : (row + 1) * len(runs)]
        there = [values[kind] for values in every if kind in values]
        low, high = min(one.limits[0] for one in there), max(one.limits[1] for one in there)
        for surface, values, panel in zip(surfaces, every, own, strict=True):
            if kind in values:
                colours = draw_values(panel, surface, values[kind].values, low, high)
            surface.label(panel, panel is own[0])
        figure.colorbar(colours, ax=own, label=there[0].label, aspect=25)
    figure.suptitle(plain(f"Contact zone '{name}'"), x=0.01, ha="left", fontsize=8.5)
    save_png(figure, path)
    said = "Status of the points, and what they carry, of each run in the same colours."
    return Picture(path, f"Contact zone '{name}'", said)


#: That its pictures need.
LIBRARIES = ("matplotlib", "pyvista")


def write_comparison(comparison: Comparison, path: Path) -> None:
    """Write the page of several runs; ``LIBRARIES`` are there.

    Args:
        comparison: Of these.
        path: Of the page; what is there is replaced.

    Raises:
        InputError: A file of a run cannot be read.
        MachineError: The page could not be written.
    """
    with tempfile.TemporaryDirectory() as pictures:
        text = comparison_page(comparison, _draw(comparison, Path(pictures)))
    make_folder(path.parent)
    replace_file(path, text.encode())


def _draw(comparison: Comparison, folder: Path) -> list[Picture]:
    with style(), in_units(units_of(comparison.runs)):
        runs = drawn_runs(comparison.runs)
        return [*draw_contacts(runs, folder), *draw_histories(runs, folder)]


def comparison_page(comparison: Comparison, pictures: Sequence[Picture]) -> str:
    """The whole page.

    Args:
        comparison: Of some runs.
        pictures: Of them all; their files are there.
    """
    groups = comparison.groups()
    names = comparison.names
    return render(
        "compare.html",
        title=" · ".join(names),
        style=style_sheet(),
        runs=comparison.runs,
        notes=comparison.notes(),
        headline=comparison.headline(groups),
        scene=_named("key", names, comparison.scene_rows()),
        groups=[(group.title, _group_table(names, group)) for group in groups],
        checks=_named("check", names, comparison.check_rows()),
        model=_named("", names, comparison.model_rows()),
        pictures=pictures,
    )


def _named(first: str, names: Sequence[str], rows: list[list[str]]) -> Markup:
    """Names and the value in each run; empty where there are none."""
    return table([[first, *names], *rows], "Runs side by side") if rows else Markup()


def _group_table(names: Sequence[str], group: QuantityGroup) -> Markup:
    """Quantities and how far those of each run are from those of the first."""
    parts = []
    if group.rows:
        units = ["unit"] if any(row.unit for row in group.rows) else []
        first, *others = names
        apart = [word for name in others for word in (f"{name} − {first}", "share", "error bars")]
        rows: list[list[str]] = [["quantity", *names, *units, *apart]]
        for row in group.rows:
            cells = [row.name, *row.values, *([row.unit] if units else [])]
            for found in row.differences:
                if found is None:
                    cells += ["", "", ""]
                    continue
                bars = found.bars
                if found.is_beyond_bars:
                    bars = Markup('<b class="beyond">{}</b>').format(bars)
                cells += [found.words, found.share, bars]
            rows.append(cells)
        parts.append(table(rows, f"Quantities of the {group.title}"))
    if group.settings:
        parts.append(_named("as used", names, group.settings))
    return Markup("\n").join(parts)
