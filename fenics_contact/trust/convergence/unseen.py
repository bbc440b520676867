"""Contact between the points of a mesh, which it does not see, and what its depth does.

Contact that a mesh does not see: what stands opposite sinks in between the points. Gaps are closed
at contact points. Between these the surface is that of the elements, and what stands opposite may
be deep in it. A pressure p on a piece of the length h from one point to the next pushes the
surface back by about p h/E*; under Hertz's pressure on a width of 2a, points h apart let the
obstacle sink in by h/(4a) of that. Where it sinks in by as much, the answer is that of other
surfaces.

Effect of unresisted depths between points on an answer. The last load step is solved again with
gaps narrower by that depth at the points that touch beside it: what stands opposite is pushed in
as far as it would have to be, were the surface closed there. The difference is what is not known.
It tells, too, whether the depth governs an answer: a body that bends gives way by much more under
the contact's force than what the pressure closes near by.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.comparison import Place, nearer_to_failing, worst_of
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Measure,
    Quantities,
)

# Depth between points, over itself and what pressure closes, at the most. Measured on obstacles of
# a tenth of a cell to ten cells: below, error bars hold what that does to forces, and from 0.8
# on forces and indentations are wrong by any factor. Under the edge of a punch it is up to 0.5.
LARGEST_UNSEEN = 0.6
# Of the largest pressure of all contacts: what a depth would carry alone does not govern the answer
# of a scene below. Rollers of a bearing that no load reaches touch with next to nothing.
_GOVERNS = 0.01
# Of the spacing of points: what round-off leaves of a depth.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class Unseen:
    """How deep a surface is between its points, on this rank.

    Attributes:
        shares: Depth between points, over itself and what pressure closes, (places,): 0 … 1.
        governing: The same, or the pressure that the depth would carry over itself and a hundredth
            of the largest pressure of all contacts where that is less, (places,): 0 … 1.
        places: (places, 3) (length).
        spacing: From one contact point to the next, (places,) (length).
        depth: Between points, less that at these, (places,) (length).
        nodes: Of the facet of each place, by the numbers of the surface, (places, nodes).
    """

    shares: Array
    governing: Array
    places: Array
    spacing: Array
    depth: Array
    nodes: AnyIntegers


def unseen(problem: Problem, solution: Solution, number: int, displacement: Array) -> Unseen:
    """How deep the surface of a contact that can only push is between its points; collective.

    Args:
        problem: The model.
        solution: Its solution.
        number: Of the contact.
        displacement: At the body's nodes of this rank, (nodes, components) (length).
    """
    contact, state = problem.contacts[number], solution.states[number]
    trace, kinematics = contact.trace, contact.kinematics
    between = kinematics.between_points(displacement)
    at_nodes = np.maximum(-state.gap[: len(contact.nodes)], 0.0)
    nodes = kinematics.facets.nodes[between.facets]
    sunk = trace.at_all_nodes(at_nodes)[nodes]
    at_points = sunk.max(axis=1, initial=0.0)
    depth = np.maximum(between.depth - at_points - _ROUND_OFF * between.spacing, 0.0)
    peaks = [largest(problem.comm, one.contact_pressure) for one in solution.states]
    gives_way = between.spacing / contact.moduli.plane_strain
    shares = _shares(depth, peaks[number] * gives_way + at_points)
    governing = np.minimum(shares, _shares(depth, _GOVERNS * max(peaks) * gives_way))
    return Unseen(shares, governing, between.places, between.spacing, depth, nodes)


def _shares(depth: Array, closes: Array) -> Array:
    """Depths over themselves and what closes, (places,)."""
    return np.divide(depth, depth + closes, out=np.zeros_like(depth), where=depth > 0)


def unseen_contact(forces: InternalForces) -> Check | None:
    """Return the check of depths between points, over themselves and the closed gap; collective."""
    worst: Check | None = None
    for number, contact in enumerate(forces.problem.contacts):
        if not contact.is_one_sided:
            continue
        found = unseen(forces.problem, forces.solution, number, forces.displacement)
        if largest(forces.problem.comm, np.ones(len(found.shares))) == 0:
            continue
        value, place = worst_of(forces.problem.comm, found.governing, found.places)
        check = Check(value, LARGEST_UNSEEN, contact.label, place)
        worst = nearer_to_failing(worst, check)
    return worst


# Of what closes there, from which the depth is more than what other parts of bars hold: under a
# Hertzian pressure it is this share where points are about 1.7 half-widths of the contact apart.
_COUNTS = 0.3


@dataclass(frozen=True, eq=False)
class Sunk:
    """A contact in which what stands opposite sinks in between points.

    Attributes:
        number: Of the contact, in scene order.
        contact: The contact.
        place: Where the depth is the largest share of itself and what closes (length).
        governing: How far that governs the answer of the scene, the largest, as of ``Unseen``.
        depth: The largest between points that touch (length).
        narrower: By how much gaps are to be narrower, at the points of this rank (length).
        is_beside: Whether a point touches beside every place.
        moved: How far the surface or what stands opposite moves along its normal where it touches,
            the largest (length).
    """

    number: int
    contact: ContactSurface
    place: Place
    governing: float
    depth: float
    narrower: Array
    is_beside: bool
    moved: float


def sunk_contacts(problem: Problem, solution: Solution, share: float) -> list[Sunk]:
    """Contacts with a place at which the depth is more than a share; collective.

    Args:
        problem: The model.
        solution: Its solution.
        share: As of ``Unseen.shares``.
    """
    found = [_sunk(problem, solution, number, share) for number in range(len(problem.contacts))]
    return [one for one in found if one is not None]


def _sunk(problem: Problem, solution: Solution, number: int, share: float) -> Sunk | None:
    contact, state, comm = problem.contacts[number], solution.states[number], problem.comm
    if not contact.is_one_sided:
        return None
    trace, kinematics = contact.trace, contact.kinematics
    between = unseen(problem, solution, number, solution.displacement)
    far = between.shares > share
    if total(comm, int(far.sum())) == 0:
        return None
    closed = state.status != OPEN
    at_nodes = trace.surface.of_owners(trace.at_all_nodes(closed[: len(trace.nodes)].astype(float)))
    touched = (at_nodes[between.nodes] > 0).any(axis=1)
    beside = np.zeros(len(trace.all_nodes))
    beside[between.nodes[far & touched]] = 1.0
    beside = np.minimum(trace.surface.summed(beside), 1.0)
    depth = largest(comm, between.depth[far & touched])
    own = solution.displacement[trace.all_nodes]
    opposite = kinematics.relative(solution.displacement) - own
    ways = [trace.at_points(one) for one in (own, opposite)]
    moved = [np.abs(kinematics.normal(way))[closed] for way in ways]
    return Sunk(
        number,
        contact,
        worst_of(comm, between.shares, between.places)[1],
        largest(comm, between.governing),
        depth,
        np.where(closed, depth * np.clip(trace.at_points(beside), 0.0, 1.0), 0.0),
        total(comm, int((far & ~touched).sum())) == 0,
        max(largest(comm, one) for one in moved),
    )


def unseen_depth_errors(load_steps: LoadSteps, again: Again) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by depths between points; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: How the answer to the last one is found with something changed.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 without such contacts.
        None where the answer with narrower gaps was not found.
    """
    assert load_steps.last is not None
    sunk = sunk_contacts(load_steps.problem, load_steps.last.solution, _COUNTS)
    if not sunk:
        return dict.fromkeys(again.answer, 0.0)
    return _narrowed(load_steps, again, sunk)


