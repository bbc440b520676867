"""Gradients of quantities in the state of a problem, each a function.

Of a contact they are derivatives in pressures, slips, …; areas and radii have none: from cell to
cell they are no smooth function of anything. Of the whole model: energies, reactions, ….
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.evaluate.contact_moments import axis_of_torque, turned
from fenics_contact.evaluate.contact_quantities import ContactAnswer
from fenics_contact.evaluate.internal_forces import (
    pressure_of_facets,
    pressure_of_facets_transposed,
)
from fenics_contact.problem.loads.couplings import SpreadForce
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.scalar_unknown import ScalarUnknown
from fenics_contact.quantities import names
from fenics_contact.quantities.names import EXTERNAL_WORK, REACTION, REACTION_MOMENT, STRAIN_ENERGY
from fenics_contact.scene.loading.couplings import Way
from fenics_contact.scene.quantity_names import QuantityName
from fenics_contact.scene.values import AXES
from fenics_contact.solve.condensed.adjoint import BodyGradient
from fenics_contact.solve.systems.solution import Solution


@dataclass(frozen=True, eq=False)
class StateGradient:
    """Derivatives of a quantity in the state of a problem.

    Attributes:
        contacts: In what happens at each.
        scalars: In the scalar unknowns, beside what these do to jumps and displacements.
        body: In the body, None where the contacts tell all of it.
        energy: How often the strain energy is in it: of that, stiffness is a part.
        springs: In forces of the springs of elastic supports on the body, with the displacement
            held: number of a foot of ``Problem.feet`` → (nodes, components).
        resultant: Gives the quantity itself, in the same state, where it is one of the whole
            thickness, as forces and energies are; collective.
    """

    contacts: Sequence[AnswerGradient]
    scalars: Array
    body: BodyGradient | None = None
    energy: float = 0.0
    springs: Mapping[int, Array] = field(default_factory=dict)
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
        moving = [one for one in problem.unknowns if one.contact is contact and one.moves_obstacle]
        if contact.has_unknown_position:  # its indentation is an unknown
            own = [(one, answers.indentation) for one in moving if one.drives]
            found = found.plus(cls.of_scalars(problem, own))
            answers = replace(answers, indentation=0.0)
        if contact.has_unknown_angle:
            of_path = answers.angle / contact.kinematics.lever
            turning = [(one, of_path) for one in moving if one.turns]
            found = found.plus(cls.of_scalars(problem, turning))
            answers = replace(answers, angle=0.0)
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


#: Gives derivatives of a quantity of a contact, or of its component along an axis; collective.
ContactGradient = Callable[[ContactAnswer, int | None], AnswerGradient]


def _of_resultant(
    answer: ContactAnswer, along: Array, pressure: bool, friction: bool
) -> AnswerGradient:
    """The component of the contact's force on the body of ``on`` along a vector."""
    contact = answer.contact
    trace, sign = contact.trace, contact.sides.on_sign
    if contact.spaces.kinematics == "axisymmetric":
        along = along * [0.0, 1.0]
    found = AnswerGradient.none(contact)
    if pressure:
        found = found.adding(pressure=-sign * trace.weights * (trace.normals @ along))
    if friction:
        found = found.adding(friction=sign * trace.weights[:, None] * along)
    return found


