"""Line contact with nonlocal friction: averages of a pressure, and the traction in shear.

For bodies whose pressure shear does not change (equal ones, or incompressible on rigid).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
# Gauss points over the kernel's width.
_POINTS = 400


def averaged(pressure: Callable[[Array], Array], radius: float, x: Array) -> Array:
    """(w_ρ ∗ p)(x) on a line, w_ρ ∝ exp(−1 / (1 − (s/ρ)²)) for |s| < ρ.

    Args:
        pressure: Of places, (…,) → (…,) (stress).
        radius: ρ (length).
        x: Where, (points,) (length).
    """
    shares, weights = np.polynomial.legendre.leggauss(_POINTS)
    kernel = weights * np.exp(-1 / (1 - shares**2))
    return np.asarray(pressure(x[:, None] - radius * shares) @ kernel / kernel.sum())


def sheared_traction(
    bound: Callable[[Array], Array], width: float, shear: float, cells: int = 800
) -> tuple[Array, Array, Flags]:
    """Traction of a line contact that is pressed first, and then sheared by a force that grows.

    Where it sticks, both surfaces have moved by the same, ∫ ln|x − s| q(s) ds = constant; elsewhere
    q is the bound (K. L. Johnson, Contact Mechanics, 1985, section 7.2, with a bound of any kind).

    Args:
        bound: Of places, > 0 within ``width`` (stress).
        width: Half of the width on which there may be traction (length).
        shear: Force per thickness, less than ∫ of the bound.
        cells: Of constant traction.

    Returns:
        Places, tractions there, and which of them stick.
    """
    ends = np.linspace(-width, width, cells + 1)
    x = 0.5 * (ends[1:] + ends[:-1])
    size, limit = ends[1] - ends[0], bound(x)
    apart = (x[:, None] - ends[None, :]) / width
    primitive = apart * (np.log(np.abs(apart)) - 1)
    moved = primitive[:, 1:] - primitive[:, :-1]  # −∫ ln over each cell, of a unit traction
    sticks = np.ones(cells, dtype=bool)
    while True:
        inner = np.flatnonzero(sticks)
        slipped = np.where(sticks, 0.0, limit)
        matrix = np.ones((len(inner) + 1, len(inner) + 1))
        matrix[:-1, :-1] = moved[np.ix_(inner, inner)]
        matrix[-1, -1] = 0.0
        right = np.append(-(moved @ slipped)[inner], shear / size - slipped.sum())
        traction = slipped.copy()
        traction[inner] = np.linalg.solve(matrix, right)[:-1]
        beyond = sticks & (traction > limit)
        if not beyond.any():
            return x, traction, sticks
        sticks &= ~beyond
