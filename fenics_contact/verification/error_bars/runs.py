"""Runs the cases of error bars, and keeps what they gave."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from mpi4py import MPI

from fenics_contact.common.errors import FenicsContactError
from fenics_contact.results.records.cycles import CycleRecord
from fenics_contact.results.records.record import Quantities
from fenics_contact.results.result import Result
from fenics_contact.simulation.scene_run import Run
from fenics_contact.verification.case import UntrustedError
from fenics_contact.verification.error_bars.case import (
    BarCase,
    Model,
    Reference,
    Row,
    Setting,
    rows_of,
    size_of,
    without_penalties,
)

# Of the last cycle, where loads come again.
CYCLE_LOSS = "cycle_loss"

Errors = Mapping[str, Mapping[str, float | None]]


@dataclass(frozen=True)
class Answer:
    """What a run found: quantities, and their estimated errors by source."""

    quantities: Quantities
    errors: Errors


Solver = Callable[[Model], Answer]


@dataclass(frozen=True)
class BarOutcome:
    """A case that was run.

    Attributes:
        case: The case.
        rows: Of all runs.
        notes: Of runs that gave no answer.
        seconds: For all.
    """

    case: BarCase
    rows: tuple[Row, ...]
    notes: tuple[str, ...]
    seconds: float


def answer_with_errors(model: Model) -> Answer:
    """Solve, and estimate all errors; collective."""
    found = _solved(model, "all")
    last = _last_cycle(found)
    if last is None:
        return Answer(found.quantities, found.errors)
    return Answer(_with_loss(found), {**found.errors, CYCLE_LOSS: last.errors})


def run_bar_case(case: BarCase, quick: bool, solver: Solver = answer_with_errors) -> BarOutcome:
    """Run a case; collective. Runs without an answer are noted."""
    started = time.perf_counter()
    references: dict[float, Reference] = {}
    rows: list[Row] = []
    notes: list[str] = []
    for setting in case.runs(quick):
        try:
            if setting.load not in references:
                references[setting.load] = reference_of(case, setting.load)
            answer = solver(case.model_of(setting))
        except FenicsContactError as error:
            notes.append(f"{words_of(setting)}: {error}")
            continue
        found = references[setting.load]
        rows += rows_of(case, setting, answer.quantities, answer.errors, found)
    seconds = MPI.COMM_WORLD.allreduce(time.perf_counter() - started, op=MPI.MAX)
    return BarOutcome(case, tuple(rows), tuple(notes), seconds)


def reference_of(case: BarCase, load: float) -> Reference:
    """The formula's, or that of the finer of two fine meshes; collective."""
    if case.exact is not None:
        return Reference(case.exact(load), {})
    assert case.finer is not None
    models = [case.finer(level, load) for level in (0, 1)]
    coarse, fine = (
        without_penalties(model.scene, _with_loss(_solved(model, "none"))) for model in models
    )
    doubt = {name: size_of(np.subtract(value, coarse[name])) for name, value in fine.items()}
    return Reference(fine, doubt)


def _last_cycle(found: Result) -> CycleRecord | None:
    return None if found.cycles is None else found.cycles.each[-1]


def _with_loss(found: Result) -> Quantities:
    """Its quantities, and what the last cycle lost."""
    last = _last_cycle(found)
    return found.quantities if last is None else {**found.quantities, CYCLE_LOSS: last.loss}


def words_of(setting: Setting) -> str:
    """A run in a few words."""
    return (
        f"{setting.element}, {setting.cells} cells, parameters {setting.level + 1}, load "
        f"{setting.load:g}"
    )


def _solved(model: Model, errors: Literal["all", "none"]) -> Result:
    """A result that converged, whatever the checks say of large parameters."""
    settings = dataclasses.replace(model.scene.solver, errors=errors)
    scene = dataclasses.replace(model.scene, solver=settings)
    result = Run(scene, MPI.COMM_WORLD, model.body).solve()
    if not result.converged:
        raise UntrustedError(result.verdict)
    return result
