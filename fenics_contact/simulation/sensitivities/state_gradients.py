"""Quantities as functions of what happens: their derivatives in pressures, slips, forces, ….

Areas and radii have none: from cell to cell they are no smooth function of anything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.recovered_pressure import (
    pressure_of_facets,
    pressure_of_facets_transposed,
)
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknowns import Indentation
from fenics_contact.quantities import table
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    INDENTATION,
    MAX_CONTACT_PRESSURE,
    MAX_SLIP,
    NORMAL_FORCE,
    PENALTY_ENERGY,
    PRESSURE_INTEGRAL,
    REACTION,
    STRAIN_ENERGY,
)
from fenics_contact.quantities.quantity import Together
from fenics_contact.scene.quantity_names import QuantityName
from fenics_contact.scene.values import AXES
from fenics_contact.solve.condensed.adjoint import BodyGradient
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.measured import measured


@dataclass(eq=False)
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

    contacts: list[AnswerGradient]
    scalars: Array
    body: BodyGradient | None = None
    energy: float = 0.0
    resultant: Callable[[], float] | None = None

    @classmethod
    def none(cls, problem: Problem) -> StateGradient:
        """Of a quantity that never changes."""
        contacts = [AnswerGradient.none(contact) for contact in problem.contacts]
        return cls(contacts, np.zeros(len(problem.unknowns)))


class Quantities:
    """The quantities of an answer by their names; collective.

    Args:
        problem: In the state of the answer.
        solution: The answer; None before there is one, when their names alone are asked for.
    """

    def __init__(self, problem: Problem, solution: Solution | None = None) -> None:
        self.problem, self._solution = problem, solution

    @property
    def solution(self) -> Solution:
        """The answer."""
        assert self._solution is not None
        return self._solution

    def find(self, text: str) -> QuantityName:
        """What a name stands for, if that has derivatives.

        Args:
            text: Its name, such as ``normal_force`` or ``left.reaction_x``.

        Raises:
            InputError: There is no such quantity, or it has no derivatives.
        """
        try:
            name = self.problem.scene.names.find(text)
        except ValueError as error:
            raise InputError(f"of: {error}") from None
        if table.is_vector(name.quantity) and name.axis is None:
            raise InputError(f"of: '{text}' is a vector; ask for its components, such as {text}_x")
        known = (*self._of_contacts, *self._of_body)
        if name.quantity not in known and not name.quantity.startswith("displacement_"):
            raise InputError(
                f"of: '{text}' has no derivatives; those that have are "
                + ", ".join([*known, "displacement_NAME"])
            )
        return name

    def gradient(self, text: str) -> StateGradient:
        """Derivatives of a quantity; collective.

        Args:
            text: Its name, such as ``normal_force`` or ``left.reaction_x``.

        Raises:
            InputError: There is no such quantity, or it has no derivatives.
        """
        name = self.find(text)
        found = StateGradient.none(self.problem)
        if name.quantity.startswith("displacement_"):
            self._add_displacement(found, name)
        elif name.quantity in self._of_body:
            self._of_body[name.quantity](found, name)
        else:
            for number in self._contacts_of(name, text):
                self._of_contacts[name.quantity](found, number, name)
        row = table.find(name.quantity)
        if row is not None and row.is_extensive:
            found.resultant = partial(self._value, name)
        return found

    def _value(self, name: QuantityName) -> float:
        """Of the answer, in its state; collective."""
        value = measured(self.problem, self.solution)[self.problem.scene.names.key(name)]
        return float(np.atleast_1d(value)[name.axis or 0])

    @property
    def _of_body(self) -> dict[str, Callable[[StateGradient, QuantityName], None]]:
        return {
            REACTION: self._add_reaction,
            STRAIN_ENERGY: self._add_strain_energy,
            EXTERNAL_WORK: self._add_external_work,
            "elongation": self._add_elongation,
        }

    @property
    def _of_contacts(self) -> dict[str, Callable[[StateGradient, int, QuantityName], None]]:
        return {
            NORMAL_FORCE: self._add_normal_force,
            PRESSURE_INTEGRAL: self._add_pressure_integral,
            FRICTION_FORCE: self._add_friction_force,
            CONTACT_FORCE: self._add_contact_force,
            MAX_CONTACT_PRESSURE: self._add_max_pressure,
            MAX_SLIP: self._add_max_slip,
            INDENTATION: self._add_indentation,
            FRICTION_WORK: self._add_friction_work,
            PENALTY_ENERGY: self._add_penalty_energy,
        }

    def _contacts_of(self, name: QuantityName, text: str) -> list[int]:
        """The contacts whose quantities add up to one, or which has the largest."""
        problem, states = self.problem, self.solution.states
        every = list(range(len(problem.contacts)))
        if name.owner:
            return [problem.scene.names.contacts.index(name.owner)]
        row = table.find(name.quantity)
        assert row is not None
        if row.together is Together.SUM or len(every) == 1:
            return every
        if row.together is Together.LARGEST:
            sizes = [self._largest(n, self._sizes(n, name.quantity))[0] for n in every]
            return [int(np.argmax(sizes))] if states else []
        raise InputError(
            f"of: '{text}': the model has {len(every)} contacts, which have it one by one; ask "
            f"for NAME.{text}, NAME being a contact's"
        )

    def _add_resultant(
        self, found: StateGradient, number: int, along: Array, pressure: bool, friction: bool
    ) -> None:
        """Add the component of a contact's force on the body of ``on`` along a vector."""
        contact, answers = self.problem.contacts[number], found.contacts[number]
        trace, sign = contact.trace, contact.sides.on_sign
        if contact.spaces.kinematics == "axisymmetric":
            along = along * [0.0, 1.0]
        if pressure:
            answers.pressure -= sign * trace.weights * (trace.normals @ along)
        if friction:
            answers.friction += sign * trace.weights[:, None] * along

    def _add_normal_force(self, found: StateGradient, number: int, name: QuantityName) -> None:
        axis = self.problem.contacts[number].axis
        if axis is None:
            raise InputError(
                f"of: 'normal_force' of '{self.problem.contacts[number].label}' is none, as the "
                "surface wraps around; ask for its pressure_integral"
            )
        self._add_resultant(found, number, axis, pressure=True, friction=False)
        contact, state = self.problem.contacts[number], self.solution.states[number]
        if contact.kinematics.axis is not None:  # that of an obstacle, which may turn
            pressed = state.contact_pressure[:, None] * contact.trace.normals
            found.contacts[number].direction -= contact.trace.integral(pressed)

    def _add_friction_force(self, found: StateGradient, number: int, name: QuantityName) -> None:
        self._add_resultant(found, number, self._axis(name), pressure=False, friction=True)

    def _add_contact_force(self, found: StateGradient, number: int, name: QuantityName) -> None:
        self._add_resultant(found, number, self._axis(name), pressure=True, friction=True)

    def _axis(self, name: QuantityName) -> Array:
        assert name.axis is not None
        return np.asarray(np.eye(self.problem.spaces.components)[name.axis])

    def _add_pressure_integral(self, found: StateGradient, number: int, name: QuantityName) -> None:
        found.contacts[number].pressure += self.problem.contacts[number].trace.weights

    def _sizes(self, number: int, quantity: str) -> Array:
        """What a largest value is the largest of, at the points."""
        state = self.solution.states[number]
        if quantity == MAX_CONTACT_PRESSURE:
            return pressure_of_facets(self.problem.contacts[number], state)
        return np.where(state.status != OPEN, np.linalg.norm(state.slip, axis=1), 0.0)

    def _largest(self, number: int, sizes: Array) -> tuple[float, int, int]:
        """The largest value at the points of a contact, its rank and point there; collective."""
        contact = self.problem.contacts[number]
        owned = np.flatnonzero(contact.trace.owned)
        best = int(owned[np.argmax(sizes[owned])]) if len(owned) else -1
        value = float(sizes[best]) if len(owned) else -np.inf
        every = of_every_rank(contact.spaces.comm, (value, best))
        rank = max(range(len(every)), key=lambda one: every[one][0])
        return (every[rank][0], rank, every[rank][1])

    def _at_largest(self, number: int, quantity: str) -> Array:
        """1 at the point that has the largest value, 0 elsewhere, (points,); collective."""
        sizes = self._sizes(number, quantity)
        _, rank, point = self._largest(number, sizes)
        found = np.zeros(len(sizes))
        if rank == self.problem.comm.rank:
            found[point] = 1.0
        return found

    def _add_max_pressure(self, found: StateGradient, number: int, name: QuantityName) -> None:
        there = self._at_largest(number, name.quantity)
        found.contacts[number].pressure += pressure_of_facets_transposed(
            self.problem.contacts[number], there
        )

    def _add_max_slip(self, found: StateGradient, number: int, name: QuantityName) -> None:
        slip = self.solution.states[number].slip
        size = np.linalg.norm(slip, axis=1)
        direction = slip / np.where(size > 0, size, 1.0)[:, None]
        found.contacts[number].slip += self._at_largest(number, name.quantity)[:, None] * direction

    def _add_indentation(self, found: StateGradient, number: int, name: QuantityName) -> None:
        contact, answers = self.problem.contacts[number], found.contacts[number]
        if contact.contact.obstacle is None or not self.problem.has_datum:
            raise InputError("of: 'indentation': there is no obstacle, or it has no datum")
        answers.brought_up += 1.0
        if not contact.floats:
            answers.indentation += 1.0
        for place, unknown in enumerate(self.problem.unknowns):
            if isinstance(unknown, Indentation) and unknown.contact is contact:
                found.scalars[place] += 1.0

    def _add_friction_work(self, found: StateGradient, number: int, name: QuantityName) -> None:
        contact, state = self.problem.contacts[number], self.solution.states[number]
        if contact.friction.follows_path:
            raise InputError(
                "of: 'friction_work' has derivatives with the static law; with the incremental one "
                "it is summed up along the load steps"
            )
        if contact.friction.stores_energy:
            raise InputError(
                "of: 'friction_work' has no derivatives where a part of the slip goes back; the "
                "friction_force has"
            )
        weights = contact.trace.weights[:, None]
        if contact.friction.has_friction:
            found.contacts[number].friction -= weights * state.slip
            found.contacts[number].slip -= weights * state.friction_traction

    def _add_penalty_energy(self, found: StateGradient, number: int, name: QuantityName) -> None:
        found.contacts[number].energy += self.problem.contacts[number].trace.weights

    def _add_strain_energy(self, found: StateGradient, name: QuantityName) -> None:
        self._add_energies(found, 1.0)

    def _add_energies(self, found: StateGradient, factor: float) -> None:
        """Add a multiple of the strain energy."""
        nodal = factor * self.solution.internal_force
        found.body = BodyGradient(nodal, np.zeros_like(nodal))
        found.energy += factor
        first = len(found.scalars) - len(self.problem.preloads)
        for number, state in enumerate(self.solution.preloads):
            found.scalars[first + number] += factor * state.force

    def _add_external_work(self, found: StateGradient, name: QuantityName) -> None:
        """2 W − Σ ∫ t · w, W the strain energy, t tractions; and what brought obstacles up."""
        if self.problem.scene.load_steps.several:
            raise InputError(
                "of: 'external_work' has derivatives where there is one load step; else it is "
                "summed up along them"
            )
        self._add_energies(found, 2.0)
        for number, contact in enumerate(self.problem.contacts):
            state, answers = self.solution.states[number], found.contacts[number]
            kinematics, weights = contact.kinematics, contact.trace.weights
            jump, normals = kinematics.jump_at_points(), contact.trace.normals
            traction = state.friction_traction.copy()
            if contact.normal.follows_jump:
                traction -= state.contact_pressure[:, None] * normals
            raised = kinematics.brought_up * kinematics.direction - jump
            answers = answers.with_traction(contact, weights[:, None] * raised)
            found.contacts[number] = answers
            answers.jump -= weights[:, None] * traction
            answers.pressure += kinematics.pressing_interference * weights
            integral = contact.trace.integral
            answers.interference += float(integral(state.contact_pressure))
            answers.brought_up += float(integral(traction) @ kinematics.direction)
            answers.direction += kinematics.brought_up * integral(traction)

    def _add_reaction(self, found: StateGradient, name: QuantityName) -> None:
        assert name.axis is not None
        problem = self.problem
        dofs = self._dofs_of(name.owner, name.axis) if name.owner else problem.constrained
        reactions = np.zeros_like(problem.load)
        is_radial = problem.spaces.kinematics == "axisymmetric" and name.axis == 0
        if not is_radial:  # over a revolution they cancel
            mine = dofs[dofs % problem.spaces.components == name.axis]
            reactions.reshape(-1)[mine] = 1.0
        found.body = BodyGradient(np.zeros_like(reactions), reactions)

    def _dofs_of(self, owner: str, axis: int) -> Array:
        """Dofs whose forces along an axis count to the supports of a name."""
        problem = self.problem
        numbers = [n for n, one in enumerate(problem.applied_supports) if one.label == owner]
        if problem.shared_reactions.are_shared(numbers, axis):
            raise InputError(
                f"of: '{owner}.reaction_{AXES[axis]}' has no derivatives, as other supports hold "
                "some of its points along that axis too; the reaction of all supports has"
            )
        counted = np.zeros(problem.load.size, dtype=bool)
        found = [np.zeros(0, dtype=np.int64)]
        for support in problem.applied_supports:
            dofs = support.dofs[~counted[support.dofs]]
            counted[dofs] = True
            if support.label == owner:
                found.append(dofs)
        return np.concatenate(found)

    def _add_elongation(self, found: StateGradient, name: QuantityName) -> None:
        problem = self.problem
        number = [preload.scene.label for preload in problem.preloads].index(name.owner)
        found.scalars[len(found.scalars) - len(problem.preloads) + number] = 1.0

    def _add_displacement(self, found: StateGradient, name: QuantityName) -> None:
        assert name.axis is not None
        nodal = self.problem.points.gradient(name.quantity, name.axis)
        found.body = BodyGradient(nodal, np.zeros_like(nodal))
