"""Moves edges of contact and of stick that stay where they are as the load changes.

Where nothing but loads acts, and no gap is there from the start, the whole answer is proportional
to the load, and its edges do not move (J. Dundurs, M. Stippes, J. Appl. Mech. 37 (1970) 965-970).
The load then says nothing of what the place of an edge in its cell does to the answer. Here other
changes move them: a small traction along the normals of the contact, which grows with the distance
from its middle, moves the edge of contact; another friction coefficient moves that of stick. Both
change the exact answer smoothly.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import ufl

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.evaluate.contact_areas import Zones, contact_area, cut_areas, stick_area
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import CONTACT_AREA, STICK_AREA
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import (
    Change,
    Measure,
    Quantities,
    last_step_again,
)

# The size that is tried first: of the traction over the mean pressure, of the change of the
# friction coefficient over itself.
_FIRST = 0.02
# Largest sizes, over the first: half of the mean pressure, a fifth of the coefficient.
_MOST_TRACTION, _MOST_STRENGTH = 25.0, 10.0
# Pieces of the surface that an edge passes through, to either side, and sizes on either side.
_PIECES = 1.0
_SIZES = 4
# Of that, what an edge may move by to one side, as it moves less to the other one; and how often a
# size is tried anew until it does not.
_FAR, _TRIES = 3.0, 4
# Of a piece: an edge that the loads move by less is taken to stand still; one that the first size
# moves by less cannot move, as that of a punch.
_STILL, _FIXED = 0.5, 1e-3


@dataclass(frozen=True)
class Edge:
    """The edge of what touches, or of what sticks, of a contact.

    Attributes:
        contact: Its number.
        area: The quantity that tells where it is.
        cut: Area of the pieces of the surface that it passes through (area).
    """

    contact: int
    area: str
    cut: float

    def moved(self, one: Quantities, other: Quantities) -> float:
        """Return by how many pieces the edge moves between two answers."""
        key: Hashable = (self.contact, self.area)
        return abs(float(np.subtract(one[key], other[key]))) / self.cut


@dataclass(frozen=True)
class _Shift:
    """Change that moves edges: nodal forces, (nodes, components), and change of the coefficient."""

    forces: Array
    strength: float

    def times(self, size: float) -> _Shift:
        return _Shift(size * self.forces, size * self.strength)

    def plus(self, other: _Shift) -> _Shift:
        return _Shift(self.forces + other.forces, self.strength + other.strength)


def edges_inside(problem: Problem, solution: Solution) -> list[Edge]:
    """Edges that pass through pieces of the surfaces, of all contacts; collective."""
    found = []
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        cuts = zip((CONTACT_AREA, STICK_AREA), cut_areas(contact, state), strict=True)
        found += [Edge(number, name, cut) for name, cut in cuts if cut > 0]
    return found


def standing(edges: Sequence[Edge], rows: Sequence[Quantities]) -> list[Edge]:
    """Return the edges that hardly move from one of several answers to another."""
    return [
        edge
        for edge in edges
        if max(edge.moved(one, other) for one in rows for other in rows) < _STILL
    ]


def shifted_answers(
    load_steps: LoadSteps, measure: Measure, edges: Sequence[Edge]
) -> list[tuple[float, Quantities]]:
    """Answers of the last load step with edges moved, as many as converge; collective.

    Where there is none to one side, as of a body that less friction would not hold, twice as many
    are found to the other side.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.
        edges: Which are to move.

    Returns:
        By how much, -1 … 1, and the quantities; empty where no edge can be moved.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    shift = _scaled(load_steps, edges)
    if shift is None:
        return []
    even = np.arange(1, _SIZES + 1) / _SIZES
    between = even - 0.5 / _SIZES
    sides = {sign: _to_a_side(load_steps, measure, shift, sign * even) for sign in (-1.0, 1.0)}
    for sign, found in sides.items():
        if found and not sides[-sign]:
            found += _to_a_side(load_steps, measure, shift, sign * between)
    return [(0.0, answer), *(row for found in sides.values() for row in found)]


def _to_a_side(
    load_steps: LoadSteps, measure: Measure, shift: _Shift, sizes: Array
) -> list[tuple[float, Quantities]]:
    """Return answers for sizes of one sign, up to the first that has none; collective."""
    rows = []
    for size in sizes:
        change = _by(shift.times(size), load_steps.time)
        found = last_step_again(load_steps, measure, change, roughly=True)
        if found is None:
            break
        rows.append((float(size), found))
    return rows


