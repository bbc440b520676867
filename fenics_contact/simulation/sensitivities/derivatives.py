"""Derivatives of quantities in the data of a problem and in the numbers of its scene.

They are found while the answer's system is there. Where friction remembers its path, or a bolt is
locked, they go back through the load steps. What a step is given by the one before is the slip
that counts as none there, and the length of the bolt: its derivatives are those of a quantity of
the step before, whose own adjoint leads to the next one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from fenics_contact.body.elastic_body import ModulusSlopes
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.contact.point_gradients import AnswerGradient, along
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import moduli_change
from fenics_contact.simulation.sensitivities.adjoints import AnswerAdjoint, adjoint_of
from fenics_contact.simulation.sensitivities.gradients import gradient_of
from fenics_contact.simulation.sensitivities.heat_adjoint import HeatAdjoint, HeatGradient
from fenics_contact.simulation.sensitivities.quantity_gradients import StateGradient
from fenics_contact.simulation.sensitivities.scene_changes import Change, SceneChanges
from fenics_contact.simulation.sensitivities.scene_values import numbers_of
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, recall
from fenics_contact.solve.load_steps.load_steps import LoadSteps


class QuantityGradient:
    """Derivatives of a quantity in what a problem is given; collective.

    Attributes:
        contacts: In what each contact is given.
        multipliers: Of the forces that are in balance.

    Args:
        adjoint: Of the answer, in whose state the problem is.
        step: The answer.
        state: Derivatives in what happens.
    """

    def __init__(self, adjoint: AnswerAdjoint, step: AcceptedStep, state: StateGradient) -> None:
        self._problem, self._step, self._adjoint = adjoint.problem, step, adjoint.condensed
        self._energy, self._resultant = state.energy, state.resultant
        self._springs = state.springs
        self._heat: HeatGradient | None = None
        if self._problem.conduction is not None:
            heat = HeatAdjoint(self._problem, step.solution)
            state, self._heat = heat.settled(state, adjoint.of)
        self.multipliers, self.contacts = adjoint.of(state)

    def along(self, change: Change) -> float:
        """Derivative of the quantity in a number of the scene; collective.

        Args:
            change: What the number changes.
        """
        problem = self._problem
        owned = slice(0, problem.spaces.owned_nodes)
        found = sum(
            along(problem.contacts[number], self.contacts[number], given)
            for number, given in change.contacts.items()
        )
        if change.load is not None:
            found += float(np.sum(self.multipliers.displacement[owned] * change.load[owned]))
        if change.prescribed is not None:
            found += float(self._at_constrained @ change.prescribed)
        if change.columns:
            found += self._along_columns(change)
        for place, forces in change.springs.items():
            found += self._along_springs(place, forces(self._step.solution.displacement)[owned])
        if change.modulus is not None:
            found += self._along_modulus(*change.modulus)
        if change.heat is not None:
            assert self._heat is not None
            by_heat = change.heat(self._heat)
            found += by_heat if problem.comm.rank == 0 else 0.0
        itself = 0.0
        if change.of_resultants and self._resultant is not None:
            itself = change.of_resultants * self._resultant()
        if problem.comm.rank == 0:
            found += itself
            scalars = self.multipliers.scalars
            found += sum(float(scalars[place] * by) for place, by in change.scalars.items())
            kept = self.multipliers.kept_scalars
            found += sum(float(kept[place] * by) for place, by in change.held.items())
        return float(total(problem.comm, found))

    @cached_property
    def _at_constrained(self) -> Array:
        """In the displacements that are prescribed, 0 where another rank counts; collective."""
        problem = self._problem
        nodal = self.multipliers.at_supports.copy()
        for number, contact in enumerate(problem.contacts):
            if self._adjoint.jumps[number] is not None:
                jump = contact.trace.onto_nodes(self.contacts[number].jump)
                nodal += contact.kinematics.on_body(jump)
        mine = problem.constrained < problem.spaces.owned_nodes * problem.spaces.components
        return np.where(mine, nodal.reshape(-1)[problem.constrained], 0.0)

    def _along_columns(self, change: Change) -> float:
        """The far field of resultants moves as its columns change."""
        problem = self._problem
        assert problem.far_field is not None
        outer = np.searchsorted(problem.constrained, problem.far_field.dofs)
        scalars = self._step.unknowns.scalars
        moved = sum(scalars[place] * column for place, column in change.columns.items())
        return float(self._at_constrained[outer] @ moved)

    def _along_springs(self, place: int, forces: Array) -> float:
        """Change by spring forces that change at this rank's own nodes, (nodes, components)."""
        felt = self.multipliers.displacement[: len(forces)]
        if place in self._springs:
            felt = felt + self._springs[place][: len(forces)]
        return float(np.sum(felt * forces))

    def _along_modulus(self, number: int, name: str) -> float:
        """(e/2 u − ψ) · K_θ u of a quantity that has e times the strain energy in it."""
        problem, virtual, factor = self._problem, self.multipliers, 0.5 * self._energy
        present, present_stress = self._step.solution.displacement, self._step.unknowns.mean_stress
        displacement = factor * present - virtual.displacement
        stress = factor * present_stress - virtual.mean_stress
        slopes = problem.discrete.once(
            "modulus slopes",
            lambda: ModulusSlopes(problem.elastic, problem.spaces),
        )
        on = problem.scene.material[number].on
        state, virtual_state = (present, present_stress), (displacement, stress)
        return slopes.work(name, on, state, virtual_state)


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
        adjoint = adjoint_of(load_steps)
        changes = _changes(problem, step.unknowns.time, keys)
        for name, state in states.items():
            gradient = QuantityGradient(adjoint, step, state)
            for key, change in changes.items():
                found[name][key] += gradient.along(change)
            states[name] = of_step_before(problem, gradient)
    return found


def require_adjoint(problem: Problem) -> None:
    """Refuse what has no derivatives: laws that do not say theirs, bodies that follow answers."""
    if moduli_change(problem.scene):
        raise InputError(
            "derivatives: moduli follow temperatures that are found, or that change between load "
            "steps, which has none yet"
        )
    for contact in problem.contacts:
        for law in contact.laws:
            if not law.has_vjp:
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
    follows |= any(unknown.keeps_last for unknown in problem.unknowns)
    if not follows or len(steps) == 1:
        return [last]
    if problem.conduction is not None:
        raise InputError(
            "derivatives: where temperatures are found, answers that depend on load steps before "
            "the last one have none yet; take one step"
        )
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
    rows = zip(problem.body_scalars, gradient.multipliers.kept_scalars, strict=True)
    kept = [(scalar, value) for scalar, value in rows if scalar.keeps_last]
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
