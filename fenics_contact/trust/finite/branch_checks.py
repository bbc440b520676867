"""Checks of answers in finite strains: cells that collapse, and equilibria that are not stable.

Newton's method may end on a wrong branch: a cell at a corner has collapsed there, or the body would
leave the equilibrium by itself. Forces are in balance on such a branch, and contact laws hold.
"""

from __future__ import annotations

from fenics_contact.body.finite.hyperelastic_body import HyperelasticBody
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check

# Share of its volume that a piece of the body may lose. Compressible rubber that is pressed to half
# of its height loses a third; collapsed cells have lost more than nine tenths.
_MOST_LOST = 0.9


def volume_ratio(forces: InternalForces) -> Check | None:
    """Largest share of its volume that a piece of the body has lost, 1 − det F; collective."""
    elastic = forces.problem.elastic
    if not isinstance(elastic, HyperelasticBody):
        return None
    return Check(1 - elastic.volume_ratio_at(forces.displacement), _MOST_LOST)


def stable_equilibrium(forces: InternalForces) -> Check | None:
    """Number of motions in which the body would leave the equilibrium by itself.

    They are counted by the tangent at the answer, of motions that contact and friction leave.
    """
    count = forces.solution.unstable_motions
    return None if count is None else Check(float(count), 0.0)
