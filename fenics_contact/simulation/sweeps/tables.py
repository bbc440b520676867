"""The files of a sweep: ``sweep.csv``, ``sweep.json`` and ``states.npz``."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fenics_contact.common.atomic_files import naming, replace_file, replaced_file
from fenics_contact.results.records.record import plain
from fenics_contact.simulation.sweeps.rows import STATES, Row, columns_of

TABLE, SUMMARY, STATES_FILE, PAGE = "sweep.csv", "sweep.json", "states.npz", "sweep.html"


def clear(folder: Path) -> None:
    """Remove the files of an earlier sweep.

    Raises:
        MachineError: They cannot be removed.
    """
    with naming(folder):
        for name in (TABLE, SUMMARY, STATES_FILE, PAGE):
            (folder / name).unlink(missing_ok=True)


def write_table(
    folder: Path, keys: Sequence[str], points: Sequence[tuple[Sequence[Any], int, Row]]
) -> None:
    """Write ``sweep.csv``.

    Args:
        folder: Of the sweep.
        keys: That are varied.
        points: Of each, in the order of the grid: values of the keys, exit code, and numbers of
            the answer, none where there is no answer.

    Raises:
        MachineError: It could not be written.
    """
    names = columns_of(row for _, _, row in points)
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow([*keys, "exit_code", *names])
    for values, code, row in points:
        numbers = (row.get(name) for name in names)
        writer.writerow([*map(_field, values), code, *map(_field, numbers)])
    replace_file(folder / TABLE, text.getvalue().encode())


def _field(value: Any) -> str:
    """A value as spreadsheets and Python read it; nothing where there is none."""
    if value is None or isinstance(value, str):
        return value or ""
    return json.dumps(plain(value), default=str)


def write_summary(folder: Path, content: Mapping[str, Any]) -> None:
    """Write ``sweep.json``.

    Args:
        folder: Of the sweep.
        content: Of the file.

    Raises:
        MachineError: It could not be written.
    """
    text = json.dumps(plain(content), indent=2, ensure_ascii=False, allow_nan=False, default=str)
    replace_file(folder / SUMMARY, f"{text}\n".encode())


def write_states(folder: Path, states: Iterable[tuple[int, Mapping[str, Any]]]) -> None:
    """Write ``states.npz``: the contact points of all answers, one after the other.

    Args:
        folder: Of the sweep.
        states: Row of each answer, and its arrays.

    Raises:
        MachineError: It could not be written.
    """
    found = sorted(((n, arrays) for n, arrays in states if arrays), key=lambda one: one[0])
    points = [np.full(len(arrays["contact"]), number) for number, arrays in found]
    whole = {"point": _joined(points, np.int64)}
    for name, kind in STATES.items():
        whole[name] = _joined([arrays[name] for _, arrays in found], kind)
    with replaced_file(folder / STATES_FILE) as temporary, temporary.open("wb") as file:
        np.savez(file, allow_pickle=False, **whole)


def _joined(parts: Sequence[Any], kind: Any) -> Any:
    return np.concatenate([np.zeros(0, dtype=kind), *parts]).astype(kind)
