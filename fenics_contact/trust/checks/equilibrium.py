"""Checks of the whole body: its forces balance, and motions held for free need no force."""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import numpy as np

from fenics_contact.common.parallel import largest, total
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import balance, nearer_to_failing

# What holds a motion that nothing pushes: of the forces applied.
_NO_FORCE = 1e-9


def equilibrium(forces: InternalForces) -> Check | None:
    """Resultants and moments of loads, support reactions and contact forces add up to zero.

    In every part of the body by itself, relative to the sum of its nodal forces; the part
    nearest to failing counts, and where there are several, each is told. None of bodies that move.
    """
    if not forces.rests:
        return None
    spaces, found = forces.problem.spaces, forces.balances()
    if spaces.kinematics == "axisymmetric":  # radial nodal forces balance around the ring
        left = np.abs(found.resultants[:, 1])
    else:
        left = np.linalg.norm(np.hstack([found.resultants, found.moments]), axis=1)
    imbalance = forces.imbalance
    every = [
        balance(value, sum_of_forces, imbalance, part=name)
        for name, value, sum_of_forces in zip(spaces.parts.names, left, found.carried, strict=True)
    ]
    worst = reduce(nearer_to_failing, every)  # a body has at least one part
    return replace(worst, parts=tuple(every)) if len(every) > 1 else worst


def given_forces(forces: InternalForces) -> Check | None:
    """Force on each of the body's scalars against the one that is given; collective.

    Such as that along a bolt that is tightened; over the larger of the two. The one compared
    follows from the displacement and the scalar. None where no force is given.
    """
    problem, solution = forces.problem, forces.solution
    asked = [one.force for one in problem.body_scalars if not one.is_locked]
    if not asked:
        return None
    states = forces.scalar_states()
    found = [state.force for state in states if not state.is_locked]
    size = float(np.abs([asked, found]).max()) or 1.0
    value = float(np.abs(np.subtract(found, asked)).max()) / size
    return Check(value, _NO_FORCE + 2 * solution.imbalance_limit / size)


def stabilisation(forces: InternalForces) -> Check | None:
    """Largest force where motions that nothing resists are held, over all forces applied.

    It vanishes, but for what is left out of balance elsewhere, whose lever is no longer.
    """
    problem = forces.problem
    if not problem.stabilisation:
        return None
    owned = problem.spaces.owned_nodes
    applied = np.abs(forces.load[:owned]).sum() + np.abs(forces.contacts[:owned]).sum()
    size = total(problem.comm, float(applied)) or 1.0
    value = largest(problem.comm, np.abs(forces.at_stabilised())) / size
    return Check(value, _NO_FORCE + 2 * forces.solution.imbalance_limit / size)
