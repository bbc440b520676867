"""Whether an answer is surely the only one: a sufficient condition, from W and μ alone.

Let two answers differ by x in their forces, and by W x in their gaps. Across the contact their
forces and gaps satisfy x_n (W x)_n ≤ 0 at each point. Along it the friction of a larger bound does
at most so much more work: x_t · (W x)_t ≤ μ |x_n| |(W x)_t|. So there is one answer if

    xᵀ W x > Σ μ |x_n| |(W x)_t|   for all x ≠ 0.

As 2ab ≤ θa² + b²/θ, this holds if W − ½ μ (θ N + Wᵀ T W/θ) is positive definite for some θ > 0,
where N and T pick the rows across and along. The largest eigenvalue of what is subtracted, relative
to W, says by how much coefficients may grow. The condition is sharp for one point. It is far from
sharp on fine meshes: the coefficient that it allows falls with the mesh size.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh, solve_triangular
from scipy.optimize import minimize_scalar
from scipy.sparse.linalg import eigsh

from fenics_contact.common.arrays import Array
from fenics_contact.solve.exact.local_problem import LocalProblem
from fenics_contact.solve.exact.natural_map import NaturalMap
from fenics_contact.solve.exact.scalars import Scalars

# Logarithms of θ are looked for within this, in scaled units.
_WIDEST = 7.0
# Rows up to which all eigenvalues are found.
_SMALL = 60
# Of the result.
_ROUNDING = 1e-6


def surely_unique_up_to(problem: LocalProblem) -> float:
    """How many times as large as they are coefficients may be, so that there is one answer.

    Whatever q is: an answer is surely the only one if this is larger than 1. If it is not, there
    may be others, but need not.

    Args:
        problem: W and the laws. Of a bound by a rule, ``laws.coefficient`` is to be its largest
            slope.

    Returns:
        Infinite without friction that depends on a force; 0 if W is not positive definite, or if
        equations of the scalars alone do not determine them.
    """
    scalars = Scalars(NaturalMap(problem))
    if not scalars.is_exact:
        return 0.0
    compliance = scalars.without()[0]
    friction = _largest_slopes(problem)
    if not friction.any():
        return np.inf
    points, size = problem.points, problem.dimension
    try:
        root = cholesky((compliance + compliance.T) / 2, lower=True)
    except LinAlgError:
        return 0.0
    across = solve_triangular(root, np.eye(points * size)[:, ::size], lower=True)
    along = solve_triangular(root, compliance.T, lower=True).reshape(points * size, points, size)
    across = across * np.sqrt(friction)
    along = (along[:, :, 1:] * np.sqrt(friction)[:, None]).reshape(points * size, -1)
    first, second = across @ across.T / 2, along @ along.T / 2

    def largest(logarithm: float) -> float:
        """The largest eigenvalue with a θ; a convex function of its logarithm."""
        return _largest_eigenvalue(np.exp(logarithm) * first + np.exp(-logarithm) * second)

    found = minimize_scalar(largest, bounds=(-_WIDEST, _WIDEST), options={"xatol": 1e-3})
    return (1 - _ROUNDING) / float(found.fun)


def _largest_eigenvalue(matrix: Array) -> float:
    """Largest eigenvalue of a symmetric matrix, by Lanczos' method if the matrix is large."""
    last = len(matrix) - 1
    if last < _SMALL:
        return float(eigh(matrix, eigvals_only=True, subset_by_index=(last, last))[0])
    start = np.ones(len(matrix))  # so that it gives the same number each time
    return float(eigsh(matrix, 1, which="LA", v0=start, return_eigenvectors=False, tol=1e-8)[0])


def _largest_slopes(problem: LocalProblem) -> Array:
    """Largest slope of the bound of friction in the force, at each point in scaled units."""
    laws = problem.laws
    follows = laws.rubs & ~laws.given
    if laws.fixed_bound is not None:
        follows &= np.isnan(laws.fixed_bound)
    return np.where(follows, laws.coefficient, 0.0)
