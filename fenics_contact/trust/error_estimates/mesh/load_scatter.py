"""How quantities scatter about smooth functions, as edges move through elements.

Functions of the load where the load moves the edges, else of what does (``edge_shift``). Where a
gap closes, or all that touches begins to slip, an edge comes up or leaves the surface: quantities
then have a kink on any mesh, which says nothing of this one. So loads count from the last of these.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence
from itertools import takewhile

import numpy as np

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.contact_areas import Zones, contact_area, cut_areas, stick_area
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import CONTACT_AREA, STICK_AREA
from fenics_contact.scene.loading.load_paths import knots
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.mesh.edge_shift import (
    Edge,
    edges_inside,
    shifted_answers,
    standing,
)
from fenics_contact.trust.error_estimates.solving_again import (
    AlongLine,
    Change,
    Measure,
    Quantities,
    last_step_again,
)

# Share of the way since the loads last turned that is looked at: Hertz's edge then moves by a tenth
# of its radius.
_SPAN = 0.3
_LOADS = 8
# Pieces of the surface that an edge is to pass through in that span, at the most: where cells are
# small at the edge alone, those further off have no part in the error.
_PIECES = 8.0
# And that it is to pass through at the least: the polynomial leaves a third of a wave as long as a
# piece where one of them is passed, and all of it where two are. Not of more than this share of the
# way, over which t^1.5 itself is 3e-4 beside the polynomial.
_WAVES, _FAR = 2.0, 0.75
# Where that is too short: of degree 2 nodes at the ends of facets and in their middle differ, so
# that waves are as long as facets. Of few that are seen so much is left; no less counts, as it
# tells too little.
_SEEN, _LEFT, _LEAST = (0.75, 1.0, 1.25, 1.5), (0.13, 0.34, 0.64, 1.0), 0.45
# Of the polynomial in pseudo-time: t^1.5, Hertz's force, differs by 1e-6 from one over the span.
_DEGREE = 3
# Answers at the least: two more than the polynomial has coefficients.
_ENOUGH = _DEGREE + 1 + 2
# Of the last load step, at the most.
_OF_A_STEP = 0.95
# How often a span is made shorter, at the most, to begin behind a kink; of an area, next to none.
_SHORTER, _NONE = 3, 1e-9


def load_scatter(
    load_steps: LoadSteps, measure: Measure, recorded: Sequence[tuple[float, Quantities]]
) -> dict[Hashable, float] | None:
    """Standard deviation of quantities about polynomials; collective.

    In pseudo-time, of load steps where these are close enough, else of loads within the last one.
    In the size of a shift where edges stand still, or almost; the larger where there are both.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.
        recorded: Pseudo-time and quantities of every load step.

    Returns:
        By key, of vectors the length over their components, without what some loads do not have;
        0 where no edge can move. None where too few of the solves converge.
    """
    problem = load_steps.problem
    last, answer = recorded[-1]
    if not any(
        contact.is_one_sided or contact.friction.has_friction for contact in problem.contacts
    ):
        return dict.fromkeys(answer, 0.0)
    assert load_steps.last is not None
    edges = edges_inside(problem, load_steps.last.solution)
    if not edges:
        return dict.fromkeys(answer, 0.0)
    pairs = zip(problem.contacts, load_steps.last.solution.states, strict=True)
    piece = piece_share(pairs)
    spans = _spans(load_steps, piece, [time for time, _ in recorded])
    looked_at = [(span, _over(span, load_steps, measure, recorded, edges)) for span in spans]
    still, far_still = (
        standing(edges, [found for _, found in rows]) for _, rows in (looked_at[0], looked_at[-1])
    )
    found = []
    # Of pieces that are large beside the contact the near span moves no edge by half of one.
    if not still or len(far_still) < len(edges):
        enough = [(span, rows) for span, rows in looked_at if len(rows) >= _ENOUGH]
        if not enough and len(still) < len(edges):
            return None
        found += [_about_polynomials(rows, (last, span)) for span, rows in enough]
        if found and enough[-1][0] == spans[-1] and _WAVES * piece > _FAR:
            left = _left_of_waves(problem, edges, enough[-1][1])
            found[-1] = {key: error / left for key, error in found[-1].items()}
    if still:
        shifted = shifted_answers(load_steps, measure, still)
        if shifted and len(shifted) < _ENOUGH:
            return None
        found.append(
            _about_polynomials(shifted, (0.0, 1.0)) if shifted else dict.fromkeys(answer, 0.0)
        )
    return {key: max(of[key] for of in found) for key in answer if all(key in of for of in found)}


def _spans(load_steps: LoadSteps, piece: float, times: Sequence[float]) -> list[float]:
    """Spans of pseudo-time before the end that are looked at, each by itself.

    One is near. In the other, longer one edges pass whole pieces; those of smaller pieces scatter
    less there, under smaller loads, so that it cannot stand for the near one.

    Args:
        load_steps: At their end.
        piece: What an edge's passing of a piece changes of the area; 0 without edges.
        times: Pseudo-times of the load steps.
    """
    assert load_steps.last is not None
    last = times[-1]
    turn = max((knot for knot in knots(load_steps.problem.scene) if knot < last), default=0.0)
    before = load_steps.last.before.time if load_steps.last.before else 0.0
    near, far = min(_SPAN, _PIECES * (piece or 1.0)), min(_FAR, _WAVES * piece)
    spans = [share * (last - max(turn, 0.0)) for share in (near, max(near, far))]
    return sorted(
        {
            span
            if sum(time >= last - span for time in times) >= _ENOUGH
            else min(span, _OF_A_STEP * (last - before))
            for span in spans
        }
    )


def _over(
    span: float,
    load_steps: LoadSteps,
    measure: Measure,
    recorded: Sequence[tuple[float, Quantities]],
    edges: Sequence[Edge],
) -> list[tuple[float, Quantities]]:
    """Pseudo-times and quantities in a span, of load steps if these are many there; collective.

    Behind the last kink in it, if enough can be found there.
    """
    assert load_steps.last is not None
    last = recorded[-1][0]
    rows = [(time, found) for time, found in recorded if time >= last - span]
    rows = _behind_kinks(load_steps.problem, rows)
    if len(rows) >= _ENOUGH:
        return rows
    answer = measure(load_steps.last.solution)  # of works, not summed over steps
    every = rows = [(last, answer), *_solved(load_steps, measure, last - span, edges)]
    for _ in range(_SHORTER):
        kept = _behind_kinks(load_steps.problem, rows)
        if len(kept) == len(rows) or len(kept) >= _ENOUGH:
            return kept
        span = last - min(time for time, _ in kept) or span / _LOADS
        rows = [(last, answer), *_solved(load_steps, measure, last - span, edges)]
    return every


def _behind_kinks(
    problem: Problem, rows: Sequence[tuple[float, Quantities]]
) -> list[tuple[float, Quantities]]:
    """Return times and quantities, back from the last to the first with all its edges."""
    ordered = sorted(rows, key=lambda row: -row[0])
    wanted = _zones(problem, ordered[0][1])
    return list(takewhile(lambda row: _zones(problem, row[1]) == wanted, ordered))


def _zones(problem: Problem, found: Quantities) -> list[bool]:
    """Return for each contact whether it touches, touches all over, and sticks somewhere."""
    flags = []
    for number, contact in enumerate(problem.contacts):
        touches, sticks = (
            float(np.linalg.norm(found.get((number, name), 0.0)))
            for name in (CONTACT_AREA, STICK_AREA)
        )
        whole, least = contact.trace.area, _NONE * contact.trace.area
        flags += [touches > least, touches >= whole - least, sticks > least]
    return flags


def _solved(
    load_steps: LoadSteps, measure: Measure, first: float, edges: Sequence[Edge]
) -> list[tuple[float, Quantities]]:
    """Quantities at pseudo-times from the first to the last, as many as converge; collective.

    At the first alone where that moves no edge: all others would tell as little.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    found: list[tuple[float, Quantities]] = []
    line = AlongLine(load_steps)
    for share in np.arange(_LOADS, 0, -1) / _LOADS:
        time = load_steps.time + share * (first - load_steps.time)
        quantities = last_step_again(load_steps, measure, _at(time), line.at(share), True)
        if quantities is not None:
            found.append((time, quantities))
        if len(found) == 1 and edges and standing(edges, [answer, found[0][1]]) == list(edges):
            break
    return found


