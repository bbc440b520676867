"""Effect of unresisted depths between points on an answer.

The last load step is solved again with gaps narrower by that depth at the points that touch beside
it: what stands opposite is pushed in as far as it would have to be, were the surface closed there.
The difference is what is not known. It tells, too, whether the depth governs an answer: a body that
bends gives way by much more under the contact's force than what the pressure closes near by.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.checks.comparison import Place, nearer_to_failing, worst_of
from fenics_contact.trust.error_estimates.solving_again import (
    Measure,
    Quantities,
    differences,
    last_step_again,
)
from fenics_contact.trust.resolution.unseen import LARGEST_UNSEEN, unseen

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


def unseen_depth_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by depths between points; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 without such contacts.
        None where the answer with narrower gaps was not found.
    """
    assert load_steps.last is not None
    solution = load_steps.last.solution
    answer = measure(solution)
    sunk = sunk_contacts(load_steps.problem, solution, _COUNTS)
    if not sunk:
        return dict.fromkeys(answer, 0.0)
    return differences(answer, _narrowed(load_steps, measure, sunk))


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
    known = [one for one in govern if one.is_beside and not problem.inertia.moves]
    measure = _forces_of(problem)
    other = _narrowed(load_steps, measure, known) if known else None
    if other is not None:
        answer = measure(solution)
        for one in known:
            before, after = (float(np.sum(row[one.number])) for row in (answer, other))
            change = abs(after - before)
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


def _narrowed(load_steps: LoadSteps, measure: Measure, sunk: list[Sunk]) -> Quantities | None:
    """Quantities with gaps narrower by the depth beside it; collective."""
    before = [one.contact.kinematics.gap for one in sunk]
    time = load_steps.time

    def narrow(problem: Problem) -> None:
        problem.set_time(time)
        for one, gap in zip(sunk, before, strict=True):
            one.contact.set_gap(gap - one.narrower)

    try:
        return last_step_again(load_steps, measure, narrow)
    finally:
        for one, gap in zip(sunk, before, strict=True):
            one.contact.set_gap(gap)
