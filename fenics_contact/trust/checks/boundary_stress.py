"""Check of the stress behind every contact against the contact's own resultants."""

from __future__ import annotations

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.forms import Expr
from fenics_contact.common import form_cache
from fenics_contact.common.parallel import total
from fenics_contact.contact.surface.facet_sizes import relative_cell_size
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import nearer_to_failing

# Boundary stress against reactions: first order in the size h of the cells behind the facets,
# whose stress it is (corners and the stick-slip edge cap the order). Over 320 random scenes, from
# 2 facets up and with cells deeper than wide, the difference was at most 2.1 h/L with degree 1 and
# .58 h/L with degree 2; over the facets' size it came to 4.5 and 1.3.
_STRESS_OVER_SIZE = {1: 5.0, 2: 1.5}
# A limit that a body without any stress would keep is none: half, or this share of what such a
# body has where that is more.
_LARGEST_STRESS_LIMIT = 0.5
_OF_NO_STRESS = 0.8


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
        limit = _STRESS_OVER_SIZE[spaces.degree] * relative_cell_size(contact.trace.surface)
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


def _boundary_traction(problem: Problem) -> Expr:
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
