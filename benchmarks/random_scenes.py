"""Scenes at random: how many are solved, refused, not trusted.

``python benchmarks/random_scenes.py [--number 500] [--first 0] [--seed 9] [--few] [--json FILE]``

Also on several ranks. Scenes that are not trusted, that end without an answer, or that crash
are printed as Python; ``--first N --number 1`` with the same seed and the same version of
hypothesis solves one of them again.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import sys
import traceback
from collections import Counter
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fenics_contact import Result
from tests.random_outcomes import ANSWERED, UNTRUSTED, Outcome, outcome_of
from tests.random_scenes import RandomScene, draw

from mpi4py import MPI  # isort: skip  (FEniCSx comes first)

COMM = MPI.COMM_WORLD
CRASHED = "crashed"
NAMES = {
    ANSWERED: "answered, all checks passed",
    UNTRUSTED: "answered, a check failed",
    2: "refused (input, no equilibrium)",
    3: "not converged",
    5: "machine",
}
SECONDS = 300  # after which a scene is said to hang


def solve(seed: int, number: int, few: bool) -> dict[str, Any]:
    """A row of results; collective."""
    random = draw(seed, number, few_forms=few)
    faulthandler.dump_traceback_later(SECONDS, exit=True)
    try:
        outcome = outcome_of(random, COMM)
    except Exception:  # whatever it is, it is what is looked for
        if COMM.size > 1:
            raise  # other ranks may be waiting
        outcome = Outcome(-1, traceback.format_exc(), 0.0)
    faulthandler.cancel_dump_traceback_later()
    row = row_of(number, random, outcome)
    if COMM.rank == 0:
        tell(row, random)
    return row


def row_of(number: int, random: RandomScene, outcome: Outcome) -> dict[str, Any]:
    """What is kept of a scene."""
    scene, result = random.scene, outcome.result
    checks = {} if result is None else result.checks
    return {
        "number": number,
        "kind": random.kind,
        "kinematics": scene.kinematics,
        "cell": f"{random.cell} degree {scene.discretisation.degree} order {random.order}",
        "solver": scene.solver.solver if result is None else result.model["solver"],
        "strategy": scene.solver.strategy,
        "outcome": CRASHED if outcome.code < 0 else NAMES[outcome.code],
        "finite": outcome.finite,
        "slips_and_sticks": outcome.mixed,
        "areas": {} if result is None else areas_of(result),
        "seconds": outcome.seconds,
        "checks": {name: check.value / check.limit for name, check in checks.items()},
        "words": outcome.words,
    }


def areas_of(result: Result) -> dict[str, float]:
    """Of all contacts, by status."""
    points = result.points
    if points is None:
        return {}
    of_status = ((name, points.status == name) for name in ("OPEN", "STICK", "SLIP"))
    return {name: float(points.weights[chosen].sum()) for name, chosen in of_status}


def tell(row: dict[str, Any], random: RandomScene) -> None:
    """A line, and the whole scene where something is to be looked at."""
    mark = "slips and sticks" if row["slips_and_sticks"] else ""
    print(
        f"{row['number']:5} {row['kind']:12} {row['kinematics']:13} {row['cell']:32} "
        f"{row['seconds']:6.2f} s  {row['outcome']}; {mark}",
        flush=True,
    )
    if row["outcome"] != NAMES[ANSWERED] or not row["finite"]:
        failed = {name: round(share, 3) for name, share in row["checks"].items() if not share <= 1}
        print(f"      {row['words']} {failed or ''}", flush=True)
    if row["outcome"] in (CRASHED, NAMES[UNTRUSTED], NAMES[3]):
        print(f"      {random!r}", flush=True)


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts over all scenes, and how near to its limit each check came."""
    nearest: dict[str, float] = {}
    for row in rows:
        for name, share in row["checks"].items():
            nearest[name] = max(nearest.get(name, 0.0), share)
    solved = [row for row in rows if row["outcome"] in (NAMES[ANSWERED], NAMES[UNTRUSTED])]
    return {
        "scenes": len(rows),
        "outcomes": dict(Counter(row["outcome"] for row in rows)),
        "kinematics": dict(Counter(row["kinematics"] for row in rows)),
        "kinds": dict(Counter(row["kind"] for row in rows)),
        "solvers": dict(Counter(row["solver"] for row in rows)),
        "slip_and_stick_at_once": sum(row["slips_and_sticks"] for row in rows),
        "slip_and_stick_share_of_solved": sum(r["slips_and_sticks"] for r in solved)
        / max(len(solved), 1),
        "not_finite": sum(not row["finite"] for row in rows),
        "longest_seconds": max(row["seconds"] for row in rows),
        "seconds": sum(row["seconds"] for row in rows),
        "nearest_to_failing_over_limit": dict(sorted(nearest.items(), key=lambda item: -item[1])),
    }


def main() -> int:
    """Solve them, print what came out, and fail where a scene crashed or is not trusted."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=500, help="of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--few", action="store_true", help="few kinds of forms, as the tests")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.number)
    rows = [solve(options.seed, number, options.few) for number in numbers]
    found = summary(rows)
    if COMM.rank == 0:
        print(json.dumps(found, indent=2))
        if options.json:
            content = {"seed": options.seed, "summary": found, "rows": rows}
            options.json.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")
    return int(any(row["outcome"] in (CRASHED, NAMES[UNTRUSTED]) for row in rows))


if __name__ == "__main__":
    sys.exit(main())
