"""What further answers of one body cost, against a run from scratch.

``python benchmarks/study_cost.py [--quick] [--json FILE]``.

Each case asks a study for quick answers (``Study.quantities``) at values that differ by a per cent
each time, with and without checks, and at values of which each is begun anew; and for whole ones
(``Study.solve``), with fields and all checks. Some cases have contacts that are solved exactly.
The page of ``explore`` is asked for answers as a slider asks, with the displacement of the body.
Without ``--quick``, a larger body in space, a thousand points of friction coefficient and load on
66,000 unknowns in the plane, and Hertz's force over a hundred indentations are added. Times are
CPU time of one rank, the median of several; with ``OMP_NUM_THREADS=1``, as ``./bootstrap`` sets
it.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI
from rich.console import Console
from rich.table import Table

from fenics_contact import Body, Scene, SolverSettings, Study, load_scene
from fenics_contact.explore.explorer import Explorer
from fenics_contact.verification.memory_check import BlockCase, slab
from fenics_contact.verification.memory_worker import body_of, scene_of

DEMOS = Path(__file__).resolve().parent.parent / "demos"
COMM = MPI.COMM_WORLD
MU, DEPTH = "contact.0.friction_coefficient", "contact.0.obstacle.indentation"
NO_BARS, EXACT = "solver.errors=none", "solver.strategy=exact"
# Answers that are timed, after those that warm the caches up.
ANSWERS, FIRST = 9, 2
PER_CENT = 0.01
# Seconds that were asked for: of a further answer by dimension; a cold one may cost five times as
# much, one with checks twice as much. Where contacts are solved exactly: of a further answer, of a
# cold one; one with checks may cost 1.5 times as much.
LIMITS, COLD, CHECKED = {2: 0.005, 3: 0.06}, 5.0, 2.0
EXACT_LIMITS, EXACT_COLD, EXACT_CHECKED = {2: 0.003, 3: 0.015}, 0.01, 1.5
FRAMES_A_SECOND = 60
POINTS, CHECKED_EVERY, SWEEP_LIMIT = 1000, 50, 8.0


@dataclass(frozen=True)
class Asked:
    """A case: a scene, and the value that changes.

    Attributes:
        name: For the table.
        make: Gives the scene, and its mesh where the scene names none.
        key: Of the value.
        value: Where it begins.
        follow: Whether answers are followed, as nobody knows whether there is but one.
    """

    name: str
    make: Callable[[], tuple[Scene, Body | None]]
    key: str
    value: float
    follow: bool = False


def demo(name: str, *settings: str) -> Callable[[], tuple[Scene, Body | None]]:
    """A demo without error bars."""
    return lambda: (load_scene(DEMOS / f"{name}.toml", [NO_BARS, *settings]), None)


def block(case: BlockCase, strategy: str = "auto") -> Callable[[], tuple[Scene, Body | None]]:
    """A block of the benchmark of costs."""
    settings = SolverSettings(errors="none", strategy=strategy)
    return lambda: (replace(scene_of(case, "auto"), solver=settings), body_of(case, COMM))


FINE = ("mesh.parameters.size=0.088", "mesh.parameters.cells_outside=36")
QUICK = [
    Asked("sphere, friction", demo("sphere"), MU, 0.6),
    Asked("sphere, indentation", demo("sphere"), DEPTH, 1.0),
    Asked("sphere, radius", demo("sphere"), "contact.0.obstacle.radius", 8.0),
    Asked("slab, load", demo("slab"), "load.0.traction.0", -300.0),
    Asked("slab on springs, friction", demo("winkler"), MU, 0.6, follow=True),
    Asked("block in space, friction", block(slab("P1 tets", 24)), MU, 0.3),
    Asked("sphere, exact, friction", demo("sphere", EXACT), MU, 0.6),
    Asked("sphere, exact, indentation", demo("sphere", EXACT), DEPTH, 1.0),
    Asked("block in space, exact, friction", block(slab("P1 tets", 24), "exact"), MU, 0.3),
]
FULL = [
    Asked("sphere, fine, friction", demo("sphere", *FINE), MU, 0.6),
    Asked("large block in space, friction", block(slab("P1 tets", 40)), MU, 0.3),
    Asked("large block in space, indentation", block(slab("P1 tets", 40)), DEPTH, 0.02),
]


@contextmanager
def timed(seconds: list[float]) -> Iterator[None]:
    """Add the CPU time of what is done to a list."""
    begun = time.process_time()
    yield
    seconds.append(time.process_time() - begun)


def median(ask: Callable[[float], Any], value: float, change: float) -> float:
    """Of the answers at values each of which differs from the last one by a share."""
    seconds: list[float] = []
    for number in range(FIRST + ANSWERS):
        with timed(seconds):
            ask(value * (1 + change * number))
    return statistics.median(seconds[FIRST:])


def measure(asked: Asked) -> dict[str, Any]:
    """A row of one case."""
    scene, body = asked.make()
    study = Study(scene, body=body)
    first: list[float] = []
    with timed(first):
        result = study.solve()
    starts: set[str] = set()
    newton: list[int] = []

    def quick(value: float, checks: bool = False) -> None:
        answer = study.quantities({asked.key: value}, follow=asked.follow, checks=checks)
        assert answer.converged, answer.said
        starts.add(answer.start)
        newton.append(answer.newton_iterations)

    def cold(value: float) -> None:
        study.forget_answer()
        quick(value)

    begun_anew = median(cold, asked.value, PER_CENT)
    starts.clear()
    quick(asked.value)
    newton.clear()
    warm = median(quick, asked.value, PER_CENT)
    checked = median(partial(quick, checks=True), asked.value, PER_CENT)
    whole = median(lambda value: study.solve({asked.key: value}), asked.value, PER_CENT)
    contacts = study.run.problem.contacts if study.run is not None else []
    limit, cold_limit = LIMITS[scene.dimension], COLD * LIMITS[scene.dimension]
    checked_limit = CHECKED * limit
    if scene.is_exact:
        limit, cold_limit = EXACT_LIMITS[scene.dimension], EXACT_COLD
        checked_limit = EXACT_CHECKED * limit
    return {
        "case": asked.name,
        "dimension": scene.dimension,
        "dofs": result.model.dofs,
        "contact_dofs": sum(len(c.trace.surface.dofs) for c in contacts),
        "first_seconds": first[0],
        "cold_seconds": begun_anew,
        "warm_seconds": warm,
        "checked_seconds": checked,
        "warm_start": "/".join(sorted(starts - {"cold"})) or "cold",
        "newton": statistics.median(newton),
        "whole_seconds": whole,
        "limit": limit,
        "cold_limit": cold_limit,
        "checked_limit": checked_limit,
        "factorisations": study.factorisations,
    }


def explored(*settings: str) -> dict[str, Any]:
    """Answers to a slider that moves an indentation, with the displacement of the body."""
    scene, _ = demo("sphere", *settings)()
    explorer = Explorer(Study(scene))

    def ask(value: float) -> None:
        *_, answer = explorer.follow({DEPTH: value})
        assert answer.kind == "answer"

    return {
        "case": " ".join(("explore, indentation of the sphere", *settings)),
        "dimension": 2,
        "a_second": 1 / median(ask, 1.0, PER_CENT),
        "least": FRAMES_A_SECOND,
    }


def thousand_points(*settings: str) -> dict[str, Any]:
    """A grid of friction coefficient and load, checked; every 50th with fields and all checks."""
    scene, _ = demo("sphere", *FINE, *settings)()
    study, seconds, passed = Study(scene), [], True
    with timed(seconds):
        dofs = study.solve().model.dofs
        for number in range(POINTS):
            row, column = divmod(number, 40)
            column = column if row % 2 == 0 else 39 - column  # to and fro: neighbours are near
            changes = {MU: 0.2 + 0.02 * row, DEPTH: 0.6 + 0.01 * column}
            if number % CHECKED_EVERY == 0:
                passed &= study.solve(changes).passed
            passed &= study.quantities(changes).passed
    return {
        "case": " ".join((f"{POINTS} points of friction and indentation", *settings)),
        "dimension": 2,
        "dofs": dofs,
        "seconds": seconds[0],
        "limit": SWEEP_LIMIT,
        "passed": passed,
        "factorisations": study.factorisations,
    }


def hertz(depths: int) -> dict[str, Any]:
    """Largest error of F = 4/3 E* √R d^(3/2) from a depth of .25 on."""
    scene, _ = demo("sphere", "contact.0.friction_coefficient=0")()
    study, seconds, worst = Study(scene), [], 0.0
    with timed(seconds):
        for depth in np.linspace(2 / depths, 2, depths):
            answer = study.quantities({DEPTH: float(depth)}, checks=False)
            force = answer.quantities["normal_force"]
            exact = 4 / 3 * 1000 / (1 - 0.3**2) * 8**0.5 * depth**1.5
            if depth >= 0.25:
                worst = max(worst, abs(force / exact - 1))
    return {
        "case": f"Hertz's force over {depths} indentations",
        "dimension": 2,
        "seconds": seconds[0],
        "largest_error": worst,
        "limit": 0.005,
        "factorisations": study.factorisations,
    }


def print_table(rows: list[Mapping[str, Any]]) -> None:
    """Milliseconds beside their limits."""
    table = Table(title="What a further answer costs (milliseconds of CPU time)")
    table.add_column("case")
    for heading in ("dofs", "contact dofs", "first", "cold", "limit", "warm", "limit"):
        table.add_column(heading, justify="right")
    for heading in ("with checks", "limit", "Newton"):
        table.add_column(heading, justify="right")
    table.add_column("begun")
    table.add_column("with fields, checks", justify="right")
    for row in rows:
        if "warm_seconds" not in row:
            continue
        times = {key: 1000 * row[key] for key in row if key.endswith(("seconds", "limit"))}
        table.add_row(
            row["case"],
            f"{row['dofs']:,}",
            str(row["contact_dofs"]),
            f"{times['first_seconds']:.0f}",
            *_beside(times["cold_seconds"], times["cold_limit"]),
            *_beside(times["warm_seconds"], times["limit"]),
            *_beside(times["checked_seconds"], times["checked_limit"]),
            f"{row['newton']:g}",
            row["warm_start"],
            f"{times['whole_seconds']:.0f}",
        )
    console = Console(width=160)
    console.print(table)
    for row in rows:
        if "warm_seconds" not in row:
            console.print(", ".join(f"{key} {value}" for key, value in row.items()))


def _beside(found: float, limit: float) -> tuple[str, str]:
    return f"{found:.1f}{' !' if found > limit else ''}", f"{limit:g}"


def main() -> None:
    """Measure, print and, if asked, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer cases: about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows")
    options = parser.parse_args()
    rows = [measure(asked) for asked in (QUICK if options.quick else QUICK + FULL)]
    rows += [explored(), explored(EXACT), hertz(12 if options.quick else 100)]
    if not options.quick:
        rows += [thousand_points(), thousand_points(EXACT)]
    print_table(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
