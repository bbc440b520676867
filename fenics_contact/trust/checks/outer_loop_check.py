"""Check of the loop on the pressure: the bound that friction was solved with is that found."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import largest
from fenics_contact.contact.noise import carries_more_than
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import TRACE, nearer_to_failing, worst_of

# Of the tolerance of the loop, which ends when the last pass changes pressures by less.
_SAFETY = 10.0


def outer_loop(forces: BulkForces) -> Check | None:
    """G of the friction that was solved against μ p of the pressure that came out; collective.

    Over the largest μ p. No other check sees a loop that ended too early: friction would be
    within a bound that is larger than it should be, or obey one that is smaller.
    """
    problem, solution = forces.problem, forces.solution
    worst: Check | None = None
    limit = TRACE + _SAFETY * problem.scene.solver.outer_tolerance
    for number, contact in enumerate(problem.contacts):
        if not contact.is_coulomb:
            continue
        wanted = contact.friction.bound_of(solution.states[number].contact_pressure)
        peak = largest(problem.comm, wanted)
        if peak <= 0 or not carries_more_than(contact, forces.imbalance):
            continue
        owned = contact.trace.owned
        off = np.abs(solution.friction_bound[number] - wanted)[owned]
        value, place = worst_of(problem.comm, off, contact.trace.coordinates[owned])
        worst = nearer_to_failing(worst, Check(value / peak, limit, contact.label, place))
    return worst
