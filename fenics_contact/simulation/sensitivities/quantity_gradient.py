"""A quantity's derivatives in all that a problem is given, from one adjoint solve."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fenics_contact.body.elastic_body import ModulusSlopes
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import AnswerGradient, along, vjp
from fenics_contact.simulation.sensitivities.scene_changes import Change
from fenics_contact.simulation.sensitivities.state_gradient import StateGradient
from fenics_contact.solve.condensed.adjoint import BodyGradient, CondensedAdjoint
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep


def adjoint_of(system: CondensedSystem) -> CondensedAdjoint:
    """The adjoint of the true tangent of an answer, in whose state a system is; collective.

    There friction's bound follows the pressure, and tractions turn with the slip as the law has it.
    """
    for contact in system.problem.frictional:
        if contact.is_coulomb:
            contact.friction_term.follow_pressure()
            contact.follow_pressure()
        kinematics, tangent = contact.kinematics, contact.friction_term.tangent_state
        tangent.take_true(kinematics.tangential(kinematics.jump_at_points()))
    system.linearise(system.state)
    return system.adjoint()


class QuantityGradient:
    """Derivatives of a quantity in what a problem is given; collective.

    Attributes:
        contacts: In what each contact is given.
        multipliers: Of the forces that are in balance.

    Args:
        adjoint: Of the answer's tangent, in whose state the problem is.
        step: The answer.
        state: Derivatives in what happens.
    """

    def __init__(self, adjoint: CondensedAdjoint, step: AcceptedStep, state: StateGradient) -> None:
        self._problem = problem = adjoint.problem
        self._step = step
        self._adjoint, self._energy, self._resultant = adjoint, state.energy, state.resultant
        numbered = list(enumerate(problem.contacts))
        tractions = [self._traction(number, state) for number, _ in numbered]
        start = adjoint.opposing(tractions)
        known, jumps = [], []
        for number, contact in numbered:
            virtual = adjoint.jump(number, start) + adjoint.held_jump(number, state.body)
            answers, traction = state.contacts[number], tractions[number]
            if traction is not None:
                answers = answers.with_traction(contact, -answers.traction(contact))
                virtual += traction
            known.append(self._with_work(contact, answers, virtual))
            jumps.append(contact.trace.onto_nodes(vjp(contact, known[-1]).jump))
        body = self._with_untouched(state.body, jumps)
        self.multipliers = adjoint.solve(jumps, state.scalars, body, start)
        self.contacts = []
        for number, contact in numbered:
            virtual = self.multipliers.other_jump(number)
            self.contacts.append(vjp(contact, self._with_work(contact, known[number], virtual)))

    def _traction(self, number: int, state: StateGradient) -> Array | None:
        """The virtual jump whose work on a contact's tractions is in a quantity, at all nodes.

        None where not all points are nodes, or nothing follows the jump.
        """
        contact = self._problem.contacts[number]
        if not contact.trace.nodal or self._adjoint.jumps[number] is None:
            return None
        of_traction = state.contacts[number].traction(contact)
        return contact.trace.onto_nodes(of_traction / contact.trace.weights[:, None])

    @staticmethod
    def _with_work(contact: ContactSurface, answers: AnswerGradient, jump: Array) -> AnswerGradient:
        """With the work of a contact's tractions on a virtual jump at its nodes."""
        weights = contact.trace.weights[:, None]
        return answers.with_traction(contact, weights * contact.trace.at_points(jump))

    def _with_untouched(self, body: BodyGradient | None, jumps: list[Array]) -> BodyGradient | None:
        """With the jumps of contacts that exert no forces, which are displacements; collective."""
        problem = self._problem
        for number, (contact, jump) in enumerate(zip(problem.contacts, jumps, strict=True)):
            moves = total(problem.comm, float(np.abs(jump).sum())) > 0
            if self._adjoint.jumps[number] is not None or not moves:
                continue
            more = contact.kinematics.on_body(jump)
            reactions = np.zeros_like(more) if body is None else body.reactions
            body = BodyGradient(more if body is None else body.displacement + more, reactions)
        return body

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
        if change.modulus is not None:
            found += self._along_modulus(*change.modulus)
        itself = 0.0
        if change.of_resultants and self._resultant is not None:
            itself = change.of_resultants * self._resultant()
        if problem.comm.rank == 0:
            found += itself
            scalars = self.multipliers.scalars
            found += sum(float(scalars[place] * by) for place, by in change.scalars.items())
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
