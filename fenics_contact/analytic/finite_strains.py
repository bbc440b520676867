"""Closed forms of bodies in finite strains: a lubricated block, a ring between plates.

The stored energies are those of ``scene.laws.energies``, by their names there.
"""

from __future__ import annotations

from math import gamma, log, pi

from scipy.optimize import brentq

_LOWEST, _HIGHEST = 1e-3, 1e3  # stretches between which a side is free of stress


def lubricated_block(law: str, stretch: float, modulus: float, ratio: float) -> float:
    """Force over undeformed area that presses a block to a stretch in plane strain, > 0.

    Plates without friction press it, and its sides are free: both stretches in the plane are the
    same everywhere.

    Args:
        law: Name of the stored energy.
        stretch: Along the force, below 1.
        modulus: Young's modulus (stress).
        ratio: Poisson's ratio.

    Raises:
        ValueError: No closed form is known of the energy.
    """
    plane = modulus / (1 - ratio**2)
    if law == "St Venant-Kirchhoff":  # S = E/(1 − ν²) (λ² − 1)/2, P = λ S
        return plane * stretch * (1 - stretch**2) / 2
    if law == "Hencky":  # Kirchhoff's stress is E/(1 − ν²) ln λ
        return -plane * log(stretch) / stretch
    if law != "neo-Hookean":
        raise ValueError(f"no closed form of the stored energy '{law}'")
    shear = modulus / (2 * (1 + ratio))
    lame = 2 * shear * ratio / (1 - 2 * ratio)

    def on_side(across: float) -> float:
        return shear * (across - 1 / across) + lame * log(across * stretch) / across

    across = float(brentq(on_side, _LOWEST, _HIGHEST, xtol=1e-15))
    return -(shear * (stretch - 1 / stretch) + lame * log(across * stretch) / stretch)


# Length of the elastica between the points of contact, over the ring's: the lemniscate's constant.
_LEMNISCATE = (2 * pi) ** 1.5 / gamma(0.25) ** 2


def flattened_ring(half_height: float, stiffness: float) -> float:
    """Force of either plate on a thin ring that is flattened between two of them, per thickness.

    It holds once the ring lies on the plates along lines, below a half height of .71778 of its
    radius: what bends is then an elastica without a force along the plates.
    R. Frisch-Fay, Flexible Bars, Butterworths 1962.

    Args:
        half_height: Half of the distance between the plates, to the ring's middle line (length).
        stiffness: E I of a width of 1; in plane strain E t³/12(1 − ν²) (force × length).
    """
    return float(stiffness * (_LEMNISCATE / half_height) ** 2)
