"""Slip and gaps that no point of the mesh shows.

Slip where all that touches sticks, as far as can be seen. Beside edges and corners the share u that
friction has of its bound g rises like a power x^-s of the distance, s = 1/2 at the most (K. L.
Johnson, Contact Mechanics, Cambridge 1985, section 2.8); where pressure and traction rise alike, as
below the corner of a block, it hardly rises. An end stands for half of a piece of the length b, so
that it carries 2^s/(1 - s) times what the other end does, which tells s. At its bound friction is
up to (b/2) ((1 - s) u)^(1/s), and slips up to 2.5 times that at the most (π²/4 for s = 1/2: D. S.
Dugdale, J. Mech. Phys. Solids 8 (1960) 100-104): less than c = (b/2) u^(1/s). There the surface
moves by 4 g c/(π E*) at the end, and a third of it in the mean. What each piece does so at its own
bound is summed up: of those inside, where the share is even, that is next to nothing.

A gap where the last point of a surface touches, but carries little beside its neighbour. Pressure
rises from the edge of what touches as the root of the distance (chapters 4 and 5). With the edge at
the share s of a piece from its end, what the end stands for, half of the piece, carries in the mean
(4/3) (1/2 − s)^1.5 / (1 − s)^.5 of what the other end does: with less than .47 of it, s > 0.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_WORK,
    MAX_SLIP,
    SLIP_AREA,
    STICK_AREA,
)
from fenics_contact.solve.newton.solution import Solution

_AREAS = (STICK_AREA, SLIP_AREA)
# Shares of a piece that may be open, and what its end then carries over its other end.
_OPEN = np.linspace(0.0, 0.5, 101)
_CARRIED = 4 / 3 * (0.5 - _OPEN) ** 1.5 / np.sqrt(1 - _OPEN)
# Powers with which friction may rise to its bound, and what an end then carries over the other one.
_POWERS = np.linspace(0.01, 0.5, 50)
_RISES = 2**_POWERS / (1 - _POWERS)


def unseen_zones(problem: Problem, solution: Solution) -> dict[Hashable, float]:
    """Return errors of quantities by slip and gaps that no point shows; collective.

    Args:
        problem: The model.
        solution: Its solution.

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

    Args:
        problem: The model.
        solution: Its solution.

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
