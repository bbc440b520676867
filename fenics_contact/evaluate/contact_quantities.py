"""Quantities of a contact from an answer: evaluators, each of one quantity or of a few.

Resultants of a contact's pressure and friction on the body of its surface `on`. Of two bodies they
are found on the slave. What acts there, and its opposite on the master, balance, so that the
choice of slave changes nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP, ContactState
from fenics_contact.evaluate.contact_areas import Zones, contact_area, radii, stick_area
from fenics_contact.evaluate.contact_moments import contact_moments
from fenics_contact.evaluate.internal_forces import pressure_of_facets
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities import names, table
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    FRICTION_FORCE,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
)
from fenics_contact.quantities.quantity import Quantity
from fenics_contact.solve.systems.solution import Solution


def resultants(
    contact: ContactSurface, state: ContactState, friction_force: Array
) -> dict[str, float | list[float] | None]:
    """Forces of a contact; collective.

    Args:
        contact: The contact.
        state: What happens at its points.
        friction_force: Of the friction law on the slave, at the nodes (force).

    Returns:
        By the interface's names; the normal force is None where the contact has no axis.
    """
    trace, sign = contact.trace, contact.sides.on_sign
    of_pressure = -sign * trace.integral(state.contact_pressure[:, None] * trace.normals)
    of_friction = sign * _friction(contact, state, friction_force)
    if contact.spaces.kinematics == "axisymmetric":
        of_pressure[0] = 0.0
    axis = contact.axis
    return {
        NORMAL_FORCE: None if axis is None else float(of_pressure @ axis),
        PRESSURE_INTEGRAL: float(trace.integral(state.contact_pressure)),
        FRICTION_FORCE: (of_friction + 0.0).tolist(),  # no −0
        CONTACT_FORCE: (of_pressure + of_friction + 0.0).tolist(),
    }


def _friction(contact: ContactSurface, state: ContactState, force: Array) -> Array:
    """Force along the surface on the slave; collective.

    That of a friction law is at the nodes, that of a law across the contact, such as glue, at the
    points.
    """
    rubs, normal = contact.friction.has_friction, contact.normal
    found = np.zeros(contact.spaces.components)
    if rubs:
        found = resultant(contact.spaces, force[contact.owned_nodes])
    if normal.exerts_shear:
        traction = state.friction_traction
        if rubs:
            traction = normal.traction(contact.kinematics.jump_at_points())
        found = found + contact.trace.integral(traction)
    if contact.spaces.kinematics == "axisymmetric":
        found[0] = 0.0
    return found


def resultant(spaces: Spaces, forces: Array) -> Array:
    """Global sum of forces at owned points; over a revolution, radial ones cancel; collective.

    Args:
        spaces: Those of the body.
        forces: At points, (points, components) (force).
    """
    summed: Array = total(spaces.comm, forces.sum(axis=0))
    if spaces.kinematics == "axisymmetric":
        summed[0] = 0.0
    return np.asarray(summed)


@dataclass(frozen=True, eq=False)
class ContactAnswer:
    """A contact and an answer.

    Attributes:
        problem: The model, in the state of the answer.
        solution: The answer.
        number: Of the contact, in scene order.
    """

    problem: Problem
    solution: Solution
    number: int

    @property
    def contact(self) -> ContactSurface:
        """The surface in contact, by the number of the contact."""
        return self.problem.contacts[self.number]

    @property
    def state(self) -> ContactState:
        """Pressures, slips and status at the contact points."""
        return self.solution.states[self.number]

    @cached_property
    def zones(self) -> Zones:
        """Where it touches, and where it sticks; collective."""
        return Zones(self.contact, self.state)


#: Gives quantities of a contact by their names; collective.
Evaluator = Callable[[ContactAnswer], Mapping[str, Any]]


def contact_quantities(problem: Problem, solution: Solution, number: int) -> dict[str, Any]:
    """All quantities of a contact by their names; collective.

    Args:
        problem: The model, in the state of the answer.
        solution: The answer.
        number: Of the contact, in scene order.
    """
    answer = ContactAnswer(problem, solution, number)
    found: dict[str, Any] = {}
    for evaluate in _EVALUATORS:
        found |= evaluate(answer)
    return found | {name: value(answer) for name, value in _REGISTERED.items()}


def register(quantity: Quantity, value: Callable[[ContactAnswer], float]) -> None:
    """Add a quantity of contacts to the table, with its evaluation.

    Args:
        quantity: Its row.
        value: Gives the quantity; collective.

    Raises:
        ValueError: There is a quantity of this name.
    """
    table.register(quantity)
    _REGISTERED[quantity.name] = value


def unregister(name: str) -> None:
    """Take out a quantity that was registered."""
    del _REGISTERED[name]
    table.unregister(name)


def _resultants(answer: ContactAnswer) -> Mapping[str, Any]:
    friction_force = answer.solution.friction_force[answer.number]
    return resultants(answer.contact, answer.state, friction_force)


def _moments(answer: ContactAnswer) -> Mapping[str, Any]:
    friction_force = answer.solution.friction_force[answer.number]
    return contact_moments(answer.contact, answer.state, friction_force)


def _peak_pressure(answer: ContactAnswer) -> Mapping[str, Any]:
    comm, pressure = answer.contact.spaces.comm, pressure_of_facets(answer.contact, answer.state)
    return {names.MAX_CONTACT_PRESSURE: largest(comm, pressure)}


def _areas(answer: ContactAnswer) -> Mapping[str, Any]:
    closed = contact_area(answer.zones)
    sticking = min(stick_area(answer.zones), closed)
    return {
        names.CONTACT_AREA: closed,
        names.STICK_AREA: sticking,
        names.SLIP_AREA: closed - sticking,
        **radii(answer.zones),
    }


def _penetration(answer: ContactAnswer) -> Mapping[str, Any]:
    contact, gap = answer.contact, answer.state.gap
    depth = np.where(np.isfinite(gap), -gap, 0.0)
    deepest = max(largest(contact.spaces.comm, depth), 0.0) if contact.is_one_sided else 0.0
    return {names.MAX_PENETRATION: deepest}


def _slip(answer: ContactAnswer) -> Mapping[str, Any]:
    slip = np.linalg.norm(answer.state.slip[answer.state.status != OPEN], axis=1)
    return {names.MAX_SLIP: largest(answer.contact.spaces.comm, slip)}


def _energies(answer: ContactAnswer) -> Mapping[str, Any]:
    contact, state = answer.contact, answer.state
    return {
        names.FRICTION_WORK: contact.work.of_friction(state),
        names.PENALTY_ENERGY: float(contact.trace.integral(state.penalty_energy)),
    }


def _wear(answer: ContactAnswer) -> Mapping[str, Any]:
    return answer.contact.wear.quantities(answer.state)


def _stored_along(answer: ContactAnswer) -> Mapping[str, Any]:
    """Energy of elastic slip, where friction has such; collective."""
    if not answer.contact.friction.stores_energy:
        return {}
    return {names.ELASTIC_SLIP_ENERGY: answer.contact.work.in_elastic_slip(answer.state)}


def _undecided(answer: ContactAnswer) -> Mapping[str, Any]:
    """How many points slip by less than 2ε: with an ε twice as large they may stick.

    A point that sticks creeps by ε times the share of its bound that it carries, whatever ε:
    that it creeps by nearly ε says that friction is nearly used up, not that ε decides.
    """
    contact, state = answer.contact, answer.state
    if not contact.friction.regularisation.is_numerical:
        return {}
    slip = np.linalg.norm(contact.friction.scaled_slip(state.slip), axis=1)
    slips = contact.trace.owned & (state.status == SLIP) & (contact.friction_bound > 0)
    near = slips & (slip < 2 * contact.regularisation_parameter)
    return {names.UNDECIDED_POINTS: int(total(contact.spaces.comm, near.sum()))}


def _of_two_bodies(answer: ContactAnswer) -> Mapping[str, Any]:
    """How far they slid, over the contact's size, and the widest gap that closed; collective.

    The slip is since it was found what faces what, the gap that of the meshes.
    """
    contact = answer.contact
    if contact.sides.opposite is None:
        return {}
    gap = np.abs(contact.kinematics.gap[answer.state.status != OPEN])
    return {**slid(contact), names.CLOSED_GAP: largest(contact.spaces.comm, gap)}


def slid(contact: ContactSurface) -> dict[str, float]:
    """How far two bodies slid since it was found what faces what, if they do; collective."""
    if contact.sides.opposite is None:
        return {}
    return {names.SLIP_SINCE_PAIRING: contact.relative_sliding()}


def _motion(answer: ContactAnswer) -> Mapping[str, Any]:
    """How far an obstacle was driven, moved and turned; nothing without one, or a datum."""
    obstacle, kinematics = answer.contact.contact.obstacle, answer.contact.kinematics
    if obstacle is None:
        return {}
    found: dict[str, Any] = {}
    if answer.problem.has_datum:
        found[names.INDENTATION] = kinematics.brought_up + kinematics.indentation
    if obstacle.displacement is not None:
        found[names.OBSTACLE_DISPLACEMENT] = kinematics.displacement.tolist()
    if obstacle.turning is not None:
        found[names.OBSTACLE_ROTATION] = kinematics.angle
    return found


def _heat(answer: ContactAnswer) -> Mapping[str, Any]:
    """Heat into the body of ``on``, of a contact that conducts; collective."""
    if answer.contact.contact.conductance is None or answer.problem.conduction is None:
        return {}
    flows = answer.problem.conduction.flows(answer.solution.states)
    return {names.HEAT_FLOW: flows[answer.number]}


_EVALUATORS: tuple[Evaluator, ...] = (
    *(_resultants, _peak_pressure, _areas, _penetration, _slip, _energies, _wear),
    *(_stored_along, _moments, _undecided, _of_two_bodies, _motion, _heat),
)
_REGISTERED: dict[str, Callable[[ContactAnswer], float]] = {}
