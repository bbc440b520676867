"""Check that friction can hold back the parts that no support holds."""

from __future__ import annotations

from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.existence.slip_shares import HELD, slip_shares
from fenics_contact.results.result import Check


def slip_limit(forces: InternalForces) -> Check | None:
    """How much of what friction can hold against rigid motions of parts it does hold; collective.

    At all of it parts slip as one, and nothing says how far: pressures of the linear theory change
    with that, until an answer is found that means nothing. None where friction holds no part, and
    of bodies that move.
    """
    found = slip_shares(forces.problem, forces.solution.states) if forces.rests else None
    largest = None if found is None else found.largest()
    if largest is None:
        return None
    return Check(largest.share, HELD, part=" and ".join(largest.parts))
