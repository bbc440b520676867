"""Springs that keep steps of Newton's method short where contact alone holds a body.

A roller that touches a ring at a few points can roll: nothing but the neighbours of these points
resists, once they touch. The tangent is singular, or nearly so, and a step by it goes far beyond
what is drawn. Springs at as many dofs as there are free motions are added to the tangent, and to
nothing else: the forces in balance have none, so that the answer has none (proximal point method:
R. T. Rockafellar, SIAM J. Control Optim. 14 (1976) 877-898).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import qr

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Of the largest row of motions, below which a row tells of no further motion.
_TELLS = 1e-6


def free_motions(problem: Problem) -> list[Array]:
    """Rigid motions of bodies that only contact resists; collective.

    There are none where inertia resists every motion.

    Args:
        problem: The problem, with its supports.

    Returns:
        Nodal displacements in each motion, (nodes, components).
    """
    if problem.inertia.moves:
        return []
    motions = RigidMotions(problem)
    if motions.body_is_held:
        return []
    return [motions.displacement(one) for one in np.eye(motions.count)]


def sprung(motions: Array) -> Integers:
    """Rows of motions (rows, motions) which together tell all of them apart."""
    if motions.size == 0:
        return np.zeros(0, dtype=np.int64)
    upper, order = qr(motions.T, mode="r", pivoting=True)
    sizes = np.abs(upper.diagonal())
    return np.asarray(order[: int((sizes > _TELLS * sizes.max(initial=0.0)).sum())], dtype=np.int64)
