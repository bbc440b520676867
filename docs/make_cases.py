"""Write a page for each case of ``fenics-contact verify``: ``python docs/make_cases.py``.

The numbers are those of ``verified/measured.json``, which ``fenics-contact verify --json
docs/verified/measured.json`` writes; the words those of ``verified/words.md``, a section a case.
The build of the documentation calls ``make_all``.
"""

from __future__ import annotations

import inspect
import json
import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from fenics_contact.verification import CASES
from fenics_contact.verification.case import Case

DOCS = Path(__file__).resolve().parent
PAGES = DOCS / "cases"
WORDS = DOCS / "verified" / "words.md"
MEASURED = DOCS / "verified" / "measured.json"
Row = dict[str, Any]


class CasesError(Exception):
    """A case lacks its words or its numbers, or there are some of no case."""


def words() -> dict[str, str]:
    """What each case's problem is, by the case's name."""
    parts = re.split(r"^## (\w+)\n", WORDS.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    return {name: text.strip() for name, text in zip(parts[::2], parts[1::2], strict=True)}


def measured() -> dict[str, list[Row]]:
    """The rows of each case, by the case's name."""
    rows: dict[str, list[Row]] = {}
    for row in json.loads(MEASURED.read_text(encoding="utf-8")):
        rows.setdefault(row["name"], []).append(row)
    return rows


def make_all() -> None:
    """Write all pages.

    Raises:
        CasesError: Words, numbers and cases do not belong together.
    """
    said, rows = words(), measured()
    names = {case.name for case in CASES}
    for what, found in (("verified/words.md", said), ("verified/measured.json", rows)):
        if different := names ^ set(found):
            raise CasesError(f"docs/{what} and the cases differ: {', '.join(sorted(different))}")
    shutil.rmtree(PAGES, ignore_errors=True)
    PAGES.mkdir()
    for case in CASES:
        text = page(case, said[case.name], rows[case.name])
        (PAGES / f"{case.name}.md").write_text(text, encoding="utf-8")
    (PAGES / "index.md").write_text(overview(rows), encoding="utf-8")


def page(case: Case, problem: str, rows: Sequence[Row]) -> str:
    """Problem, reference, mesh, results of a case."""
    seconds = rows[0]["seconds"]
    lines = [
        f"# {case.name}: {case.summary}",
        "",
        "## Problem",
        "",
        problem,
        "",
        f"The scene, with all of its numbers, is built in `{_module(case)}`.",
        "",
        "## Reference",
        "",
        f"{case.source[0].upper()}{case.source[1:]}.",
        "",
        "## Meshes",
        "",
        *_meshes(rows[0]["meshes"]),
        "",
        "## Results",
        "",
        *table(rows),
        "",
        "```sh",
        f"fenics-contact verify {case.name}{' ' * 12}# {seconds:.0f} s on a machine of two cores",
        "```",
    ]
    return "\n".join(lines) + "\n"


def _module(case: Case) -> str:
    module = inspect.getmodule(case.run)
    assert module is not None
    return module.__name__.replace(".", "/") + ".py"


def _meshes(meshes: Sequence[str]) -> Iterator[str]:
    """A line a mesh; cases whose runs are processes of their own have none."""
    if not meshes:
        yield "Its runs are processes of their own."
    for mesh in meshes:
        yield f"- {mesh}"


def table(rows: Sequence[Row]) -> Iterator[str]:
    """Computed numbers beside what they should be; the bar where one was estimated."""
    barred = any(row["estimated_error"] is not None for row in rows)
    yield f"| quantity | computed | reference | error | allowed |{' error bar |' if barred else ''}"
    yield f"|---|---|---|---|---|{'---|' if barred else ''}"
    for row in rows:
        kind = " (abs)" if row["absolute"] else ""
        cells = [
            row["quantity"].replace("|", "\\|"),
            f"{row['value']:.7g}",
            f"{row['reference']:.7g}",
            f"{row['error']:.1e}{kind}",
            f"{row['tolerance']:.1e}",
        ]
        if barred:
            bar = row["estimated_error"]
            cells.append("?" if bar is None else f"{bar:.1e}")
        yield f"| {' | '.join(cells)} |"
    yield ""
    yield "Errors are relative, or absolute where marked (abs); so are the error bars beside them."


def overview(rows: dict[str, list[Row]]) -> str:
    """All cases with their largest error over what is allowed."""
    numbers = sum(len(found) for found in rows.values())
    lines = [
        "# A page a benchmark",
        "",
        f"{len(rows)} problems with {numbers} numbers beside formulas, published values and "
        "independent computations: problem, reference, mesh, result and error bar of each. "
        "`fenics-contact verify` runs them all.",
        "",
        "| case | what | compared with | numbers | largest error over what is allowed |",
        "|---|---|---|---|---|",
    ]
    for case in CASES:
        found = rows[case.name]
        largest = max(row["error"] / row["tolerance"] for row in found if row["tolerance"] > 0)
        cells = [f"[{case.name}]({case.name}.md)", case.summary, case.source, str(len(found))]
        lines.append(f"| {' | '.join([*cells, f'{largest:.2g}'])} |")
    lines += ["", "```{toctree}", ":hidden:", "", *(case.name for case in CASES), "```"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    make_all()
