"""Displacements of an elastic half-space under a unit force on its surface.

Point forces after J. Boussinesq and V. Cerruti, and line forces in plane strain after A. Flamant
(K. L. Johnson, Contact Mechanics, Cambridge 1985, sections 2.2, 2.3, 3.2 and 3.6).
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array


def boussinesq(points: Array, inward: Array, youngs_modulus: float, poissons_ratio: float) -> Array:
    """Displacement of a half-space under a unit point force on its surface.

    Args:
        points: Relative to the force, shape (points, 3) (length).
        inward: Unit normal into the half-space, along which the force acts, (3,).
        youngs_modulus: E (stress).
        poissons_ratio: ν.

    Returns:
        Displacement over force, shape (points, 3) (Johnson, (3.18)).
    """
    nu = poissons_ratio
    z = points @ inward
    aside = points - np.outer(z, inward)
    rho = np.linalg.norm(points, axis=1)
    shear_modulus = youngs_modulus / (2 * (1 + nu))
    deep = z**2 / rho**3 + 2 * (1 - nu) / rho
    wide = z / rho**3 - (1 - 2 * nu) / (rho * (rho + z))
    return (np.outer(deep, inward) + wide[:, None] * aside) / (4 * np.pi * shear_modulus)


def cerruti(
    points: Array, along: Array, inward: Array, youngs_modulus: float, poissons_ratio: float
) -> Array:
    """Displacement of a half-space under a unit point force along its surface.

    ``along`` is the force's unit vector, at a right angle to ``inward``, (3,); the other arguments
    and shapes are those of ``boussinesq``.

    Returns:
        Displacement over force, shape (points, 3) (Johnson, (3.75)).
    """
    nu = poissons_ratio
    x, z = points @ along, points @ inward
    aside = points - np.outer(z, inward)
    rho = np.linalg.norm(points, axis=1)
    shear_modulus = youngs_modulus / (2 * (1 + nu))
    found = np.outer(1 / rho + (1 - 2 * nu) / (rho + z), along)
    found += (x / rho**3)[:, None] * points
    found += np.outer((1 - 2 * nu) * x / (rho * (rho + z)), inward)
    found -= ((1 - 2 * nu) * x / (rho * (rho + z) ** 2))[:, None] * aside
    return found / (4 * np.pi * shear_modulus)


def flamant(
    points: Array, inward: Array, youngs_modulus: float, poissons_ratio: float, datum: float
) -> Array:
    """Displacement of a half-plane in plane strain under a unit line force on its edge.

    A logarithm needs a datum: it is zero straight below the force, at the given distance.
    The other arguments and shapes are those of ``boussinesq``.

    Returns:
        Displacement over force per thickness, shape (points, 3) (Johnson, (2.19)).
    """
    nu = poissons_ratio
    z = points @ inward
    aside = points - np.outer(z, inward)
    distance = np.linalg.norm(aside, axis=1)
    sideways = aside / np.where(distance > 0, distance, 1.0)[:, None]
    rho = np.hypot(z, distance)
    angle = np.arctan2(distance, z)
    logarithm = np.log(rho / datum)
    sine, cosine = np.sin(angle), np.cos(angle)
    first, second = 2 * (1 - nu**2), (1 - 2 * nu) * (1 + nu)
    radial = -first * cosine * logarithm - second * angle * sine
    around = first * sine * logarithm + 2 * nu * (1 + nu) * sine
    around += second * (sine - angle * cosine)
    deep = radial * cosine - around * sine
    wide = radial * sine + around * cosine
    return (np.outer(deep, inward) + wide[:, None] * sideways) / (np.pi * youngs_modulus)


def flamant_along(
    points: Array,
    along: Array,
    inward: Array,
    youngs_modulus: float,
    poissons_ratio: float,
    datum: float,
) -> Array:
    """Displacement of a half-plane in plane strain under a unit line force along its edge.

    The stress is that of the force into it, turned; what it leaves open is a translation, and
    displacements are zero straight below the force, at the distance of the datum. ``along`` is that
    of ``cerruti``; the other arguments and shapes are those of ``flamant``.

    Returns:
        Displacement over force per thickness, shape (points, 3) (Johnson, section 2.3).
    """
    nu = poissons_ratio
    x, z = points @ along, points @ inward
    rho = np.hypot(x, z)
    cosine, sine = x / rho, z / rho
    from_below = -np.arctan2(x, z)  # angle from the axis of symmetry of the stress
    logarithm = np.log(rho / datum)
    first, second = 2 * (1 - nu**2), (1 - 2 * nu) * (1 + nu)
    radial = -first * cosine * logarithm - second * from_below * sine
    around = first * sine * logarithm + 2 * nu * (1 + nu) * sine
    around += second * (sine - from_below * cosine)
    aside = radial * cosine - around * sine + (1 + nu)
    deep = radial * sine + around * cosine
    return (np.outer(aside, along) + np.outer(deep, inward)) / (np.pi * youngs_modulus)
