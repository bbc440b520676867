"""Solves scenes of a list and adds a line for each to a file; started by ``random_scenes.py``.

``python random_worker.py JOB``, also under ``mpirun -n N``. JOB is a JSON file: ``seed``,
``kinds``, ``errors``, ``numbers``, ``stages`` (``coarse``, ``solver``, ``twin``, ``fine``,
``finest``), ``done`` (pairs of
number and stage that are left out), ``rows`` (where lines are added), ``now`` (which solve is under
way) and ``seconds`` (after which a solve hangs).
"""

from __future__ import annotations

import dataclasses
import faulthandler
import json
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from random_changes import wants_finest
from random_rows import row_of

from fenics_contact import Result
from fenics_contact.results.records.run import Model, Seconds
from tests.problem.existence.variational_inequality import normal_force
from tests.random.kinds import draw_any
from tests.random.outcomes import ANSWERED, UNTRUSTED, Outcome, outcome_of
from tests.random.scenes import RandomScene

from mpi4py import MPI  # isort: skip  (FEniCSx comes first)

COMM = MPI.COMM_WORLD
Solve = Callable[[RandomScene, MPI.Comm], Outcome]
CRASHED = -1


def work(job: dict[str, Any]) -> None:
    """All scenes of a job; collective."""
    done = {tuple(pair) for pair in job["done"]}
    for number in job["numbers"]:
        random = COMM.bcast(_drawn(job, number) if COMM.rank == 0 else None)
        stages = tuple(job["stages"])
        for stage in job["stages"]:
            if stage != "coarse" and stage not in stages:
                continue
            if stage == "solver" and (number, stage) not in done:
                scene = _by_other_solver(random, COMM.bcast(_solver_of(job, number)))
            else:
                scene = of_stage(random, stage)
            if scene is None or (number, stage) in done:
                continue
            if stage == "finest" and not COMM.bcast(COMM.rank == 0 and wanted(job, number)):
                continue
            given = {"number": number, "ranks": COMM.size, "stage": stage}
            given["has_twin"] = random.twin is not None
            solve = outcome_of
            if stage == "twin":
                given["factors"] = dict(random.twin.factors)
                solve = exact_outcome if random.twin.exact else outcome_of
            row = solved(scene, given, job, solve)
            if stage == "coarse" and row["code"] == UNTRUSTED:
                stages = ("twin",)  # which tells whether it is refused rightly
            elif stage == "coarse" and row["code"] != ANSWERED:
                break


def _drawn(job: dict[str, Any], number: int) -> RandomScene:
    return draw_any(job["seed"], number, job["kinds"], job["errors"])


def of_stage(random: RandomScene, stage: str) -> RandomScene | None:
    """What is solved; references need no errors of their own."""
    if stage == "coarse":
        return random
    if stage == "twin":
        return None if random.twin is None else _as_reference(random.twin.scene)
    finer = random.refined()
    return _as_reference(finer.refined() if stage == "finest" else finer)


def _solver_of(job: dict[str, Any], number: int) -> str:
    """The solver that a scene was solved by, on any number of ranks; on the root."""
    return next((row["solver"] for row in _rows(job, number) if row["stage"] == "coarse"), "full")


def _by_other_solver(random: RandomScene, solver: str) -> RandomScene:
    """The scene, by the direct solver that it was not solved by; without errors."""
    other = "condensed" if solver == "full" else "full"
    settings = dataclasses.replace(random.scene.solver, solver=other, errors="none")
    return dataclasses.replace(random, scene=dataclasses.replace(random.scene, solver=settings))


def wanted(job: dict[str, Any], number: int) -> bool:
    """Whether a third mesh tells more of a scene."""
    return wants_finest(_rows(job, number))


def _rows(job: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """Rows of a scene so far."""
    lines = Path(job["rows"]).read_text(encoding="utf-8").splitlines()[1:]
    return [row for row in map(json.loads, lines) if row["number"] == number]


def _as_reference(random: RandomScene) -> RandomScene:
    settings = dataclasses.replace(random.scene.solver, solver="auto", errors="none")
    return dataclasses.replace(random, scene=dataclasses.replace(random.scene, solver=settings))


def exact_outcome(random: RandomScene, comm: MPI.Comm) -> Outcome:
    """Of the variational inequality, which has neither penalty nor any of the program's solvers."""
    force = normal_force(random, random.body(comm))
    quantities = {"normal_force": force}
    model = Model(kinematics=random.scene.kinematics, contact_points=0, solver="exact")
    result = Result(
        title="",
        converged=True,
        verdict="exact",
        model=model,
        contacts=[],
        supports=[],
        quantities=quantities,
        steps=[],
        checks={},
        timings=Seconds(total=0.0),
        versions={},
    )
    return Outcome(ANSWERED, "exact", 0.0, result=result)


def solved(
    random: RandomScene, given: dict[str, Any], job: dict[str, Any], solve: Solve = outcome_of
) -> dict[str, Any]:
    """A row, which is written; collective."""
    if COMM.rank == 0:
        Path(job["now"]).write_text(json.dumps([given["number"], given["stage"]]), encoding="utf-8")
    faulthandler.dump_traceback_later(job["seconds"], exit=True)
    try:
        outcome = solve(random, COMM)
    except Exception:  # whatever it is, it is what is looked for
        if COMM.size > 1:
            traceback.print_exc()
            COMM.Abort(1)  # other ranks may be waiting
        outcome = Outcome(CRASHED, traceback.format_exc(), 0.0)
    row = given | row_of(random, outcome)
    faulthandler.cancel_dump_traceback_later()
    if row["code"] not in (ANSWERED, 2):
        row["scene"] = repr(random)
    if COMM.rank == 0:
        add_line(Path(job["rows"]), row)
    return row


def add_line(path: Path, row: dict[str, Any]) -> None:
    """A row as one line, whole or not at all; other processes add theirs."""
    line = json.dumps(row, default=float) + "\n"
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    try:
        os.write(handle, line.encode())
    finally:
        os.close(handle)


if __name__ == "__main__":
    work(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
