"""Complex modes of s² M + s C + K with a K that is not symmetric, and where they begin to flutter.

With Rayleigh's damping C = α M + β K the modes are those of K φ = κ M φ, and s² + (α + β κ) s + κ =
0. A κ that is not real makes a pair of modes of one frequency, of which one grows: flutter. A κ < 0
makes one that grows without swinging: divergence.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, eigs

from fenics_contact.common.arrays import Array

Complex = NDArray[np.complex128]
Times = Callable[[Array], Array]

# Of eigenvalues: beyond what meshes are worth, and within what round-off allows.
_ACCURATE = 1e-10
# Of 1/κ over the largest one: of nodes that have no mass.
_MASSLESS = 1e-13
# Unknowns up to which all modes are found.
_FEW = 40
# Of a growth rate over ω: less is round-off, as of two equal frequencies.
GROWS = 1e-6


def lowest_squares(
    size: int, number: int, times_mass: Times, solve: Times
) -> tuple[Complex, Complex]:
    """κ and φ of K φ = κ M φ for the smallest |κ|.

    Args:
        size: Number of unknowns.
        number: How many; one more where that would cut a pair.
        times_mass: M u.
        solve: K⁻¹ f.

    Returns:
        κ in the order of |κ|, and the φ as columns; fewer where there are fewer.
    """

    def times(vector: Array) -> Array:
        return solve(times_mass(vector))

    if size <= max(_FEW, 2 * number + 4):
        flexibilities, shapes = np.linalg.eig(np.array([times(unit) for unit in np.eye(size)]).T)
    else:
        count = number + 1
        flexibilities, shapes = eigs(
            LinearOperator((size, size), matvec=times, dtype=np.float64),
            k=count,
            which="LM",
            v0=times(np.random.default_rng(0).normal(size=size)),
            ncv=min(size, max(2 * count + 2, 24)),
            tol=_ACCURATE,
        )
    sizes = np.abs(flexibilities)
    order = np.argsort(-sizes, kind="stable")
    order = order[sizes[order] > _MASSLESS * sizes.max(initial=0.0)]
    squares = 1.0 / flexibilities[order].astype(np.complex128)
    count = min(number, len(squares))
    if count < len(squares) and _is_pair(squares[count - 1], squares[count]):
        count += 1
    return squares[:count], shapes[:, order[:count]].astype(np.complex128)


def _is_pair(one: complex, other: complex) -> bool:
    return bool(one.imag != 0 and abs(one - other.conjugate()) <= 1e-8 * abs(one))


def exponents(squares: Complex, of_mass: float = 0.0, of_stiffness: float = 0.0) -> Complex:
    """Exponents s of each κ: that of the two which swings forward, or else which grows faster.

    Args:
        squares: κ.
        of_mass: α (1/time).
        of_stiffness: β (time).

    Returns:
        Growth rates as real parts, angular frequencies as imaginary ones (1/time).
    """
    half = 0.5 * (of_mass + of_stiffness * squares)
    root = np.sqrt(half**2 - squares)
    one, other = -half + root, -half - root
    swings = np.maximum(np.abs(one.imag), np.abs(other.imag)) > 0
    takes_one = np.where(swings, one.imag >= other.imag, one.real >= other.real)
    return np.where(takes_one, one, other)


def grows(found: Complex) -> bool:
    """Whether some mode does, by more than round-off.

    Args:
        found: As of ``exponents``.
    """
    return bool((found.real > GROWS * np.abs(found)).any())


def first_growth(
    grows_at: Callable[[float], bool], coefficients: Sequence[float], tolerance: float
) -> float | None:
    """The smallest coefficient at which something grows, by bisection behind the first that does.

    Args:
        grows_at: Whether it does at a coefficient.
        coefficients: At which to look first, rising.
        tolerance: To which it is found, absolute.

    Returns:
        The middle of the last interval; the first coefficient where something grows there;
        None where nothing grows at any of them.
    """
    below: float | None = None
    for coefficient in coefficients:
        if grows_at(coefficient):
            break
        below = coefficient
    else:
        return None
    above = coefficient
    if below is None:
        return above
    while above - below > tolerance:
        middle = 0.5 * (below + above)
        if grows_at(middle):
            above = middle
        else:
            below = middle
    return 0.5 * (below + above)
