"""Errors of the mesh at single points, at jumps of displacements, and at edges of obstacles.

Errors of contacts that touch in single points: no piece of the surface between nodes is whole. How
large such a contact is no mesh as coarse can tell, nor how far what touches gives way there: on
this mesh as if the pressure were that of the point's whole share of the surface. Under a pressure
p on a circle of area A a half-space gives way by .96 p √A/E* in the mean (K. L. Johnson, Contact
Mechanics, Cambridge 1985, (3.29)), and beside a strip of width b by about p b/E*. The last load
step is solved again with gaps wider by that: the difference is what is not known.

Errors of what does converge where prescribed displacements jump: that is of first order. Where an
obstacle ends at a support and asks a node of both for another displacement than the support does,
the node follows the support. So what should be a jump there rises along the first cell of the
contact: it is known to a cell where it lies. The last load step is solved again with that node at
the obstacle, so that the rise is along the support's first cell instead. Of two supports, the node
follows the other one; beside a step of a support's function, what it is past it.

Errors by the place of an obstacle's edge, as no node beyond touches, wherever that is. An answer
is that of an obstacle which ends a share of a piece of the surface beyond the last node before it.
Measured on flat punches on a layer, plane and axisymmetric, that share is .25 (squares of degree
1), .4 (triangles), of degree 2 .15 and .23 beyond a corner of cells, .42 and .49 beyond the middle
of a side, whatever the size of cells: .3, or less than .2 from it. The last load step is solved
again with an obstacle that ends a piece earlier, as if the last nodes before it were beyond it. Of
what that changes, the error is the share of the piece by which the obstacle ends elsewhere than at
.3 of it, and .15 more.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import CONTACT_AREA, CONTACT_RADIUS
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.convergence.support_steps import past_steps
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Measure,
    Quantities,
    differences,
    last_step_again,
)


def single_point_errors(load_steps: LoadSteps, again: Again) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by such contacts; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: How the answer to the last one is found with something changed.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 without such contacts.
        None where the answer with wider gaps was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    pairs = zip(problem.contacts, solution.states, strict=True)
    gives = [(contact, _local_depth(contact, state)) for contact, state in pairs]
    before = [(contact, contact.kinematics.gap, depth) for contact, depth in gives if depth > 0]
    if not before:
        return dict.fromkeys(again.answer, 0.0)
    time = load_steps.time

    def widen(share: float, problem: Problem) -> None:
        problem.set_time(time)
        for contact, gap, depth in before:
            contact.set_gap(gap + share * depth)

    try:
        return again.effects(widen)
    finally:
        for contact, gap, _ in before:
            contact.set_gap(gap)


def touches_in_points(contact: ContactSurface, state: ContactState) -> bool:
    """Whether it may open and no piece of it touches with all its ends; collective."""
    if not contact.is_one_sided:
        return False
    whole = (state.status != OPEN)[contact.trace.pieces.points].all(axis=1)
    return largest(contact.spaces.comm, whole.astype(float)) == 0


def _local_depth(contact: ContactSurface, state: ContactState) -> float:
    """How far the surface gives way at single points that touch, the largest; collective.

    0 where a piece touches with all its ends, where nothing does, and where gaps cannot open.
    """
    if not touches_in_points(contact, state):
        return 0.0
    trace, spaces = contact.trace, contact.spaces
    closed = state.status != OPEN
    widths = np.sqrt(trace.weights)
    if spaces.components == 2:  # a strip as long as the body is thick; a ring of some width
        lengths = np.abs(trace.surface.factors[trace.numbers])
        if spaces.kinematics == "axisymmetric":  # on the axis a circle
            lengths = np.maximum(lengths, widths)
        widths = trace.weights / lengths
    depths = np.where(closed, state.contact_pressure * widths, 0.0)
    return largest(spaces.comm, depths) / contact.moduli.plane_strain


# Over the largest displacement: what is less is no jump.
_NONE = 1e-6
# For what is not the leading order.
_SAFETY = 1.25


def torn_errors(load_steps: LoadSteps, again: Again) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by jumps; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: As of ``single_point_errors``.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        those nodes moved was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    missed = _missed(problem, solution.displacement, load_steps.time)
    scale = largest(problem.comm, np.abs(solution.displacement).ravel())
    if largest(problem.comm, np.abs(missed).ravel()) <= _NONE * scale:
        return dict.fromkeys(again.answer, 0.0)

    def follow_others(share: float, problem: Problem) -> None:
        problem.prescribed = problem.prescribed + share * missed.reshape(-1)[problem.constrained]

    return again.effects(follow_others, factor=_SAFETY)


def _missed(problem: Problem, displacement: Array, time: float) -> Array:
    """Return how far held nodes are from where others want them (length); collective."""
    missed = np.zeros_like(displacement)
    for contact in problem.contacts:
        if contact.has_penalty and not contact.kinematics.faces_body:
            missed += _to_obstacle(contact, displacement)
    missed[problem.free] = 0.0
    flat, present = missed.reshape(-1), displacement.reshape(-1)
    for support in problem.supports.applied:
        if support.follows:
            continue
        away = support.values * support.path(time) - present[support.dofs]
        flat[support.dofs] = np.where(away != 0, away, flat[support.dofs])
    return missed + past_steps(problem, time)


def _to_obstacle(contact: ContactSurface, displacement: Array) -> Array:
    """From where nodes are to where an obstacle lets them be, at the body's nodes; collective."""
    kinematics, nodes, trace = contact.kinematics, contact.nodes, contact.trace
    away = kinematics.motion_at_points[: len(nodes)] - displacement[nodes]
    gap = kinematics.whole_gap()[: len(nodes)]
    away[~np.isfinite(gap)] = 0.0
    if contact.is_one_sided:
        normals = trace.normals[: len(nodes)]
        entered = -np.where(np.isfinite(gap), gap, 0.0) - np.einsum("ni,ni->n", normals, away)
        away = -np.maximum(entered, 0.0)[:, None] * normals
    whole = np.zeros((len(trace.all_nodes), trace.normals.shape[1]))
    whole[trace.numbers] = away
    return trace.surface.on_body(whole)


