"""Reading the files of a sweep, and refusing those that a page cannot be made of."""

from __future__ import annotations

import csv
import json
import math
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.results.records.record import UnitsRecord

TABLE, RECORD, STATES = "sweep.csv", "sweep.json", "states.npz"
EXIT_CODE = "exit_code"
_NUMBERS = (
    *("x", "y", "z", "gap", "contact_pressure"),
    *("traction_x", "traction_y", "traction_z", "slip_x", "slip_y", "slip_z"),
)
_WHOLE = ("point", "contact", "status")
_STATUSES = 3  # open, stick, slip
# What reading a file that was cut off or changed raises, besides what is not a value of its kind.
_DAMAGED = (
    *(ValueError, RecursionError, EOFError, KeyError, TypeError),
    *(csv.Error, zipfile.BadZipFile, zlib.error),
)


@dataclass(frozen=True)
class SweepRecord:
    """The content of ``sweep.json``.

    Attributes:
        scene: Its path as it was given.
        vary: The values of every varied key; the last key runs fastest.
        rows: Number of points of the grid.
        answered: Number of those that have an answer.
        bulk_factorisations: Of all processes.
        seconds: That the sweep took.
        title: Of the scene.
        contacts: Their names, in scene order.
        failures: Row → why it has no answer, in a sentence.
        units: Of all numbers, if the scene has some.
        kinematics: Of the model, if the sweep says it.
    """

    scene: str
    vary: dict[str, list[Any]]
    rows: int
    answered: int
    bulk_factorisations: int
    seconds: float
    title: str = ""
    contacts: list[str] = field(default_factory=list)
    failures: dict[int, str] = field(default_factory=dict)
    units: UnitsRecord | None = None
    kinematics: str | None = None


@dataclass(frozen=True)
class SweepTable:
    """The content of ``sweep.csv``.

    Attributes:
        exit_codes: Of every row.
        columns: Every other column but the varied keys; None where there is no value.
    """

    exit_codes: list[int]
    columns: dict[str, list[float | None]]


@dataclass(frozen=True)
class ContactStates:
    """All contact points of all answered points of the grid, one after the other.

    Attributes:
        point: Row of ``sweep.csv``, (entries,).
        contact: Number of the contact, in scene order.
        status: 0 open, 1 stick, 2 slip.
        numbers: The others, by their names.
    """

    point: Integers
    contact: Integers
    status: Integers
    numbers: Mapping[str, Array]

    def vectors(self, name: str, rows: Integers | Flags) -> Array:
        """Vectors at some entries, (entries, 3).

        Args:
            name: Of the vector; empty for the coordinates.
            rows: Which entries.
        """
        before = f"{name}_" if name else ""
        return np.column_stack([self.numbers[f"{before}{axis}"][rows] for axis in "xyz"])


def read_record(folder: Path) -> SweepRecord:
    """The content of a sweep's ``sweep.json``.

    Raises:
        InputError: There is none, or it is damaged; says how.
    """
    path = folder / RECORD
    with _reading(path):
        content = json.loads(path.read_text(encoding="utf-8"))
        record = TypeAdapter(SweepRecord).validate_python(content)
        number = math.prod(len(values) for values in record.vary.values())
        if not record.vary or number != record.rows:
            said = f"the values of `vary` make {number} points, but `rows` is {record.rows}"
            raise ValueError(said)
    return record


@contextmanager
def _reading(path: Path) -> Iterator[None]:
    """Say of which file it is that it cannot be read, or is damaged.

    Raises:
        InputError: In place of what reading raises.
    """
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(map(str, first["loc"])) or "the whole"
        raise _damaged(path, f"{place}: {first['msg']}") from None
    except _DAMAGED as error:
        raise _damaged(path, str(error) or "it ends too early") from None


def _damaged(path: Path, said: str) -> InputError:
    return InputError(f"{path}: damaged: {said}; sweep again")


def read_table(folder: Path, record: SweepRecord) -> SweepTable:
    """The content of a sweep's ``sweep.csv``.

    Args:
        folder: Of the sweep.
        record: Its ``sweep.json``.

    Raises:
        InputError: There is none, it is damaged, or it is of another sweep; says where.
    """
    path = folder / TABLE
    with _reading(path), path.open(newline="", encoding="utf-8") as file:
        head, *rows = list(csv.reader(file)) or [[]]
        return _table(head, rows, record)


