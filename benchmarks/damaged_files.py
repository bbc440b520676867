"""Damaged mesh files at random: none may crash the program, hang it, or be solved wrongly.

``python benchmarks/damaged_files.py [--number 150] [--first 0] [--seed 1] [--only N …]
[--seconds 60]``

Files of Abaqus, Nastran and Gmsh of small blocks, each with a damage (``draws.py`` in
``tests/mesh/soundness``), are solved by a worker, which is replaced when it crashes or hangs. A
file is to be refused by one sentence, or to have the answer of the sound file within 1 %. Where the
damage may have made another sound body, any answer will do. Exit code 1 where one is wrong.
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import io
import json
import subprocess
import sys
import tempfile
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.mesh.soundness.draws import ANY, EITHER, REFUSAL, SAME, DamagedFile, draw, sound

QUANTITIES = ("normal_force", "strain_energy", "reaction")
SHARE = 0.01  # by which answers may differ


def parsed() -> argparse.Namespace:
    """What is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--number", type=int, default=150, help="of files")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="files of these numbers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60, help="after which a run hangs")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> int:
    """Run all, say what came out, and fail where something is wrong."""
    options = parsed()
    numbers = options.only or list(range(options.first, options.first + options.number))
    if options.worker:
        for number in numbers:
            print(json.dumps(row_of(options.seed, number, options.seconds)), flush=True)
        return 0
    rows: list[dict[str, Any]] = []
    while len(rows) < len(numbers):
        rows += rows_of_worker(numbers[len(rows) :], options)
    kinds = Counter(row["came"] for row in rows)
    print(f"{len(rows)} files: " + ", ".join(f"{n} {came}" for came, n in kinds.most_common()))
    return int(any(row["is_wrong"] for row in rows))


def rows_of_worker(numbers: list[int], options: argparse.Namespace) -> list[dict[str, Any]]:
    """What a worker makes of files, until it ends; its last file is a crash if it ends early."""
    command = [sys.executable, __file__, "--worker", "--seed", str(options.seed)]
    command += ["--seconds", str(options.seconds), "--only", *map(str, numbers)]
    rows = []
    with tempfile.TemporaryFile("w+") as errors:
        worker = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True)
        assert worker.stdout is not None
        for line in worker.stdout:
            rows.append(json.loads(line))
            say(rows[-1])
        worker.wait()
        if len(rows) < len(numbers):
            errors.seek(0)
            words = errors.read()[-3000:]
            came = "hung" if "Timeout (" in words else "crashed"
            number = numbers[len(rows)]
            row = {"number": number, "damage": "", "file": "", "came": came, "is_wrong": True}
            rows.append(row | {"words": words})
            say(rows[-1])
    return rows


def say(row: dict[str, Any]) -> None:
    """A line, and the words where something is to be looked at."""
    mark = "WRONG" if row["is_wrong"] else ""
    print(f"{row['number']:5} {row['file']:26} {row['damage']:36} {row['came']} {mark}", flush=True)
    if row["is_wrong"]:
        print(f"      {row['words']}", flush=True)


def row_of(seed: int, number: int, seconds: float) -> dict[str, Any]:
    """What becomes of a file."""
    damaged = draw(seed, number)
    faulthandler.dump_traceback_later(seconds, exit=True)
    code, words, values = solved(damaged)
    wanted = reference(damaged.key)
    faulthandler.cancel_dump_traceback_later()
    came, is_wrong = judged(damaged.must, code, words, values, wanted)
    file = f"{damaged.name} {damaged.key[0]} {damaged.key[1]}"
    return {
        "number": number,
        "file": file,
        "damage": damaged.damage,
        "came": came,
        "is_wrong": is_wrong,
        "words": words,
    }


def judged(
    must: str, code: int, words: str, values: list[float], wanted: list[float]
) -> tuple[str, bool]:
    """What came of a file, and whether it may."""
    if code == 2:
        is_one_sentence = words.count("\n") == 1 and "Traceback" not in words
        return "refused", must == SAME or not is_one_sentence
    if code in (3, 4):
        return "not trusted", must in (SAME, REFUSAL)
    if code != 0:
        return f"exit {code}", True
    if is_near(values, wanted):
        return "the same answer", must == REFUSAL
    return "another answer", must != ANY and must in (SAME, EITHER, REFUSAL)


def is_near(values: list[float], wanted: list[float]) -> bool:
    """Whether two answers are the same."""
    if len(values) != len(wanted):
        return False
    size = max(map(abs, wanted))
    return all(abs(a - b) <= SHARE * size for a, b in zip(values, wanted, strict=True))


@cache
def reference(key: tuple[str, int]) -> list[float]:
    """The answer of the sound file."""
    return solved(sound(key))[2]


def solved(file: DamagedFile) -> tuple[int, str, list[float]]:
    """Exit code of a run, what it says, and its answer."""
    from fenics_contact import main as program

    said = io.StringIO()
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.redirect_stderr(said),
        # What is not trusted is said there, where rows of this worker go.
        contextlib.redirect_stdout(said),
    ):
        (Path(folder) / file.name).write_bytes(file.text.encode())
        scene = Path(folder) / "scene.toml"
        scene.write_text(file.scene, encoding="utf-8")
        code = program(["run", str(scene), "--out", f"{folder}/out", "--quiet"])
        values: list[float] = []
        if code == 0:
            text = (Path(folder) / "out" / "result.json").read_text(encoding="utf-8")
            found = json.loads(text)["quantities"]
            for name in QUANTITIES:
                value = found.get(name, [])
                values += value if isinstance(value, list) else [value]
    return code, said.getvalue(), values


if __name__ == "__main__":
    sys.exit(main())
