"""Derivatives of a formula as exact as the formula: by an imaginary step, without any difference.

W. Squire, G. Trapp, Using complex variables to estimate derivatives of real functions, SIAM Review
40 (1998) 110-112. The formula must be analytic, and made of operations that keep imaginary parts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array

# So small that its square is nothing beside 1, and yet a number like any other.
_STEP = 1e-100


def slope(formula: Callable[[complex], Any], at: float) -> Array:
    """Derivative of a formula, in the shape of its values; 0 where it has no finite value.

    Args:
        formula: Takes a complex number.
        at: Where.

    >>> float(slope(lambda x: 1 / x, 2.0))
    -0.25
    """
    found = np.asarray(formula(complex(at, _STEP)))
    return np.where(np.isfinite(found.real), found.imag, 0.0) / _STEP
