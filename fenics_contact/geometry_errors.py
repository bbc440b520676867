"""Errors by the cells' geometry: what straight or quadratic facets miss of curved surfaces.

Pressures of surfaces that nearly conform follow from small differences of large gaps. The last load
step is solved again with gaps as they are between surfaces that pass smoothly through the mesh's
nodes (``smooth_surface``): the difference is the error, but for parts of higher order.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.load_steps import History
from fenics_contact.parallel import largest
from fenics_contact.problem import Problem
from fenics_contact.solving_again import Measure, differences, last_step_again

# Of the extent of a contact: what is missed is round-off of the nodes.
_NONE = 1e-12


def geometry_errors(history: History, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by gaps; collective.

    Args:
        history: At its end; it is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        other gaps was not found.
    """
    assert history.last is not None
    problem, answer = history.problem, measure(history.last.solution)
    one_sided = [contact for contact in problem.contacts if contact.is_one_sided]
    missed = [contact.kinematics.missed() for contact in one_sided]
    sizes = [
        largest(problem.comm, np.abs(one)) / contact.trace.extent()
        for one, contact in zip(missed, one_sided, strict=True)
    ]
    if max(sizes, default=0.0) <= _NONE:
        return dict.fromkeys(answer, 0.0)
    before = [contact.kinematics.gap for contact in one_sided]

    def narrow(problem: Problem) -> None:
        for contact, gap, one in zip(one_sided, before, missed, strict=True):
            assert contact.normal is not None
            contact.kinematics.gap = gap - one
            contact.normal.set_gap(contact.kinematics.gap)

    try:
        return differences(answer, last_step_again(history, measure, narrow))
    finally:
        for contact, gap in zip(one_sided, before, strict=True):
            assert contact.normal is not None
            contact.kinematics.gap = gap
            contact.normal.set_gap(gap)
