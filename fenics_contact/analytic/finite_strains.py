"""Closed forms of bodies in finite strains: a lubricated block, a ring between plates.

The stored energies are those of ``scene.laws.energies``, by their names there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import gamma, log, pi

from scipy.optimize import brentq

_LOWEST, _HIGHEST = 1e-3, 1e3  # stretches between which a side is free of stress


def lubricated_block(
    law: str, stretch: float, modulus: float, ratio: float, own: Mapping[str, float] | None = None
) -> float:
    """Force over undeformed area that presses a block to a stretch in plane strain, > 0.

    Plates without friction press it, and its sides are free: both stretches in the plane are the
    same everywhere, and the one across makes the nominal stress vanish on the sides.

    Args:
        law: Name of the stored energy.
        stretch: Along the force, below 1.
        modulus: Young's modulus in small strains (stress).
        ratio: Poisson's ratio.
        own: Constants of the energy's own, by their names (stress); none of most.

    Raises:
        ValueError: No closed form is known of the energy.
    """
    plane = modulus / (1 - ratio**2)
    if law == "St Venant-Kirchhoff":  # S = E/(1 − ν²) (λ² − 1)/2, P = λ S
        return plane * stretch * (1 - stretch**2) / 2
    if law == "Hencky":  # Kirchhoff's stress is E/(1 − ν²) ln λ
        return -plane * log(stretch) / stretch
    lame = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))
    slope = _SLOPES.get(law)
    if slope is None:
        raise ValueError(f"no closed form of the stored energy '{law}'")
    given = own or {"c10": modulus / (4 * (1 + ratio))}

    def nominal(along: float, across: float) -> float:
        """∂Ψ/∂λ along one direction in the plane, with the other stretch across it."""
        shape, by_volume, of_squares = slope(along, across, given)
        volume = log(along * across)
        return shape + (by_volume + 2 * (lame / 2 + of_squares) * volume) / along

    across = float(brentq(lambda side: nominal(side, stretch), _LOWEST, _HIGHEST, xtol=1e-15))
    return -nominal(stretch, across)


def _neo_hookean(along: float, across: float, own: Mapping[str, float]) -> _Slope:
    return 2 * own["c10"] * along, -2 * own["c10"], 0.0


def _mooney_rivlin(along: float, across: float, own: Mapping[str, float]) -> _Slope:
    c10, c01 = own["c10"], own["c01"]
    return 2 * along * (c10 + c01 * (1 + across**2)), -2 * (c10 + 2 * c01), -2 * c01


def _yeoh(along: float, across: float, own: Mapping[str, float]) -> _Slope:
    c10, c20, c30 = own["c10"], own["c20"], own["c30"]
    stretched = along**2 + across**2 - 2
    shape = 2 * along * (c10 + 2 * c20 * stretched + 3 * c30 * stretched**2)
    return shape, -2 * c10, -4 * c20


# Of ∂Ψ/∂λ: the part of the invariants, and the factors of ln J and, beside λ/2, of ln²J in Ψ.
_Slope = tuple[float, float, float]
_SLOPES: Mapping[str, Callable[[float, float, Mapping[str, float]], _Slope]] = {
    "neo-Hookean": _neo_hookean,
    "Mooney-Rivlin": _mooney_rivlin,
    "Yeoh": _yeoh,
}

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
