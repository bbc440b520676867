"""Derivatives of a quantity in the state of a problem: pressures, slips, scalars, the body."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalars.scalar import ScalarUnknown
from fenics_contact.solve.condensed.adjoint import BodyGradient


@dataclass(frozen=True, eq=False)
class StateGradient:
    """Derivatives of a quantity in the state of a problem.

    Attributes:
        contacts: In what happens at each.
        scalars: In the scalar unknowns, beside what these do to jumps and displacements.
        body: In the body, None where the contacts tell all of it.
        energy: How often the strain energy is in it: of that, stiffness is a part.
        resultant: Gives the quantity itself, in the same state, where it is one of the whole
            thickness, as forces and energies are; collective.
    """

    contacts: Sequence[AnswerGradient]
    scalars: Array
    body: BodyGradient | None = None
    energy: float = 0.0
    resultant: Callable[[], float] | None = None

    @classmethod
    def none(cls, problem: Problem) -> Self:
        """The gradient of a quantity that never changes."""
        contacts = [AnswerGradient.none(contact) for contact in problem.contacts]
        return cls(contacts, np.zeros(len(problem.unknowns)))

    @classmethod
    def of_contact(cls, problem: Problem, number: int, answers: AnswerGradient) -> Self:
        """The gradient of a quantity of one contact.

        Args:
            problem: The model.
            number: Of the contact.
            answers: Derivatives in what happens at the contact.
        """
        contact, found = problem.contacts[number], cls.none(problem)
        if contact.has_unknown_position:  # its indentation is an unknown
            own = [
                (unknown, answers.indentation)
                for unknown in problem.unknowns
                if unknown.drives and unknown.contact is contact
            ]
            found = found.plus(cls.of_scalars(problem, own))
            answers = replace(answers, indentation=0.0)
        contacts = [*found.contacts]
        contacts[number] = answers
        return replace(found, contacts=contacts)

    @classmethod
    def of_scalars(cls, problem: Problem, values: Iterable[tuple[ScalarUnknown, float]]) -> Self:
        """The gradient of a weighted sum of scalar unknowns.

        Args:
            problem: The model.
            values: Unknowns and their weights.
        """
        found = np.zeros(len(problem.unknowns))
        for unknown, value in values:
            found[problem.unknowns.index(unknown)] += value
        return replace(cls.none(problem), scalars=found)

    @classmethod
    def of_body(cls, problem: Problem, body: BodyGradient, energy: float = 0.0) -> Self:
        """The gradient of a quantity of the body.

        Args:
            problem: The model.
            body: Derivatives in the body.
            energy: How often the strain energy is in the quantity.
        """
        return replace(cls.none(problem), body=body, energy=energy)

    def plus(self, other: StateGradient) -> Self:
        """The gradient of the sum of two quantities, whose ``resultant`` is not said."""
        bodies = [one for one in (self.body, other.body) if one is not None]
        displacement = sum((one.displacement for one in bodies), start=np.zeros(()))
        reactions = sum((one.reactions for one in bodies), start=np.zeros(()))
        return replace(
            self,
            contacts=[
                one.plus(more) for one, more in zip(self.contacts, other.contacts, strict=True)
            ],
            scalars=self.scalars + other.scalars,
            body=BodyGradient(displacement, reactions) if bodies else None,
            energy=self.energy + other.energy,
            resultant=None,
        )
