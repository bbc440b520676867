"""Checks of the physics on every run.

None asks the friction law for its own forces: the forces compared come from the
bulk, as nodal reactions (K u − f) or as boundary stress, so a wrong solution fails.
"""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from fenics_contact.contact import ContactSurface
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
# most 4.2 h/L with degree 1 and .36 h/L with degree 2.
_STRESS_OVER_SIZE = {1: 10.0, 2: 2.5}


def run_checks(problem: Problem, solution: Solution, reactions: Array) -> dict[str, Check]:
    """All checks that the scene's terms call for; collective.

    Args:
        problem: The model.
        solution: Its solution.
        reactions: Nodal support reactions, shape (nodes, components) (force).
    """
    checks = {"equilibrium": equilibrium(problem, solution, reactions)}
    if problem.contacts:
        checks["boundary_stress"] = boundary_stress(problem, solution)
    if problem.frictional:
        checks["friction_cone"] = friction_cone(problem, solution)
        checks["friction_law"] = friction_law(problem, solution)
        checks["dissipation"] = dissipation(problem, solution)
    return checks


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


def recovered_traction(
    problem: Problem, solution: Solution, number: int
) -> tuple[Array, NDArray[np.bool_]]:
    """Friction traction that the bulk needs at the points of a contact.

    Returns:
        (K u − f) / weight, tangential, shape (points, components) (stress); and which
        points count: owned, and not held by a support, whose reaction would mix in.
    """
    contact = problem.contacts[number]
    force = (solution.internal_force - problem.load)[contact.nodes]
    components = problem.spaces.components
    held = np.zeros(problem.load.size, dtype=bool)
    held[problem.constrained] = True
    counted = contact.owned & ~held.reshape(-1, components)[contact.nodes].any(axis=1)
    return contact.tangential(force / contact.weights[:, None]), counted


def _limit(problem: Problem, contact: ContactSurface, solution: Solution) -> float:
    """What the accepted imbalance, all on the lightest point, does to traction over g."""
    lightest = smallest(problem.comm, contact.weights[contact.owned])
    traction = 2 * solution.imbalance_limit / lightest
    return _TRACE + traction / _strongest(problem, contact)


def _strongest(problem: Problem, contact: ContactSurface) -> float:
    return largest(problem.comm, contact.friction_bound)


def _worst(problem: Problem, values: list[tuple[Array, float, float]]) -> Check:
    """The check of the contact that comes nearest to its limit (values, scale, limit)."""
    found = [
        (largest(problem.comm, value, empty=-np.inf) / scale, limit)
        for value, scale, limit in values
    ]
    value, limit = max(found, key=lambda pair: pair[0] / pair[1])
    return Check(max(value, 0.0), limit)


def friction_cone(problem: Problem, solution: Solution) -> Check:
    """|σ_T| − g, over the largest g (paper, (1.6)): traction within its bound."""
    values = []
    for number, contact in enumerate(problem.contacts):
        if contact.friction is not None:
            traction, counted = recovered_traction(problem, solution, number)
            excess = np.linalg.norm(traction, axis=1) - contact.friction_bound
            values.append(
                (excess[counted], _strongest(problem, contact), _limit(problem, contact, solution))
            )
    return _worst(problem, values)


def friction_law(problem: Problem, solution: Solution) -> Check:
    """|σ_T + g φ_ε′(u_T)| over the largest g (paper, (2.8)): bulk against friction law."""
    values = []
    for number, contact in enumerate(problem.contacts):
        if contact.friction is not None:
            traction, counted = recovered_traction(problem, solution, number)
            law = solution.friction_force[number] / contact.weights[:, None]
            difference = np.linalg.norm(traction - law, axis=1)
            values.append(
                (
                    difference[counted],
                    _strongest(problem, contact),
                    _limit(problem, contact, solution),
                )
            )
    return _worst(problem, values)


def dissipation(problem: Problem, solution: Solution) -> Check:
    """σ_T · u_T ≤ 0 at every point: friction takes energy, nowhere gives it (paper, (1.6))."""
    values = []
    for number, contact in enumerate(problem.contacts):
        if contact.friction is not None:
            traction, counted = recovered_traction(problem, solution, number)
            slip = contact.slip(solution.displacement)
            longest = largest(problem.comm, np.linalg.norm(slip, axis=1))
            given = np.einsum("ij,ij->i", traction, slip)
            scale = _strongest(problem, contact) * (longest or 1.0)
            values.append((given[counted], scale, _limit(problem, contact, solution)))
    return _worst(problem, values)


def boundary_stress(problem: Problem, solution: Solution) -> Check:
    """∫ σ(u) n over each contact against its pressure and friction resultants.

    Relative to ∫ (p + g + mean stress of the body): where the contact carries little,
    the error of the stress is still that of the body's. First order in the facet size.
    """
    spaces = problem.spaces
    size = spaces.components
    cauchy = problem.stress(problem.displacement)
    normal = ufl.FacetNormal(problem.body.mesh)
    traction = ufl.as_vector(
        [sum(cauchy[i, j] * normal[j] for j in range(size)) for i in range(size)]
    )
    test = ufl.TestFunction(spaces.displacement_space)
    typical = _mean_stress(problem, solution)
    worst = Check(0.0, np.inf)
    for contact, force in zip(problem.contacts, solution.friction_force, strict=True):
        measure = spaces.boundary(contact.group)
        nodal = spaces.assemble(fem.form(spaces.weight * ufl.dot(traction, test) * measure))
        found = total(problem.comm, nodal[: spaces.owned_nodes].sum(axis=0))
        pressure = contact.contact_pressure[:, None] * contact.normals
        given = total(problem.comm, force[contact.owned].sum(axis=0)) - contact.integral(pressure)
        carried = contact.contact_pressure + contact.friction_bound + typical
        check = Check(
            float(np.linalg.norm(found - given) / (contact.integral(carried) or 1.0)),
            _STRESS_OVER_SIZE[spaces.degree] * contact.relative_facet_size(),
        )
        if check.value / check.limit >= worst.value / worst.limit:
            worst = check
    return worst


def _mean_stress(problem: Problem, solution: Solution) -> float:
    """Root mean square stress of the body, √(E a(u, u) / volume)."""
    spaces = problem.spaces
    owned = slice(0, spaces.owned_nodes)
    energy = total(
        problem.comm, np.sum(solution.displacement[owned] * solution.internal_force[owned])
    )
    volume = total(problem.comm, fem.assemble_scalar(fem.form(spaces.weight * spaces.bulk)))
    return float(np.sqrt(max(energy, 0.0) * problem.material.youngs_modulus / volume))