def governed_by_depth(load_steps: LoadSteps) -> dict[int, Check]:
    """How far depths between points govern answers, of contacts that these fail the check of.

    Of a contact whose force the change moves by ΔF that is ΔF/(F + ΔF); of one whose force loads
    give, the depth over itself and how far the surface moves. The larger of both counts, and 1
    where something sinks in beside no point that touches, or where no answer was found. Where the
    depth would carry next to nothing of what other contacts do, it is that share; collective.

    Args:
        load_steps: At their end; all is there again afterwards.

    Returns:
        By the contact's number.
    """
    if load_steps.last is None:
        return {}
    problem, solution = load_steps.problem, load_steps.last.solution
    sunk = sunk_contacts(problem, solution, LARGEST_UNSEEN)
    shares = {one.number: one.governing for one in sunk}
    govern = [one for one in sunk if one.governing > LARGEST_UNSEEN]
    shares.update({one.number: 1.0 for one in govern})
    moves = problem.inertia.moves or not problem.elastic.is_linear  # neither solves it again
    known = [one for one in govern if one.is_beside and not moves]
    again = Again.of_last_step(load_steps, _forces_of(problem))
    changes = _narrowed(load_steps, again, known) if known else None
    if changes is not None:
        for one in known:
            before, change = float(np.sum(again.answer[one.number])), changes[one.number]
            of_force = change / (before + change) if change > 0 else 0.0
            shares[one.number] = max(of_force, one.depth / (one.depth + one.moved))
    return {
        one.number: Check(shares[one.number], LARGEST_UNSEEN, one.contact.label, one.place)
        for one in sunk
    }


def judged_by_depth(load_steps: LoadSteps, checks: Mapping[str, Check]) -> dict[str, Check]:
    """Checks, that of depths between points by how far these govern the answer; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        checks: By name, with that one by what the pressure closes near by.

    Returns:
        By name; the same where it passes as it is.
    """
    check = checks.get("unseen_contact")
    if check is None or check.passed or check.unmade:
        return {**checks}
    worst: Check | None = None
    for found in governed_by_depth(load_steps).values():
        worst = nearer_to_failing(worst, found)
    return {**checks} if worst is None else {**checks, "unseen_contact": worst}


def _forces_of(problem: Problem) -> Measure:
    """Integrals of pressures, by the contact's number (force); collective."""

    def measure(solution: Solution) -> Quantities:
        pairs = enumerate(zip(problem.contacts, solution.states, strict=True))
        return {k: float(one.trace.integral(state.contact_pressure)) for k, (one, state) in pairs}

    return measure


def _narrowed(
    load_steps: LoadSteps, again: Again, sunk: list[Sunk]
) -> dict[Hashable, float] | None:
    """Changes of quantities if gaps are narrower by the depth between points; collective."""
    before = [one.contact.kinematics.gap for one in sunk]
    time = load_steps.time

    def narrow(share: float, problem: Problem) -> None:
        problem.set_time(time)
        for one, gap in zip(sunk, before, strict=True):
            one.contact.set_gap(gap - share * one.narrower)

    try:
        return again.effects(narrow)
    finally:
        for one, gap in zip(sunk, before, strict=True):
            one.contact.set_gap(gap)
