"""Reference of ``result.json``, read off the records: for ``docs/results.md``.

``python docs/make_results.py`` writes the tables into the page.
"""

from __future__ import annotations

import re
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from fenics_contact.quantities.table import every
from fenics_contact.results.records.record import Record, meanings
from fenics_contact.results.records.run import RunRecord

_NAMES = {
    str: "text",
    int: "whole number",
    float: "number",
    bool: "`true` or `false`",
    type(None): "`null`",
    typing.Any: "value",
}
_UNIT = re.compile(r" \((force|length|s|MB)\)")


def key_tables() -> str:
    """Every key of ``result.json``: a table of each kind of object, in Markdown."""
    text: list[str] = []
    for record, places in records().items():
        title = ", ".join(f"`{place}`" for place in places) or "The whole file"
        summary = (record.__doc__ or "").strip().splitlines()[0]
        text += ["", f"### {title}", "", summary, ""]
        text += ["| key | value | unit | meaning |", "|---|---|---|---|", *_rows(record)]
    return "\n".join(text).strip()


def quantity_tables() -> dict[str, str]:
    """Every quantity, in Markdown: those of each contact, and those of the whole model alone."""
    of_contacts = ["| key | unit | meaning | whole model |", "|---|---|---|---|"]
    of_the_whole = ["| key | unit | meaning |", "|---|---|---|"]
    for one in every():
        row = f"| `{one.name}` | {one.unit} | {one.meaning} |"
        if one.whole:
            of_contacts.append(f"{row} {one.whole} |")
        else:
            of_the_whole.append(row)
    return {"contact quantities": "\n".join(of_contacts), "quantities": "\n".join(of_the_whole)}


def with_tables(page: str) -> str:
    """The page with today's tables between its marks, ``<!-- NAME -->`` and ``<!-- end -->``."""
    for name, table in (quantity_tables() | {"keys": key_tables()}).items():
        before, mark, rest = page.partition(f"<!-- {name} -->\n")
        _, end, after = rest.partition("<!-- end -->")
        page = f"{before}{mark}\n{table}\n\n{end}{after}"
    return page


def records() -> dict[type[Record], list[str]]:
    """All kinds of objects, with the places at which they stand."""
    found: dict[type[Record], list[str]] = {RunRecord: []}
    waiting: list[tuple[type[Record], str]] = [(RunRecord, "")]
    while waiting:
        record, place = waiting.pop(0)
        for name, hint in _hints(record).items():
            for inner, mark in _inside(hint):
                at = f"{place}{name}{mark}"
                if inner is not record:  # a check holds checks of parts
                    found.setdefault(inner, []).append(at)
                    waiting.append((inner, f"{at}."))
    return found


def _hints(record: type[Record]) -> dict[str, Any]:
    """Types of the keys, in the order of the file."""
    hints = typing.get_type_hints(record)
    names = [one.name for one in fields(record)]
    return {name: hints[name] for name in names}


def _inside(hint: Any, mark: str = "") -> Iterator[tuple[type[Record], str]]:
    """Records inside a type, and how they are reached: in a list, or by a name."""
    if isinstance(hint, type) and issubclass(hint, Record):
        yield hint, mark
    origin = typing.get_origin(hint)
    more = "[]" if origin is list else ".NAME" if origin is Mapping else ""
    for part in typing.get_args(hint):
        yield from _inside(part, mark + more)


def _rows(record: type[Record]) -> list[str]:
    said, rows = meanings(record), []
    for name, hint in _hints(record).items():
        meaning, unit = said[name], ""
        found = _UNIT.search(meaning)
        if found:
            meaning, unit = _UNIT.sub("", meaning), found[1]
        if name in record.LEFT_OUT:
            meaning = f"{meaning.rstrip('.')}; left out where there is none."
        value = _value(hint, may_be_null=name not in record.LEFT_OUT)
        rows.append(f"| `{name}` | {value} | {unit} | {meaning} |")
    return rows


def _value(hint: Any, may_be_null: bool = True) -> str:
    """Return in words which values a key holds."""
    origin, parts = typing.get_origin(hint), typing.get_args(hint)
    if origin is typing.Literal:
        return " or ".join(f'`"{word}"`' for word in parts)
    if origin in (typing.Union, types.UnionType):
        kept = [part for part in parts if may_be_null or part is not type(None)]
        return " or ".join(map(_value, kept))
    if origin is list:
        return (
            f"list of {_value(parts[0]).replace('object', 'objects').replace('number', 'numbers')}"
        )
    if origin is Mapping:
        return f"name → {_value(parts[1])}"
    if isinstance(hint, type) and issubclass(hint, Record):
        return "object"
    return _NAMES[hint]
