"""The page of a sweep: one file that needs nothing else to be shown."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import outcome_of
from fenics_contact.common.wording import one_line
from fenics_contact.report.drawing.style import COLOURS, LINES
from fenics_contact.report.gallery import require
from fenics_contact.report.page.sweep_columns import (
    Quantity,
    label,
    quantities_of,
    said_in_table,
    unit_of_key,
)
from fenics_contact.report.page.sweep_files import (
    TABLE,
    SweepRecord,
    SweepTable,
    is_numeric,
    read_record,
    read_states,
    read_table,
)
from fenics_contact.report.page.sweep_states import FIELDS, MEASURED, packed_states
from fenics_contact.report.page.templates import file_text, render, style_sheet
from fenics_contact.report.page.view_page import packed
from fenics_contact.results.records.record import NO_UNITS
from fenics_contact.results.tables import headed

PAGE = "sweep.html"
_SCRIPTS = ("curves.js", "map.js", "states.js", "table.js", "sweep.js")
# Values of quantities that a page holds in 3 MB, and points that failed that it lists.
_MOST_CELLS, _MOST_FAILURES = 300_000, 500


def write_sweep_page(folder: Path) -> Path:
    """Write the page of a sweep from its files.

    Args:
        folder: With ``sweep.csv``, ``sweep.json`` and ``states.npz``.

    Returns:
        The path of the page, ``sweep.html`` in the folder.

    Raises:
        InputError: A file is missing or damaged, or they are of different sweeps; a library is
            missing.
        MachineError: The page could not be written.
    """
    record = read_record(folder)
    table, states = read_table(folder, record), read_states(folder, record)
    require("plotly")
    data = _data(record, table) | packed_states(states, record.kinematics)
    text = json.dumps(data, ensure_ascii=False, allow_nan=False)
    page = render(
        "sweep.html",
        title=one_line(record.title) or "Sweep",
        passed=not any(table.exit_codes),
        outcome=_outcome(table),
        facts=_facts(record),
        failures=_failures(record, table),
        failed=sum(code != 0 for code in table.exit_codes),
        left_out=data["left_out"],
        keys=data["keys"],
        has_bars=any(quantity["bars"] is not None for quantity in data["quantities"]),
        table=TABLE,
        style=style_sheet(),
        data=Markup(packed(text)),
        plotly=Markup(_plotly()),
        script=Markup("\n").join(map(file_text, _SCRIPTS)),
    )
    path = folder / PAGE
    replace_file(path, page.encode())
    return path


@cache
def _plotly() -> str:
    from plotly.offline import get_plotlyjs

    return packed(get_plotlyjs())


def _data(record: SweepRecord, table: SweepTable) -> dict[str, Any]:
    """All that the page draws but the contact states."""
    every, units = quantities_of(table), record.units or NO_UNITS
    quantities = every[: max(1, _MOST_CELLS // record.rows)]
    cells = said_in_table(quantities, table)
    return {
        "keys": [_key(key, values, record) for key, values in record.vary.items()],
        "codes": table.exit_codes,
        "outcomes": [outcome_of(code) for code in table.exit_codes],
        "failures": {row: one_line(said) for row, said in record.failures.items()},
        "quantities": [
            _drawn(quantity, said, record) for quantity, said in zip(quantities, cells, strict=True)
        ],
        "left_out": len(every) - len(quantities),
        "contacts": [one_line(name) for name in record.contacts],
        "labels": {name: headed(name, MEASURED[name], record.units) for name in FIELDS},
        "length": units.of("length"),
        "statuses": [
            {"name": name.lower(), "colour": COLOURS[name]} for name in ("OPEN", "STICK", "SLIP")
        ],
        "colours": [colour for colour, _ in LINES],
    }


def _key(key: str, values: list[Any], record: SweepRecord) -> dict[str, Any]:
    """A varied key: what it is called, its values, and whether they are numbers."""
    unit, name = unit_of_key(key, record.units), one_line(key)
    return {
        "name": name,
        "label": f"{name} ({unit})" if unit else name,
        "said": [_value(value) for value in values],
        "values": values if is_numeric(values) else None,
    }


def _value(value: object) -> str:
    if isinstance(value, str):
        return one_line(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    return json.dumps(value, ensure_ascii=False)


def _drawn(quantity: Quantity, said: list[str], record: SweepRecord) -> dict[str, Any]:
    """A quantity with its numbers as they stand in the table, and in words."""
    return {
        "owner": one_line(quantity.owner),
        "name": quantity.words,
        "label": label(quantity, "", record.units),
        "parts": [
            {"axis": axis, "label": label(quantity, axis, record.units), "values": cells}
            for axis, cells in quantity.parts.items()
        ],
        "bars": quantity.bars,
        "said": said,
    }


def _outcome(table: SweepTable) -> str:
    """In a few words what came out."""
    codes = table.exit_codes
    wrong = sum(code != 0 for code in codes)
    if not wrong:
        return f"✓ OK: all {len(codes)} points converged, and every check passed"
    return f"✗ {wrong} of {len(codes)} points have no answer that can be trusted"


def _facts(record: SweepRecord) -> list[str]:
    """Return sentences on what was varied, and on its cost."""
    varied = [f"Varied: {_varied(key, values, record)}." for key, values in record.vary.items()]
    times = record.bulk_factorisations
    factorised = "once" if times == 1 else f"{times} times"
    took = f"{record.seconds:.3g} s, the bulk was factorised {factorised}"
    return [
        *varied,
        f"Answered: {record.answered} of {record.rows} points in {took}.",
        f"Scene: {one_line(record.scene)}.",
    ]


def _varied(key: str, values: list[Any], record: SweepRecord) -> str:
    said, unit = [_value(value) for value in values], unit_of_key(key, record.units)
    unit = f" {unit}" if unit else ""
    if is_numeric(values) and len(values) > 4:
        return f"{one_line(key)}, {len(values)} values from {said[0]} to {said[-1]}{unit}"
    return f"{one_line(key)} = {', '.join(said)}{unit}"


def _failures(record: SweepRecord, table: SweepTable) -> list[tuple[int, str, str]]:
    """Return row, values of keys and reason of the first points that failed."""
    keys = [_key(key, values, record) for key, values in record.vary.items()]
    rows = [row for row, code in enumerate(table.exit_codes) if code][:_MOST_FAILURES]
    whys = [record.failures.get(row) or outcome_of(table.exit_codes[row]) for row in rows]
    return [(row, _point(keys, row), one_line(why)) for row, why in zip(rows, whys, strict=True)]


def _point(keys: list[dict[str, Any]], row: int) -> str:
    """The values of the keys at a row, the last of which runs fastest."""
    said = []
    for key in reversed(keys):
        row, number = divmod(row, len(key["said"]))
        said.append(f"{key['name']} = {key['said'][number]}")
    return ", ".join(reversed(said))
