"""Error against time: the paper's slab and annulus, Hertz's contact and its like with friction.

``python benchmarks/work_precision.py [--quick] [--json FILE] [--plot DIR] [CASE …]``

Seconds are those of one process with all forms compiled: mesh, assembly, set-up, solve and the
estimation of errors, of all levels of the adaptive method together; without compilation and
output. Beside the true errors stand the estimated ones. ``docs/benchmarks.md`` shows them.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from precision_cases import ADAPTIVE, CASES, METHODS, Case, value_and_bar
from rich.console import Console
from rich.table import Table

from fenics_contact import Result, Scene, run
from fenics_contact.report.drawing.figures import new_figure, save_png, style
from fenics_contact.report.drawing.style import DOUBLE, LINES

COLOURS = {
    ADAPTIVE: LINES[0][0],
    "Q2 uniform": LINES[1][0],
    "Q2 graded": LINES[2][0],
    "P1 uniform": LINES[3][0],
}
MARKERS = {"P1 uniform": "^", "Q2 uniform": "s", "Q2 graded": "v", ADAPTIVE: "o"}
TARGETS = (1e-2, 1e-3)
# Runs shorter than this are made twice, and the faster one counts (s).
_SHORT = 3.0


def seconds_of(result: Result) -> float:
    """Of a run, without compilation and output."""
    timings = result.timings
    return timings["total"] - timings["compile"] - timings["output"]


def measured(case: Case, method: str, scene: Scene, again: bool = False) -> list[dict[str, Any]]:
    """A row a quantity; none where the run has no answer. Short ones may be made again."""
    result = run(scene)
    if not result.converged:
        print(f"{case.name} {method}: {result.verdict}", flush=True)
        return []
    seconds = seconds_of(result)
    if again and seconds < _SHORT:
        seconds = min(seconds, seconds_of(run(scene)))
    rows = []
    for quantity, reference in case.references.items():
        value, bar = value_and_bar(quantity, result.quantities, result.errors, case.without)
        rows.append(
            {
                "case": case.name,
                "method": method,
                "dofs": result.model["dofs"],
                "seconds": seconds,
                "estimation_seconds": result.timings["errors"],
                "quantity": quantity,
                "value": value,
                "reference": reference,
                "error": abs(value / reference - 1),
                "estimated_error": bar,
            }
        )
    return rows


def reached(rows: list[dict[str, Any]], target: float) -> str:
    """Seconds and dofs from which on the error of a series stays within a target."""
    first = len(rows)
    while first > 0 and rows[first - 1]["error"] <= target:
        first -= 1
    if first == len(rows):
        return "-"
    return f"{rows[first]['seconds']:.2f} s, {rows[first]['dofs']}"


def select(rows: list[dict[str, Any]], **keys: Any) -> list[dict[str, Any]]:
    """Rows with given entries."""
    return [row for row in rows if all(row[key] == value for key, value in keys.items())]


def print_table(case: Case, rows: list[dict[str, Any]]) -> None:
    """What every method takes to the targets, and how many of its bars hold."""
    table = Table("quantity", "method", *(f"to {t:.1%}" for t in TARGETS), "bars", title=case.title)
    for quantity in case.references:
        for method in case.levels:
            one = select(rows, case=case.name, quantity=quantity, method=method)
            barred = [row for row in one if row["estimated_error"] is not None]
            held = sum(row["error"] <= row["estimated_error"] for row in barred)
            cells = [reached(one, target) for target in TARGETS]
            table.add_row(quantity, method, *cells, f"{held} of {len(one)}")
    Console().print(table)


def plot(case: Case, rows: list[dict[str, Any]], path: Path) -> None:
    """A panel a quantity: true and estimated error against seconds."""
    with style():
        _plot(case, rows, path)


def _plot(case: Case, rows: list[dict[str, Any]], path: Path) -> None:
    from matplotlib.ticker import LogLocator

    names = list(case.references)
    size = (DOUBLE * max(1.0, len(names) / 4), 3.2)
    figure, panels = new_figure("", size, ncols=len(names), sharey=True)
    figure.suptitle(case.title, x=0.01, ha="left", fontsize=8.5)
    for panel, quantity in zip(panels, names, strict=True):
        for method in case.levels:
            one = select(rows, case=case.name, quantity=quantity, method=method)
            seconds = [row["seconds"] for row in one]
            style = {"color": COLOURS[method], "markersize": 3.5, "linewidth": 1.0}
            panel.loglog(
                seconds, [r["error"] for r in one], marker=MARKERS[method], label=method, **style
            )
            panel.loglog(
                seconds,
                [row["estimated_error"] or float("nan") for row in one],
                marker=MARKERS[method],
                markerfacecolor="white",
                linestyle=":",
                **style,
            )
        for target in TARGETS:
            panel.axhline(target, color="0.75", linewidth=0.8, zorder=0)
        panel.set_title(quantity.replace("_", " "))
        panel.set_xlabel("seconds")
        panel.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        panel.xaxis.set_major_formatter("{x:g}")
        panel.xaxis.set_minor_formatter("")
    panels[0].set_ylabel("relative error (dotted: estimated)")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    save_png(figure, path)


def chosen_cases(names: list[str]) -> list[Case]:
    """Cases by name, all without names."""
    return [case for case in CASES if not names or case.name in names]


def main() -> None:
    """Measure, print and, if asked, write and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    known = [case.name for case in CASES]
    parser.add_argument("names", nargs="*", metavar="CASE", help=f"of {', '.join(known)}")
    parser.add_argument("--quick", action="store_true", help="coarser: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    parser.add_argument("--plot", type=Path, metavar="DIR", help="draw, with matplotlib")
    options = parser.parse_args()
    for name in options.names:
        if name not in known:
            parser.error(f"no case '{name}'; there are {', '.join(known)}")
    rows: list[dict[str, Any]] = []
    cases = chosen_cases(options.names)
    for case in cases:
        for method in METHODS:
            if method not in case.levels:
                continue
            scenes = case.series(method, options.quick)
            run(scenes[0])  # compiles the forms
            for scene in scenes:
                rows += measured(case, method, scene, again=not options.quick)
            print(f"{case.name:11} {method:11} to {rows[-1]['dofs']:6} dofs", flush=True)
    for case in cases:
        print_table(case, rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    if options.plot:
        options.plot.mkdir(parents=True, exist_ok=True)
        for case in cases:
            plot(case, rows, options.plot / f"work_precision_{case.name}.png")


if __name__ == "__main__":
    main()
