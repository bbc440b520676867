"""Whether the cut faces of a sector move alike, and what one gets the other gives."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.parallel import total
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.comparison import balance, nearer_to_failing

# Of the largest displacement of the faces: round-off of a solve.
_ALIKE = 1e-9


def cyclic_symmetry(forces: InternalForces) -> Check | None:
    """Jump of the displacement across the cut, and forces that both faces leave; collective.

    None without a cut. What loads and contacts leave on ``on`` acts, turned, on the other face
    against what they leave there: supports apart, both are to balance.
    """
    problem = forces.problem
    cut = problem.discrete.cut
    if cut is None:
        return None
    apart = Check(cut.mismatch(forces.displacement), _ALIKE, kind="motion")
    owned = slice(0, problem.spaces.owned_nodes)
    at_cut = cut.nodes[owned]
    left = np.where(problem.free, forces.unbalanced, 0.0)[owned][at_cut]
    needed = forces.solution.internal_force[owned][at_cut]
    off, size = total(problem.comm, np.array([np.abs(left).sum(), np.abs(needed).sum()]))
    return nearer_to_failing(apart, balance(off, size, forces.imbalance, kind="forces"))
