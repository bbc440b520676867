"""Answers of a kept body from its contacts alone, without fields and error bars."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.condensed_forces import CondensedForces
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.evaluate.quantities import contact_points
from fenics_contact.problem.problem import Problem
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.records.contacts import PreloadRecord, SupportRecord
from fenics_contact.results.result import Check
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation import verdict
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.warm_start import Uniqueness, WarmStart
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import FindBody, Solution

# How an answer was begun: as a separate run does; at the last answer, where there is one answer
# only; or there all the same.
Start = Literal["cold", "warm", "followed"]
# What is done with the last load step of an answer besides, while its problem is there; collective.
Watch = Callable[[Problem, Solution], None]


@dataclass(frozen=True)
class Answer:
    """The last load step of a scene, as contacts and supports tell it.

    Attributes:
        converged: Whether there is one.
        said: Why not, in a sentence; or that a branch was followed.
        start: ``cold``: begun as a separate run begins; ``warm``: begun at the last answer, where
            no other answer may be; ``followed``: begun there though others may be.
        newton_iterations: Newton steps of the last load step.
        quantities: Those of the whole model, by their names.
        contacts: Those of each contact, in scene order.
        supports: Each support, without error bars.
        preloads: Of each preload, by its name.
        points: The contact points, as of a run's result; None without an answer.
        checks: Those of the physics that need no field in the body; None where none was asked for.
        verdict: Whether to trust it, in a few sentences.
    """

    converged: bool
    said: str
    start: Start
    newton_iterations: int = 0
    quantities: dict[str, Any] = field(default_factory=dict)
    contacts: list[dict[str, Any]] = field(default_factory=list)
    supports: list[SupportRecord] = field(default_factory=list)
    preloads: dict[str, PreloadRecord] = field(default_factory=dict)
    points: ContactPoints | None = None
    checks: dict[str, Check] | None = None
    verdict: str = ""

    @property
    def passed(self) -> bool:
        """Whether there is an answer that was checked, and every check holds."""
        return self.converged and self.checks is not None and not self._failed

    @property
    def exit_code(self) -> int | None:
        """0 passed, 3 not converged and 4 a check failed, as of a run; None if not checked."""
        if not self.converged:
            return NotConvergedError.exit_code
        if self.checks is None:
            return None
        return 4 if self._failed else 0

    @property
    def _failed(self) -> bool:
        return any(not check.passed for check in (self.checks or {}).values())


_FOLLOWED = (
    "The answer was followed from the last one; as there may be others, a separate run may find "
    "another one."
)


class QuickAnswers:
    """Answers on one body, each from the last one where that is safe; collective.

    Attributes:
        find_body: Gives what is inside the body in the last answer; None before there is one.

    Args:
        kept: The body.
    """

    def __init__(self, kept: KeptBody) -> None:
        self._kept = kept
        self.find_body: FindBody | None = None
        self._last: WarmStart | None = None
        self._uniqueness = Uniqueness()

    def answer(
        self, scene: Scene, follow: bool, checks: bool = True, watch: Watch | None = None
    ) -> Answer:
        """Solve a scene of the body; collective.

        Args:
            scene: The scene.
            follow: Begin at the last answer also where others may be.
            checks: Check the physics.
            watch: Called with the last load step, in whose state the problem is then; collective.

        Raises:
            InputError: The scene cannot be used, or has no equilibrium.
            MachineError: The machine failed.
        """
        timings = Timings()
        with self._kept.stepping_again(scene, timings) as (load_steps, system):
            history = StepHistory(system.problem, timings, partial(CondensedForces.of, system))
            history.begin([])
            taken = _QuickSteps(load_steps, history, watch)
            start = self._begin(load_steps, system, taken.warm, follow)
            try:
                solution = load_steps.solve(taken)
            except NotConvergedError as error:
                return Answer(
                    converged=False, said=str(error), start="cold", verdict=f"No answer: {error}"
                )
            if self._last is not None:
                taken.warm.know_without_friction(self._last.without_friction)
            self._last, self.find_body = taken.warm, solution.find_body
            return _measured(history, solution, start if load_steps.warm_steps else "cold", checks)

    def _begin(
        self, load_steps: LoadSteps, system: CondensedSystem, present: WarmStart, follow: bool
    ) -> Start:
        """Begin load steps at those of the last answer, where they may; collective.

        Args:
            load_steps: None of them is taken yet.
            system: Theirs.
            present: To which those that are taken are added.
            follow: As of ``answer``.

        Returns:
            How those begin that come from the last answer.
        """
        last, problem = self._last, system.problem
        if last is None or not last.suits(problem):
            return "cold"
        # How automatic steps are cut and grow depends on where they begin.
        listed = not problem.scene.steps.automatic
        is_sure = listed and self._uniqueness.is_sure(system)
        if not (is_sure or follow):
            return "cold"
        load_steps.begin_near(warm=lambda newton: last.solve(newton, len(present.steps)))
        return "warm" if is_sure else "followed"


class _QuickSteps(StepListener):
    """Adds the last load step of a quick answer to its history, and keeps all for the next answer.

    Attributes:
        warm: The load steps of this answer, from which the next one begins.
    """

    def __init__(
        self, load_steps: LoadSteps, history: StepHistory[InternalForces], watch: Watch | None
    ) -> None:
        self._load_steps, self._history, self._watch = load_steps, history, watch
        self.warm = WarmStart()

    def accepted(self, step: AcceptedStep) -> None:
        """Keep a load step; collective."""
        self.warm.keep(self._load_steps.newton)
        if self._load_steps.pace.next(step.time) is not None:
            self._history.pass_by(step.time, step.solution)
            return
        self._history.add(step.time, step.solution)
        if self._watch is not None:
            self._watch(self._load_steps.problem, step.solution)


def _measured(
    history: StepHistory[InternalForces], solution: Solution, start: Start, checks: bool
) -> Answer:
    """Return the answer of the last load step, in whose state the problem still is; collective."""
    problem, steps = history.forces.problem, history.steps
    found = history.checks() if checks else None
    return Answer(
        converged=True,
        said=_FOLLOWED if start == "followed" else "",
        start=start,
        newton_iterations=solution.newton_iterations,
        quantities=dict(steps[-1].quantities),
        contacts=history.by_contact,
        supports=history.supports,
        preloads=history.scalars,
        points=contact_points(problem, solution),
        checks=found,
        verdict=verdict.of_quick_answer(
            problem, solution, steps, found, history.energy_balance.open_share
        ),
    )
