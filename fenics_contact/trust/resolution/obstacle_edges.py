"""Errors by the place of an obstacle's edge, as no node beyond touches, wherever that is.

An answer is that of an obstacle which ends a share of a piece of the surface beyond the last node
before it. Measured on flat punches on a layer, plane and axisymmetric, that share is .25 (squares
of degree 1), .4 (triangles), of degree 2 .15 and .23 beyond a corner of cells, .42 and .49 beyond
the middle of a side, whatever the size of cells: .3, or less than .2 from it. The last load step
is solved again with an obstacle that ends a piece earlier, as if the last nodes before it were
beyond it. Of what that changes, the error is the share of the piece by which the obstacle ends
elsewhere than at .3 of it, and .15 more.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import CONTACT_AREA, CONTACT_RADIUS
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.solving_again import (
    Measure,
    Quantities,
    differences,
    last_step_again,
)

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
