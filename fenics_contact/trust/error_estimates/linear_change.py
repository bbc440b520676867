"""Change of an answer by small changes: its points keep touching, sticking and slipping.

Newton's method takes many steps from an answer to one beside it where thousands of points touch:
some open and close, and stiff penalties answer each of them with forces that are off by more than
the change itself. A change that is small enough leaves nearly all of them as they are. Then one
step with the tangent of the answer tells what it does, and what the whole of it does follows in
proportion. The tangent is factorised once for all changes.

Errors by the load steps are found so as well. A point slips as friction has it from where the load
step began, and one that closes within it from there, too, though it was open on the way. Of steps
twice as long that would be where the step before began. So the slip of each step that is not the
first after a turn of the loads counts from there, at the points that slip or have closed, and what
that does to the answer is what steps of their length do.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import TypeVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.quantities.names import SLIP_AREA, STICK_AREA, STICK_RADIUS
from fenics_contact.scene.loading.load_paths import knots
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.condensed.split_solver import SplitSolver
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.load_steps import between_turns
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Change,
    Look,
    Measure,
    Quantities,
    Visit,
    begin_at_answer,
    restore,
    seen,
    steps_again,
)

# Of a change, what is made of it: so little that next to no point opens, closes, sticks or slips
# by it, and so much that it stands out of the round-off of forces, gap over ε₁.
_SHARE = 1e-5
# By the same tangent: a change of a parameter changes it as well, by its share, so that forces
# which statics alone decide would be off by that share of themselves.
_STEPS = 2
# Of what steps twice as long would do if all that slips in them stuck from where they began: what
# covers the true errors of histories that were measured, by two and more.
_OF_STEPS = 0.5
# Of ε: what points that stick are shifted by at the most.
_OF_STICK = 0.1
# Of pseudo-times that are the same.
_SAME = 1e-9
# Memory for factors of tangents that are kept, over that of the condensed stiffness.
_KEPT = 1.0


Found = TypeVar("Found")


NO_STICK = (
    "Areas that stick and slip have no error bars: small changes say little of where these meet; "
    'solver.errors = "all" solves the whole history again.'
)


def without_stick(errors: Mapping[Hashable, float]) -> dict[Hashable, float]:
    """Return errors without those of areas and radii up to where points begin to slip."""
    names = (STICK_AREA, SLIP_AREA, STICK_RADIUS)
    return {
        key: error
        for key, error in errors.items()
        if (key[1] if isinstance(key, tuple) else key) not in names
    }


class LinearChange:
    """Answers with a small share of a change, by the tangent of the answer; collective.

    Args:
        load_steps: At their end, over a condensed system.
        measure: Quantities of a solution, called in its state; collective.
        steps: How many load steps there were.

    Attributes:
        again: The last load step again with such changes. What points creep in it, they creep in
            each of the load steps.
    """

    def __init__(self, load_steps: LoadSteps, measure: Measure, steps: int) -> None:
        assert load_steps.last is not None
        self._load_steps, self._measure = load_steps, measure
        system = load_steps.newton.system
        assert isinstance(system, CondensedSystem)
        self._system = system
        solution = load_steps.last.solution
        self.again = Again(
            measure(solution),
            solution.displacement,
            self._answer,
            stands_for=float(steps),
            share=_SHARE,
        )
        begin_at_answer(load_steps)
        system.linearise_truly()

    def _answer(self, change: Change, look: Look | None) -> Quantities:
        """Return the quantities with a change that is small; collective."""
        return self._after(change, seen(self._measure, look))

    def _after(self, change: Change, find: Callable[[Solution], Found]) -> Found:
        """Return what is found in the state that a change leads to; collective."""
        self._make(change)
        try:
            return find(self._load_steps.newton.solution())
        finally:
            restore(self._load_steps)

    def _make(self, change: Change) -> None:
        """Go from the answer to where a small change leads; collective."""
        problem = self._load_steps.problem
        begin_at_answer(self._load_steps)
        change(problem)
        for contact in problem.coulomb:
            contact.friction_term.follow_pressure()
        self._system.follow_supports()
        for _ in range(_STEPS):
            self._system.step_by_last_tangent()


class LinearHistory:
    """All load steps again with a small share of a change, each by the tangent at its end.

    What a load step leaves to the next ones, as slip that friction starts from and the length of a
    bolt that is locked, is that of the answer with the change.

    Args:
        load_steps: At their end, with the ends of all their steps.
        measure: As of ``LinearChange``.
        times: Pseudo-times of the steps.
    """

    def __init__(self, load_steps: LoadSteps, measure: Measure, times: Sequence[float]) -> None:
        self._load_steps, self._measure, self._times = load_steps, measure, times
        self._ends = load_steps.ends or {}
        self._away: dict[float, list[Array]] = {}
        self._share = 0.0
        self._steps = _KeptSteps((*knots(load_steps.problem.scene), times[-1]))
        # Where bodies are paired anew, the tangents of each history are over other unknowns.
        self._tangents = _KeptTangents(0.0 if self._searches_again else _KEPT)

    @cached_property
    def again(self) -> Again | None:
        """How the history with a change is found; collective.

        None where a step is not, or has no end over the unknowns that there are now.
        """
        size = len(self._load_steps.newton.system.position())
        ends = [self._ends.get(time) for time in self._times]
        if any(end is None or len(end.position) != size for end in ends):
            return None
        answer = self._answer(None, None, self._steps)
        if answer is None:
            return None
        last = self._steps.kept[-1].solution.displacement
        return Again(answer, last, self._answer, share=_SHARE, walk=self._walk)

    def _walk(self, visit: Visit) -> None:
        """Go to each load step without a change, and back to the answer; collective."""
        last = self._load_steps.last
        assert last is not None
        for step in self._steps.kept:
            self._load_steps.go_back_to(step)
            visit(step.time, step.solution)
        self._load_steps.go_back_to(last)

    def _answer(
        self, change: Change | None, look: Look | None, listener: StepListener | None = None
    ) -> Quantities | None:
        """Return the quantities at the end with a change that is small; collective."""
        done = iter(pairwise((None, *self._times)))
        calls = (change, partial(self._step, done), None, listener)
        measure = seen(self._measure, look)
        return steps_again(self._load_steps, measure, self._times, *calls)

    def step_errors(self) -> dict[Hashable, float] | None:
        """Estimated errors of the last load step's quantities by the load steps; collective.

        Returns:
            By quantity: absolute, of vectors the length of the difference; None where it does not
            tell them (``tells_steps``).
        """
        if self.again is None or not self.tells_steps:
            return None
        self._away = dict(self._counted_from_before())
        self._share = self._share_of_slips()
        try:
            shifted = replace(self.again, share=self._share)
            return shifted.effects(lambda share, problem: None, factor=_OF_STEPS)
        finally:
            self._away = {}

    @property
    def tells_steps(self) -> bool:
        """Whether it tells errors by the load steps.

        Not where bodies wear or were paired anew on the way, and not where loads turn at both ends
        of a load step.
        """
        wears = any(contact.wear.wears for contact in self._load_steps.problem.contacts)
        return not (wears or self._searches_again) and all(len(part) > 1 for part in self._parts)

    @property
    def _searches_again(self) -> bool:
        """Whether the contact search between bodies was repeated along the load steps."""
        contacts = self._load_steps.problem.contacts
        return any(contact.kinematics.paired_at is not None for contact in contacts)

    @property
    def _parts(self) -> list[list[float]]:
        """Pseudo-times in parts between turns of the loads."""
        return between_turns(self._times, knots(self._load_steps.problem.scene))

    def _counted_from_before(self) -> Iterator[tuple[float, list[Array]]]:
        """Yield load steps with how far before theirs the step before began, at each contact.

        At points that touch at their ends, (points, components) (length). What is not known of the
        first step of a part is what the others tell.
        """
        states, contacts = self._steps.states, self._load_steps.problem.contacts
        for part in self._parts:
            longer = len(part) / (len(part) - 1)
            for time in part[1:]:
                number, away = self._times.index(time), []
                for contact, *slips in zip(contacts, *states[: number + 1], strict=True):
                    before = slips[-2].slip
                    start = slips[-3].slip if number > 1 else np.zeros_like(before)
                    counts = contact.friction.follows_path & (slips[-1].status != OPEN)
                    away.append(longer * np.where(counts[:, None], start - before, 0.0))
                yield time, away

    def _share_of_slips(self) -> float:
        """So little of those slips that no point that sticks slips by it; collective."""
        found = _SHARE
        for away in self._away.values():
            for contact, one in zip(self._load_steps.problem.contacts, away, strict=True):
                farthest = largest(self._load_steps.problem.comm, np.linalg.norm(one, axis=1))
                if farthest > 0:
                    found = min(found, _OF_STICK * contact.regularisation_parameter / farthest)
        return found

    def _step(self, times: Iterator[tuple[float | None, float | None]], newton: Newton) -> Solution:
        """Take a load step from near its known end by the tangent there; collective."""
        system = newton.system
        assert isinstance(system, CondensedSystem)
        before, time = next(times)
        assert time is not None
        contacts = self._load_steps.problem.contacts
        for contact, away in zip(contacts, self._away.get(time, ()), strict=False):
            if contact.friction.follows_path:
                law = contact.friction
                law.reference = law.reference + self._share * away
        self._ends[time].begin(newton, None if before is None else self._ends[before])
        system.linearise_truly(self._tangents.at(time))
        system.step_by_last_tangent()
        self._tangents.keep(time, system.split_solver)
        return newton.solution()


class _KeptTangents:
    """Solvers of the tangents at the ends of load steps, for histories that pass near by.

    As many as there is room for.

    Args:
        room: Memory for their dense factors, over that of the condensed stiffness.
    """

    def __init__(self, room: float) -> None:
        self._kept: dict[float, SplitSolver] = {}
        self._room = room

    def at(self, time: float) -> SplitSolver | None:
        """Solver of the tangent at a load step; None where none is kept."""
        return self._kept.get(time)

    def keep(self, time: float, solver: SplitSolver | None) -> None:
        """Keep that of a load step of which there is none, where there is room."""
        if solver is not None and time not in self._kept and solver.memory <= self._room:
            self._kept[time] = solver
            self._room -= solver.memory


@dataclass(frozen=True, eq=False)
class _KeptSteps(StepListener):
    """Keeps load steps.

    Attributes:
        times: Pseudo-times of those that are kept.
        kept: So far.
        states: Of each contact, in every load step.
    """

    times: Sequence[float]
    kept: list[AcceptedStep] = field(default_factory=list)
    states: list[list[ContactState]] = field(default_factory=list)

    def accepted(self, step: AcceptedStep) -> None:
        """Keep a step, if it is one of those, and its states."""
        self.states.append(step.solution.states)
        if min(abs(time - step.time) for time in self.times) <= _SAME * step.time:
            self.kept.append(step)