# Of a piece, where the obstacle of an answer ends, and what is not known of that.
_ENDS, _UNKNOWN = 0.3, 0.15
# The edge itself is where the scene says.
_KNOWN = (CONTACT_AREA, CONTACT_RADIUS)


def obstacle_edge_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by edges of obstacles; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; 0 where no obstacle ends
        inside what touches. None where an answer with a shorter one was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    answer = measure(solution)
    found = dict.fromkeys(answer, 0.0)
    for contact, state in zip(problem.contacts, solution.states, strict=True):
        beyond, share = _last_points(contact, state)
        if share > 0:
            other = _shortened(load_steps, measure, contact, beyond)
            change = differences(answer, other)
            if change is None:
                return None
            for key in found.keys() & change.keys():
                name = key[1] if isinstance(key, tuple) else key
                found[key] += 0.0 if name in _KNOWN else share * change[key]
    return found


def _last_points(contact: ContactSurface, state: ContactState) -> tuple[Array, float]:
    """Points that touch next to an obstacle's edge, and the share of a piece in doubt; collective.

    The second is 0 where there are none, and where nothing else touches.
    """
    none = np.zeros(len(state.status), dtype=bool)
    kinematics, pieces = contact.kinematics, contact.trace.pieces
    if not contact.is_one_sided or kinematics.faces_body:
        return none, 0.0
    closed, reached = state.status != OPEN, kinematics.reached
    corners = pieces.points.shape[1]
    pairs = [pieces.points[:, [a, b]] for a in range(corners) for b in range(corners) if a != b]
    inner, outer = np.concatenate(pairs).T
    cut = closed[inner] & ~reached[outer]
    inner, outer = inner[cut], outer[cut]
    ends = kinematics.end_of_obstacle(inner, outer)
    inner, ends = inner[ends < 1], ends[ends < 1]
    last = none.copy()
    last[inner] = True
    sums = [(np.abs(ends - _ENDS) + _UNKNOWN).sum(), len(ends), (closed & ~last).sum()]
    shares, count, others = total(contact.spaces.comm, np.array(sums, dtype=float))
    return last, float(shares / count) if count > 0 and others > 0 else 0.0


def _shortened(
    load_steps: LoadSteps, measure: Measure, contact: ContactSurface, beyond: Array
) -> Quantities | None:
    """Quantities where no obstacle stands before some points; None without an answer."""
    before, time = contact.kinematics.gap, load_steps.time

    def shorten(problem: Problem) -> None:
        problem.set_time(time)
        contact.set_gap(np.where(beyond, np.inf, before))

    try:
        return last_step_again(load_steps, measure, shorten)
    finally:
        contact.set_gap(before)
