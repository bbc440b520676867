"""Steps of displacements that supports prescribe by functions of the place.

A mesh does not tell a step from a steep rise; the function does, where it is asked between nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.parallel import gather_rows, largest
from fenics_contact.problem import Problem
from fenics_contact.supports import AppliedSupport

Array = NDArray[np.float64]
Step = tuple[int, tuple[float, ...], float]

# Of the largest value: what is less is no step.
_NONE = 1e-6
# Halvings of an edge on which a support's function is looked at. Over the last of them a step stays
# as it is, while what changes along a line, or like a root, falls to 1/1024, or to 1/32.
_HALVINGS, _LAST = 30, 10
_STEP = 0.5


def support_steps(problem: Problem, time: float) -> list[Step]:
    """Steps of the functions by which supports prescribe displacements; collective.

    Args:
        problem: The model.
        time: Pseudo-time.

    Returns:
        Of each: the number of its support, where it is, (3,), and how large (length).
    """
    found: list[Step] = []
    for number, support in enumerate(problem.scene.support):
        applied = problem.supports.applied[number]
        for value in support.displacement.values():
            if callable(value):
                found += _steps(problem, (number, applied), value, time)
    return found


def _steps(
    problem: Problem, whose: tuple[int, AppliedSupport], value: Any, time: float
) -> list[Step]:
    """Along edges between neighbouring nodes: what is halved again and again keeps a step."""
    number, applied = whose
    spaces, key = problem.spaces, f"support[{number}].displacement"
    group = spaces.body.group(applied.on, key)
    if group.dimension != spaces.body.dimension - 1:
        return []
    low, high = _edges(problem, spaces.facets(group))
    at = [spaces.evaluate_at(value, points.T, key) for points in (low, high)]
    least = _NONE * largest(problem.comm, np.abs(np.concatenate(at)))
    before = np.zeros(len(low))
    for halving in range(_HALVINGS):
        if halving == _HALVINGS - _LAST:
            before = np.abs(at[1] - at[0])
        middle = 0.5 * (low + high)
        between = spaces.evaluate_at(value, middle.T, key)
        first = np.abs(between - at[0]) > np.abs(at[1] - between)
        low, high = np.where(first[:, None], low, middle), np.where(first[:, None], middle, high)
        at = [np.where(first, at[0], between), np.where(first, between, at[1])]
    left = np.abs(at[1] - at[0])
    torn = (left > _STEP * before) & (left > least) & (applied.path(time) != 0)
    rows = np.column_stack([low, abs(applied.path(time)) * left])[torn]
    rows = gather_rows(problem.comm, rows)
    return [(number, tuple(row[:3].tolist()), float(row[3])) for row in rows]


def _edges(problem: Problem, facets: NDArray[np.int32]) -> tuple[Array, Array]:
    """Ends of the edges from the first node of each facet to its others, (edges, 3) each."""
    spaces = problem.spaces
    dofmap = spaces.displacement_space.dofmap
    low, high = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for cell, facet in facets:
        closure = dofmap.dof_layout.entity_closure_dofs(spaces.body.dimension - 1, int(facet))
        points = spaces.coordinates[dofmap.list[cell, closure]]
        low.append(np.repeat(points[:1], len(points) - 1, axis=0))
        high.append(points[1:])
    return np.concatenate(low), np.concatenate(high)