def _scaled(load_steps: LoadSteps, edges: Sequence[Edge]) -> _Shift | None:
    """A shift that moves some edge of each kind by a piece, and the others less; collective."""
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    touching, sticking = (
        [edge for edge in edges if edge.area == name] for name in (CONTACT_AREA, STICK_AREA)
    )
    none = np.zeros_like(problem.load)
    found = None
    for chosen, first, most in (
        (touching, _Shift(_spreading(problem, solution, touching), 0.0), _MOST_TRACTION),
        (sticking, _Shift(none, _FIRST), _MOST_STRENGTH),
    ):
        scaled = _by_a_piece(load_steps, chosen, first, most) if chosen else None
        if scaled is not None:
            found = scaled if found is None else found.plus(scaled)
    return found


def _by_a_piece(
    load_steps: LoadSteps, edges: Sequence[Edge], first: _Shift, most: float
) -> _Shift | None:
    """A shift of one kind that moves no edge by much more than a piece to either side; collective.

    What a large size does tells too little of a small one, where it moves an edge to the end of its
    surface: so the size that follows is tried in turn.

    Returns:
        None where the first size has no answer, or moves no edge.
    """
    assert load_steps.last is not None
    areas = partial(_areas, load_steps.problem)
    answer = areas(load_steps.last.solution)

    def moved_by(size: float) -> float:
        change = _by(first.times(size), load_steps.time)
        tried = last_step_again(load_steps, areas, change, roughly=True)
        return max(edge.moved(tried, answer) for edge in edges) if tried else 0.0

    moved = moved_by(1.0)
    if moved <= _FIXED:
        return None
    size = min(most, _PIECES / moved)
    for _ in range(_TRIES):
        moved = max(moved_by(size), moved_by(-size))
        if moved <= _FAR * _PIECES:
            break
        size *= _PIECES / moved
    return first.times(size)


def _areas(problem: Problem, solution: Solution) -> Quantities:
    """Areas that tell where edges are; collective."""
    found: dict[Hashable, float] = {}
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        zones = Zones(contact, state)
        closed = contact_area(zones)
        found[number, CONTACT_AREA] = closed
        found[number, STICK_AREA] = min(stick_area(zones), closed)
    return found


def _spreading(problem: Problem, solution: Solution, edges: Sequence[Edge]) -> Array:
    """Nodal forces that pull contacts off, the more the further from their middle; collective."""
    found = np.zeros_like(problem.load)
    for edge in edges:
        contact = problem.contacts[edge.contact]
        found += contact.kinematics.on_body(_pull(contact, solution.states[edge.contact]))
    return found


def _pull(contact: ContactSurface, state: ContactState) -> Array:
    """Return the force on one contact at its surface's nodes, (nodes, components); collective.

    Its traction is the first size at the mean of squared distances from the middle. None of one
    that touches in a single point.
    """
    trace, surface, comm = contact.trace, contact.trace.surface, contact.spaces.comm
    share = np.where(state.status != OPEN, trace.weights, 0.0) * trace.owned
    sums = [share.sum(), share @ state.contact_pressure, *(share @ trace.coordinates)]
    area, force, *moments = total(comm, np.array(sums))
    middle = np.array(moments) / area
    mean = total(comm, float(share @ ((trace.coordinates - middle) ** 2).sum(axis=1))) / area
    if mean == 0:
        return np.zeros_like(trace.normals_at_nodes)
    away = ((surface.coordinates - middle) ** 2).sum(axis=1) / mean
    pulls = _FIRST * force / area * away[:, None] * trace.normals_at_nodes
    traction = surface.vector_function(pulls, "traction")
    work = ufl.dot(traction, ufl.TestFunction(surface.space))
    return surface.assemble(form_cache.form(trace.weight * work * trace.measure))


def _by(shift: _Shift, time: float) -> Change:
    def change(problem: Problem) -> None:
        problem.disturbance = Disturbance.growing(shift.forces, time)
        for contact in problem.frictional:
            contact.friction.scale_coefficient(1.0 + shift.strength)
        problem.set_time(time)

    return change
