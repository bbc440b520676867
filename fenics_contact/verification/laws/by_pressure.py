"""A friction coefficient that depends on the pressure, where the pressure is known."""

from __future__ import annotations

from collections.abc import Iterator

from fenics_contact.scene.values import Profile
from fenics_contact.verification.case import Case, Finding, of_quantity, solved
from fenics_contact.verification.laws.stiff_block import LENGTH, block_of, stiff_block

_COEFFICIENT, _HIGH, _SHARE = 0.5, 100.0, 0.4
_LAW = {
    "friction_coefficient": _COEFFICIENT,
    "friction_law": {
        "kind": "pressure dependent",
        "pressures": (0.0, _HIGH),
        "shares": (1.0, _SHARE),
    },
}
_SHIFT = 0.01


def _bound(lowest: float, highest: float) -> float:
    """Mean of μ (1 − (1 − s) p/p_h) p of pressures that vary linearly, up to p_h."""
    mean = (lowest + highest) / 2
    square = (lowest**2 + lowest * highest + highest**2) / 3
    return _COEFFICIENT * (mean - (1 - _SHARE) * square / _HIGH)


def _cases(quick: bool) -> Iterator[Finding]:
    body, stiffness = block_of(20 if quick else 60), 1e3
    depth = 0.06
    springs = {"foundation_stiffness": stiffness, **_LAW}
    result = solved(stiff_block(depth, (_SHIFT,), springs), body)
    pressed = stiffness * depth
    expected = LENGTH * _bound(pressed, pressed)
    yield of_quantity(result, "friction_force", expected, 1e-3, ", uniform pressure")
    given = Profile(along="x", at=(-LENGTH / 2, LENGTH / 2), values=(0.0, _HIGH))
    result = solved(stiff_block(0.0, (_SHIFT,), {"pressure": given, **_LAW}), body)
    expected = LENGTH * _bound(0.0, _HIGH)
    yield of_quantity(result, "friction_force", expected, 1e-3, ", pressure that is given")


CASES: tuple[Case, ...] = (
    Case(
        "pressure_dependent",
        "a friction coefficient that falls with the pressure",
        "the bound integrated over pressures that are known",
        _cases,
    ),
)
