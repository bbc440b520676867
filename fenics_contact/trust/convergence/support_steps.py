"""Steps of displacements that supports prescribe by functions of the place.

A mesh does not tell a step from a steep rise; the function does, where it is asked between nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fenics_contact.body.supports import AppliedSupport
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import AXES, Value

Step = tuple[int, tuple[float, ...], float]

# Of the largest value: what is less is no step.
_NONE = 1e-6
# Halvings of an edge on which a support's function is looked at. Over the last of them a step stays
# as it is, while what changes along a line, or like a root, falls to 1/1024, or to 1/32.
_HALVINGS, _LAST = 30, 10
_STEP = 0.5


@dataclass(frozen=True)
class _Torn:
    """Edges between neighbouring nodes along which a support's function steps, on this rank.

    Attributes:
        places: Of the steps, (edges, 3).
        sizes: By how much, (edges,) (length).
        nodes: The end of each that is nearer to its step.
        to_other_end: What the function is more at the other one, (edges,) (length).
    """

    places: Array
    sizes: Array
    nodes: NDArray[np.int32]
    to_other_end: Array


def support_steps(problem: Problem, time: float) -> list[Step]:
    """Steps of the functions by which supports prescribe displacements; collective.

    Returns:
        Of each: the number of its support, where it is, (3,), and how large (length).
    """
    found: list[Step] = []
    for number, _, torn in _all(problem, time):
        rows = gather_rows(problem.comm, np.column_stack([torn.places, torn.sizes]))
        found += [(number, tuple(row[:3].tolist()), float(row[3])) for row in rows]
    return found


def past_steps(problem: Problem, time: float) -> Array:
    """From what supports prescribe beside steps to what they do past these; collective.

    So that what rises along a cell instead of a step rises along the next one.

    Returns:
        At the body's nodes, 0 where there is no step, (nodes, components) (length).
    """
    whole = np.zeros_like(problem.load)
    for _, axis, torn in _all(problem, time):
        rows = np.zeros((len(whole), 2))
        np.add.at(rows, torn.nodes, np.column_stack([torn.to_other_end, np.ones(len(torn.nodes))]))
        sums, counts = problem.spaces.summed(rows).T
        whole[:, axis] += sums / np.maximum(counts, 1.0)
    return whole


def _all(problem: Problem, time: float) -> list[tuple[int, int, _Torn]]:
    """Support, axis and edges of all functions on sides of the body."""
    found = []
    for number, support in enumerate(problem.scene.support):
        applied = problem.supports.applied[number]
        group = problem.body.group(applied.on, f"support[{number}].on")
        if support.is_elastic or group.dimension != problem.body.dimension - 1:
            continue
        for axis, value in support.displacement.items():
            if callable(value):
                torn = _torn(problem, (number, applied), value, time)
                found.append((number, AXES.index(axis), torn))
    return found


def _torn(problem: Problem, whose: tuple[int, AppliedSupport], value: Value, time: float) -> _Torn:
    """Along edges between neighbouring nodes: what is halved again and again keeps a step."""
    number, applied = whose
    spaces, key = problem.spaces, f"support[{number}].displacement"
    nodes = _edges(problem, spaces.facets(spaces.body.group(applied.on, key)))
    ends = spaces.coordinates[nodes.T]
    low, high = ends
    at = [spaces.evaluate_at(value, points.T, key) for points in (low, high)]
    rise = at[1] - at[0]
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
    factor = applied.path(time)
    torn = (left > _STEP * before) & (left > least) & (factor != 0)
    at_low = (np.diff(np.linalg.norm(ends - low, axis=2), axis=0)[0] > 0)[torn]
    return _Torn(
        low[torn],
        (abs(factor) * left)[torn],
        np.where(at_low, nodes[torn, 0], nodes[torn, 1]),
        factor * np.where(at_low, rise[torn], -rise[torn]),
    )


def _edges(problem: Problem, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Nodes of the edges from the first node of each facet to its others, (edges, 2)."""
    spaces = problem.spaces
    dofmap = spaces.displacement_space.dofmap
    found = [np.zeros((0, 2), dtype=np.int32)]
    for cell, facet in facets:
        closure = dofmap.dof_layout.entity_closure_dofs(spaces.body.dimension - 1, int(facet))
        nodes = dofmap.list[cell, closure]
        found.append(np.column_stack([np.repeat(nodes[:1], len(nodes) - 1), nodes[1:]]))
    return np.concatenate(found)
