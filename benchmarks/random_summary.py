"""What is said of scenes at random: a line a solve, and of all together."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import Any

from random_coverage import (
    Change,
    against_statics,
    coverage,
    independent,
    rank_differences,
    refinements,
    table,
)

Row = dict[str, Any]
NAMES = {
    0: "answered, all checks passed",
    4: "answered, a check failed",
    2: "refused (input, no equilibrium)",
    3: "not converged",
    5: "machine",
    -1: "crashed",
    -2: "hung",
}
_LISTED = 60


def say(row: Row) -> None:
    """A line, and the words where something is to be looked at."""
    mark = "slips and sticks" if row.get("slips_and_sticks") else ""
    print(
        f"{row['number']:5} {row['ranks']} {row['stage']:6} {row['kind']:14} "
        f"{row.get('kinematics', ''):13} {row.get('cell', ''):32} {row['seconds']:6.2f} s  "
        f"{NAMES[row['code']]}; {mark}",
        flush=True,
    )
    if row["code"] != 0:
        checks = row.get("checks", {}).items()
        failed = {name: round(share, 3) for name, share in checks if not share <= 1}
        print(f"      {row['words']} {failed or ''}", flush=True)


def failures(rows: list[Row]) -> list[str]:
    """What must not be: a crash, a hang, an answer that is not trusted or wrong."""
    found = [
        f"{row['number']} ({row['kind']}), {row['ranks']} ranks, {row['stage']}: "
        f"{NAMES[row['code']]}"
        for row in rows
        if row["code"] in (-1, -2, 4) or not row.get("finite", True)
    ]
    found += against_statics(rows) + rank_differences(rows)
    wrong = [change for change in (*refinements(rows), *independent(rows)) if change.wrong]
    return found + [f"wrong and passed: {words(change)}" for change in wrong]


def words(change: Change) -> str:
    """A change in a line."""
    bar = "none" if change.bar is None else f"{change.bar:.3g}"
    share = change.change / change.size if change.size else float("inf")
    cause = f"; {change.cause}" if change.cause else ""
    return (
        f"{change.number} ({change.kind}) {change.name}: {change.change:.3g} ({share:.1%}), "
        f"bar {bar}, against {change.against}{cause}"
    )


def report(rows: list[Row]) -> str:
    """Outcomes by kind, failures, coverage, bars that are too short."""
    lines = ["", outcomes(rows), "", nearest(rows), ""]
    failed = failures(rows)
    lines += [f"{len(failed)} failures", *(f"  {text}" for text in failed), ""]
    lines += [table(coverage(rows)), ""]
    lines += _short(list(refinements(rows)) + list(independent(rows)))
    return "\n".join(lines)


def outcomes(rows: list[Row]) -> str:
    """How many of each kind ended how, on the coarse mesh, by number of ranks."""
    counts: dict[tuple[str, int], Counter[str]] = defaultdict(Counter)
    seconds: dict[tuple[str, int], float] = defaultdict(float)
    for row in rows:
        seconds[row["stage"], row["ranks"]] += row["seconds"]
        if row["stage"] == "coarse":
            counts[row["kind"], row["ranks"]][NAMES[row["code"]]] += 1
    lines = [
        f"{kind:15} {ranks} rank(s)  " + ", ".join(f"{n} {name}" for name, n in of.most_common())
        for (kind, ranks), of in sorted(counts.items())
    ]
    solved = [row for row in rows if row["stage"] == "coarse" and row["code"] in (0, 4)]
    mixed = sum(row["slips_and_sticks"] for row in solved)
    lines.append(f"slip and stick at once: {mixed} of {len(solved)} that were answered")
    spent = (f"{stage} on {n}: {value:.0f} s" for (stage, n), value in sorted(seconds.items()))
    return "\n".join([*lines, "seconds: " + ", ".join(spent)])


def nearest(rows: Iterable[Row]) -> str:
    """How near to its limit each check came, of what passed."""
    found: dict[str, tuple[float, int]] = {}
    for row in rows:
        if row["code"] == 0 and row["stage"] == "coarse":
            for name, share in row["checks"].items():
                found[name] = max(found.get(name, (0.0, -1)), (share, row["number"]))
    ordered = sorted(found.items(), key=lambda item: -item[1][0])
    near = ", ".join(f"{name} {share:.2g} ({number})" for name, (share, number) in ordered)
    return f"nearest to failing, over the limit: {near}"


def _short(changes: list[Change]) -> list[str]:
    """Bars that do not cover, the farthest first."""
    short = [change for change in changes if change.bar is not None and not change.covered]
    short.sort(key=lambda change: -change.change / max(change.bar or 0.0, 1e-300))
    lines = [f"{len(short)} bars are too short; the shortest:"]
    lines += [f"  {words(change)}" for change in short[:_LISTED]]
    bare = [
        c for c in changes if c.bar is None and c.against != "refined" and c.change > 0.01 * c.size
    ]
    lines.append(f"{len(bare)} are off an independent answer by more than 1 % without a bar")
    return lines + [f"  {words(change)}" for change in bare[:_LISTED]]
