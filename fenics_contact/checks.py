"""Checks of the physics on every run.

None asks the friction law for its own forces: the forces compared come from the
bulk, as nodal reactions (K u − f) or as boundary stress, so a wrong solution fails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.parallel import largest, smallest, total
from fenics_contact.problem import Problem
from fenics_contact.result import Check
from fenics_contact.solver import Solution

Array = NDArray[np.float64]

# Round-off of sums and traces, beside the imbalance that the solver accepted.
_ROUND_OFF = 1e-9
_TRACE = 1e-6
# Boundary stress against reactions: first order in the facet size h (corners and the
# stick-slip edge cap it). Over 250 random scenes, from 2 facets up, the difference was at
# most 2.3 h/L with degree 1 and .43 h/L with degree 2.
_STRESS_OVER_SIZE = {1: 10.0, 2: 2.5}
# A limit that a body without any stress would keep is none.
_LARGEST_STRESS_LIMIT = 0.5


def run_checks(problem: Problem, solution: Solution, reactions: Array) -> dict[str, Check]:
    """All checks that the scene's terms call for; collective.

    A check that finds nothing to compare, such as friction where supports hold every
    contact point, is left out: it would pass whatever the solution.

    Args:
        problem: The model.
        solution: Its solution.
        reactions: Nodal support reactions, shape (nodes, components) (force).
    """
    checks = {
        "equilibrium": equilibrium(problem, solution, reactions),
        "boundary_stress": boundary_stress(problem, solution),
        "friction_cone": friction_cone(problem, solution),
        "friction_law": friction_law(problem, solution),
        "dissipation": dissipation(problem, solution),
    }
    return {name: check for name, check in checks.items() if check is not None}


def equilibrium(problem: Problem, solution: Solution, reactions: Array) -> Check:
    """Resultants and moments of loads, support reactions and friction add up to zero.

    Relative to the sum of all nodal forces. The reactions come from the bulk, which
    balances itself, so whatever a wrong solution leaves on free nodes shows here.
    """
    spaces = problem.spaces
    forces = problem.load + reactions
    for contact, force in zip(problem.contacts, solution.friction_force, strict=True):
        forces[contact.nodes] += force
    forces = forces[: spaces.owned_nodes]
    size = total(problem.comm, np.abs(forces).sum()) or 1.0
    limit = _ROUND_OFF + 2 * solution.imbalance_limit / size
    if spaces.kinematics == "axisymmetric":  # radial nodal forces balance around the ring
        sums = total(problem.comm, forces[:, 1].sum())
        return Check(abs(sums) / size, limit)
    points = spaces.coordinates[: spaces.owned_nodes]
    arms = points - total(problem.comm, points.sum(axis=0)) / total(problem.comm, len(points))
    vectors = np.zeros((len(forces), 3))
    vectors[:, : spaces.components] = forces
    length = largest(problem.comm, np.abs(arms).ravel(), empty=1.0)
    sums = np.concatenate([vectors.sum(axis=0), np.cross(arms, vectors).sum(axis=0) / length])
    return Check(float(np.linalg.norm(total(problem.comm, sums))) / size, limit)


def recovered_friction(problem: Problem, solution: Solution, number: int) -> Array:
    """Friction forces that the bulk needs at the nodes of a contact.

    Returns:
        K u − f, tangential, shape (nodes, components) (force), less what other contacts
        give to a shared node.
    """
    contact = problem.contacts[number]
    force = solution.internal_force - problem.load
    for other, (neighbour, friction) in enumerate(
        zip(problem.contacts, solution.friction_force, strict=True)
    ):
        if other != number:
            force[neighbour.nodes] -= friction
    return contact.tangential(force[contact.nodes])


@dataclass(frozen=True, eq=False)
class _Compared:
    """What a friction check compares at the nodes where nothing but friction acts.

    Attributes:
        bulk: Recovered friction, over the largest bound and the node's area: a traction's share.
        law: The friction law's, likewise.
        bound: The most that the points around a node can give it, likewise.
        slip: Displacement along the surface (length).
        nodal: Whether each node is a point of its own, whose law can be asked.
        comm: Communicator.
    """

    bulk: Array
    law: Array
    bound: Array
    slip: Array
    nodal: bool
    comm: Any


def _worst(
    problem: Problem, solution: Solution, compare: Callable[[_Compared], float]
) -> Check | None:
    """The check of the frictional contact that comes nearest to its limit.

    Args:
        problem: The model.
        solution: Its solution.
        compare: The global value of the check for one contact, good at or below 0.
    """
    worst: Check | None = None
    for number, contact in enumerate(problem.contacts):
        free, movable = contact.free_along_surface(problem.constrained)
        counted = contact.owned_nodes & movable
        if contact.friction is None or problem.comm.allreduce(int(counted.sum())) == 0:
            continue
        trace = contact.trace
        area = trace.to_nodes(trace.weights)
        unit = area * largest(problem.comm, contact.friction_bound)
        bound = trace.to_nodes(trace.weights * contact.friction_bound) / unit
        bulk = free * recovered_friction(problem, solution, number) / unit[:, None]
        law = free * solution.friction_force[number] / unit[:, None]
        slip = free * contact.tangential(solution.displacement[contact.nodes])
        compared = _Compared(
            bulk[counted], law[counted], bound[counted], slip[counted], trace.nodal, problem.comm
        )
        found = compare(compared)
        lightest = smallest(problem.comm, unit[contact.owned_nodes])
        limit = _TRACE + 2 * solution.imbalance_limit / lightest
        check = Check(found if np.isnan(found) else max(found, 0.0), limit)
        worst = check if worst is None else _nearer_to_failing(worst, check)
    return worst


def _nearer_to_failing(first: Check, second: Check) -> Check:
    """The one that fails, is not a number, or uses more of its limit."""
    return first if second.value / second.limit <= first.value / first.limit else second


def friction_cone(problem: Problem, solution: Solution) -> Check | None:
    """|σ_T| − g, over the largest g (paper, (1.6)): traction within its bound."""

    def excess(compared: _Compared) -> float:
        return largest(compared.comm, np.linalg.norm(compared.bulk, axis=1) - compared.bound)

    return _worst(problem, solution, excess)


def friction_law(problem: Problem, solution: Solution) -> Check | None:
    """|σ_T + g φ_ε′(u_T)| over the largest g (paper, (2.8)): bulk against friction law."""

    def difference(compared: _Compared) -> float:
        return largest(compared.comm, np.linalg.norm(compared.bulk - compared.law, axis=1))

    return _worst(problem, solution, difference)


def dissipation(problem: Problem, solution: Solution) -> Check | None:
    """σ_T · u_T ≤ 0 at every point: friction takes energy, nowhere gives it (paper, (1.6)).

    Where points lie between nodes, a node's force is not that of one slip, and only the
    sum must be so.
    """

    def given(compared: _Compared) -> float:
        power = np.einsum("ij,ij->i", compared.bulk, compared.slip)
        longest = largest(compared.comm, np.linalg.norm(compared.slip, axis=1)) or 1.0
        if compared.nodal:
            return largest(compared.comm, power) / longest
        return total(compared.comm, power.sum()) / longest

    return _worst(problem, solution, given)


def boundary_stress(problem: Problem, solution: Solution) -> Check | None:
    """∫ σ(u) n over each contact against its pressure and friction resultants.

    Relative to ∫ (p + g + mean stress of the body): where the contact carries little,
    the error of the stress is still that of the body's. First order in the facet size.
    Left out are contacts that loads act on as well, and axes along which supports hold
    the contact: their forces are in σ n, too.
    """
    spaces = problem.spaces
    traction = _boundary_traction(problem)
    test = ufl.TestFunction(spaces.displacement_space)
    typical = _mean_stress(problem, solution)
    worst: Check | None = None
    for contact, force in zip(problem.contacts, solution.friction_force, strict=True):
        axes = ~contact.held_axes(problem.constrained)
        if problem.is_loaded(contact.group) or not axes.any():
            continue
        measure = spaces.boundary(contact.group)
        nodal = spaces.assemble(fem.form(spaces.weight * ufl.dot(traction, test) * measure))
        found = total(problem.comm, nodal[: spaces.owned_nodes].sum(axis=0))
        pressure = contact.contact_pressure[:, None] * contact.trace.normals
        given = total(
            problem.comm, force[contact.owned_nodes].sum(axis=0)
        ) - contact.trace.integral(pressure)
        carried = contact.contact_pressure + contact.friction_bound + typical
        limit = _STRESS_OVER_SIZE[spaces.degree] * contact.trace.relative_facet_size()
        check = Check(
            float(np.linalg.norm((found - given)[axes]) / (contact.trace.integral(carried) or 1.0)),
            min(limit, _LARGEST_STRESS_LIMIT),
        )
        worst = check if worst is None else _nearer_to_failing(worst, check)
    return worst


def _boundary_traction(problem: Problem) -> Any:
    """σ n on the boundary, as a UFL vector."""
    size = problem.spaces.components
    cauchy = problem.elastic.stress()
    normal = ufl.FacetNormal(problem.body.mesh)
    return ufl.as_vector([sum(cauchy[i, j] * normal[j] for j in range(size)) for i in range(size)])


def _mean_stress(problem: Problem, solution: Solution) -> float:
    """Root mean square stress of the body, √(E a(u, u) / volume), E the largest stiffness."""
    spaces = problem.spaces
    owned = slice(0, spaces.owned_nodes)
    energy = total(
        problem.comm, np.sum(solution.displacement[owned] * solution.internal_force[owned])
    )
    volume = total(problem.comm, fem.assemble_scalar(fem.form(spaces.weight * spaces.bulk)))
    return float(np.sqrt(max(energy, 0.0) * problem.elastic.reference_modulus / volume))
