"""Other answers of a load step: Coulomb's friction may have several, each with its own start."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import AXES
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution

logger = logging.getLogger(__name__)


# Two answers are the same if displacements differ by no more than this, over the largest.
_SAME = 1e-6
# Penetration and slip that a start begins with, over the facet size: Newton's first step goes as
# far as its linearisation reaches, whatever they are.
_DEPTH = 1e-3
# Part of a direction in the surface from which it counts as along it.
_ALONG = 0.1


@dataclass(frozen=True)
class Start:
    """State of all points of Coulomb contacts at the start of Newton's method.

    Attributes:
        name: In words.
        closed: Whether they touch.
        way: Direction in which they slip, (components,); None where they stick.
    """

    name: str
    closed: bool
    way: tuple[float, ...] | None = None


def starts(components: int) -> list[Start]:
    """All of them: apart, stuck, slipping each way along each axis."""
    found = [Start("apart", False), Start("all sticks", True)]
    for axis in range(components):
        for sign in (1.0, -1.0):
            way = tuple(sign * float(axis == i) for i in range(components))
            name = f"all slips along {'+' if sign > 0 else '-'}{AXES[axis]}"
            found.append(Start(name, True, way))
    return found


def other_solutions(load_steps: LoadSteps) -> Iterator[tuple[str, Solution | None]]:
    """Solve the last load step from other starts; collective.

    Args:
        load_steps: At their end; all is there again when all starts have been tried.

    Yields:
        The start's name and the solution, of each answer that is none of those before, None of
        a start from which there was none; the problem's state is that answer's until the next
        is asked for.
    """
    assert load_steps.last is not None
    newton, problem = load_steps.newton, load_steps.problem
    known = [load_steps.last.solution.displacement]
    try:
        for start in starts(problem.spaces.components):
            if not _is_along(problem, start):
                continue
            load_steps.go_back()
            newton.forget()
            _begin(load_steps, start)
            try:
                newton.run(search_energy=False)
            except NotConvergedError as error:
                logger.debug("  from '%s': %s", start.name, error)
                yield start.name, None
                continue
            found = newton.solution(0, f"Newton's method, from the start '{start.name}'")
            if not any(is_same(problem, found.displacement, other) for other in known):
                known.append(found.displacement)
                yield start.name, found
    finally:
        load_steps.go_back()


@dataclass(frozen=True)
class ExactAnswers:
    """Answers of a load step whose contacts are solved exactly, other than the known one.

    Attributes:
        others: Their names and solutions.
        complete: Whether there are surely no more.
        way: How they were looked for, in words.
    """

    others: Iterator[tuple[str, Solution]]
    complete: bool
    way: str


def exact_answers(load_steps: LoadSteps, exact: ExactSolver) -> ExactAnswers:
    """Find all answers of the last load step at the contact points; collective.

    Args:
        load_steps: At their end; all is there again when all others have been asked for.
        exact: Of their problem.

    Returns:
        Answers; the problem's state is that of one until the next is asked for.
    """
    assert load_steps.last is not None
    load_steps.go_back()
    found = exact.all_answers()
    load_steps.go_back()
    return ExactAnswers(_others(load_steps, exact, found.forces), found.complete, found.way)


def _others(
    load_steps: LoadSteps, exact: ExactSolver, forces: Sequence[Array]
) -> Iterator[tuple[str, Solution]]:
    """Take the problem to answers that are not known yet, one after the other; collective."""
    newton, last = load_steps.newton, load_steps.last
    assert last is not None
    known = [last.solution.displacement]
    try:
        for start in forces:
            load_steps.go_back()
            newton.forget()
            try:
                found = newton.solve_exactly(exact, start)
            except NotConvergedError as error:
                logger.debug("  %s", error)
                continue
            if not any(is_same(load_steps.problem, found.displacement, one) for one in known):
                known.append(found.displacement)
                yield f"answer {len(known)}", found
    finally:
        load_steps.go_back()


def _is_along(problem: Problem, start: Start) -> bool:
    """Whether a start's slip is along some contact, not across all; collective."""
    if start.way is None:
        return True
    along = [
        contact.kinematics.tangential(_everywhere(contact, start.way))
        for contact in problem.coulomb
    ]
    return max(largest(problem.comm, np.abs(slip).ravel()) for slip in along) > _ALONG


def _everywhere(contact: ContactSurface, way: tuple[float, ...]) -> Array:
    return np.tile(way, (len(contact.trace.weights), 1))


def is_same(problem: Problem, one: Array, other: Array, share: float = _SAME) -> bool:
    """Whether the displacements of two answers are those of the same one; collective.

    Args:
        problem: Of both.
        one: At the nodes of this rank, (nodes, components) (length).
        other: Likewise.
        share: Of the largest one, by which they may differ.
    """
    size = largest(problem.comm, np.abs(other).ravel())
    return largest(problem.comm, np.abs(one - other).ravel()) <= share * size


def _begin(load_steps: LoadSteps, start: Start) -> None:
    """Bring all Coulomb contacts to a start, from the state of the answer; collective."""
    problem, newton = load_steps.problem, load_steps.newton
    assert load_steps.last is not None
    displacement = load_steps.last.unknowns.displacement.copy()
    for contact in problem.coulomb:
        displacement += _shift(contact, start)
    position = newton.system.position_of(displacement)
    newton.begin.at(position, load_steps.last.unknowns.scalars)
    for contact in problem.coulomb:
        contact.friction_term.follow_pressure()
        if start.way is None:
            contact.friction_term.tangent_state.stick_all()
        else:
            contact.friction_term.tangent_state.slip_all(_slip(contact, start.way))


def _slip(contact: ContactSurface, way: tuple[float, ...]) -> Array:
    """Slip in a direction at the points; where that is across the surface, some other way."""
    turned = (way[-1], *way[:-1])
    along, other = (contact.kinematics.tangential(_everywhere(contact, w)) for w in (way, turned))
    is_along = np.linalg.norm(along, axis=1) > _ALONG
    along = np.where(is_along[:, None], along, other)
    return np.asarray(_DEPTH * contact.facet_size * along)


def _shift(contact: ContactSurface, start: Start) -> Array:
    """Return the displacement of a slave's nodes to their start, at body nodes; collective."""
    kinematics, trace = contact.kinematics, contact.trace
    depth = _DEPTH * contact.facet_size * (1.0 if start.closed else -1.0)
    gap = np.where(kinematics.reached, kinematics.gap, 0.0)
    jump = kinematics.jump_at_points()
    across = (gap + depth - kinematics.normal(jump))[:, None] * trace.normals
    slip = contact.friction.reference.copy()
    if start.way is not None:
        slip += _slip(contact, start.way)
    change = across + slip - kinematics.tangential(jump)
    at_nodes = np.where(kinematics.reached[:, None], change, 0.0)[: len(contact.nodes)]
    return np.asarray(trace.surface.on_body(trace.at_all_nodes(at_nodes)))
