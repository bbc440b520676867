"""Stress along lines in words, and the table that a run writes of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.analyses.stress_lines.record import StressLineRecord
from fenics_contact.results.records.run import Outcome
from fenics_contact.results.result import Result
from fenics_contact.results.tables import AnalysisWords, Rows, headed
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.units.dimensions import UnitNames

_COMPONENTS = ("xx", "yy", "zz", "yz", "xz", "xy")
_HEADER = [
    *("line", "s", "x", "y", "z"),
    *(f"stress_{component}" for component in _COMPONENTS),
    "temperature",
    *(f"strain_{component}" for component in _COMPONENTS),
]


def words_on_outside(lines: Sequence[StressLineRecord]) -> str:
    """Sentences, each after a space, on lines that are partly outside the body.

    Args:
        lines: Of the run.
    """
    words = ""
    for line in lines:
        outside = line.is_inside.count(False)
        if outside:
            are = "point is" if outside == 1 else "points are"
            words += f" On the line '{line.name}' {outside} {are} outside the body, without stress."
    return words


def line_rows(result: Outcome) -> Rows:
    """A table of the largest von Mises stress along each line, its head first.

    Args:
        result: Of a run that has lines.
    """
    stress = headed("largest von Mises stress", "stress", result.units)
    rows: Rows = [["line", stress, headed("at s", "length", result.units), "points in the body"]]
    for line in result.lines:
        sizes = line.von_mises
        largest = int(np.nanargmax(sizes))
        inside = f"{line.is_inside.count(True)} of {len(sizes)}"
        rows.append([line.name, f"{sizes[largest]:.6g}", f"{line.distances[largest]:.6g}", inside])
    return rows


def file_rows(lines: Sequence[StressLineRecord]) -> Rows:
    """Rows of ``lines.csv``, the head first; what a point does not have is empty.

    Args:
        lines: Of the run.
    """
    rows: Rows = [list(_HEADER)]
    for line in lines:
        for point, (distance, place) in enumerate(zip(line.distances, line.places, strict=True)):
            stress, strain = (
                [tensor[name][point] if name in tensor else None for name in _COMPONENTS]
                for tensor in (line.stress, line.strain)
            )
            heat = None if line.temperature is None else line.temperature[point]
            numbers = [distance, *place, *stress, heat, *strain]
            rows.append([line.name, *("" if n is None else f"{n:.8g}" for n in numbers)])
    return rows


class _LineWords(AnalysisWords):
    def plan(self, scene: Scene, units: UnitNames | None) -> list[str]:
        names = ", ".join(f"'{line.name}' ({line.points} points)" for line in scene.line)
        return [f"Stress along lines: {names}"]

    def tables(self, result: Outcome) -> list[Rows]:
        return [line_rows(result)]

    def files(self, result: Result) -> dict[str, Rows]:
        return {"lines.csv": file_rows(result.lines)}


WORDS = _LineWords()
