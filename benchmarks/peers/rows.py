"""Rows of measurements, and what follows from them: errors, envelopes, ratios at equal error."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from typing import Any

# A run as ``run.py`` writes it: problem, program, setting, level, version, dofs, solve_seconds,
# process_seconds, newton, factorisations, values; of a run without an answer ``failed`` as well.
Row = dict[str, Any]


@dataclasses.dataclass(frozen=True)
class Point:
    """Of a curve of error over seconds.

    Attributes:
        seconds: Of CPU.
        error: Relative; the largest of this mesh and all finer ones, so that a value that passes
            through the reference by chance is no merit.
        row: That it is of.
    """

    seconds: float
    error: float
    row: Row


def answered(rows: Iterable[Row], **keys: Any) -> list[Row]:
    """Rows that have an answer, with given entries."""
    return [
        row
        for row in rows
        if "failed" not in row and all(row[key] == value for key, value in keys.items())
    ]


def curve(rows: Iterable[Row], quantity: str, reference: float, seconds: str) -> list[Point]:
    """Of one program with one setting, from coarse to fine.

    Args:
        rows: Of its meshes.
        quantity: A key of ``values``.
        reference: What it is to be.
        seconds: ``solve_seconds`` or ``process_seconds``.
    """
    points: list[Point] = []
    largest = 0.0
    for row in sorted(rows, key=lambda each: each["level"], reverse=True):
        if quantity in row["values"]:
            largest = max(largest, abs(row["values"][quantity] / reference - 1))
            points.append(Point(row[seconds], largest, row))
    return points[::-1]


def envelope(points: Iterable[Point]) -> list[Point]:
    """Those that no cheaper one is as good as, from the cheapest to the best."""
    found: list[Point] = []
    for point in sorted(points, key=lambda each: (each.seconds, each.error)):
        if not found or point.error < found[-1].error:
            found.append(point)
    return found


def program_envelope(
    rows: Iterable[Row], quantity: str, reference: float, seconds: str
) -> list[Point]:
    """Of one program: the best of all its settings and meshes."""
    settings: dict[str, list[Row]] = {}
    for row in rows:
        settings.setdefault(row["setting"], []).append(row)
    curves = (curve(each, quantity, reference, seconds) for each in settings.values())
    return envelope(point for each in curves for point in each)


def seconds_to(points: Iterable[Point], error: float) -> float | None:
    """Of the cheapest point with at most this error; None if there is none."""
    good = [point.seconds for point in points if point.error <= error]
    return min(good) if good else None


def ratios(ours: list[Point], theirs: list[Point]) -> list[float]:
    """At each point of their envelope, their seconds over ours at the same error or a smaller one.

    Points whose error none of ours reaches are left out.
    """
    pairs = ((point.seconds, seconds_to(ours, point.error)) for point in theirs)
    return [there / here for there, here in pairs if here is not None]


def mean_ratio(found: list[float]) -> float | None:
    """Geometric; None of none."""
    return math.exp(sum(map(math.log, found)) / len(found)) if found else None


def merged(old: Row | None, new: Row) -> Row:
    """The faster of two runs of the same, phase by phase; an answer counts more than none."""
    if old is None or "failed" in old:
        return new
    if "failed" in new:
        return old
    least = {key: min(old[key], new[key]) for key in ("solve_seconds", "process_seconds")}
    return new | least | {"runs": old["runs"] + new["runs"]}


def key_of(row: Mapping[str, Any]) -> tuple[Any, ...]:
    """What a row is of."""
    return (row["problem"], row["program"], row["setting"], row["level"])
