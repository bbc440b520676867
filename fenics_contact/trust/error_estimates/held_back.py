"""Share of a body's energy that exists because its mesh is too stiff.

A thin body shears where its elements cannot bend: it is much too stiff under given forces, and its
local errors are as large as the solution. Forces that stand for these move it by the share s of
what it has moved, a(δ, u) / a(u, u), which is only the first step to the answer of the space with
the bubbles. Along the solution's own shape each further step is that share of the one before, so
that all of them make 1/(1 - s) of the first one, as Ritz's method with that shape says.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.table import QuantityValue
from fenics_contact.solve.newton.solution import Solution

TOO_STIFF = (
    "What the mesh changes has no error bar: the mesh makes more of the stiffness than the bodies, "
    "as where thin parts bend in few cells of degree 1. Take degree 2, or more cells across what "
    "is thin."
)
# The mesh then makes half of the stiffness: what is estimated by small errors does not hold.
_MOST = 0.5
# Of the largest product of forces and displacements at a node: energy of a body that only moves.
_NONE = 1e-9


# Of its size: what the first step changes a quantity by that statics alone decide.
_DECIDED = 1e-6


class HeldBack:
    """Share of a solution's energy due to its mesh, by forces that represent local errors.

    Args:
        problem: The model.
        solution: Its solution.
        before: Displacement that these forces change, (nodes, components) (length).

    Attributes:
        share: Of the stiffness, along the solution's own shape, what the mesh makes.
    """

    def __init__(self, problem: Problem, solution: Solution, before: Array) -> None:
        self._comm, self._before = problem.comm, before
        self._owned = slice(0, problem.spaces.owned_nodes)
        self._force = solution.internal_force[self._owned]
        products = self._force * solution.displacement[self._owned]
        energy, sizes = total(self._comm, np.array([products.sum(), np.abs(products).sum()]))
        self._energy = energy if energy > _NONE * sizes else np.inf
        self.share = 0.0

    def look(self, changed: Solution) -> None:
        """Find the share from the solution under these forces as well; collective."""
        moved = (changed.displacement - self._before)[self._owned]
        self.share = total(self._comm, float(np.sum(self._force * moved))) / self._energy

    @property
    def is_too_stiff(self) -> bool:
        """Whether the mesh makes more of the stiffness than the body."""
        return self.share > _MOST

    def hides(self, change: float, value: QuantityValue) -> bool:
        """Whether it is too stiff to tell the error of a quantity.

        Args:
            change: What local errors change it by.
            value: It itself.
        """
        return self.is_too_stiff and change > _DECIDED * float(np.linalg.norm(value))

    @property
    def all_steps(self) -> float:
        """Sum of all steps to the answer over the first one.

        Of a mesh that is too stiff no more is said than of one that nearly is.
        """
        return 1 / (1 - min(max(self.share, 0.0), _MOST))
