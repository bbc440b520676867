"""The adjoint of an answer: by the tangent of its laws, or by the exact solver's linearisation.

Either gives multipliers of the forces that are in balance, and derivatives in what contacts are
given. An exact answer has the forces at its points as unknowns of their own: those decide
derivatives there, and the body follows.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import (
    AnswerGradient,
    FoundGradient,
    GivenGradient,
    of_found_forces,
    of_found_jump,
    vjp,
    vjp_of_found,
)
from fenics_contact.simulation.sensitivities.quantity_gradients import StateGradient
from fenics_contact.solve.at_points.point_adjoint import PointAdjoint, PointGradient
from fenics_contact.solve.condensed.adjoint import BodyGradient, CondensedAdjoint, Multipliers
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.load_steps.load_steps import LoadSteps


def adjoint_of(load_steps: LoadSteps) -> AnswerAdjoint:
    """The adjoint of an answer, in whose state load steps are; collective.

    Raises:
        InputError: Their solver has none.
        NotConvergedError: The answer ends there.
    """
    newton = load_steps.newton
    system = newton.system
    if not isinstance(system, CondensedSystem):
        raise InputError(f"the {system.name} solver has no adjoint")
    if newton.exact is not None:
        return _ExactAdjoint(system.adjoint(), newton.exact.adjoint())
    system.linearise_truly()
    return _LawsAdjoint(system.adjoint())


class AnswerAdjoint(ABC):
    """Derivatives of quantities of an answer; collective.

    Attributes:
        condensed: Of the body.
        problem: In the state of the answer.

    Args:
        condensed: Of the body.
    """

    def __init__(self, condensed: CondensedAdjoint) -> None:
        self.condensed, self.problem = condensed, condensed.problem

    @abstractmethod
    def of(self, state: StateGradient) -> tuple[Multipliers, list[GivenGradient]]:
        """Multipliers of a quantity, and its gradient in what each contact is given; collective.

        Args:
            state: Its derivatives in what happens.
        """

    def _with_untouched(self, body: BodyGradient | None, jumps: list[Array]) -> BodyGradient | None:
        """With the jumps of contacts that exert no forces, which are displacements; collective."""
        problem = self.problem
        for number, (contact, jump) in enumerate(zip(problem.contacts, jumps, strict=True)):
            moves = total(problem.comm, float(np.abs(jump).sum())) > 0
            if self.condensed.jumps[number] is not None or not moves:
                continue
            more = contact.kinematics.on_body(jump)
            reactions = np.zeros_like(more) if body is None else body.reactions
            body = BodyGradient(more if body is None else body.displacement + more, reactions)
        return body


class _LawsAdjoint(AnswerAdjoint):
    """Adjoint of an answer with penalties: its true tangent, in which forces follow jumps."""

    def of(self, state: StateGradient) -> tuple[Multipliers, list[GivenGradient]]:
        """Multipliers of a quantity, and its gradient in what each contact is given; collective."""
        condensed, numbered = self.condensed, list(enumerate(self.problem.contacts))
        tractions = [self._traction(number, state) for number, _ in numbered]
        start = condensed.opposing(tractions)
        known, jumps = [], []
        for number, contact in numbered:
            virtual = condensed.jump(number, start) + condensed.held_jump(number, state.body)
            answers, traction = state.contacts[number], tractions[number]
            if traction is not None:
                answers = answers.with_traction(contact, -answers.traction(contact))
                virtual += traction
            known.append(_with_work(contact, answers, virtual))
            jumps.append(contact.trace.onto_nodes(vjp(contact, known[-1]).jump))
        body = self._with_untouched(state.body, jumps)
        multipliers = condensed.solve(jumps, state.scalars, body, start)
        found = []
        for number, contact in numbered:
            virtual = multipliers.other_jump(number)
            found.append(vjp(contact, _with_work(contact, known[number], virtual)))
        return multipliers, found

    def _traction(self, number: int, state: StateGradient) -> Array | None:
        """The virtual jump whose work on a contact's tractions is in a quantity, at all nodes.

        None where not all points are nodes, or nothing follows the jump.
        """
        contact = self.problem.contacts[number]
        if not contact.trace.nodal or self.condensed.jumps[number] is None:
            return None
        of_traction = state.contacts[number].traction(contact)
        return contact.trace.onto_nodes(of_traction / contact.trace.weights[:, None])


class _ExactAdjoint(AnswerAdjoint):
    """Adjoint of an exact answer: the laws of contact and friction linearised at the points.

    Args:
        condensed: Of the body.
        at_points: Of the laws.
    """

    def __init__(self, condensed: CondensedAdjoint, at_points: PointAdjoint) -> None:
        super().__init__(condensed)
        self._at_points = at_points
        self._points = {id(one.contact): one for one in at_points.points}

    def of(self, state: StateGradient) -> tuple[Multipliers, list[GivenGradient]]:
        """Multipliers of a quantity, and its gradient in what each contact is given; collective."""
        condensed, contacts = self.condensed, self.problem.contacts
        known, jumps, of_forces = [], [], [np.zeros(0)]
        for number, contact in enumerate(contacts):
            held = condensed.held_jump(number, state.body)
            known.append(_with_work(contact, state.contacts[number], held))
            points = self._points.get(id(contact))
            if points is None:
                jump = vjp(contact, known[-1]).jump
            else:
                jump, _ = of_found_jump(contact, known[-1])
                of_forces.append(points.gradient_of_rows(*of_found_forces(contact, known[-1])))
            jumps.append(contact.trace.onto_nodes(jump))
        body = self._with_untouched(state.body, jumps)
        right = condensed.gradient(jumps, state.scalars, body)
        found, given = self._at_points.solve(right.of_unknowns, np.concatenate(of_forces))
        multipliers = condensed.multipliers(np.zeros(len(right.of_unknowns)), found, right)
        by_contact = dict(zip(self._points, given, strict=True))
        return multipliers, [
            self._given(contact, known[number], multipliers.other_jump(number), by_contact)
            for number, contact in enumerate(contacts)
        ]

    def _given(
        self,
        contact: ContactSurface,
        answers: AnswerGradient,
        virtual: Array,
        given: Mapping[int, PointGradient],
    ) -> GivenGradient:
        """Gradient in what a contact is given; collective.

        Args:
            contact: The contact.
            answers: Gradient in what happens there.
            virtual: Virtual jump of the multipliers at all nodes of its surface.
            given: Gradient in what the exact solver is given, by contact.
        """
        worked = _with_work(contact, answers, virtual)
        if id(contact) not in given:
            return vjp(contact, worked)
        points, part = self._points[id(contact)], given[id(contact)]
        gap, slip = points.in_space(part.openings)
        found = FoundGradient(
            gap=gap,
            slip=slip,
            bound=points.at_points(part.bound) * contact.trace.weights,
            elastic_slip=points.at_points(part.elastic_slip),
            traction=contact.kinematics.tangential(worked.friction),
        )
        return vjp_of_found(contact, answers, found)


def _with_work(contact: ContactSurface, answers: AnswerGradient, jump: Array) -> AnswerGradient:
    """With the work of a contact's tractions on a virtual jump at its nodes."""
    weights = contact.trace.weights[:, None]
    return answers.with_traction(contact, weights * contact.trace.at_points(jump))
