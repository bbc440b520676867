"""What is said of scenes at random: a line a solve, and of all together."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from typing import Any

from random_changes import Change, independent, refinements, refused_rightly, short_bars
from random_coverage import (
    against_statics,
    coverage,
    rank_differences,
    solver_differences,
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
# Of the section in docs/error_bars.md; ``verify --errors --table`` leaves it there.
HEADING = "## Scenes at random"


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
    too_coarse = refused_rightly(rows)
    found = [
        f"{row['number']} ({row['kind']}), {row['ranks']} ranks, {row['stage']}: "
        f"{NAMES[row['code']]}"
        for row in rows
        if row["code"] in (-1, -2)
        or (_is_not_trusted(row) and row["number"] not in too_coarse)
        or not row.get("finite", True)
    ]
    found += [
        f"{row['number']} ({row['kind']}), {row['ranks']} ranks: {text}"
        for row in rows
        for text in row.get("faults", ())
    ]
    found += against_statics(rows) + rank_differences(rows) + solver_differences(rows)
    return found + [f"wrong and passed: {words(change)}" for change in wrong(rows, listed=False)]


def _is_not_trusted(row: Row) -> bool:
    """Whether a failed check ends what should have been answered."""
    return row["code"] == 4 and row.get("must_be") not in ("refused", "seen")


def wrong(rows: list[Row], listed: bool) -> list[Change]:
    """Numbers that passed, but are off by more than 3 bars and 1 %.

    Args:
        rows: All of them.
        listed: Those of which a cause is known that is only listed, or the others.
    """
    found = [change for change in (*refinements(rows), *independent(rows)) if change.wrong]
    return [change for change in found if bool(change.causes) == listed]


def words(change: Change) -> str:
    """A change in a line."""
    bar = "none" if change.bar is None else f"{change.bar:.3g}"
    share = change.change / change.size if change.size else float("inf")
    cause = f"; {', '.join(change.causes)}" if change.causes else ""
    return (
        f"{change.number} ({change.kind}) {change.name}: {change.change:.3g} ({share:.1%}), "
        f"bar {bar}, against {change.against}{cause}"
    )


def report(rows: list[Row]) -> str:
    """Outcomes by kind, failures, coverage, bars that are too short."""
    lines = ["", outcomes(rows), "", nearest(rows), ""]
    coarse = sorted(refused_rightly(rows))
    lines += [f"{len(coarse)} not trusted, and off their twins: {', '.join(map(str, coarse))}"]
    failed = failures(rows)
    lines += [f"{len(failed)} failures", *(f"  {text}" for text in failed), ""]
    listed = wrong(rows, listed=True)
    lines += [f"{len(listed)} wrong and passed, listed by cause"]
    lines += [*(f"  {words(change)}" for change in listed), "", table(coverage(rows)), ""]
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
    """Bars that do not cover, the farthest first; answers that are off without a bar."""
    short = short_bars(changes)
    lines = [f"{len(short)} bars are too short; the shortest:"]
    lines += [f"  {words(change)}" for change in short[:_LISTED]]
    bare = [
        change
        for change in changes
        if change.bar is None and change.against != "refined" and change.far
    ]
    lines.append(f"{len(bare)} are off an independent answer by more than 1 % without a bar")
    return lines + [f"  {words(change)}" for change in bare[:_LISTED]]


def section(rows: list[Row], seed: int) -> str:
    """Coverage for ``docs/error_bars.md``, with the bars that are too short."""
    solved = {row["number"] for row in rows if row["stage"] == "coarse"}
    finer = {row["number"] for row in rows if row["stage"] == "fine" and row["code"] == 0}
    short = short_bars(list(refinements(rows)))
    causes = Counter(", ".join(change.causes) or "no cause known" for change in short)
    counts = {"wrong": len(wrong(rows, listed=False)), "listed": len(wrong(rows, listed=True))}
    codes: dict[int, set[int]] = {}
    for row in rows:
        if row["stage"] == "coarse":
            codes.setdefault(row["number"], set()).add(row["code"])
    ranks = Counter(row["number"] for row in rows if row["stage"] == "coarse")
    counts["several"] = sum(count > 1 for count in ranks.values())
    counts["otherwise"] = sum(len(found) > 1 for found in codes.values())
    lines = [
        HEADING,
        "",
        _INTRODUCTION.format(seed=seed, scenes=len(solved), finer=len(finer), **counts),
        table(coverage(rows)),
        "",
        f"{len(short)} bars are too short: "
        + ", ".join(f"{count} ({cause})" for cause, count in causes.most_common())
        + ". The shortest, each with the number of its scene (`--only`):",
        "",
        "| scene | kind | quantity | change | of its size | bar | cause |",
        "|---|---|---|---|---|---|---|",
        *(_short_row(change) for change in short[:25]),
    ]
    return "\n".join(lines)


def _short_row(change: Change) -> str:
    share = change.change / change.size if change.size else float("inf")
    return (
        f"| {change.number} | {change.kind} | {change.name} | {change.change:.2g} | {share:.1e} | "
        f"{change.bar:.2g} | {', '.join(change.causes)} |"
    )


_INTRODUCTION = """\
Written by `python benchmarks/random_scenes.py --seed {seed} --number {scenes} --refine --ranks 1,2
--out FILE --table docs/error_bars.md`. The scenes are drawn, not chosen, and meshes are coarse.
Each that was answered with all checks passed is solved again with cells of half the size; *covered*
is the share of changes that are no larger than the bar of the coarse answer. A missing bar does not
cover, unless the run says that the quantity does not converge (and a third mesh, where there is
one, does not contradict); changes below 1e-9 of the size are left out. Of {scenes} scenes, {finer}
were answered on both meshes. {wrong} numbers were *wrong and passed*: off by more than 3 bars and
by more than 1 %. {listed} more were, of which the cause is listed below: edges of what touches or
sticks that lie inside cells (these areas move by more than 2 % with the mesh, or the edge is that
of a punch; areas and the largest slip, which single points decide, also where it moves by less), or
numbers that oscillate with the mesh (the third mesh takes back more than a quarter of the change).
{several} of the scenes were solved on 1 and 2 ranks, {otherwise} of these with another outcome.

Cells of order 1 keep their polygon when they are halved; those of order 2 come nearer to the curve.
"""
