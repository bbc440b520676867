"""By how much varying loads can grow at the most, whatever the pressures of contacts become.

With loads f₀ that are constant and λ f₁ that grow, contact forces within their cones can balance
f₀ + λ f₁ (``limit_analysis``) up to the least

  λ = (Σ g |r_T| − f₀(r))/f₁(r)  over motions r with r_n + μ |r_T| ≤ 0 and f₁(r) > 0,

g bounds of friction that are known: beyond it nothing holds the loads. Below it something may not,
as friction of unknown pressure follows no associated law: so it is an upper bound (D. C. Drucker,
Coulomb friction, plasticity, and limit loads, J. Appl. Mech. 21 (1954) 71-74). Each motion that
runs at some λ gives a smaller one, which is found to round-off in a few steps (W. Dinkelbach,
Management Science 13 (1967) 492-498).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import on_root
from fenics_contact.problem.existence.friction_cones import ContactCones, contact_cones
from fenics_contact.problem.existence.limit_analysis import LimitAnalysis
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

#: A factor of loads beyond which these are not what makes parts slip.
MOST = 100.0
# Motions that are tried at the most: each gives the next factor.
_TRIES = 50
# Of the factor: less than that it falls no more.
_SETTLED = 1e-12


@dataclass(frozen=True)
class GrowthLimit:
    """An upper bound of the factor of varying loads.

    Attributes:
        factor: Beyond which no contact forces balance the loads.
        motion: That then runs, in words.
    """

    factor: float
    motion: str


def growth_limit(problem: Problem, varying: Array, present: float) -> GrowthLimit | None:
    """Find the factor beyond which nothing can balance the loads; collective.

    Args:
        problem: In the state of an answer.
        varying: Nodal forces of the varying loads for a factor of 1, (nodes, components) (force).
        present: Their factor at present.

    Returns:
        None where loads of any size, up to ``MOST`` times as large, can be balanced.
    """
    rigid = RigidMotions(problem)
    if rigid.count == 0 or rigid.force_size == 0:
        return None
    cones, aligned = contact_cones(problem, rigid).aligned()
    grown = rigid.work_of(varying) @ aligned
    constant = rigid.force @ aligned - present * grown

    def find() -> tuple[float, Array] | None:
        return _least_factor(cones, constant, grown, rigid.force_size)

    found = on_root(problem.comm, find)
    if found is None:
        return None
    factor, motion = found
    return GrowthLimit(factor, rigid.describe(aligned @ motion))


def _least_factor(
    cones: ContactCones, constant: Array, varying: Array, size: float
) -> tuple[float, Array] | None:
    """The least factor at which a motion runs, and what slides in it; on one rank.

    Args:
        cones: What contacts can exert.
        constant: Work of constant loads on each motion (force × length).
        varying: Work of varying loads, for a factor of 1.
        size: Of all contributions to these, for round-off.
    """
    factor, best = MOST, None
    for _ in range(_TRIES):
        loads = constant + factor * varying
        found = LimitAnalysis(cones, loads, max(size, factor * size)).running()
        if found is None:
            break
        motion, sliding = found
        lengths = np.linalg.norm(cones.bounded_slips @ motion, axis=1)
        pushed = float(varying @ motion)
        if pushed <= 0:  # what runs are the constant loads
            return None
        least = (float(cones.bounds @ lengths) - float(constant @ motion)) / pushed
        if least >= factor * (1 - _SETTLED):
            break
        factor, best = least, sliding
    return None if best is None else (factor, best)
