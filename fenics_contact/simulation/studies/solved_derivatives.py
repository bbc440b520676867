"""An answer on a kept body with its derivatives, and whether it has a kink."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.parallel import largest, total
from fenics_contact.common.timings import Timings
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.derivatives import Derivatives, derivatives
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution

# Of the largest depth, and of ε: nearer to the edge than this is on it.
_NEAR = 1e-8


def has_kink(problem: Problem, solution: Solution) -> bool:
    """Whether derivatives of an answer are one-sided; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer.
    """
    found = [
        _just_touches(contact, state) or _just_slips(contact, state)
        for contact, state in zip(problem.contacts, solution.states, strict=True)
    ]
    return bool(total(problem.comm, sum(found)) > 0)


def _just_touches(contact: ContactSurface, state: ContactState) -> bool:
    """Whether a point that carries nothing is as near as those that do; collective."""
    deepest = largest(contact.spaces.comm, np.maximum(-state.gap, 0.0))
    if not contact.is_one_sided or deepest == 0:
        return False
    return bool((np.abs(state.gap) <= _NEAR * deepest).any())


def _just_slips(contact: ContactSurface, state: ContactState) -> bool:
    """Whether the slip of a point that friction holds is as long as sticking allows."""
    longest = contact.regularisation_parameter
    if not contact.friction.has_friction or not longest:
        return False
    slip = np.linalg.norm(contact.friction.scaled_slip(state.slip), axis=1)
    held = (state.status != OPEN) & (contact.friction_bound > 0)
    return bool((held & (np.abs(slip - longest) <= _NEAR * longest)).any())


@dataclass(frozen=True)
class SolvedDerivatives:
    """Derivatives of the answer of a scene.

    Attributes:
        slopes: Quantity → key → derivative.
        one_sided: Whether points just touch or just slip in a load step of it.
    """

    slopes: Derivatives
    one_sided: bool


@dataclass(frozen=True, eq=False)
class SolvedScene:
    """A scene that has been solved, while its system is there.

    Attributes:
        load_steps: That were taken; at the last one.
        system: That has solved them.
        steps: All of them.
        one_sided: As of ``SolvedDerivatives``.
    """

    load_steps: LoadSteps
    system: CondensedSystem
    steps: list[AcceptedStep]
    one_sided: bool

    def derivatives(self, of: Sequence[str], by: Sequence[str] | None) -> Derivatives:
        """Return the derivatives at the last load step; load steps are gone back; collective."""
        return derivatives(self.load_steps, self.system, self.steps, of, by)


def solved_derivatives(
    kept: KeptBody, scene: Scene, of: Sequence[str], by: Sequence[str] | None
) -> SolvedDerivatives:
    """Solve a scene as a separate run does, and differentiate its answer; collective.

    Args:
        kept: The body of the scene.
        scene: The scene.
        of: Names of quantities.
        by: Keys of the scene; None for all numbers that have a derivative.

    Raises:
        InputError: A quantity or a key has no derivative, or the scene has no equilibrium.
        NotConvergedError: There is no answer.
    """
    with solved_scene(kept, scene) as solved:
        return SolvedDerivatives(solved.derivatives(of, by), solved.one_sided)


@contextmanager
def solved_scene(kept: KeptBody, scene: Scene) -> Iterator[SolvedScene]:
    """A scene solved as a separate run does; collective.

    Args:
        kept: The body of the scene.
        scene: The scene.

    Raises:
        InputError: The scene has no equilibrium.
        NotConvergedError: There is no answer.
    """
    with kept.stepping(scene, Timings()) as (load_steps, system):
        taken = _StepsWithKinks(load_steps)
        load_steps.solve(taken)
        yield SolvedScene(load_steps, system, taken.steps, taken.one_sided)


class _StepsWithKinks(StepListener):
    """Keeps load steps to be differentiated.

    Attributes:
        steps: All of them.
        one_sided: Whether points just touch or just slip in one of them.
    """

    def __init__(self, load_steps: LoadSteps) -> None:
        self._problem, self._exact = load_steps.problem, load_steps.newton.exact
        self.steps: list[AcceptedStep] = []
        self.one_sided = False

    def accepted(self, step: AcceptedStep) -> None:
        """Keep a load step; collective."""
        self.steps.append(step)
        if self._exact is not None:
            self.one_sided |= self._exact.at_edges > 0
        else:
            self.one_sided |= has_kink(self._problem, step.solution)
