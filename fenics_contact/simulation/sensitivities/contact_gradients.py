"""Gradients of quantities of a contact, each a function: derivatives in pressures, slips, ….

Areas and radii have none: from cell to cell they are no smooth function of anything.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.contact.point_gradients import AnswerGradient
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.contact_quantities import ContactAnswer
from fenics_contact.evaluate.internal_forces import (
    pressure_of_facets,
    pressure_of_facets_transposed,
)
from fenics_contact.quantities import names

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
    names.MAX_CONTACT_PRESSURE: _max_pressure,
    names.MAX_SLIP: _max_slip,
    names.INDENTATION: _indentation,
    names.FRICTION_WORK: _friction_work,
    names.PENALTY_ENERGY: _penalty_energy,
}
