"""Scenes at random: how many are solved, refused, not trusted; how far their error bars cover.

``python benchmarks/random_scenes.py [--number 500] [--first 0] [--seed 9] [--only N …]
[--kinds KIND …] [--refine] [--solvers]
[--errors none] [--ranks 1,2] [--jobs N] [--seconds 120] [--out FILE]``

Not under ``mpirun``: it starts workers (``random_worker.py``) on one and on several ranks, which
solve many scenes each and are replaced when they crash or hang. Every solve is a line of FILE; an
interrupted run (Ctrl-C) goes on where it stopped when it is started again with the same FILE.
``--refine`` solves each answered scene again with cells of half the size, and where bars are too
short, in plane models, on a third mesh; ``--solvers`` solves it by the other direct solver, to the
same numbers; ``--table docs/error_bars.md`` writes there what bars
cover. ``--only N`` solves the scene of this number alone, ``--kinds`` draws
scenes of these kinds in turn (``tests.random.kinds.KINDS``). Scenes of a number and seed stay the
same with the same sources (those of ``tests.random.scenes``, one in four: and the same hypothesis).
"""

from __future__ import annotations

import argparse
import json
import signal
import sys
import tempfile
from pathlib import Path
from typing import Any

from random_changes import wants_finest
from random_pool import Job, Pool
from random_summary import HEADING, failures, report, say, section

REFERENCES = ("twin", "fine", "finest")


def parsed() -> argparse.Namespace:
    """What is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=500, help="of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="scenes of these numbers")
    parser.add_argument("--seed", type=int, default=9)
    parser.add_argument("--kinds", nargs="+", default=(), metavar="KIND")
    parser.add_argument("--refine", action="store_true", help="solve again with cells of half")
    parser.add_argument("--errors", default="all", metavar="none", help="that are estimated")
    parser.add_argument("--solvers", action="store_true", help="solve by full and by condensed")
    parser.add_argument("--ranks", default="1", metavar="1,2", help="solve on each of these")
    parser.add_argument("--jobs", type=int, default=1, help="processes at once")
    parser.add_argument("--seconds", type=float, default=120, help="after which a solve hangs")
    parser.add_argument("--out", type=Path, metavar="FILE", help="of lines, one a solve; goes on")
    parser.add_argument("--table", type=Path, metavar="FILE", help="of Markdown, gets the coverage")
    return parser.parse_args()


def main() -> int:
    """Solve what FILE does not hold yet, say what came out, and fail where something is wrong."""
    options = parsed()
    ranks = [int(text) for text in options.ranks.split(",")]
    numbers = options.only or list(range(options.first, options.first + options.number))
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with tempfile.TemporaryDirectory() as folder:
        path = options.out or Path(folder) / "rows.jsonl"
        drawn = {"seed": options.seed, "kinds": list(options.kinds), "errors": options.errors}
        if not begin(path, drawn):
            return 2
        kinds, places = tuple(options.kinds), (path, Path(folder))
        given = (options.seed, kinds, options.seconds, options.jobs, say, options.errors)
        pool = Pool(*places, *given)
        stopped = False
        try:
            references = (*("solver",) * options.solvers, *REFERENCES[: 3 if options.refine else 1])
            pool.run(jobs(read(path), numbers, ranks, references))
        except KeyboardInterrupt:
            stopped = True
        rows = [row for row in read(path) if row["number"] in set(numbers)]
    print(report(rows))
    if options.table:
        write_section(options.table, section(rows, options.seed))
    return 130 if stopped else int(bool(failures(rows)))


def write_section(path: Path, text: str) -> None:
    """Put a section at the end of a page, in place of the one that was there."""
    before = path.read_text(encoding="utf-8") if path.exists() else ""
    path.write_text(before.split(HEADING)[0].rstrip() + f"\n\n{text}\n", encoding="utf-8")


def begin(path: Path, drawn: dict[str, Any]) -> bool:
    """Make the file, or get it ready to go on with; False, with a sentence, if it is of another."""
    if not path.exists() or not path.read_text(encoding="utf-8").strip():
        path.write_text(json.dumps(drawn) + "\n", encoding="utf-8")
        return True
    text = path.read_text(encoding="utf-8")
    whole = text[: text.rfind("\n") + 1]
    if whole != text:  # cut off while it was written
        path.write_text(whole, encoding="utf-8")
    found = {"kinds": [], "errors": "all"} | json.loads(whole.splitlines()[0])
    is_same = bool(found == {"kinds": [], "errors": "all"} | drawn)
    if not is_same:
        print(f"{path} holds scenes of {found}, not {drawn}: name another file with --out")
    return is_same


def read(path: Path) -> list[dict[str, Any]]:
    """All rows so far."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()[1:]]


def jobs(
    rows: list[dict[str, Any]],
    numbers: list[int],
    ranks: list[int],
    references: tuple[str, ...],
    size: int = 20,
) -> list[Job]:
    """What is still to be solved, some scenes each; references on the first number of ranks."""
    found = []
    for count in ranks:
        stages = ("coarse", *references) if count == ranks[0] else ("coarse",)
        done = {row["number"]: {} for row in rows}
        for row in rows:
            if row["ranks"] == count:
                done[row["number"]][row["stage"]] = row
        open_ones = [number for number in numbers if is_open(done.get(number, {}), stages)]
        pairs = {(number, stage) for number, of in done.items() for stage in of}
        for start in range(0, len(open_ones), size):
            found.append(Job(count, open_ones[start : start + size], stages, pairs))
    return found


def is_open(done: dict[str, dict[str, Any]], stages: tuple[str, ...]) -> bool:
    """Whether a solve of a scene is missing."""
    if "coarse" not in done:
        return True
    if done["coarse"]["code"] != 0:
        return False
    needless = set() if done["coarse"].get("has_twin") else {"twin"}
    if not wants_finest(done.values()):
        needless.add("finest")
    return any(stage not in done for stage in stages if stage not in needless)


if __name__ == "__main__":
    sys.exit(main())
