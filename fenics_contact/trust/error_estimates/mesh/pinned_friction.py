"""Friction beside nodes that something else keeps from slipping: it is known up to a cell.

Where a contact ends at a support, or at another contact, nodes of both cannot slip. Friction there
is what the support or the other contact takes, and no tangential balance tells it: the regularised
law gives none at a node at rest, and all there is at one that the give of a penalty lets slip. The
next node slips, or nearly, and carries all it can. What happens in between, a zone that sticks and
ends somewhere within the cell, no solution on this mesh sees; nor does any change of the load, as
all of it grows in proportion.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    FRICTION_FORCE,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    REACTION,
    SLIP_AREA,
    STICK_AREA,
)
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.newton.solution import Solution

# Of a direction across a surface: squares below it are round-off.
_NONE = 1e-9
# Of the slip of its neighbour, below which a node is at rest: what holds it may also move it along.
_AT_REST = 0.1
# Of the friction bound.
_MUCH = 0.5


@dataclass(frozen=True)
class PinnedFriction:
    """Unknown part of a contact's friction force, and what takes it up.

    Attributes:
        at_supports: By number, in the order of ``Problem.applied_supports``, beside nodes that
            these hold (force).
        at_contacts: By number, beside nodes that another contact holds (force).
        area: In which it is not known whether the surface sticks (area, length in 2D).
    """

    at_supports: dict[int, float]
    at_contacts: dict[int, float]
    area: float

    @property
    def whole(self) -> float:
        """Whole unknown part of the contact's friction force (force)."""
        return sum(self.at_supports.values()) + sum(self.at_contacts.values())


def pinned_friction(problem: Problem, solution: Solution) -> list[PinnedFriction]:
    """Return the unknown friction force of every contact, in scene order; collective."""
    pairs = list(zip(problem.contacts, solution.states, strict=True))
    supports = [_held_axes(problem, support.dofs) for support in problem.applied_supports]
    contacts = [[_pressed_along(contact, state)] for contact, state in pairs]
    found = []
    for number, (contact, state) in enumerate(pairs):
        others = [[] if other == number else holds for other, holds in enumerate(contacts)]
        by_supports, by_contacts = (
            {n: part for n, one in enumerate(holds) if (part := _sum(contact, state, one))[0] > 0}
            for holds in (supports, others)
        )
        area = sum(part[1] for part in [*by_supports.values(), *by_contacts.values()])
        found.append(
            PinnedFriction(
                {n: part[0] for n, part in by_supports.items()},
                {n: part[0] for n, part in by_contacts.items()},
                area,
            )
        )
    return found


def unknown_by_pinned(problem: Problem, solution: Solution) -> dict[Hashable, float]:
    """Unknown parts of quantities, as nodes cannot slip (``pinned_friction``); collective.

    What one contact's friction may be more, supports or another contact's pressure take.
    """
    found: dict[Hashable, float] = {}

    def add(keys: Sequence[Hashable], unknown: float) -> None:
        for key in keys:
            found[key] = found.get(key, 0.0) + unknown

    def of_contact(number: int, *names: str) -> list[Hashable]:
        return [*names, *((number, name) for name in names)]

    labels = [support.label for support in problem.applied_supports]
    for number, pinned in enumerate(pinned_friction(problem, solution)):
        add(of_contact(number, FRICTION_FORCE, CONTACT_FORCE), pinned.whole)
        add(of_contact(number, STICK_AREA, SLIP_AREA), pinned.area)
        for support, unknown in pinned.at_supports.items():
            add([REACTION, Reaction(support), Reaction(labels[support])], unknown)
        for other, unknown in pinned.at_contacts.items():
            names = (NORMAL_FORCE, PRESSURE_INTEGRAL, CONTACT_FORCE)
            add(of_contact(other, *names), unknown)
    return found


def _sum(contact: ContactSurface, state: ContactState, holds: list[Array]) -> tuple[float, float]:
    """Return force and area of a contact in several directions at the nodes; collective."""
    if not contact.friction.has_friction:
        return 0.0, 0.0
    parts = [_unknown(contact, state, held[contact.nodes]) for held in holds]
    return sum(force for force, _ in parts), sum(area for _, area in parts)


def _held_axes(problem: Problem, dofs: Integers) -> list[Array]:
    """Directions at the body's nodes along which a support holds them, an array an axis."""
    components = problem.spaces.components
    found = [np.zeros_like(problem.load) for _ in range(components)]
    for axis, along in enumerate(found):
        along[dofs[dofs % components == axis] // components, axis] = 1.0
    return found


def _pressed_along(contact: ContactSurface, state: ContactState) -> Array:
    """Normals at the body's nodes that a contact keeps from moving along them, else 0; collective.

    Not of foundations, which give way.
    """
    trace = contact.trace
    closed = (state.status != OPEN)[: len(contact.nodes)] & contact.has_penalty
    normals = trace.normals[: len(contact.nodes)] * closed[:, None]
    whole = np.zeros((len(trace.all_nodes), trace.normals.shape[1]))
    whole[trace.numbers] = normals
    return trace.surface.on_body(whole)


def _unknown(contact: ContactSurface, state: ContactState, held: Array) -> tuple[float, float]:
    """Half of what friction could be along directions held, on pieces of the surface; collective.

    And half of their area.

    Args:
        contact: Its pieces lie between nodes.
        state: What happens at them.
        held: Directions along which its nodes cannot move, (nodes, components); 0 elsewhere.
    """
    pieces, count = contact.trace.pieces, len(contact.nodes)
    normals = contact.trace.normals[:count]
    along = held - np.einsum("ni,ni->n", held, normals)[:, None] * normals
    pinned = (along**2).sum(axis=1) > _NONE
    direction = along[pieces.points]
    lengths = np.linalg.norm(direction, axis=2, keepdims=True)
    direction = direction / np.where(lengths > 0, lengths, 1.0)
    slip = contact.friction.effective_slip(state.slip)[:count][pieces.points]
    traction = state.friction_traction[:count][pieces.points]
    slips = _uses_much(contact, state)[pieces.points] & ~pinned[pieces.points]
    # Of each pinned corner the largest of what its slipping neighbours carry along it.
    moved, carried = (
        np.abs(np.einsum("pai,pbi->pab", direction, vectors)) for vectors in (slip, traction)
    )
    own = np.abs(np.einsum("pai,pai->pa", direction, slip))
    carried = carried * (slips[:, None, :] & (own[:, :, None] < _AT_REST * moved))
    carried = carried.max(axis=2, initial=0.0) * pinned[pieces.points]
    shares = np.stack([carried, carried > 0]) * pieces.weights / pieces.points.shape[1]
    sums = (pieces.areas * shares.sum(axis=2)).sum(axis=1)
    force, area = total(contact.spaces.comm, sums)
    return float(force), float(area)


def _uses_much(contact: ContactSurface, state: ContactState) -> Flags:
    """Return for each node whether it slips, or carries more than half of its friction bound."""
    carried = contact.friction.rule.metric.carried(state.friction_traction)
    used = carried > _MUCH * contact.friction.bound_of(state.contact_pressure)
    found = (state.status == SLIP) | ((state.status != OPEN) & used)
    return np.asarray(found[: len(contact.nodes)])
