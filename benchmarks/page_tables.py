"""Tables of a documentation page, written between its marks.

A mark is a line ``<!-- table: NAME -->`` before a table, and ``<!-- end of table -->`` after it.
"""

from __future__ import annotations

import re

_TABLE = re.compile(r"(<!-- table: (.+?) -->\n).*?(<!-- end of table -->)", re.DOTALL)


def filled(page: str, tables: dict[str, str]) -> str:
    """A page with these tables in place of those that it has.

    Raises:
        ValueError: A table that there is to be is missing on the page, or is not known.
    """
    names = [found[1] for found in _TABLE.findall(page)]
    if sorted(names) != sorted(tables):
        raise ValueError(f"the page has the tables {names}, and is to have {list(tables)}")
    return _TABLE.sub(lambda found: f"{found[1]}{tables[found[2]]}{found[3]}", page)


def markdown(headings: list[str], rows: list[list[str]]) -> str:
    """A table of cells."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)
