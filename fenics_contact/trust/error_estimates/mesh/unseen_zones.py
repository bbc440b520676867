"""Slip and gaps that no point of the mesh shows, and friction beside pinned nodes.

Slip and gaps that no point of the mesh shows. Slip where all that touches sticks, as far as can be
seen. Beside edges and corners the share u that friction has of its bound g rises like a power x^-s
of the distance, s = 1/2 at the most (K. L. Johnson, Contact Mechanics, Cambridge 1985, section
2.8); where pressure and traction rise alike, as below the corner of a block, it hardly rises. An
end stands for half of a piece of the length b, so that it carries 2^s/(1 - s) times what the other
end does, which tells s. At its bound friction is up to (b/2) ((1 - s) u)^(1/s), and slips up to
2.5 times that at the most (π²/4 for s = 1/2: D. S. Dugdale, J. Mech. Phys. Solids 8 (1960)
100-104): less than c = (b/2) u^(1/s). There the surface moves by 4 g c/(π E*) at the end, and a
third of it in the mean. What each piece does so at its own bound is summed up: of those inside,
where the share is even, that is next to nothing.

A gap where the last point of a surface touches, but carries little beside its neighbour. Pressure
rises from the edge of what touches as the root of the distance (chapters 4 and 5). With the edge at
the share s of a piece from its end, what the end stands for, half of the piece, carries in the mean
(4/3) (1/2 − s)^1.5 / (1 − s)^.5 of what the other end does: with less than .47 of it, s > 0.

Friction beside nodes that something else keeps from slipping: it is known up to a cell. Where a
contact ends at a support, or at another contact, nodes of both cannot slip. Friction there is what
the support or the other contact takes, and no tangential balance tells it: the regularised law
gives none at a node at rest, and all there is at one that the give of a penalty lets slip. The
next node slips, or nearly, and carries all it can. What happens in between, a zone that sticks and
ends somewhere within the cell, no solution on this mesh sees; nor does any change of the load, as
all of it grows in proportion.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_FORCE,
    FRICTION_FORCE,
    FRICTION_WORK,
    MAX_SLIP,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    REACTION,
    REACTION_MOMENT,
    SLIP_AREA,
    STICK_AREA,
)
from fenics_contact.scene.quantity_names import Reaction
from fenics_contact.solve.systems.solution import Solution

_AREAS = (STICK_AREA, SLIP_AREA)
# Shares of a piece that may be open, and what its end then carries over its other end.
_OPEN = np.linspace(0.0, 0.5, 101)
_CARRIED = 4 / 3 * (0.5 - _OPEN) ** 1.5 / np.sqrt(1 - _OPEN)
# Powers with which friction may rise to its bound, and what an end then carries over the other one.
_POWERS = np.linspace(0.01, 0.5, 50)
_RISES = 2**_POWERS / (1 - _POWERS)


def unseen_zones(problem: Problem, solution: Solution) -> dict[Hashable, float]:
    """Return errors of quantities by slip and gaps that no point shows; collective.

    Returns:
        Of each contact by its number and the name, and of all by the name.
    """
    found = _unseen_slip(problem, solution)
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        area = _unseen_gap(contact, state)
        for name in (CONTACT_AREA, *_AREAS):
            for key in (name, (number, name)):
                found[key] = found.get(key, 0.0) + area
    return found


def _unseen_gap(contact: ContactSurface, state: ContactState) -> float:
    """Area of what may be open beside ends that touch; collective.

    None of foundations: their pressure is known where they end.
    """
    trace, pieces = contact.trace, contact.trace.pieces
    if not (contact.is_one_sided and contact.has_penalty):
        return 0.0
    closed = (state.status != OPEN)[pieces.points]
    pressures = np.where(closed, state.contact_pressure[pieces.points], 0.0)
    # An end has no neighbour that carries much less; beside an open one the edge is seen.
    lower = pressures.min(axis=1, initial=np.inf, keepdims=True) < _CARRIED[0] * pressures
    counts = np.zeros(len(trace.surface.coordinates))
    np.add.at(counts, pieces.nodes, lower | ~closed.all(axis=1, keepdims=True))
    ends = trace.surface.summed(counts)[pieces.nodes] == 0
    most = pressures.max(axis=1, initial=0.0, keepdims=True)
    carried = pressures / np.where(most > 0, most, 1.0)
    share = np.interp(-carried, -_CARRIED, _OPEN) * (ends & (most > 0))
    areas = np.array(
        [(pieces.measures * share.max(axis=1, initial=0.0)).sum(), pieces.measures.sum()]
    )
    gap, every = total(contact.spaces.comm, areas)
    return trace.area * float(gap / every)


def _unseen_slip(problem: Problem, solution: Solution) -> dict[Hashable, float]:
    """Return errors of areas, slips and friction works by unseen slip; collective.

    Returns:
        Of each contact by its number and the name, and of all by the name; nothing of contacts on
        which some points slip, of those that do not touch, and of those that rub nowhere.
    """
    found: dict[Hashable, float] = {}
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        for name, unknown in _of_contact(contact, state).items():
            found[number, name] = unknown
            before = found.get(name, 0.0)
            found[name] = max(before, unknown) if name == MAX_SLIP else before + unknown
    return found


def _of_contact(contact: ContactSurface, state: ContactState) -> dict[str, float]:
    if not contact.friction.has_friction:
        return {}
    comm, trace, pieces = contact.trace.spaces.comm, contact.trace, contact.trace.pieces
    if largest(comm, (state.status == SLIP).astype(float)) > 0:
        return {}
    closed = state.status != OPEN
    bounds = np.where(closed, contact.friction.bound_of(state.contact_pressure), 0.0)
    carried = contact.friction.rule.metric.carried(state.friction_traction)
    used = np.where(bounds > 0, carried / np.where(bounds > 0, bounds, 1.0), 0.0)
    share = _slipping_share(used[pieces.points], closed[pieces.points])
    sides = pieces.areas if contact.spaces.components == 2 else np.sqrt(2 * pieces.areas)
    bound = bounds[pieces.points].max(axis=1, initial=0.0)
    slip = 4 / np.pi * bound * share * sides / contact.moduli.plane_strain
    areas = share * pieces.measures
    sums = np.array([areas.sum(), (bound * slip * areas).sum() / 3, pieces.measures.sum()])
    area, work, every = total(comm, sums)
    once = trace.area / float(every)  # quadrilaterals are cut twice
    found = dict.fromkeys(_AREAS, once * float(area))
    return found | {MAX_SLIP: largest(comm, slip), FRICTION_WORK: once * float(work)}


def _slipping_share(used: Array, closed: Flags) -> Array:
    """Share of each piece of the surface that may slip at one of its ends, (pieces,).

    Args:
        used: Friction over its bound at the corners, (pieces, corners).
        closed: Which of these touch, (pieces, corners).
    """
    most = np.where(closed, used, 0.0).max(axis=1, initial=0.0)
    least = np.where(closed, used, np.inf).min(axis=1, initial=np.inf)
    # What one end alone carries, beside an edge of contact, may rise as steeply as can be.
    several = (closed.sum(axis=1) > 1) & (least > 0)
    rise = np.where(several, most / np.where(several, least, 1.0), _RISES[-1])
    return np.asarray(0.5 * np.minimum(most, 1.0) ** (1 / np.interp(rise, _RISES, _POWERS)))


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
            moments = [Reaction(of, REACTION_MOMENT) for of in (support, labels[support])]
            add(moments, unknown * problem.support_moments.reach(support))
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
