"""Checks of conduction: what each body takes in of heat, it gives."""

from __future__ import annotations

from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check

# Where temperatures and pressures have settled, of all heat.
_SETTLED = 1e-5


def heat_balance(forces: InternalForces) -> Check | None:
    """Heat that a body takes in and does not give, over all heat; None without any; collective."""
    conduction = forces.problem.conduction
    if conduction is None:
        return None
    left = conduction.imbalance(forces.solution.states)
    return None if left is None else Check(left, _SETTLED)
