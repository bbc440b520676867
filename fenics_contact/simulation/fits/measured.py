"""Input of a fit: a measured curve, and the parameters that the fit varies."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.wording import did_you_mean
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.scene_values import found_in, numbered

TIME = "time"
#: What the name of an uncertainty ends in, as that of a bar in ``sweep.csv``.
UNCERTAINTY = "_error"
# Of a row of ``sweep.csv``: rows that have no answer are no data.
_EXIT_CODE = "exit_code"


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured curve: a quantity over the pseudo-time, another quantity, or keys of the scene.

    Attributes:
        over: ``time``, the name of a quantity, or keys of the scene.
        at: Their values, (rows, names).
        quantity: What was measured.
        values: Of it, (rows,).
        uncertainties: Standard uncertainties, (rows,); None where they are not known.
        source: Where the table is from, for messages.
    """

    over: tuple[str, ...]
    at: Array
    quantity: str
    values: Array
    uncertainties: Array | None = None
    source: str = "data"

    def __len__(self) -> int:
        return len(self.values)


def read_measured(path: Path, scene: Scene, of: str | None = None) -> Measured:
    """Read a table: CSV, its first line names of columns.

    Args:
        path: Of the file.
        scene: Whose quantities and keys the columns are.
        of: The quantity that is to be met; by default the only one that is no abscissa.

    Raises:
        InputError: The file cannot be read, a column is missing or unknown, or a cell is no number;
            says where.
    """
    head, rows = _table(path)
    over, rest = _abscissae(path, head, scene)
    quantity = _quantity(path, rest, of)
    for name in (*over, quantity) if over[0] not in (TIME, *_keys(over, scene)) else (quantity,):
        _require_quantity(path, name, scene)
    has_uncertainties = quantity + UNCERTAINTY in rest
    names = [*over, quantity, *([quantity + UNCERTAINTY] if has_uncertainties else [])]
    table = _numbers(path, head, rows, names)
    at, values = table[:, : len(over)], table[:, len(over)]
    uncertainties = table[:, -1] if has_uncertainties else None
    if uncertainties is not None and not (uncertainties > 0).all():
        line = int(np.flatnonzero(~(uncertainties > 0))[0]) + 1
        raise InputError(
            f"{path}: row {line}: {quantity}{UNCERTAINTY} = {uncertainties[line - 1]:g}: a "
            "standard uncertainty must be above 0; leave the column out where it is not known"
        )
    return Measured(over, at, quantity, values, uncertainties, str(path))


def _table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Names of the columns, and the rows that are not empty."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except ValueError:
        raise InputError(f"{path}: cannot be read: it is no text in UTF-8") from None
    rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines())]
    rows = [row for row in rows if any(row) and not row[0].startswith("#")]
    if len(rows) < 2:
        raise InputError(f"{path}: a line of names and rows of numbers are missing")
    head, *body = rows
    repeated = [name for name in head if name and head.count(name) > 1]
    if repeated:
        raise InputError(f"{path}: two columns are called '{repeated[0]}'")
    for number, row in enumerate(body, 1):
        if len(row) != len(head):
            raise InputError(f"{path}: row {number} has {len(row)} cells, the first {len(head)}")
    return head, body


def _abscissae(path: Path, head: Sequence[str], scene: Scene) -> tuple[tuple[str, ...], list[str]]:
    """Return the abscissae of the curve, and the other columns: keys of the scene come first."""
    keys = _keys(head, scene)
    number = len(keys) or 1
    if len(head) <= number:
        raise InputError(
            f"{path}: its first line must name {TIME}, a quantity or keys of the scene, and then "
            f"the quantity that was measured; it is '{','.join(head)}'"
        )
    return tuple(head[:number]), list(head[number:])


def _keys(names: Sequence[str], scene: Scene) -> list[str]:
    """The first names, as far as they are keys of the scene."""
    found = []
    for name in names:
        try:
            found_in(scene, name)
        except InputError:
            break
        found.append(name)
    return found


def _quantity(path: Path, columns: Sequence[str], of: str | None) -> str:
    """The column that is to be met."""
    known = [name for name in columns if name != _EXIT_CODE and not name.endswith(UNCERTAINTY)]
    if of is not None:
        if of not in known:
            hint = did_you_mean(of, known) or f"; there are {', '.join(known) or 'none'}"
            raise InputError(f"{path}: there is no column '{of}'{hint}")
        return of
    if len(known) != 1:
        there = ", ".join(known[:5]) + (", …" if len(known) > 5 else "")
        said = f"has {there}; say which is to be met with --of" if known else "has no quantity"
        raise InputError(f"{path}: behind what the curve is over it {said}")
    return known[0]


