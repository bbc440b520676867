"""Mesh after mesh, until the estimated errors are those that a scene allows.

Mesh, solve, estimate, find sizes: each level starts from the answer of the last one, where there
is a single load step; histories are run anew. Penalties and regularisations that the scene left to
the program are made smaller where it is they that decide; what the scene has set stays, and is
named as the reason where the accuracy is not reached for it.
"""

from __future__ import annotations

import dataclasses
import logging
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import TypeVar

import numpy as np

from fenics_contact.common.errors import FenicsContactError, StoppedError
from fenics_contact.common.failures import attempt
from fenics_contact.common.parallel import from_root, total
from fenics_contact.quantities.names import STRAIN_ENERGY
from fenics_contact.results.check_messages import (
    energy_line,
    level_line,
    not_reached,
    reached,
    source_advice,
)
from fenics_contact.results.records.record import Errors
from fenics_contact.results.records.run import AccuracyRecord, LevelRecord, Seconds
from fenics_contact.results.result import Result
from fenics_contact.scene.quantity_names import in_words
from fenics_contact.scene.settings import Accuracy
from fenics_contact.simulation.adaptive.goals import GoalFinder
from fenics_contact.simulation.adaptive.next_mesh import finer_there, hindrance, sizes_by_curvature
from fenics_contact.simulation.adaptive.target_mesh_size import (
    BudgetExceededError,
    TargetMeshSize,
)
from fenics_contact.simulation.adaptive.targets import (
    asked_of,
    balanced,
    is_met,
    measured_keys,
    others_than_mesh,
    relative_errors,
)
from fenics_contact.simulation.adaptive.transfer import transfer_state
from fenics_contact.simulation.scene_run import Run
from fenics_contact.solve.load_steps.accepted_step import Unknowns
from fenics_contact.trust.convergence.unbounded import LevelHistory, said, without_bars
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors

logger = logging.getLogger(__name__)

T = TypeVar("T")
# Meshes in a row on which an error may be unknown.
_PATIENCE = 3

SolveLevel = Callable[[Run, Unknowns | None], Result]


