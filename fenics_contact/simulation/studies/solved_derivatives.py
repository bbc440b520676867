"""An answer on a kept body with its derivatives: solved, and differentiated before it is gone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fenics_contact.common.timings import Timings
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.derivatives import Derivatives, derivatives
from fenics_contact.simulation.sensitivities.kinks import has_kink
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution


@dataclass(frozen=True)
class SolvedDerivatives:
    """Derivatives of the answer of a scene.

    Attributes:
        slopes: Quantity → key → derivative.
        one_sided: Whether points just touch or just slip in a load step of it.
    """

    slopes: Derivatives
    one_sided: bool


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
    timings = Timings()
    problem = Problem(scene, kept.discrete, timings, by_points=True)
    require_equilibrium(problem)
    system = CondensedSystem(problem, timings, kept.condense(problem, timings))
    try:
        steps: list[AcceptedStep] = []
        kinks: list[bool] = []

        def accepted(time: float, solution: Solution) -> None:
            assert load_steps.last is not None
            steps.append(load_steps.last)
            kinks.append(has_kink(problem, solution))

        load_steps = LoadSteps(Newton(problem, system, timings), accepted)
        load_steps.finds_body = False
        load_steps.solve()
        return SolvedDerivatives(derivatives(load_steps, system, steps, of, by), any(kinks))
    finally:
        system.destroy()