def _about_polynomials(
    rows: Sequence[tuple[float, Quantities]], scale: tuple[float, float]
) -> dict[Hashable, float]:
    last, span = scale
    times = (np.array([time for time, _ in rows]) - last) / span
    powers = np.vander(times, _DEGREE + 1)
    smooth = powers @ np.linalg.pinv(powers)
    scatter = {}
    for key in rows[0][1]:
        if not all(key in found for _, found in rows):
            continue
        values = np.array([np.atleast_1d(found[key]) for _, found in rows])
        left = values - smooth @ values
        scatter[key] = float(np.sqrt((left**2).sum() / (len(rows) - _DEGREE - 1)))
    return scatter


def _left_of_waves(
    problem: Problem, edges: Sequence[Edge], rows: Sequence[tuple[float, Quantities]]
) -> float:
    """Share of the waves that facets make which a polynomial does not follow, .45 at the least.

    Args:
        problem: The model.
        edges: That pass through facets.
        rows: Pseudo-times and quantities, those of the end first.
    """
    passed = max(edge.moved(rows[0][1], found) for edge in edges for _, found in rows)
    return max(_LEAST, float(np.interp(passed / problem.spaces.degree, _SEEN, _LEFT)))


def piece_share(pairs: Iterable[tuple[ContactSurface, ContactState]]) -> float:
    """Return the share of the contact or stick area that changes as an edge passes a piece.

    The larger of both, of all contacts; 0 without edges.

    Args:
        pairs: Contacts and what happens at them.
    """
    shares = [0.0]
    for contact, state in pairs:
        zones = Zones(contact, state)
        whole = (contact_area(zones), stick_area(zones))
        for area, cut in zip(whole, cut_areas(contact, state), strict=True):
            shares.append(cut / area if area > 0 else 0.0)
    return max(shares)


def _at(time: float) -> Change:
    def change(problem: Problem) -> None:
        problem.set_time(time)

    return change
