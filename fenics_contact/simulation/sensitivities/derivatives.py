"""Derivatives of quantities in the numbers of a scene: of an answer, while its system is there.

Where friction remembers its path, or a bolt is locked, they go back through the load steps. What a
step is given by the one before is the slip that counts as none there, and the length of the bolt:
its derivatives are those of a quantity of the step before, whose own adjoint leads to the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fenics_contact.common.errors import InputError
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.contact.snapshot import recall
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.sensitivities.gradients import gradient_of
from fenics_contact.simulation.sensitivities.quantity_gradient import QuantityGradient, adjoint_of
from fenics_contact.simulation.sensitivities.scene_changes import Change, SceneChanges
from fenics_contact.simulation.sensitivities.state_gradient import StateGradient
from fenics_contact.simulation.sensitivities.values import numbers_of
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.load_steps import LoadSteps

# Quantity → key → derivative.
Derivatives = dict[str, dict[str, float]]


def derivatives(
    load_steps: LoadSteps,
    system: CondensedSystem,
    steps: Sequence[AcceptedStep],
    of: Sequence[str],
    by: Sequence[str] | None,
) -> Derivatives:
    """Derivatives of quantities of the last load step, in whose state a system is; collective.

    Args:
        load_steps: That were taken.
        system: That has solved them.
        steps: All of them.
        of: Names of quantities.
        by: Keys of the scene; None for all numbers that have a derivative.

    Raises:
        InputError: A quantity or a key has no derivative.
    """
    problem, last = system.problem, steps[-1]
    require_adjoint(problem)
    states = {name: gradient_of(problem, last.solution, name) for name in of}
    keys = keys_of(problem, last.unknowns.time, by)
    found: Derivatives = {name: dict.fromkeys(keys, 0.0) for name in of}
    for step in reversed(that_count(problem, steps)):
        if step is not last:
            _go_back_to(load_steps, step)
        adjoint = adjoint_of(system)
        changes = _changes(problem, step.unknowns.time, keys)
        for name, state in states.items():
            gradient = QuantityGradient(adjoint, step, state)
            for key, change in changes.items():
                found[name][key] += gradient.along(change)
            states[name] = of_step_before(problem, gradient)
    return found


def require_adjoint(problem: Problem) -> None:
    """Refuse laws that do not say their own derivatives."""
    for contact in problem.contacts:
        for law in contact.laws:
            if not law.has_derivatives:
                raise InputError(
                    f"derivatives: the {law.called} of '{contact.label}' has none of its own"
                )


def keys_of(problem: Problem, time: float, by: Sequence[str] | None) -> list[str]:
    """Keys of the scene's numbers by which there are derivatives; collective.

    Args:
        problem: Of the scene.
        time: Pseudo-time that its state is of.
        by: The keys; None for all.

    Raises:
        InputError: A key that is named has none.
    """
    if by is not None:
        return list(_changes(problem, time, by))
    found = []
    for key in numbers_of(problem.scene):
        try:
            SceneChanges(problem, time).by(key)
        except InputError:
            continue
        found.append(key)
    return found


def _changes(problem: Problem, time: float, keys: Sequence[str]) -> dict[str, Change]:
    changes = SceneChanges(problem, time)
    return {key: changes.by(key) for key in keys}


def that_count(problem: Problem, steps: Sequence[AcceptedStep]) -> list[AcceptedStep]:
    """The load steps that the last one depends on; collective.

    Raises:
        InputError: It depends on more than slips of those before.
    """
    last = steps[-1]
    follows = any(contact.friction.follows_path for contact in problem.contacts)
    follows |= any(unknown.is_locked for unknown in problem.unknowns)
    if not follows or len(steps) == 1:
        return [last]
    if any(one.paired_at is not None for step in steps for one in step.contacts):
        raise InputError(
            "derivatives: what faces what of two bodies was found anew between load steps, which "
            "has none; let the bodies slide less, or take one step"
        )
    return list(steps)


def _go_back_to(load_steps: LoadSteps, step: AcceptedStep) -> None:
    """Bring a problem and its system to the end of a load step; collective."""
    problem = load_steps.problem
    problem.reach(step.unknowns.scalars)
    problem.set_time(step.unknowns.time)
    for contact, memory in zip(problem.contacts, step.contacts, strict=True):
        recall(contact, memory)
    system = load_steps.newton.system
    load_steps.newton.begin.at(step.unknowns.position_in(system), step.unknowns.scalars)


def of_step_before(problem: Problem, gradient: QuantityGradient) -> StateGradient:
    """The gradient of a quantity in the state that the step before left; collective."""
    kept = zip(problem.body_scalars, gradient.multipliers.kept_scalars, strict=True)
    found = StateGradient.of_scalars(problem, kept)
    for number, (contact, after) in enumerate(
        zip(problem.contacts, gradient.contacts, strict=True)
    ):
        if contact.friction.follows_path:
            of_slip, of_state = contact.friction.vjp_reference(after.reference)
            before = AnswerGradient.none(contact).adding(slip=of_slip)
            before = replace(before, state={**after.state, **of_state})
            found = found.plus(StateGradient.of_contact(problem, number, before))
    return found
