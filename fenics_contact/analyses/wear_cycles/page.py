"""``wear.html``: the page of cycles that wear, one file that needs nothing else to be shown."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fenics_contact.analyses.wear_cycles.pictures import FEWEST_CYCLES, draw_wear, draw_wear_film
from fenics_contact.analyses.wear_cycles.worn_history import (
    HISTORY,
    PROFILES,
    WornHistory,
    read_worn,
)
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.quantities.names import (
    FRICTION_WORK,
    MAX_CONTACT_PRESSURE,
    MAX_WEAR_DEPTH,
    WORN_VOLUME,
)
from fenics_contact.report.drawing.figures import style
from fenics_contact.report.drawing.picture import Picture
from fenics_contact.report.drawing.style import in_units, with_unit
from fenics_contact.report.gallery import require
from fenics_contact.report.page.page import AnalysisPage
from fenics_contact.report.page.templates import render, style_sheet, table
from fenics_contact.results.result import read_result
from fenics_contact.results.rounding import rounded

_MOST_ROWS = 20
# Deepest wear over half its width from which gaps along the unworn normals are no longer theirs.
_STEEP = 0.1
# What columns of the history measure.
_PEAK = MAX_CONTACT_PRESSURE
_MEASURES = {WORN_VOLUME: "volume", MAX_WEAR_DEPTH: "length"}


def write_wear_page(folder: Path) -> Path:
    """Write the page of cycles that wear and its pictures, from their tables.

    Args:
        folder: With ``wear.csv`` and ``wear_profiles.csv``.

    Returns:
        The path of the page.

    Raises:
        InputError: A file is missing or damaged, or a library is.
        MachineError: The page could not be written.
    """
    run = read_result(folder) if (folder / "result.json").exists() else None
    history = read_worn(folder, () if run is None else [c.name for c in run.contacts])
    require("matplotlib")
    units = None if run is None else run.units
    with in_units(units):
        page = render(
            "wear.html",
            title=f"Wear, {folder.resolve().name}",
            style=style_sheet(),
            is_steep=_steepest(history) > _STEEP,
            outcome=_outcome(history),
            facts=list(_facts(history)),
            pictures=[*draw_wear(folder, history), *_films(folder, history)],
            cycles=table(_rows(history), "Cycles that were computed"),
            history=HISTORY,
            profiles=PROFILES,
            has_units=units is not None,
        )
    path = folder / "wear.html"
    replace_file(path, page.encode())
    return path


def _films(folder: Path, history: WornHistory) -> Iterator[Picture]:
    """``wear_NUMBER.gif`` of each contact line that wears, where there are cycles enough."""
    if len(history.cycles) < FEWEST_CYCLES:
        return
    with style():
        for number in filter(history.is_flat, history.worn):
            yield draw_wear_film(history, number, folder / f"wear_{number}.gif")


def _steepest(history: WornHistory) -> float:
    return float(history.columns["depth_over_width"].max())


def _with_bar(history: WornHistory, name: str, place: int) -> str:
    """Return a value with its bar, such as ``0.00123 ± 0.00001``."""
    columns = history.columns
    row = {"total": float(columns[f"{name}_error"][place])}
    value, bar = rounded(float(columns[name][place]), row)
    return with_unit(f"{value} ± {bar}" if bar else value, _MEASURES[name])


def _outcome(history: WornHistory) -> str:
    """Return a sentence on the wear at the end."""
    return (
        f"After {history.cycles[-1]} cycles a volume of {_with_bar(history, WORN_VOLUME, -1)} "
        f"is worn, at the deepest {_with_bar(history, MAX_WEAR_DEPTH, -1)}."
    )


def _facts(history: WornHistory) -> Iterator[str]:
    shown, passed = len(history.cycles), int(history.columns["passed_over"].sum())
    yield f"Cycles: {shown} computed, {passed} passed over by the rates of those."
    yield (
        "After ± stands the estimated error of passing over cycles, of all jumps so far; it says "
        "nothing of the mesh, of ε₁ and ε, and of the load steps."
    )
    work = with_unit(float(history.columns[FRICTION_WORK][-1]), "energy")
    yield f"Work of friction: {work}."
    steepest = _steepest(history)
    ends = ": beyond it, results are not to be relied on" if steepest > _STEEP else ""
    yield (
        f"Deepest wear over half its width: {steepest:.3g}. At {_STEEP:g} the linear theory of "
        f"gaps ends{ends}."
    )


def _rows(history: WornHistory) -> list[list[str]]:
    """A row a cycle, of many some, after one of heads."""
    count = len(history.cycles)
    places = np.unique(np.linspace(0, count - 1, min(count, _MOST_ROWS)).round().astype(int))
    several = len(history.contacts) > 1
    heads = ["cycle", "passed over before", "worn volume", "deepest wear"]
    for name in ("largest pressure", "area that never slips"):
        heads += [f"{name}, {history.title(n)}" if several else name for n in history.contacts]
    return [heads, *(_row(history, int(place)) for place in places)]


def _row(history: WornHistory, place: int) -> list[str]:
    return [
        str(history.cycles[place]),
        f"{history.columns['passed_over'][place]:.0f}",
        _with_bar(history, WORN_VOLUME, place),
        _with_bar(history, MAX_WEAR_DEPTH, place),
        *(
            with_unit(float(values[place]), measured)
            for values, measured in (
                *((history.of_contact(n, _PEAK), "stress") for n in history.contacts),
                *((history.sticking(n), "area") for n in history.contacts),
            )
        ),
    ]


class _WearPage(AnalysisPage):
    def write_own(self, folder: Path) -> Path:
        return write_wear_page(folder)


PAGE = _WearPage()
