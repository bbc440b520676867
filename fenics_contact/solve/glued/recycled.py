"""Generalised conjugate residuals that begin with all directions of the solves before.

From one Newton step to the next W changes and S' does not. Of each direction whose product with S'
was found, that with the new tangent costs no back-substitution: so a solve begins by making the
residual as small as a combination of all of them can (S. C. Eisenstat, H. C. Elman and M. H.
Schultz, SIAM J. Numer. Anal. 20 (1983) 345-357, with the subspace kept as by M. L. Parks and
others, SIAM J. Sci. Comput. 28 (2006) 1651-1674). What is soft and of long wave is found once.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import qr, solve_triangular

from fenics_contact.common.arrays import Array

# Directions that are kept, and steps of a solve at the most.
_KEPT, _MOST = 200, 300
# Of a direction's product, which is then a combination of the ones before.
_SAME = 1e-10
# The same of a known direction, which is left out then.
_NEARLY_SAME = 1e-8


class Directions:
    """Directions with their products by S'.

    Args:
        count: Number of jumps.
        multiply: Gives S' w of jumps w.
    """

    def __init__(self, count: int, multiply: Callable[[Array], Array]) -> None:
        self._count, self._multiply = count, multiply
        self._fixed: list[Array] = []
        self._found: list[tuple[Array, Array]] = []

    def free(self, motions: list[Array]) -> None:
        """Take rigid motions of bodies that contact alone holds, whose products are 0."""
        self._fixed = motions

    def add(self, direction: Array) -> Array:
        """S' times the jumps of a new direction, which may have scalars after them; it is kept."""
        product = self._multiply(direction[: self._count])
        self._found = [*self._found[-_KEPT + 1 :], (direction, product)]
        return product

    def of_size(self, size: int) -> tuple[Array, Array]:
        """All directions of a number of unknowns, as columns, and S' times their jumps.

        Args:
            size: Number of unknowns, jumps first.
        """
        nothing = np.zeros(self._count)
        every = [(np.pad(one, (0, size - self._count)), nothing) for one in self._fixed]
        every += [pair for pair in self._found if len(pair[0]) == size]
        columns = np.empty((size, len(every)), order="F")
        products = np.empty((self._count, len(every)), order="F")
        for number, (one, product) in enumerate(every):
            columns[:, number], products[:, number] = one, product
        return columns, products


def solve(
    right: Array,
    left: float,
    directions: Directions,
    product: Callable[[Array, Array], Array],
    nearly_solved: Callable[[Array], Array],
) -> Array | None:
    """Solve with a tangent; None where it does not end.

    Args:
        right: The right-hand side.
        left: Share of its norm that may be left.
        directions: Those of solves before, to which further ones are added.
        product: The tangent times vectors, by S' times their jumps; as columns or one.
        nearly_solved: The preconditioner.
    """
    limit = left * float(np.linalg.norm(right))
    basis = _Basis(len(right))
    rest = basis.begin(right.copy(), *_independent(directions, len(right), product))
    for _ in range(_MOST):
        if not np.isfinite(rest).all():
            return None
        if float(np.linalg.norm(rest)) <= limit:
            return basis.combined()
        way = nearly_solved(rest)
        size = float(np.linalg.norm(way))
        if not 0 < size < np.inf:
            return None
        way /= size
        left_over = basis.add(rest, way, product(way, directions.add(way)))
        if left_over is None:
            return None
        rest = left_over
    return None


def _independent(
    directions: Directions, size: int, product: Callable[[Array, Array], Array]
) -> tuple[Array, Array, Array]:
    """Known directions without those that others say, an orthonormal basis Q of products, and R."""
    columns, bulk = directions.of_size(size)
    products = product(columns, bulk)
    sizes = np.linalg.norm(products, axis=0)
    used = np.flatnonzero((sizes > 0) & (sizes < np.inf))  # what is not a number is neither
    while len(used):
        taken = products[:, used] / sizes[used]
        orthonormal, upper = qr(taken, mode="economic", overwrite_a=True)
        new = np.zeros(len(used), dtype=bool)  # of more than there are unknowns the last are not
        new[: len(upper)] = np.abs(upper.diagonal()) > _NEARLY_SAME
        if new.all():
            return columns[:, used] / sizes[used], orthonormal, upper
        used = used[new]
    return columns[:, used], products[:, used], np.zeros((0, 0))


class _Basis:
    """Directions Z whose products are Q R, Q orthonormal, and the shares of Q in a residual."""

    def __init__(self, size: int) -> None:
        self._known, self._of_known = np.zeros((size, 0)), np.zeros((size, 0))
        self._upper = np.zeros((0, 0))
        self._ways: list[Array] = []
        self._further: list[Array] = []
        self._columns: list[Array] = []
        self._shares: list[float] = []

    def begin(self, rest: Array, known: Array, orthonormal: Array, upper: Array) -> Array:
        """Residual without what known directions take off."""
        self._known, self._of_known, self._upper = known, orthonormal, upper
        shares = np.zeros(orthonormal.shape[1])
        for _ in range(2):
            more = orthonormal.T @ rest
            rest = rest - orthonormal @ more
            shares += more
        self._shares = list(shares)
        return rest

    def add(self, rest: Array, way: Array, product: Array) -> Array | None:
        """Residual without what a further direction takes off; None where it takes nothing."""
        size = float(np.linalg.norm(product))
        column = np.zeros(len(self._shares))
        first = self._of_known.shape[1]
        further = np.array(self._further).reshape(len(self._further), len(rest))
        for _ in range(2):
            old, new = self._of_known.T @ product, further @ product
            product = product - self._of_known @ old - new @ further
            column[:first] += old
            column[first:] += new
        own = float(np.linalg.norm(product))
        if not own > _SAME * size:
            return None
        product /= own
        self._ways.append(way)
        self._further.append(product)
        self._columns.append(np.append(column, own))
        share = float(product @ rest)
        self._shares.append(share)
        return rest - share * product

    def combined(self) -> Array:
        """Combination of all directions that solves the system but for the residual."""
        first, size = self._of_known.shape[1], len(self._shares)
        upper = np.zeros((size, size))
        upper[:first, :first] = self._upper
        for number, column in enumerate(self._columns):
            upper[: len(column), first + number] = column
        shares = solve_triangular(upper, np.array(self._shares))
        found = self._known @ shares[:first]
        for share, way in zip(shares[first:], self._ways, strict=True):
            found = found + share * way
        return np.asarray(found)
