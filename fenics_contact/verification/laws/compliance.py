"""Friction by compliance, t = c_t d^m_t where p = c d^m, on surfaces whose depth is known."""

from __future__ import annotations

from collections.abc import Iterator
from math import gamma, pi, sqrt

from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.laws.stiff_block import LENGTH, block_of, stiff_block, stiff_pad

_ACROSS, _POWER = 4e3, 2.0
_ALONG, _OWN_POWER = 800.0, 1.5
_DEPTH, _RADIUS = 0.01, 0.5
_LAWS = {
    "normal_law": {"kind": "normal compliance", "coefficient": _ACROSS, "exponent": _POWER},
    "friction_law": {"kind": "compliance", "coefficient": _ALONG, "exponent": _OWN_POWER},
}


def parabola_integral(power: float, radius: float = _RADIUS, depth: float = _DEPTH) -> float:
    """∫ ⟨d − x²/(2R)⟩^m dx over a line (length^(m + 1)).

    Args:
        power: The exponent m.
        radius: R (length).
        depth: The depth d in the middle (length).
    """
    half_width = sqrt(2 * radius * depth)
    shape = sqrt(pi) * gamma(power + 1) / gamma(power + 1.5)
    return float(depth**power * half_width * shape)


def _uniform(quick: bool) -> Iterator[Finding]:
    result = solved(stiff_block(_DEPTH, (_DEPTH,), _LAWS), block_of(4))
    normal, along = _ACROSS * _DEPTH**_POWER, _ALONG * _DEPTH**_OWN_POWER
    yield of_quantity(result, "normal_force", LENGTH * normal, 1e-3, ", uniform depth")
    yield of_quantity(result, "friction_force", LENGTH * along, 1e-3, ", uniform depth")


def _parabola(quick: bool) -> Iterator[Finding]:
    obstacle = Obstacle(
        "parabola",
        radius=_RADIUS,
        indentation=_DEPTH,
        position=(0, 0.2),
        displacement=(_DEPTH, 0),
    )
    result = solved(stiff_pad({"obstacle": obstacle, **_LAWS}), block_of(100 if quick else 400))
    normal = _ACROSS * parabola_integral(_POWER)
    along = _ALONG * parabola_integral(_OWN_POWER)
    yield of_quantity(result, "normal_force", normal, 1e-3, ", parabola")
    yield of_quantity(result, "friction_force", along, 1e-3, ", parabola")


def _both(quick: bool) -> Iterator[Finding]:
    yield from _uniform(quick)
    yield from _parabola(quick)


CASES: tuple[Case, ...] = (
    Case(
        "compliance",
        "rough surfaces that give way, friction by a power of the depth",
        "Oden and Martins 1985, integrated over a uniform depth and over a parabola",
        _both,
    ),
)