class AdaptiveRun:
    """The levels of a scene that asks for an accuracy.

    Attributes:
        run: That of the result: of the last level that was solved.
        levels: What came out of each.

    Args:
        first: The scene made ready on its first mesh.
        has_own_body: Whether its mesh was passed, and is not the scene's.

    Raises:
        InputError: The scene has nothing of what it asks for, or it cannot be estimated.
    """

    def __init__(self, first: Run, has_own_body: bool = False) -> None:
        assert first.scene.accuracy is not None
        self.run = first
        self.levels: list[LevelRecord] = []
        self._accuracy: Accuracy = first.scene.accuracy
        self._has_own_body = has_own_body
        self._seconds: dict[str, float] = {}
        self._between = 0.0
        self._coarse = 0  # levels too coarse for what touches, of which errors say nothing
        self._history = LevelHistory()
        self.asked = asked_of(first)
        self._goals = GoalFinder(self.asked)
        self._hindrance = hindrance(first.scene, first.problem.body, has_own_body)
        self._first_sizes = sizes_by_curvature(first)

    def solve(self, solve_level: SolveLevel) -> Result:
        """Solve level after level; collective.

        Args:
            solve_level: Solves one, from a guess if there is one; also writes it, if it likes.

        Returns:
            The last level's result, with ``levels`` and ``accuracy``.
        """
        run, guess, last = self.run, None, None
        while True:
            run.listen_at_end(self._goals)
            solve = partial(solve_level, run, guess)
            result = solve() if last is None else self._tried("the next mesh has no answer", solve)
            if isinstance(result, str):
                assert last is not None
                return self._with_levels(last, result)
            if not result.converged:
                return self._failed(result, last)
            if result.interrupted:
                self.run = run
                return self._interrupted(result)
            errors = relative_errors(result, self.asked, run.scene.names, _applied(run))
            self._note(run, result, errors)
            self.run, last = run, result
            coarse = run.end.budget.coarse
            self._coarse += len(coarse) > 0
            reason = "" if coarse else self._unbounded(last)
            is_there = is_met(errors, self.asked) and not coarse and not self._beyond(last)
            if is_there and not reason:
                return self._done(last, "")
            reason = reason or self._reason_to_stop(errors, last)
            if reason:
                return self._done(last, reason)
            try:
                found = self._tried("the next mesh failed", partial(self._next_run, errors, result))
            except BudgetExceededError as error:
                return self._done(last, str(error))
            except StoppedError:
                return self._interrupted(last)
            except FenicsContactError as error:
                return self._with_levels(last, f"the next mesh failed: {error}")
            if isinstance(found, str):
                return self._with_levels(last, found)
            run = found
            if not run.scene.load_steps.several and self.run.end.last is not None:
                guess = transfer_state(self.run.problem, run.problem, self.run.end.last)

    def _tried(self, missing: str, action: Callable[[], T]) -> T | str:
        """Return the result of an action; where it fails, in words what is missing; collective."""
        notes: list[str] = []
        expected = FenicsContactError, BudgetExceededError
        found = attempt(self.run.problem.comm, missing, action, None, notes, expected)
        return notes[0].removesuffix(".") if found is None else found

    def _note(self, run: Run, result: Result, errors: Errors) -> None:
        for phase, seconds in result.timings.items():
            self._seconds[phase] = self._seconds.get(phase, 0.0) + seconds
        local, energy = run.end.budget.local, result.quantities[STRAIN_ENERGY]
        self.levels.append(
            LevelRecord(
                dofs=result.model.dofs,
                cells=result.model.cells,
                seconds=result.timings.total + self._between,
                energy_error=None if local is None else _over_energy(local, energy),
                errors={name: found["total"] for name, found in errors.items()},
                sources=errors,
            )
        )
        self._history.add(result)
        logger.info(level_line(len(self.levels), self.levels[-1], self.asked))
        if len(self.levels) == 1 and self._by_energy:
            logger.info(energy_line(self._by_energy))

    @property
    def _by_energy(self) -> Mapping[str, str]:
        """Quantities without an adjoint, and why, on the last mesh with estimated errors."""
        return {} if self._goals.found is None else self._goals.found.by_energy

    def _unbounded(self, result: Result) -> str:
        """Why some of what is asked for does not converge, or nothing."""
        keys = measured_keys(result, self.asked, self.run.scene.names)
        found = [why for key, why in self.run.end.budget.unbounded.items() if key in keys.values()]
        away = [key for key in keys.values() if self._history.runs_away(key)]
        return found[0] if found else said(away, result) if away else ""

    def _beyond(self, result: Result) -> list[str]:
        """Return requested quantities that differ from the mesh before by more than both bars."""
        keys = measured_keys(result, self.asked, self.run.scene.names)
        return [name for name, key in keys.items() if self._history.is_beyond(key)]

    def _reason_to_stop(self, errors: Errors, result: Result) -> str:
        """Why no further level can help, or nothing."""
        if self.run.end.budget.coarse:
            return self._hindrance or self._used_up(result)
        unknown = self._not_estimated(errors)
        if unknown:
            return unknown
        for name, found in errors.items():
            kept = {s: v for s, v in others_than_mesh(found).items() if not self._can_reduce(s)}
            mesh = found["mesh"] or 0.0
            if sum(kept.values()) >= self.asked[name] and mesh < sum(kept.values()):
                source = max(kept, key=lambda source: kept[source])
                return (
                    f"of the error of {name}, {kept[source]:.1e} is of the {source}, which no mesh "
                    f"changes: {source_advice(source)}"
                )
        return self._hindrance or self._used_up(result)

    def _used_up(self, result: Result) -> str:
        """Return in words that no further level is allowed, or nothing."""
        if len(self.levels) >= self._accuracy.max_levels:
            most = self._accuracy.max_levels
            if self.run.end.budget.coarse:
                return f"the accuracy.max_levels = {most} meshes are used up"
            beyond = " and ".join(in_words(name) for name in self._beyond(result))
            if beyond:
                return (
                    f"the accuracy.max_levels = {most} meshes are used up, and the last two differ "
                    f"in {beyond} by more than their error bars"
                )
            return f"the accuracy.max_levels = {most} meshes are used up"
        return ""

    def _not_estimated(self, errors: Errors) -> str:
        """Return in words which errors are unknown, and will be on any mesh, or nothing."""
        unknown = {
            name: [s for s, v in found.items() if v is None and s != "total"]
            for name, found in errors.items()
            if found["total"] is None
        }
        for name, sources in unknown.items():
            if not sources:
                return f"the answer has no {in_words(name)}"
            if self.run.end.budget.local is None or sources != ["mesh"]:
                return f"the error of {name} by {' and '.join(sources)} could not be estimated"
        last = [level.errors for level in self.levels[self._coarse :][-_PATIENCE:]]
        for name in unknown:
            if len(last) == _PATIENCE and all(level[name] is None for level in last):
                why = "; under a corner the pressure has no bound" if "pressure" in name else ""
                return f"the error of {name} could not be estimated on {_PATIENCE} meshes{why}"
        return ""

    def _can_reduce(self, source: str) -> bool:
        """Whether the scene left it to the program, at some contact."""
        scene = self.run.scene
        if source == "penalty":
            return any(contact.penalty_parameter == "auto" for contact in scene.contact)
        if source == "regularisation":
            return any(contact.regularisation_parameter == "auto" for contact in scene.contact)
        return False

    def _next_run(self, errors: Errors, result: Result) -> Run:
        """The scene on the next mesh; collective."""
        began = time.perf_counter()
        comm, scene, coarse = self.run.problem.comm, self.run.scene, self.run.end.budget.coarse
        if coarse:  # what errors say is not of what touches
            rows = np.concatenate([one.finer for one in coarse])
            body = finer_there(scene, self.run.problem.spaces, rows, self._has_own_body)
        else:
            goals = self._goals.found
            if goals is None:
                raise BudgetExceededError("it was not found which cells are to be smaller")
            sizes = self._first_sizes
            target = TargetMeshSize(self.run, self.levels, self.asked, errors, goals, sizes)
            body = target.mesh(self._has_own_body)
            scene = balanced(scene, result, errors, self.asked)
        self._between = from_root(comm, time.perf_counter() - began)
        for phase in ("mesh", "total"):
            self._seconds[phase] += self._between
        return Run(scene, comm, body)

    def _failed(self, result: Result, last: Result | None) -> Result:
        """A level that did not converge, or was interrupted: the one before stands."""
        if last is None:
            return self._with_levels(result, "the first mesh has no answer")
        if result.interrupted:
            return self._interrupted(last)
        return self._with_levels(last, f"the next mesh has no answer: {result.verdict}")

    def _interrupted(self, last: Result) -> Result:
        found = self._with_levels(last, "the run was interrupted")
        return dataclasses.replace(found, interrupted=True)

    def _done(self, result: Result, reason: str) -> Result:
        """Return the result of the last level, with what its analyses find; collective."""
        found = self.run.with_all_asked(result)
        for phase in self.run.analyses.phases:
            self._seconds[phase] = found.timings[phase]
            self._seconds["total"] += found.timings[phase]
        return self._with_levels(found, reason)

    def _with_levels(self, result: Result, reason: str) -> Result:
        words = not_reached(reason) if reason else reached(len(self.levels))
        return dataclasses.replace(
            without_bars(result, self._history.runaways()),
            timings=Seconds(**self._seconds) if self._seconds else result.timings,
            verdict=f"{result.verdict} {words}",
            levels=self.levels,
            accuracy=AccuracyRecord(
                asked=self.asked, reached=not reason, reason=reason, by_energy=self._by_energy
            ),
        )


def _applied(run: Run) -> float:
    """Sum of the sizes of the loads' nodal forces at present (force); collective."""
    problem = run.problem
    return float(total(problem.comm, np.abs(problem.load[: problem.spaces.owned_nodes]).sum()))


def _over_energy(local: LocalErrors, energy: float) -> float | None:
    """Error of the displacement over it, in the energy norm."""
    return float(local.total / np.sqrt(2 * energy)) if energy > 0 else None
