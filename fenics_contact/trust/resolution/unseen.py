"""Contact that a mesh does not see: what stands opposite sinks in between the points.

Gaps are closed at contact points. Between these the surface is that of the elements, and what
stands opposite may be deep in it. A pressure p on a piece of the length h from one point to the
next pushes the surface back by about p h/E*; under Hertz's pressure on a width of 2a, points h
apart let the obstacle sink in by h/(4a) of that. Where it sinks in by as much, the answer is
that of other surfaces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.parallel import largest
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.checks.comparison import nearer_to_failing, worst_of

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
