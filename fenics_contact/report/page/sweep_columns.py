"""The quantities of a sweep: names, units and bars of the columns, and their values in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fenics_contact.common.wording import one_line
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_RADIUS,
    FRICTION_FORCE,
    MAX_CONTACT_PRESSURE,
    MAX_SLIP,
    NORMAL_FORCE,
    SLIP_AREA,
    STICK_AREA,
    STICK_RADIUS,
    STRAIN_ENERGY,
)
from fenics_contact.quantities.table import MEASURED_BY_PRELOADS, has_true_value, measured_by
from fenics_contact.report.page.sweep_files import SweepTable
from fenics_contact.results.records.record import UnitsRecord
from fenics_contact.results.rounding import rounded, sizes_of
from fenics_contact.results.tables import headed
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.reference import measured_by as measured_by_key
from fenics_contact.scene.scene import Scene

Cells = list[float | None]
# What is shown first, of what there is.
_FIRST = (
    *(NORMAL_FORCE, FRICTION_FORCE, MAX_CONTACT_PRESSURE, STICK_AREA, SLIP_AREA),
    *(MAX_SLIP, CONTACT_AREA, CONTACT_RADIUS, STICK_RADIUS),
)
_BAR, _OF_POINTS = "_error", "displacement_"
#: Where there is no value, and where there is no answer.
NO_VALUE = "none"


@dataclass(frozen=True)
class Quantity:
    """A number or a vector of every point of the grid.

    Attributes:
        owner: Name of the contact, support or preload; empty for the whole model.
        name: As in ``result.json``.
        parts: The columns of its components by axis, or its only one by an empty name.
        bars: Estimated errors, of a vector the length; None where the sweep has none.
    """

    owner: str
    name: str
    parts: Mapping[str, Cells]
    bars: Cells | None

    @property
    def measured(self) -> str:
        """Dimension, such as ``stress``."""
        if self.owner and self.name in MEASURED_BY_PRELOADS:
            return MEASURED_BY_PRELOADS[self.name]
        return "length" if self.name == "displacement" else measured_by(self.name)

    @property
    def words(self) -> str:
        """Its name in words."""
        return one_line(self.name.replace("_", " "))

    @property
    def rank(self) -> int:
        """Its place among those that are shown first; what is 0 everywhere is shown last."""
        if not any(cell for cells in self.parts.values() for cell in cells):
            return len(_FIRST) + 1
        return _FIRST.index(self.name) if self.name in _FIRST else len(_FIRST)

    def repeats(self, whole: Quantity | None) -> bool:
        """Whether this is of an owner, and the same as that of the whole model.

        Args:
            whole: The quantity of the same name of the whole model, if there is one.
        """
        return bool(self.owner) and whole is not None and self.parts == whole.parts

    def said(self, row: int, size: float, has_bars: bool) -> str:
        """Its value at a row in words, with its error bar or a ``?`` where there is none.

        Args:
            row: Of the grid.
            size: What it adds up from: less than round-off of this is 0.
            has_bars: Whether the sweep has bars at all.
        """
        values = [cells[row] for cells in self.parts.values()]
        found = [value for value in values if value is not None]
        if len(found) < len(values):
            return NO_VALUE
        value = found if "" not in self.parts else found[0]
        if not has_bars or (self.bars is None and not has_true_value(self.name)):
            return rounded(value, None, size)[0]
        bar = None if self.bars is None else self.bars[row]
        words, width = rounded(value, {"total": bar}, size)
        return f"{words} ± {width}" if width else words


def quantities_of(table: SweepTable) -> list[Quantity]:
    """The quantities of a table that have a value anywhere, what matters most first.

    Those of the only contact, and of the only support, are those of the whole model, and are left
    out.
    """
    columns = table.columns
    parts: dict[tuple[str, str], dict[str, Cells]] = {}
    for column, cells in columns.items():
        if not _is_bar(column, columns):
            owner, name, axis = _named(column, columns)
            parts.setdefault((owner, name), {})[axis] = cells
    found = [
        Quantity(owner, name, axes, columns.get(f"{owner}.{name}{_BAR}" if owner else name + _BAR))
        for (owner, name), axes in parts.items()
        if any(cell is not None for cells in axes.values() for cell in cells)
    ]
    whole = {quantity.name: quantity for quantity in found if not quantity.owner}
    own = [quantity for quantity in found if not quantity.repeats(whole.get(quantity.name))]
    return sorted(own, key=lambda quantity: quantity.rank)


def _is_bar(column: str, columns: Mapping[str, object]) -> bool:
    stem = column.removesuffix(_BAR)
    return stem != column and (stem in columns or f"{stem}_x" in columns)


def _named(column: str, columns: Mapping[str, object]) -> tuple[str, str, str]:
    """Owner, quantity and axis of a column; names of owners may have dots."""
    axis = column[-1] if column[-2:] in ("_x", "_y", "_z") and f"{column[:-2]}_x" in columns else ""
    stem = column[:-2] if axis else column
    if stem.startswith(_OF_POINTS):  # of a point, whose name may have dots as well
        return "", stem, axis
    owner, _, name = stem.rpartition(".")
    return owner, name, axis


def said_in_table(quantities: Sequence[Quantity], table: SweepTable) -> list[list[str]]:
    """All values in words, a list of cells for each quantity; empty where a point has no answer.

    Args:
        quantities: In the order of the columns.
        table: That they are of.
    """
    has_bars = any(quantity.bars is not None for quantity in quantities)
    cells: list[list[str]] = [[] for _ in quantities]
    for row in range(len(table.exit_codes)):
        sizes = _sizes(quantities, row)
        for quantity, column in zip(quantities, cells, strict=True):
            said = quantity.said(row, sizes.get(quantity.measured, 0.0), has_bars)
            column.append("" if said == NO_VALUE and table.exit_codes[row] else said)
    return cells


def _sizes(quantities: Sequence[Quantity], row: int) -> Mapping[str, float]:
    """How large what is measured gets at a row; by this it is told what is round-off."""
    owners: dict[str, dict[str, list[float]]] = {}
    for quantity in quantities:
        values = [cells[row] for cells in quantity.parts.values()]
        found = [value for value in values if value is not None]
        owners.setdefault(quantity.owner, {})[quantity.name] = found
    largest: dict[str, float] = {}
    for place in owners.values():
        numbers = {name: values for name, values in place.items() if values}
        energy = numbers.pop(STRAIN_ENERGY, [0.0])
        for kind, size in sizes_of({**numbers, STRAIN_ENERGY: energy[0]}, ()).items():
            largest[kind] = max(largest.get(kind, 0.0), size)
    return largest


def unit_of_key(key: str, units: UnitsRecord | None) -> str:
    """The unit of a varied key, such as ``contact.0.obstacle.indentation``; empty if it has none.

    Args:
        key: As for ``--set``.
        units: Of the sweep, if any.
    """
    tables: tuple[type, ...] = (Scene,)
    measured = ""
    for part in (part for part in key.split(".") if not part.isdigit()):
        measured = measured_by_key(part, *tables)
        inner = [one.tables for table in tables for one in keys_of(table) if one.name == part]
        tables = tuple(table for found in inner for table in found)
    return "" if units is None or "^" in measured else units.of(measured)


def label(quantity: Quantity, axis: str, units: UnitsRecord | None) -> str:
    """Return the label of an axis of a quantity, or of one of its components.

    Args:
        quantity: The quantity.
        axis: Of the component; empty where it has none.
        units: Of the sweep, if any.
    """
    words = f"{quantity.words} {axis}" if axis else quantity.words
    return headed(words, quantity.measured, units)
