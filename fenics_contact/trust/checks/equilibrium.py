"""Checks of the whole body: its forces balance, and motions held for free need no force."""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest, total
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import balance, nearer_to_failing

# What holds a motion that nothing pushes: of the forces applied.
_NO_FORCE = 1e-9


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


def preload(forces: BulkForces) -> Check | None:
    """Force along each part that is tightened against the one that is asked for; collective.

    Over the larger of the two; that along the part follows from displacements and shortening.
    """
    problem, solution = forces.problem, forces.solution
    asked = [one.force for one in problem.preloads if not one.is_locked]
    if not asked:
        return None
    states = problem.preload_states(solution.displacement)
    found = [state.force for state in states if not state.is_locked]
    size = float(np.abs([asked, found]).max()) or 1.0
    value = float(np.abs(np.subtract(found, asked)).max()) / size
    return Check(value, _NO_FORCE + 2 * solution.imbalance_limit / size)


def stabilisation(forces: BulkForces) -> Check | None:
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
