"""Check of the stress behind every contact against the contact's own resultants."""

from __future__ import annotations

import numpy as np
from dolfinx import fem

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.facet_sizes import relative_cell_size
from fenics_contact.evaluate.internal_forces import InternalForces
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


def boundary_stress(forces: InternalForces) -> Check | None:
    """∫ σ(u) n over each contact against its pressure and friction resultants.

    Relative to ∫ (p + g + mean stress of the body): where the contact carries little,
    the error of the stress is still that of the body's. First order in the cell size.
    The resultants of other contacts on the same surface count with it. Left out are contacts that
    loads act on as well, or others on a part of them, and axes along which supports hold the
    contact: their forces are in σ n, too. None of bodies that move, in which stress varies in time.
    """
    if not forces.rests:
        return None
    problem = forces.problem
    spaces = problem.spaces
    typical = _mean_stress(forces)
    worst: Check | None = None
    for number, contact in enumerate(problem.contacts):
        axes = ~contact.supports.held_axes()
        acting = _on_surface(problem, contact)
        if acting is None or not axes.any():
            continue
        given = np.sum([sign * _resultant(forces, other) for other, sign in acting], axis=0)
        carried = sum(_carried(forces, other) for other, _ in acting)
        limit = _STRESS_OVER_SIZE[spaces.degree] * relative_cell_size(contact.trace.surface)
        if limit > _LARGEST_STRESS_LIMIT and contact.is_one_sided:
            continue  # it may touch in a single point of so coarse a surface
        found = forces.of_stress(number)
        resultant = float(np.linalg.norm(given[axes]))
        without_stress = resultant / (carried or 1.0)
        most = max(_LARGEST_STRESS_LIMIT, _OF_NO_STRESS * without_stress)
        unit = carried + typical * _area(contact) or 1.0
        left = 2 * forces.solution.imbalance_limit / unit  # of a body that has been unloaded, all
        check = Check(
            float(np.linalg.norm((found - given)[axes]) / unit),
            min(limit, most) + left,
            contact.label,
        )
        worst = nearer_to_failing(worst, check)
    return worst


def _on_surface(problem: Problem, contact: ContactSurface) -> list[tuple[int, float]] | None:
    """Numbers of the contacts that act on the slave surface of one, and the signs of their forces.

    None where something else acts there as well, or a contact on a part of it.
    """
    group = contact.sides.group
    if problem.is_loaded(group):
        return None
    tags, found = set(group.tags), []
    for number, other in enumerate(problem.contacts):
        for trace, sign in ((other.trace, 1.0), (other.sides.opposite, -1.0)):
            if trace is None or not tags & set(trace.group.tags):
                continue
            if tags != set(trace.group.tags):
                return None
            found.append((number, sign))
    return found


def _area(contact: ContactSurface) -> float:
    """Return the area of a contact's slave (area)."""
    return float(contact.trace.integral(np.ones(len(contact.trace.weights))))


def _resultant(forces: InternalForces, number: int) -> Array:
    """∫ of the tractions on a contact's slave, (components,) (force)."""
    trace, state = forces.problem.contacts[number].trace, forces.solution.states[number]
    pressure = state.contact_pressure[:, None] * trace.normals
    return np.asarray(trace.integral(state.friction_traction - pressure))


def _carried(forces: InternalForces, number: int) -> float:
    """∫ (p + g) of a contact (force)."""
    contact, state = forces.problem.contacts[number], forces.solution.states[number]
    return float(contact.trace.integral(np.abs(state.contact_pressure) + contact.friction_bound))


def _mean_stress(forces: InternalForces) -> float:
    """Root mean square stress of the body, √(E a(u, u) / volume), E the largest stiffness."""
    problem = forces.problem
    energy = 2 * forces.strain_energy
    volume = problem.discrete.once("volume", lambda: _volume(problem.spaces))
    return float(np.sqrt(max(energy, 0.0) * problem.elastic.reference_modulus / volume))


def _volume(spaces: Spaces) -> float:
    """Return the volume of the body, of all ranks (volume)."""
    found = fem.assemble_scalar(form_cache.form(spaces.weight * spaces.bulk))
    return float(total(spaces.comm, found))
