"""Derivatives of quantities in the numbers of a scene: of an answer, while its system is there."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.common.errors import InputError
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.sensitivities.quantity_gradient import QuantityGradient, adjoint_of
from fenics_contact.simulation.sensitivities.scene_changes import Change, SceneChanges
from fenics_contact.simulation.sensitivities.state_gradients import Quantities
from fenics_contact.simulation.sensitivities.values import numbers_of
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.newton.solution import Solution

# Quantity → key → derivative.
Derivatives = dict[str, dict[str, float]]


def derivatives(
    system: CondensedSystem, solution: Solution, of: Sequence[str], by: Sequence[str] | None
) -> Derivatives:
    """Of the last load step, in whose state a system is; collective.

    Args:
        system: That has solved it.
        solution: Of it.
        of: Names of quantities.
        by: Keys of the scene; None for all numbers that have a derivative.

    Raises:
        InputError: A quantity or a key has no derivative.
    """
    problem = system.problem
    quantities, changes = Quantities(problem, solution), changes_of(problem, by)
    states = {name: quantities.gradient(name) for name in of}
    adjoint, scalars = adjoint_of(system), system.scalar_values(system.state)
    if any(change.modulus is not None for change in changes.values()):
        solution.find_body()  # the functions of the body follow
    found: Derivatives = {}
    for name, state in states.items():
        gradient = QuantityGradient(adjoint, solution, scalars, state)
        found[name] = {key: gradient.along(change) for key, change in changes.items()}
    return found


def changes_of(problem: Problem, by: Sequence[str] | None) -> dict[str, Change]:
    """What keys of a scene change; collective.

    Args:
        problem: Of the scene.
        by: The keys; None for all numbers that have a derivative.

    Raises:
        InputError: A key that is named has none.
    """
    changes = SceneChanges(problem, problem.scene.steps.last)
    if by is not None:
        return {key: changes.by(key) for key in by}
    found: dict[str, Change] = {}
    for key in numbers_of(problem.scene):
        try:
            found[key] = changes.by(key)
        except InputError:
            continue
    return found
