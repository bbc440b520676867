"""Gradients of quantities of the whole model, each a function: energies, reactions, ….

Those that the model has from its contacts are in ``contact_gradients``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.contact.state import ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import EXTERNAL_WORK, REACTION, STRAIN_ENERGY
from fenics_contact.scene.quantity_names import QuantityName
from fenics_contact.scene.values import AXES
from fenics_contact.simulation.sensitivities.state_gradient import StateGradient
from fenics_contact.solve.condensed.adjoint import BodyGradient
from fenics_contact.solve.newton.solution import Solution

#: Gives derivatives of a quantity of the model, or of supports, points or preloads by their names.
ModelGradient = Callable[[Problem, Solution, QuantityName], StateGradient]


def _strain_energy(problem: Problem, solution: Solution, _name: QuantityName) -> StateGradient:
    return _energies(problem, solution, 1.0)


def _energies(problem: Problem, solution: Solution, factor: float) -> StateGradient:
    """The gradient of a multiple of the strain energy."""
    nodal = factor * solution.internal_force
    body = BodyGradient(nodal, np.zeros_like(nodal))
    forces = [factor * state.force for state in solution.scalars]
    scalars = StateGradient.of_scalars(problem, zip(problem.body_scalars, forces, strict=True))
    return StateGradient.of_body(problem, body, factor).plus(scalars)


def _external_work(problem: Problem, solution: Solution, _name: QuantityName) -> StateGradient:
    """2 W − Σ ∫ t · w, W the strain energy, t tractions; and what brought obstacles up."""
    if problem.scene.load_steps.several:
        raise InputError(
            "of: 'external_work' has derivatives where there is one load step; else it is "
            "summed up along them"
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
    raised = kinematics.brought_up * kinematics.direction - kinematics.jump_at_points()
    found = AnswerGradient.none(contact).with_traction(contact, weights[:, None] * raised)
    return found.adding(
        jump=-weights[:, None] * traction,
        pressure=kinematics.pressing_interference * weights,
        interference=float(integral(state.contact_pressure)),
        brought_up=float(integral(traction) @ kinematics.direction),
        direction=kinematics.brought_up * integral(traction),
    )


def _reaction(problem: Problem, _solution: Solution, name: QuantityName) -> StateGradient:
    assert name.axis is not None
    dofs = _dofs_of(problem, name.owner, name.axis) if name.owner else problem.constrained
    reactions = np.zeros_like(problem.load)
    is_radial = problem.spaces.kinematics == "axisymmetric" and name.axis == 0
    if not is_radial:  # over a revolution they cancel
        mine = dofs[dofs % problem.spaces.components == name.axis]
        reactions.reshape(-1)[mine] = 1.0
    return StateGradient.of_body(problem, BodyGradient(np.zeros_like(reactions), reactions))


def _dofs_of(problem: Problem, owner: str, axis: int) -> Array:
    """Dofs whose forces along an axis count to the supports of a name."""
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
    STRAIN_ENERGY: _strain_energy,
    EXTERNAL_WORK: _external_work,
    "elongation": _elongation,
}