def _normal_force(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    contact = answer.contact
    if contact.axis is None:
        raise InputError(
            f"of: 'normal_force' of '{contact.label}' is none, as the surface wraps around; ask "
            "for its pressure_integral"
        )
    found = _of_resultant(answer, contact.axis, pressure=True, friction=False)
    if contact.kinematics.axis is None:
        return found
    pressed = answer.state.contact_pressure[:, None] * contact.trace.normals
    return found.adding(direction=-contact.trace.integral(pressed))  # an obstacle may turn


def _friction_force(answer: ContactAnswer, axis: int | None) -> AnswerGradient:
    return _of_resultant(answer, _unit(answer, axis), pressure=False, friction=True)


def _contact_force(answer: ContactAnswer, axis: int | None) -> AnswerGradient:
    return _of_resultant(answer, _unit(answer, axis), pressure=True, friction=True)


def _torque(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    contact, axis = answer.contact, axis_of_torque(answer.contact)
    if axis is None or contact.spaces.kinematics == "axisymmetric":
        raise InputError(
            f"of: 'torque' of '{contact.label}' is none: give contact.axis, or in the plane "
            "contact.moment_about"
        )
    trace, sign = contact.trace, contact.sides.on_sign
    way = sign * np.tensordot(axis, turned(contact, trace.coordinates), axes=1)
    of_pressure = -trace.weights * np.einsum("ni,ni->n", way, trace.normals)
    found = AnswerGradient.none(contact)
    return found.adding(pressure=of_pressure, friction=trace.weights[:, None] * way)


def _unit(answer: ContactAnswer, axis: int | None) -> Array:
    assert axis is not None
    return np.asarray(np.eye(answer.problem.spaces.components)[axis])


def _pressure_integral(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    return AnswerGradient.none(answer.contact).adding(pressure=answer.contact.trace.weights)


def _at_largest(answer: ContactAnswer, sizes: Array) -> Array:
    """1 at the point that has the largest of some values, 0 elsewhere, (points,); collective."""
    contact = answer.contact
    owned = np.flatnonzero(contact.trace.owned)
    best = int(owned[np.argmax(sizes[owned])]) if len(owned) else -1
    value = float(sizes[best]) if len(owned) else -np.inf
    every = of_every_rank(contact.spaces.comm, value)
    found = np.zeros(len(sizes))
    if int(np.argmax(every)) == contact.spaces.comm.rank:
        found[best] = 1.0
    return found


def _max_pressure(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    contact = answer.contact
    there = _at_largest(answer, pressure_of_facets(contact, answer.state))
    found = pressure_of_facets_transposed(contact, there)
    return AnswerGradient.none(contact).adding(pressure=found)


def _max_slip(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    slip, status = answer.state.slip, answer.state.status
    size = np.linalg.norm(slip, axis=1)
    direction = slip / np.where(size > 0, size, 1.0)[:, None]
    there = _at_largest(answer, np.where(status != OPEN, size, 0.0))
    return AnswerGradient.none(answer.contact).adding(slip=there[:, None] * direction)


def _indentation(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    if answer.contact.contact.obstacle is None or not answer.problem.has_datum:
        raise InputError("of: 'indentation': there is no obstacle, or it has no datum")
    return AnswerGradient.none(answer.contact).adding(brought_up=1.0, indentation=1.0)


def _rotation(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    obstacle = answer.contact.contact.obstacle
    if obstacle is None or obstacle.turning is None:
        raise InputError("of: 'obstacle_rotation': there is no obstacle that turns")
    return AnswerGradient.none(answer.contact).adding(angle=1.0)


def _friction_work(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    contact, state = answer.contact, answer.state
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
    found, weights = AnswerGradient.none(contact), contact.trace.weights[:, None]
    if not contact.friction.has_friction:
        return found
    return found.adding(friction=-weights * state.slip, slip=-weights * state.friction_traction)


def _penalty_energy(answer: ContactAnswer, _axis: int | None) -> AnswerGradient:
    return AnswerGradient.none(answer.contact).adding(energy=answer.contact.trace.weights)


#: By names of quantities.
CONTACT_GRADIENTS: Mapping[str, ContactGradient] = {
    names.NORMAL_FORCE: _normal_force,
    names.PRESSURE_INTEGRAL: _pressure_integral,
    names.FRICTION_FORCE: _friction_force,
    names.CONTACT_FORCE: _contact_force,
    names.TORQUE: _torque,
    names.MAX_CONTACT_PRESSURE: _max_pressure,
    names.MAX_SLIP: _max_slip,
    names.INDENTATION: _indentation,
    names.OBSTACLE_ROTATION: _rotation,
    names.FRICTION_WORK: _friction_work,
    names.PENALTY_ENERGY: _penalty_energy,
}


#: Gives derivatives of a quantity of the model, or of supports, points or preloads by their names.
ModelGradient = Callable[[Problem, Solution, QuantityName], StateGradient]


def _strain_energy(problem: Problem, solution: Solution, _name: QuantityName) -> StateGradient:
    return _energies(problem, solution, 1.0)


def _energies(problem: Problem, solution: Solution, factor: float) -> StateGradient:
    """The gradient of a multiple of the strain energy."""
    nodal = factor * solution.internal_force
    for foot in problem.feet:  # K has their springs, too, whose energy is another
        nodal = nodal - factor * foot.springs.pull(solution.displacement)
    body = BodyGradient(nodal, np.zeros_like(nodal))
    forces = [factor * state.force if state.works else 0.0 for state in solution.scalars]
    scalars = StateGradient.of_scalars(problem, zip(problem.body_scalars, forces, strict=True))
    return StateGradient.of_body(problem, body, factor).plus(scalars)


def _external_work(problem: Problem, solution: Solution, _name: QuantityName) -> StateGradient:
    """2 W − Σ ∫ t · w, W the strain energy, t tractions; and what brought obstacles up."""
    if problem.scene.load_steps.several:
        raise InputError(
            "of: 'external_work' has derivatives where there is one load step; else it is "
            "summed up along them"
        )
    if problem.is_sprung:
        raise InputError(
            "of: 'external_work' has no derivatives beside springs; the strain_energy has"
        )
    found = _energies(problem, solution, 2.0)
    for number, contact in enumerate(problem.contacts):
        of_contact = _work_on_contact(contact, solution.states[number])
        found = found.plus(StateGradient.of_contact(problem, number, of_contact))
    return found


def _work_on_contact(contact: ContactSurface, state: ContactState) -> AnswerGradient:
    """−∫ t · w over a contact, and the work of bringing an obstacle up."""
    kinematics, weights = contact.kinematics, contact.trace.weights
    integral = contact.trace.integral
    traction = state.friction_traction.copy()
    if contact.normal.follows_jump:
        traction -= state.contact_pressure[:, None] * contact.trace.normals
    widened = contact.trace.at_points(kinematics.shape_field)
    moved = kinematics.jump_at_points() + contact.trace.at_points(kinematics.beyond_shape)
    raised = kinematics.brought_up * kinematics.direction - moved
    found = AnswerGradient.none(contact).with_traction(contact, weights[:, None] * raised)
    return found.adding(
        jump=-weights[:, None] * traction,
        pressure=kinematics.pressing_interference * weights,
        interference=float(integral(state.contact_pressure)),
        brought_up=float(integral(traction) @ kinematics.direction),
        angle=-float(np.sum(integral(traction * widened))),
        direction=kinematics.brought_up * integral(traction),
    )


def _reaction(problem: Problem, _solution: Solution, name: QuantityName) -> StateGradient:
    assert name.axis is not None
    if spread := _spread_forces(problem, name, ("displacement", AXES[name.axis])):
        return StateGradient.of_scalars(problem, spread)
    held = np.setdiff1d(problem.constrained, problem.coupled)
    dofs = _dofs_of(problem, name.owner, name.axis) if name.owner else held
    reactions = np.zeros_like(problem.load)
    is_radial = problem.spaces.kinematics == "axisymmetric" and name.axis == 0
    if not is_radial:  # over a revolution they cancel
        mine = dofs[dofs % problem.spaces.components == name.axis]
        reactions.reshape(-1)[mine] = 1.0
    along = np.zeros_like(reactions)
    along[:, name.axis] = 0.0 if is_radial else 1.0
    return _with_springs(problem, name, reactions, along)


def _with_springs(
    problem: Problem, name: QuantityName, reactions: Array, along: Array
) -> StateGradient:
    """The gradient of work of reactions, where supports hold dofs and where springs pull.

    Args:
        problem: The model.
        name: Whose owner has the supports that count, all if it is empty.
        reactions: Displacement on which the reactions work that hold dofs, (nodes, components).
        along: The same of those of springs.
    """
    feet = enumerate(problem.feet)
    springs = {n: along for n, foot in feet if name.owner in ("", foot.label)}
    displacement = np.zeros_like(reactions)
    for number in springs:
        displacement -= problem.feet[number].springs.pull(along)
    found = StateGradient.of_body(problem, BodyGradient(displacement, reactions))
    return replace(found, springs=springs)


def _reaction_moment(problem: Problem, _solution: Solution, name: QuantityName) -> StateGradient:
    way: Way = ("rotation", "z" if name.axis is None else AXES[name.axis])
    if spread := _spread_forces(problem, name, way):
        return StateGradient.of_scalars(problem, spread)
    dofs = _dofs_of(problem, name.owner, None)
    numbers = [n for n, one in enumerate(problem.applied_supports) if one.label == name.owner]
    arms = problem.support_moments.of_unit_rotations(numbers[0], dofs)[name.axis or 0]
    reactions = np.zeros_like(problem.load)
    reactions.reshape(-1)[dofs] = arms
    every = np.arange(reactions.size)
    turned = problem.support_moments.of_unit_rotations(numbers[0], every)[name.axis or 0]
    return _with_springs(problem, name, reactions, turned.reshape(reactions.shape))


def _spread_forces(
    problem: Problem, name: QuantityName, way: Way
) -> list[tuple[ScalarUnknown, float]]:
    """Scalars of a coupling whose face stays elastic, with what they add to a force or a moment.

    Args:
        problem: The model.
        name: Whose owner is the coupling; of another one there are none.
        way: Along or about which axis.
    """
    every = [one for one in problem.body_scalars if isinstance(one, SpreadForce)]
    own = [one for one in every if one.motion.scene.label == name.owner]
    return [(one, one.resultant(way)) for one in own]


def _dofs_of(problem: Problem, owner: str, axis: int | None) -> Integers:
    """Dofs whose forces along an axis, or along any, count to the supports of a name."""
    numbers = [n for n, one in enumerate(problem.applied_supports) if one.label == owner]
    if problem.shared_reactions.are_shared(numbers, axis):
        if axis is None:
            raise InputError(
                f"of: '{owner}.reaction_moment' has no derivatives, as other supports hold some of "
                "its points along the same axes"
            )
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


def _elongation(problem: Problem, _solution: Solution, name: QuantityName) -> StateGradient:
    own = [(scalar, 1.0) for scalar in problem.body_scalars if scalar.label == name.owner]
    return StateGradient.of_scalars(problem, own)


def of_point(problem: Problem, _solution: Solution, name: QuantityName) -> StateGradient:
    """The gradient of a component of the displacement of a named point.

    Args:
        problem: The model.
        name: ``displacement_NAME``, with an axis.
    """
    assert name.axis is not None
    nodal = problem.points.gradient(name.quantity, name.axis)
    return StateGradient.of_body(problem, BodyGradient(nodal, np.zeros_like(nodal)))


#: By names of quantities.
MODEL_GRADIENTS: Mapping[str, ModelGradient] = {
    REACTION: _reaction,
    REACTION_MOMENT: _reaction_moment,
    STRAIN_ENERGY: _strain_energy,
    EXTERNAL_WORK: _external_work,
    "elongation": _elongation,
}
