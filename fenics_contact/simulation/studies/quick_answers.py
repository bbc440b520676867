"""What the contacts of a kept body tell of an answer: without fields, checks and error bars."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.evaluate.contact_resultants import resultant
from fenics_contact.evaluate.quantities import (
    contact_points,
    contact_quantities,
    of_all_contacts,
    preload_records,
)
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.problem import Problem
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.records.contacts import PreloadRecord
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.studies.warm_start import Uniqueness, WarmStart
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.systems.body_answer import FindBody

# How an answer was begun: as a separate run does; at the last answer, where there is one answer
# only; or there all the same.
Start = Literal["cold", "warm", "followed"]


@dataclass(frozen=True)
class Answer:
    """The last load step of a scene, as its contacts tell it.

    Attributes:
        converged: Whether there is one.
        said: Why not, in a sentence; or that a branch was followed.
        start: ``cold``: begun as a separate run begins; ``warm``: begun at the last answer, where
            no other answer may be; ``followed``: begun there though others may be.
        newton_iterations: Newton steps of the last load step.
        quantities: Those of the whole model that need no field in the body, by their names.
        contacts: Those of each contact, in scene order.
        preloads: Of each preload, by its name.
        points: The contact points, as of a run's result; None without an answer.
    """

    converged: bool
    said: str
    start: Start
    newton_iterations: int = 0
    quantities: dict[str, Any] = field(default_factory=dict)
    contacts: list[dict[str, Any]] = field(default_factory=list)
    preloads: dict[str, PreloadRecord] = field(default_factory=dict)
    points: ContactPoints | None = None


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

    def answer(self, scene: Scene, follow: bool) -> Answer:
        """Solve a scene of the body; collective.

        Args:
            scene: The scene.
            follow: Begin at the last answer also where others may be.

        Raises:
            InputError: The scene cannot be used, or has no equilibrium.
            MachineError: The machine failed.
        """
        timings = Timings()
        problem = Problem(scene, self._kept.discrete, timings, by_points=True)
        require_equilibrium(problem)
        system = CondensedSystem(problem, timings, self._kept.condense(problem, timings))
        try:
            return self._solved(system, timings, follow)
        finally:
            system.destroy()

    def _solved(self, system: CondensedSystem, timings: Timings, follow: bool) -> Answer:
        problem = system.problem
        newton = Newton(problem, system, timings)
        first: list[WarmStart] = []
        found: list[Answer] = []

        def accepted(time: float, solution: Solution) -> None:
            if not first:
                first.append(WarmStart(newton, self._last))
            if time >= problem.scene.steps.last * (1 - 1e-9):
                begun: Start = start if load_steps.warm is not None else "cold"
                found.append(_measured(problem, solution, begun))
                self.find_body = solution.find_body

        load_steps = LoadSteps(newton, accepted)
        load_steps.finds_body = False
        start: Start = "cold"
        if self._last is not None and self._last.suits(problem):
            is_sure = self._uniqueness.is_sure(system)
            if is_sure or follow:
                load_steps.warm = self._last.solve
                start = "warm" if is_sure else "followed"
        try:
            load_steps.solve()
        except NotConvergedError as error:
            return Answer(converged=False, said=str(error), start="cold")
        self._last = first[0]
        return found[-1]


def _measured(problem: Problem, solution: Solution, start: Start) -> Answer:
    """Of the last load step, before slip is counted anew; collective."""
    contacts = [contact_quantities(problem, solution, n) for n in range(len(problem.contacts))]
    return Answer(
        converged=True,
        said=_FOLLOWED if start == "followed" else "",
        start=start,
        newton_iterations=solution.newton_iterations,
        quantities={**of_all_contacts(contacts), "reaction": _reaction(problem, solution)},
        contacts=contacts,
        preloads=preload_records(problem, solution),
        points=contact_points(problem, solution),
    )


def _reaction(problem: Problem, solution: Solution) -> list[float]:
    """Of all supports together: what balances loads and obstacles; collective (force).

    What bodies do to each other balances in itself.
    """
    spaces = problem.spaces
    found = -resultant(spaces, problem.load[: spaces.owned_nodes])
    for contact, force in zip(problem.contacts, solution.contact_force, strict=True):
        if contact.contact.against is None:
            found -= resultant(spaces, force[contact.owned_nodes])
    return [float(x) + 0.0 for x in found]
