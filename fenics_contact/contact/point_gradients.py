"""From the gradient of a quantity in what a contact answers to that in what it is given.

Backwards through the laws at the points, by their tangents.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface


@dataclass(frozen=True, eq=False)
class AnswerGradient:
    """Gradient of a quantity in what happens at the points of a contact.

    Points' areas are in them, and points that this rank does not own have theirs as well.

    Attributes:
        pressure: In the contact pressure, (points,).
        friction: In the friction traction on the body, (points, components).
        slip: In the slip since the start, likewise.
        depth: In minus the gap, (points,).
        energy: In the energy over area, (points,).
        jump: In the jump itself, (points, components).
        brought_up: In how far the obstacle was brought up, beside what that does to the gap.
        indentation: In how far an obstacle is driven, beside what that does to the jump.
        angle: In how far it has turned, likewise.
        interference: In the interference, beside what that does to the gap.
        direction: In that along which an obstacle is driven, beside what that does to jump, gap and
            how far it was brought up, (components,), of all ranks.
        state: In arrays that the law along the contact keeps, as a load step leaves them, by name.
    """

    pressure: Array
    friction: Array
    slip: Array
    depth: Array
    energy: Array
    jump: Array
    brought_up: float = 0.0
    indentation: float = 0.0
    angle: float = 0.0
    interference: float = 0.0
    direction: Array = field(default_factory=lambda: np.zeros(3))
    state: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def none(cls, contact: ContactSurface) -> Self:
        """The gradient of a quantity that has nothing to do with the contact."""
        scalars = [np.zeros(len(contact.trace.weights)) for _ in range(3)]
        vectors = [np.zeros_like(contact.trace.normals) for _ in range(3)]
        pressure, depth, energy = scalars
        friction, slip, jump = vectors
        turned = np.zeros(contact.trace.normals.shape[1])
        return cls(pressure, friction, slip, depth, energy, jump, direction=turned)

    def adding(self, **parts: Any) -> Self:
        """With further gradients, which are added to its own.

        Args:
            parts: By names of attributes, of the same shape; not ``state``.
        """
        return replace(self, **{name: getattr(self, name) + by for name, by in parts.items()})

    def plus(self, other: AnswerGradient) -> Self:
        """The gradient of the sum of two quantities."""
        parts = {name: part for name, part in vars(other).items() if name != "state"}
        state = {**self.state}
        for name, part in other.state.items():
            state[name] = state[name] + part if name in state else part
        return replace(self.adding(**parts), state=state)

    def traction(self, contact: ContactSurface) -> Array:
        """Part of the gradient in the traction that follows the jump, (points, components)."""
        found = contact.kinematics.tangential(self.friction)
        if contact.normal.follows_jump:
            found = found - self.pressure[:, None] * contact.trace.normals
        return found

    def with_traction(self, contact: ContactSurface, of_traction: Array) -> Self:
        """With a gradient in the traction that follows the jump besides, (points, components)."""
        pressure = self.pressure
        if contact.normal.follows_jump:
            pressure = pressure - contact.kinematics.normal(of_traction)
        friction = self.friction + contact.kinematics.tangential(of_traction)
        return replace(self, pressure=pressure, friction=friction)


@dataclass(frozen=True, eq=False)
class GivenGradient:
    """Gradient of a quantity in what a contact is given, at the points.

    Attributes:
        jump: In the jump, (points, components).
        gap: In the gap, (points,).
        pressure: In a pressure that is given, (points,).
        across: In parameters of the law across it, by name, (points,).
        along: In those of the law along it, likewise.
        state: In arrays that this keeps, as the load step before left them, likewise.
        reference: In the slip that counts as none, (points, components).
        brought_up: As of ``AnswerGradient``.
        indentation: Likewise.
        angle: Likewise.
        interference: Likewise.
        direction: Likewise.
    """

    jump: Array
    gap: Array
    pressure: Array
    across: Mapping[str, Array]
    along: Mapping[str, Array]
    state: Mapping[str, Array]
    reference: Array
    brought_up: float
    indentation: float
    angle: float
    interference: float
    direction: Array


@dataclass(frozen=True, eq=False)
class GivenChange:
    """How what a contact is given changes with a key of the scene; None of what does not.

    Attributes:
        motion: Of what stands opposite, (components,), or at the points, (points, components).
        gap: At the points, (points,).
        pressure: That is given, likewise.
        across: Parameters of the law across it, by name, likewise.
        along: Those of the law along it.
        brought_up: How far the obstacle was brought up.
        indentation: How far it is driven, where no force drives it.
        angle: How far it turns, where no moment turns it.
        interference: The interference.
        direction: That along which the obstacle is driven, (components,).
    """

    motion: Array | None = None
    gap: Array | None = None
    pressure: Array | None = None
    across: Mapping[str, Array] = field(default_factory=dict)
    along: Mapping[str, Array] = field(default_factory=dict)
    brought_up: float = 0.0
    indentation: float = 0.0
    angle: float = 0.0
    interference: float = 0.0
    direction: Array | None = None


def vjp(contact: ContactSurface, answers: AnswerGradient) -> GivenGradient:
    """At the present state of a contact, whose bound is that of its pressure.

    Args:
        contact: The contact.
        answers: Gradient of the quantity in what happens there.
    """
    kinematics = contact.kinematics
    jump, normals = kinematics.jump_at_points(), contact.trace.normals
    slip = kinematics.tangential(jump)
    of_traction = kinematics.tangential(answers.friction)
    pressed = contact.normal.pressure(jump)
    friction = contact.friction.vjp(slip, pressed, of_traction)
    of_way, of_others = contact.friction.vjp_state_update(
        slip, contact.normal.is_closed(pressed), answers.state
    )
    of_law = dict(friction.fields)
    for name, values in of_others.items():
        of_law[name] = of_law[name] + values if name in of_law else values
    pressure = answers.pressure + friction.pressure
    normal = contact.normal.vjp(jump, pressure[:, None] * normals - of_traction, answers.energy)
    depth = np.where(kinematics.reached, answers.depth, 0.0)
    return GivenGradient(
        jump=answers.jump
        + normal.jump
        + kinematics.tangential(answers.slip + friction.slip + of_way)
        + depth[:, None] * normals,
        gap=normal.gap - depth,
        pressure=pressure,
        across=normal.fields,
        along=of_law,
        state={name: of_law[name] for name in contact.friction.derived_state if name in of_law},
        reference=kinematics.tangential(friction.reference - of_way),
        brought_up=answers.brought_up,
        indentation=answers.indentation,
        angle=answers.angle,
        interference=answers.interference,
        direction=answers.direction,
    )


@dataclass(frozen=True, eq=False)
class FoundGradient:
    """Gradient of a quantity in what an exact solver is given at the points of a contact.

    Attributes:
        gap: In the gap that is left, by what the forces do, (points,).
        slip: In the slip that counts, likewise, (points, components).
        bound: In the bound of friction, (points,) (1/stress).
        elastic_slip: In ε, (points,).
        traction: In the traction along the surface, forces being held, (points, components): what
            a direction that friction goes by changes.
    """

    gap: Array
    slip: Array
    bound: Array
    elastic_slip: Array
    traction: Array


def of_found_forces(contact: ContactSurface, answers: AnswerGradient) -> tuple[Array, Array]:
    """Gradient in pressures and tractions that were found, (points,) and (points, components).

    Args:
        contact: The contact.
        answers: Gradient of the quantity in what happens there.
    """
    tractions = contact.kinematics.tangential(answers.friction)
    if contact.normal.pressure_is_known:
        return np.zeros_like(answers.pressure), tractions
    assert contact.found is not None
    stored = contact.penalty_parameter * contact.found.pressure * answers.energy
    return answers.pressure + stored, tractions


def of_found_jump(contact: ContactSurface, answers: AnswerGradient) -> tuple[Array, Array]:
    """Gradient in the jump and in the slip that counts, forces at the points being held.

    Args:
        contact: The contact.
        answers: Gradient of the quantity in what happens there.

    Returns:
        (points, components) each; the first contains the second.
    """
    kinematics = contact.kinematics
    slip = kinematics.tangential(kinematics.jump_at_points())
    closed = np.zeros(len(slip), dtype=bool) if contact.found is None else contact.found.closed
    of_way, _ = contact.friction.vjp_state_update(slip, closed, answers.state)
    of_way = kinematics.tangential(of_way)
    depth = np.where(kinematics.reached, answers.depth, 0.0)
    jump = answers.jump + kinematics.tangential(answers.slip) + of_way
    return jump + depth[:, None] * contact.trace.normals, of_way


def vjp_of_found(
    contact: ContactSurface, answers: AnswerGradient, found: FoundGradient
) -> GivenGradient:
    """At a state whose forces an exact solver found, from what it is given.

    Args:
        contact: The contact.
        answers: Gradient of the quantity in what happens there.
        found: In what the solver is given.
    """
    kinematics, friction = contact.kinematics, contact.friction
    jump, of_way = of_found_jump(contact, answers)
    slip = kinematics.tangential(kinematics.jump_at_points())
    assert contact.found is not None
    pressure, closed = contact.pressure(), contact.found.closed
    rule = friction.rule.vjp(pressure, friction.factor * found.bound)
    of_law = {**rule.fields, "regularisation_parameter": found.elastic_slip}
    _, of_others = friction.vjp_state_update(slip, closed, answers.state)
    for more in (*_of_metric(contact, found, slip), of_others):
        for name, values in more.items():
            of_law[name] = of_law[name] + values if name in of_law else values
    depth = np.where(kinematics.reached, answers.depth, 0.0)
    of_given = contact.normal.pressure_is_known
    of_penalty = (
        found.gap * contact.found.pressure + 0.5 * contact.found.pressure**2 * answers.energy
    )
    slopes = contact.normal.field_slopes("penalty_parameter", 1.0)
    return GivenGradient(
        jump=jump + found.slip - found.gap[:, None] * contact.trace.normals,
        gap=found.gap - depth,
        pressure=answers.pressure + (rule.pressure if of_given else 0.0),
        across={name: of_penalty / slope for name, slope in slopes.items()},
        along=of_law,
        state={name: of_law[name] for name in friction.derived_state if name in of_law},
        reference=-found.slip - of_way,
        brought_up=answers.brought_up,
        indentation=answers.indentation,
        angle=answers.angle,
        interference=answers.interference,
        direction=answers.direction,
    )


def _of_metric(
    contact: ContactSurface, found: FoundGradient, slip: Array
) -> Iterator[Mapping[str, Array]]:
    """Gradients in parameters of M, by which friction feels M s and tractions are M q, by name."""
    friction = contact.friction
    metric = friction.rule.metric
    assert contact.found is not None
    pulled = metric.undone(contact.found.traction)
    yield metric.gradients(metric.undone(found.slip), friction.effective_slip(slip))
    yield metric.gradients(found.traction, pulled)


def along(contact: ContactSurface, gradient: GivenGradient, change: GivenChange) -> float:
    """Derivative of the quantity in the key, this rank's part of it.

    Numbers that are no sum over points are counted by the first rank.
    """
    owned = contact.trace.owned
    found = 0.0
    if change.motion is not None:
        found -= float(np.sum((gradient.jump * change.motion)[owned]))
    pairs = [
        (gradient.gap, change.gap),
        (gradient.pressure, change.pressure),
        *((gradient.across[name], values) for name, values in change.across.items()),
        *((gradient.along[name], values) for name, values in change.along.items()),
    ]
    found += sum(float(np.sum(of[owned] * by[owned])) for of, by in pairs if by is not None)
    if contact.spaces.comm.rank == 0:
        found += gradient.brought_up * change.brought_up
        found += gradient.indentation * change.indentation
        found += gradient.angle * change.angle
        found += gradient.interference * change.interference
        if change.direction is not None:
            found += float(np.sum(gradient.direction * change.direction))
    return found
