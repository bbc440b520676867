"""Derivatives of quantities at every load step of a history, of one way back through its steps.

A quantity of a load step depends on the steps before by the slip that they left. All quantities of
all steps go back together, so that each step's tangent is made once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.simulation.sensitivities.derivatives import (
    of_step_before,
    require_adjoint,
    that_count,
)
from fenics_contact.simulation.sensitivities.gradients import gradient_of
from fenics_contact.simulation.sensitivities.quantity_gradient import QuantityGradient, adjoint_of
from fenics_contact.simulation.sensitivities.scene_changes import Change
from fenics_contact.simulation.sensitivities.state_gradient import StateGradient
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.load_steps import LoadSteps

# What is changed in a load step, by a name; called when the problem is in its state.
ChangesAt = Callable[[AcceptedStep], Mapping[str, Change]]


def history_slopes(
    load_steps: LoadSteps,
    system: CondensedSystem,
    steps: Sequence[AcceptedStep],
    of: Sequence[str],
    changes_at: ChangesAt,
    is_whole: bool = True,
) -> list[dict[str, Array]]:
    """Derivatives of quantities at load steps; collective.

    Args:
        load_steps: That were taken; they are at their last step again afterwards.
        system: That has solved them.
        steps: All of them.
        of: Names of quantities.
        changes_at: What is differentiated by, the same names in every step.
        is_whole: Whether those of all load steps are found, or of the last one alone.

    Returns:
        Of each step, or of the last one: name of the change → derivative of each quantity,
        (quantities,).

    Raises:
        InputError: A quantity has no derivative, or the history has none.
    """
    problem, last = system.problem, steps[-1]
    require_adjoint(problem)
    follows = len(that_count(problem, steps)) > 1
    found: dict[AcceptedStep, dict[str, Array]] = {}
    going_back: dict[tuple[AcceptedStep, int], StateGradient] = {}
    for step in reversed(steps):
        if step is not last and not (is_whole or follows):
            break
        load_steps.go_back_to(step)
        changes = changes_at(step)
        if is_whole or step is last:
            found[step] = {name: np.zeros(len(of)) for name in changes}
            for place, name in enumerate(of):
                going_back[step, place] = gradient_of(problem, step.solution, name)
        adjoint = adjoint_of(system)
        for (one, place), state in going_back.items():
            gradient = QuantityGradient(adjoint, step, state)
            for name, change in changes.items():
                found[one][name][place] += gradient.along(change)
            going_back[one, place] = of_step_before(problem, gradient)
        if not follows:
            going_back.clear()
    load_steps.go_back_to(last)
    return [found[step] for step in steps if step in found]
