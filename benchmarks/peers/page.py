"""docs/peers.md from the rows: tables between its marks, and the pictures."""

from __future__ import annotations

from pathlib import Path

from comparison import BARE, OURS, PROCESS, SOLVE, WHOLE, compare
from page_tables import filled, markdown
from pictures import draw, picture_of
from problems import PROBLEMS, Problem
from programs import programs
from rows import Row, answered


def write_page(rows: list[Row], docs: Path) -> None:
    """Fill the tables of the page in, and draw what it shows."""
    page = docs / "peers.md"
    text = filled(page.read_text(encoding="utf-8"), tables(rows))
    page.write_text(text, encoding="utf-8")
    for problem in PROBLEMS:
        draw(problem, rows, docs / "pictures" / picture_of(problem))


def tables(rows: list[Row]) -> dict[str, str]:
    """All tables of the page, by name."""
    made = {"programs": _programs(rows), "references": _references()}
    for problem in PROBLEMS:
        made[f"{problem.name}, ratios"] = _ratios(problem, rows)
        made[f"{problem.name}, runs"] = _runs(problem, rows)
    return made


def _programs(rows: list[Row]) -> str:
    cells = []
    for program in programs():
        versions = {row["version"] for row in answered(rows, program=program.NAME)}
        cells.append([program.NAME, ", ".join(sorted(versions)), program.ABOUT])
    return markdown(["program", "version", "how it is set up"], cells)


def _references() -> str:
    cells = []
    for problem in PROBLEMS:
        values = ", ".join(f"{name} {value:g}" for name, value in problem.references.items())
        cells.append([problem.title, values, problem.source])
    return markdown(["problem", "references", "from"], cells)


def _ratios(problem: Problem, rows: list[Row]) -> str:
    """Of every peer and quantity: solve and whole process, without and with error bars."""
    cells = []
    ways = [(setting, phase) for phase in (SOLVE, PROCESS) for setting in (BARE, WHOLE)]
    for program in programs():
        for quantity in problem.references:
            found = [compare(problem, rows, program.NAME, quantity, *way) for way in ways]
            if program.NAME != OURS and any(each is not None for each in found):
                cells.append([program.NAME, quantity, *map(str, found)])
    headings = ["solve", "solve, with our error bars", "process", "process, with our error bars"]
    return markdown(["program", "error of", *headings], cells)


def _runs(problem: Problem, rows: list[Row]) -> str:
    """Every run; of settings that have no answer, why."""
    cells = []
    of = [row for row in rows if row["problem"] == problem.name]
    for program in programs():
        for setting in program.SETTINGS.get(problem.name, {}):
            chosen = [r for r in of if (r["program"], r["setting"]) == (program.NAME, setting)]
            for row in sorted(chosen, key=lambda each: each["level"]):
                cells.append([program.NAME, setting, *_cells(problem, row)])
    headings = ["program", "setting", "unknowns", "solve", "process", "iterations, factorisations"]
    return markdown([*headings, *(f"error of {name}" for name in problem.references)], cells)


def _cells(problem: Problem, row: Row) -> list[str]:
    if "failed" in row:
        return ["", "", f"{row['process_seconds']:.3g} s", row["failed"].split("Error: ")[-1]]
    counted = f"{row['newton']}, {row['factorisations']}"
    seconds = [f"{row[phase]:.3g} s" for phase in (SOLVE, PROCESS)]
    errors = [
        f"{row['values'][name] / value - 1:+.1e}" if name in row["values"] else "?"
        for name, value in problem.references.items()
    ]
    return [f"{row['dofs']:,}", *seconds, counted, *errors]