def _table(head: list[str], rows: list[list[str]], record: SweepRecord) -> SweepTable:
    """The rows as columns.

    Raises:
        ValueError: They are not those of the sweep.
    """
    keys = list(record.vary)
    if head[: len(keys) + 1] != [*keys, EXIT_CODE] or len(set(head)) != len(head):
        said = f"the varied keys and {EXIT_CODE}"
        raise ValueError(f"its first line does not name {said}, and every quantity once")
    if len(rows) != record.rows:
        raise ValueError(f"it has {len(rows)} rows, but the sweep has {record.rows} points")
    for number, row in enumerate(rows):
        if len(row) != len(head):
            raise ValueError(f"line {number + 2} is not whole")
        for key, cell, value in zip(keys, row, values_at(record.vary, number), strict=False):
            if _is_number(value) and not math.isclose(float(cell), value, rel_tol=1e-9):
                raise ValueError(f"line {number + 2} has {key} = {cell} in place of {value}")
    first = len(keys) + 1
    columns = zip(*(row[first:] for row in rows), strict=True)
    return SweepTable(
        exit_codes=[int(row[len(keys)]) for row in rows],
        columns={
            name: [_number(cell) for cell in cells]
            for name, cells in zip(head[first:], columns, strict=True)
        },
    )


def values_at(vary: Mapping[str, list[Any]], row: int) -> list[Any]:
    """The values of the keys at a row of the grid, whose last key runs fastest.

    Args:
        vary: The values of every key.
        row: From 0.

    >>> values_at({"a": [1, 2], "b": [3, 4, 5]}, 4)
    [2, 4]
    """
    numbers = np.unravel_index(row, [len(values) for values in vary.values()])
    return [values[n] for values, n in zip(vary.values(), numbers, strict=True)]


def is_numeric(values: list[Any]) -> bool:
    """Whether the values of a key are all numbers, and none twice."""
    return all(map(_is_number, values)) and len(set(values)) == len(values)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _number(cell: str) -> float | None:
    """A cell of a quantity: empty where it has none, and nothing where it is not finite."""
    number = float(cell) if cell else math.nan
    return number if math.isfinite(number) else None


def read_states(folder: Path, record: SweepRecord) -> ContactStates | None:
    """The content of a sweep's ``states.npz``; None where no point has an answer.

    Args:
        folder: Of the sweep.
        record: Its ``sweep.json``.

    Raises:
        InputError: There is none, it is damaged, or it is of another sweep; says how.
    """
    path = folder / STATES
    if record.answered == 0 and not path.exists():
        return None
    with _reading(path), np.load(path, allow_pickle=False) as file:
        missing = [name for name in (*_WHOLE, *_NUMBERS) if name not in file]
        if missing:
            raise ValueError(f"it lacks '{missing[0]}'")
        return _states({name: file[name] for name in (*_WHOLE, *_NUMBERS)}, record)


def _states(found: Mapping[str, Any], record: SweepRecord) -> ContactStates | None:
    """The arrays of the file.

    Raises:
        ValueError: They are not those of the sweep.
    """
    shapes = {array.shape for array in found.values()}
    if len(shapes) > 1 or len(next(iter(shapes))) != 1:
        raise ValueError("its arrays are not of one length")
    limits = {"point": record.rows, "contact": len(record.contacts), "status": _STATUSES}
    for name, limit in limits.items():
        array = found[name]
        if array.dtype.kind not in "iu" or (
            array.size and not 0 <= array.min() <= array.max() < limit
        ):
            raise ValueError(f"'{name}' has entries other than whole numbers from 0 to {limit - 1}")
    numbers = {name: np.asarray(found[name], dtype=float) for name in _NUMBERS}
    if not all(np.isfinite(numbers[axis]).all() for axis in "xyz"):
        raise ValueError("a coordinate is not a number")
    if found["point"].size == 0:
        return None
    whole = {name: found[name].astype(np.int64) for name in _WHOLE}
    return ContactStates(**whole, numbers=numbers)
