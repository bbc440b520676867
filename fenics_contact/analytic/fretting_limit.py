"""Where wear by fretting ends: a paraboloid that is rubbed to and fro at a height that stays.

What sticks never wears. Around it wear goes on until the pressure there is gone, so that in the end
the circle that sticks carries all. By the reduction to one dimension the rigid profile is then
x²/R for x < c, and all of the depth d beyond (V. L. Popov, Philosophical Magazine 94 (2014) 2887;
A. V. Dimaki, A. I. Dmitriev, Y. S. Chai, V. L. Popov, Int. J. Solids Struct. 51 (2014) 4215-4220).
Lengths are over the contact radius a₀ = √(R d) of the surface before it wears, ξ = c/a₀.
"""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
from scipy.optimize import brentq

from fenics_contact.common.arrays import Array

# The worn surface begins where the body's own is reached again, which is nearer than this.
_FAR = 1.5


def force_left(stick: float) -> float:
    """Normal force over that before wear, N_∞/N₀ = (3/2) ξ (1 − ξ²/3).

    Args:
        stick: ξ, between 0 and 1.
    """
    return 1.5 * stick * (1 - stick**2 / 3)


def worn_depth(radius: Array, stick: float) -> Array:
    """Depth over d; none where it sticks, and none beyond the worn surface.

    Args:
        radius: From the axis, over a₀.
        stick: ξ, between 0 and 1.
    """
    r = np.maximum(radius, stick)
    profile = (r**2 * np.arcsin(stick / r) - stick * np.sqrt(r**2 - stick**2)) / pi
    profile += 2 / pi * np.arccos(stick / r)
    return np.maximum(profile - r**2 / 2, 0.0) * (radius > stick)


def worn_radius(stick: float) -> float:
    """Radius of the surface that is worn, a_∞/a₀.

    Args:
        stick: ξ, between 0 and 1.
    """

    def depth(r: float) -> float:
        profile = (r**2 * np.arcsin(stick / r) - stick * sqrt(r**2 - stick**2)) / pi
        return float(profile + 2 / pi * np.arccos(stick / r) - r**2 / 2)

    return float(brentq(depth, 1.0, _FAR))