def _require_quantity(path: Path, name: str, scene: Scene) -> None:
    try:
        found = scene.names.find(name)
    except ValueError as error:
        raise InputError(f"{path}: a column has an unknown name: {error}") from None
    if found.axis is None and name + "_x" in _components(name, scene):
        raise InputError(f"{path}: column '{name}' is a vector; name its components, as {name}_x")


def _components(name: str, scene: Scene) -> list[str]:
    try:
        scene.names.find(name + "_x")
    except ValueError:
        return []
    return [name + "_x"]


def _numbers(
    path: Path, head: Sequence[str], rows: Sequence[Sequence[str]], names: Sequence[str]
) -> Array:
    """Some columns as numbers, without rows of a sweep that have no answer."""
    places = [head.index(name) for name in names]
    code = head.index(_EXIT_CODE) if _EXIT_CODE in head else None
    found = []
    for number, row in enumerate(rows, 1):
        if code is not None and row[code] != "0":
            continue
        found.append([_number(path, number, row[p], n) for p, n in zip(places, names, strict=True)])
    if not found:
        raise InputError(f"{path}: no row has an answer")
    return np.array(found)


def _number(path: Path, row: int, cell: str, name: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{path}: row {row}: {name} = '{cell}': must be a number")
    return value


# As a caller gives them: keys with bounds, None for none; or words such as ``KEY=LOW:HIGH``.
Given = Mapping[str, tuple[float, float] | None] | Sequence[str]


@dataclass(frozen=True)
class Parameter:
    """A number of a scene that is to be found.

    Attributes:
        key: As of ``--set``.
        start: The scene's own value, where the search begins.
        low: The least value, perhaps −∞.
        high: The largest value, perhaps ∞.
    """

    key: str
    start: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def scale(self) -> float:
        """Divisor by which parameters of different units get one size."""
        return abs(self.start) or 1.0


def parameters_of(scene: Scene, given: Given) -> list[Parameter]:
    """The parameters of a fit.

    Args:
        scene: Where they start.
        given: Keys and bounds.

    Raises:
        InputError: A key is no number of the scene or given twice, or its bounds exclude it.
    """
    pairs = list(given.items()) if isinstance(given, Mapping) else [_read(word) for word in given]
    if not pairs:
        raise InputError("--parameters: name at least one key of the scene, such as KEY=LOW:HIGH")
    pairs = [(numbered(scene, key), bounds) for key, bounds in pairs]
    keys = [key for key, _ in pairs]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError(f"--parameters {key}: it is named twice")
    return [_parameter(scene, key, bounds) for key, bounds in pairs]


def _parameter(scene: Scene, key: str, bounds: tuple[float, float] | None) -> Parameter:
    try:
        start = found_in(scene, key)
    except InputError:
        raise InputError(
            f"--parameters {key}: the scene has no such key; keys are those of --set, such as "
            "contact.0.friction_coefficient"
        ) from None
    if isinstance(start, bool) or not isinstance(start, float | int):
        said = "chosen automatically" if start == "auto" else "no number"
        raise InputError(
            f"--parameters {key}: in the scene it is {said}; give it a number, where the search "
            "begins"
        )
    low, high = bounds or (-math.inf, math.inf)
    if not low < high:
        raise InputError(f"--parameters {key}={low:g}:{high:g}: LOW must be less than HIGH")
    if not low <= start <= high:
        raise InputError(
            f"--parameters {key}={low:g}:{high:g}: the search begins at the scene's {start:g}, "
            f"which is not between them; change the bounds, or begin elsewhere with --set "
            f"{key}=VALUE"
        )
    return Parameter(key, float(start), float(low), float(high))


def _read(word: str) -> tuple[str, tuple[float, float] | None]:
    """A key, and its bounds if there are some, of ``KEY`` or ``KEY=LOW:HIGH``."""
    key, equals, text = word.partition("=")
    if not equals:
        return key.strip(), None
    try:
        low, high = (float(end) for end in text.split(":"))
    except ValueError:
        low = high = math.nan
    if math.isnan(low) or math.isnan(high):
        raise InputError(f"--parameters {word}: write it as KEY or KEY=LOW:HIGH, with two numbers")
    return key.strip(), (low, high)
