"""``compare.html``: several runs side by side, in one file that needs nothing else to be shown."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from fenics_contact.common.atomic_files import make_folder, replace_file
from fenics_contact.report.compare.contacts import draw_contacts
from fenics_contact.report.compare.drawn_runs import drawn_runs
from fenics_contact.report.compare.histories import draw_histories
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.units import in_units
from fenics_contact.report.page.page import style_sheet
from fenics_contact.report.page.templates import render, table
from fenics_contact.results.comparison.comparison import Comparison, Group
from fenics_contact.results.comparison.runs import units_of

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


def _group_table(names: Sequence[str], group: Group) -> Markup:
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
