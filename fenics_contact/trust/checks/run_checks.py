"""Checks of the physics on every run.

None asks a contact law for its own forces: the forces compared come from the bulk,
as nodal reactions (K u − f) or as boundary stress, so a wrong solution fails.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import balance, nearer_to_failing
from fenics_contact.trust.checks.compliance import penetration_depth, stick_creep
from fenics_contact.trust.checks.friction import (
    compared_friction,
    dissipation,
    friction_cone,
    friction_law,
)
from fenics_contact.trust.checks.normal import (
    compared_pressures,
    complementarity,
    contact_law,
    penetration,
    pressure_recovery,
    tension,
)
from fenics_contact.trust.checks.outer_loop_check import outer_loop
from fenics_contact.trust.checks.pair_checks import action_and_reaction
from fenics_contact.trust.checks.resultants import resultant

# Boundary stress against reactions: first order in the size h of the cells behind the facets,
# whose stress it is (corners and the stick-slip edge cap the order). Over 320 random scenes, from
# 2 facets up and with cells deeper than wide, the difference was at most 2.1 h/L with degree 1 and
# .58 h/L with degree 2; over the facets' size it came to 4.5 and 1.3.
_STRESS_OVER_SIZE = {1: 5.0, 2: 1.5}
# A limit that a body without any stress would keep is none: half, or this share of what such a
# body has where that is more.
_LARGEST_STRESS_LIMIT = 0.5
_OF_NO_STRESS = 0.8
# What holds a motion that nothing pushes: of the forces applied.
_NO_FORCE = 1e-9


def run_checks(forces: BulkForces, reactions: Array, steps: int = 1) -> dict[str, Check]:
    """All checks that the scene's terms call for; collective.

    A check that finds nothing to compare, such as friction where supports hold every
    contact point, is left out: it would pass whatever the solution.

    Args:
        forces: Of a solution.
        reactions: Nodal support reactions, shape (nodes, components) (force).
        steps: Load steps taken.
    """
    found = all_checks(forces, reactions, steps)
    return {name: check for name, check in found.items() if check is not None}


def all_checks(forces: BulkForces, reactions: Array, steps: int) -> dict[str, Check | None]:
    """As ``run_checks``, with None for those that find nothing to compare; collective."""
    friction, pressures = compared_friction(forces), compared_pressures(forces)
    return {
        "equilibrium": equilibrium(forces, reactions),
        "resultant": resultant(forces),
        "stabilisation": _stabilisation(forces),
        "action_and_reaction": action_and_reaction(forces),
        "boundary_stress": boundary_stress(forces),
        "friction_cone": friction_cone(friction),
        "friction_law": friction_law(friction),
        "outer_loop": outer_loop(forces),
        "dissipation": dissipation(friction),
        "stick_creep": stick_creep(friction, steps),
        "contact_law": contact_law(pressures),
        "complementarity": complementarity(pressures),
        "tension": tension(pressures),
        "penetration": penetration(forces, pressures),
        "penetration_depth": penetration_depth(forces, pressures),
        "pressure_recovery": pressure_recovery(forces, pressures),
    }


def equilibrium(forces: BulkForces, reactions: Array) -> Check:
    """Resultants and moments of loads, support reactions and contact forces add up to zero.

    In every part of the body by itself, relative to the sum of its nodal forces; the part
    nearest to failing counts, and where there are several, each is told. The reactions come
    from the bulk, which balances itself, so whatever a wrong solution leaves on free nodes
    shows here.
    """
    spaces = forces.problem.spaces
    parts, owned = spaces.parts, spaces.owned_nodes
    applied = (forces.problem.load + reactions + forces.contacts)[:owned]
    vectors = np.zeros((owned, 3))
    vectors[:, : spaces.components] = applied
    if spaces.kinematics == "axisymmetric":  # radial nodal forces balance around the ring
        left = np.abs(parts.sums(applied[:, 1]))
    else:
        resultants = vectors.copy()
        if spaces.degree < spaces.geometry_order:
            # Straight shape functions on curved cells cannot turn rigidly: what turns the bulk's
            # own forces is not balanced, by an error of the discretisation, and taken off.
            vectors[:, : spaces.components] -= forces.solution.internal_force[:owned]
        moments = np.cross(parts.arms[:owned], vectors) / parts.sizes[parts.of_node[:owned], None]
        left = np.linalg.norm(parts.sums(np.hstack([resultants, moments])), axis=1)
    carried = parts.sums(np.abs(applied).sum(axis=1))
    imbalance = forces.imbalance
    found = [
        balance(value, sum_of_forces, imbalance, part=name)
        for name, value, sum_of_forces in zip(parts.names, left, carried, strict=True)
    ]
    worst = reduce(nearer_to_failing, found)  # a body has at least one part
    return replace(worst, parts=tuple(found)) if len(found) > 1 else worst


def boundary_stress(forces: BulkForces) -> Check | None:
    """∫ σ(u) n over each contact against its pressure and friction resultants.

    Relative to ∫ (p + g + mean stress of the body): where the contact carries little,
    the error of the stress is still that of the body's. First order in the cell size.
    Left out are contacts that loads act on as well, and axes along which supports hold
    the contact: their forces are in σ n, too.
    """
    problem = forces.problem
    spaces = problem.spaces
    stress_vector = _boundary_traction(problem)
    test = ufl.TestFunction(spaces.displacement_space)
    typical = _mean_stress(forces)
    worst: Check | None = None
    for number, contact in enumerate(problem.contacts):
        axes = ~contact.supports.held_axes()
        if problem.is_loaded(contact.sides.group) or not axes.any():
            continue
        measure = spaces.boundary(contact.sides.group)
        nodal = spaces.assemble(
            form_cache.form(spaces.weight * ufl.dot(stress_vector, test) * measure)
        )
        found = total(problem.comm, nodal[: spaces.owned_nodes].sum(axis=0))
        state = forces.solution.states[number]
        traction = state.friction_traction - state.contact_pressure[:, None] * contact.trace.normals
        given = contact.trace.integral(traction)
        carried = np.abs(state.contact_pressure) + contact.friction_bound
        limit = _STRESS_OVER_SIZE[spaces.degree] * contact.trace.relative_cell_size()
        if limit > _LARGEST_STRESS_LIMIT and contact.is_one_sided:
            continue  # it may touch in a single point of so coarse a surface
        resultant = float(np.linalg.norm(given[axes]))
        without_stress = resultant / (float(contact.trace.integral(carried)) or 1.0)
        most = max(_LARGEST_STRESS_LIMIT, _OF_NO_STRESS * without_stress)
        unit = float(contact.trace.integral(carried + typical)) or 1.0
        left = 2 * forces.solution.imbalance_limit / unit  # of a body that has been unloaded, all
        check = Check(
            float(np.linalg.norm((found - given)[axes]) / unit),
            min(limit, most) + left,
            contact.label,
        )
        worst = nearer_to_failing(worst, check)
    return worst


def _boundary_traction(problem: Problem) -> Any:
    """σ n on the boundary, as a UFL vector."""
    size = problem.spaces.components
    cauchy = problem.elastic.stress()
    normal = ufl.FacetNormal(problem.body.mesh)
    return ufl.as_vector([sum(cauchy[i, j] * normal[j] for j in range(size)) for i in range(size)])


def _mean_stress(forces: BulkForces) -> float:
    """Root mean square stress of the body, √(E a(u, u) / volume), E the largest stiffness."""
    problem, spaces = forces.problem, forces.problem.spaces
    energy = 2 * forces.strain_energy
    volume = total(problem.comm, fem.assemble_scalar(form_cache.form(spaces.weight * spaces.bulk)))
    return float(np.sqrt(max(energy, 0.0) * problem.elastic.reference_modulus / volume))


def _stabilisation(forces: BulkForces) -> Check | None:
    """Largest force where motions that nothing resists are held, over all forces applied.

    It vanishes, but for what is left out of balance elsewhere, whose lever is no longer.
    """
    problem = forces.problem
    if not problem.stabilisation:
        return None
    held = np.concatenate([support.dofs for support in problem.stabilisation])
    owned = problem.spaces.owned_nodes
    applied = np.abs(problem.load[:owned]).sum() + np.abs(forces.contacts[:owned]).sum()
    size = total(problem.comm, float(applied)) or 1.0
    value = largest(problem.comm, np.abs(forces.unbalanced.reshape(-1)[held])) / size
    return Check(value, _NO_FORCE + 2 * forces.solution.imbalance_limit / size)
