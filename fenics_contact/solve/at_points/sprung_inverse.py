"""The inverse of the condensed stiffness, with springs where nothing but contact holds it.

The foot of each spring is an unknown of whoever uses it: with the foot where the spring ends, the
spring has no force, and the answer is that without springs.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.condensed.constant_tangent import ComplianceSolver
from fenics_contact.solve.condensed.scalar_border import ScalarBorder


class SprungInverse:
    """Inverse of the stiffness with springs, of all unknowns.

    Displacements come first, then scalars of obstacles, derived jumps and scalars of the body.
    Derived jumps follow from displacements: forces on them act there.

    Attributes:
        matrix: The inverse, (all, all).
        inner: How many come before the scalars of the body.
        free: Which of the body's scalars are not held; only these are among all.
        feet: Numbers of those that a spring holds.
        springs: Stiffnesses of the springs.

    Args:
        solver: Knows the inverse of all but the body's scalars.
        border: Rows and columns of the body's scalars.
        size: Number of displacements and scalars of obstacles.
    """

    def __init__(self, solver: ComplianceSolver, border: ScalarBorder, size: int) -> None:
        inner = solver.inverse
        self.inner, self.free = len(inner), ~border.held
        sprung = np.flatnonzero(solver.added)
        self.feet: Integers = np.concatenate([sprung, self.inner + np.arange(self.free.sum())])
        own = border.stiffest[self.free]
        self.springs = np.concatenate([solver.added[sprung], own])
        self.matrix = inner
        if self.free.any():
            self.matrix = _bordered(inner, size, border, self.free, own)

    def solve(self, forces: Array) -> Array:
        """Changes of all by forces on all, (all,) or (all, columns)."""
        return np.asarray(self.matrix @ forces)


def _bordered(inner: Array, size: int, border: ScalarBorder, free: Flags, springs: Array) -> Array:
    """Inverse with the body's scalars, each of which has a spring.

    Args:
        inner: Inverse without them.
        size: Number of unknowns among it; derived jumps come after these.
        border: Their rows and columns.
        free: Which are unknown.
        springs: Stiffness of the spring of each of these.
    """
    columns = border.columns[:, free]
    moved, pulled = inner[:, :size] @ columns, columns.T @ inner[:size]
    corner = border.corner[np.ix_(free, free)] + np.diag(springs) - columns.T @ moved[:size]
    own = np.linalg.inv(corner)
    return np.block([[inner + moved @ own @ pulled, -moved @ own], [-own @ pulled, own]])
