"""What ``fenics-contact verify squeal`` compares."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fenics_contact.analyses.stability.flutter import exponents, first_growth, grows, lowest_squares
from fenics_contact.analyses.stability.table import Stability
from fenics_contact.common.arrays import Array
from fenics_contact.verification.case import Case, Finding, solved
from fenics_contact.verification.motion.sliding_block import (
    growth_in_time,
    moving_block,
    sliding_block,
)

_CELLS = 8


def _squeal(quick: bool) -> Iterator[Finding]:
    yield from _two_masses()
    found = solved(*sliding_block(_CELLS, Stability(number=16))).stability
    assert found is not None
    rate = max(mode.growth_rate for mode in found.modes)
    for courant in (1.0,) if quick else (1.0, 0.25):
        moved = solved(*moving_block(_CELLS, courant, end=3.25))
        label = f"growth rate of a sliding block, by time stepping at CFL {courant:g}"
        yield Finding(label, growth_in_time(moved, last=0.75), rate, 5e-2)


def _two_masses() -> Iterator[Finding]:
    """k₁ = 2, k₂ = 1, k₁₂ = k₂₁ = .3 and k₃ = 1, of unit masses: when their frequencies merge."""
    critical = (0.3 + (2.0 - 1.0) ** 2 / (4 * 0.3)) / 1.0
    found = first_growth(_grows, [0.1 * number for number in range(21)], 1e-5)
    value = np.nan if found is None else found
    yield Finding("critical coefficient of two masses", value, critical, 1e-3)


def _grows(coefficient: float) -> bool:
    stiffness = np.array([[2.0, 0.3 - coefficient], [0.3, 1.0]])

    def solve(force: Array) -> Array:
        return np.asarray(np.linalg.solve(stiffness, force))

    squares, _ = lowest_squares(2, 2, lambda moved: moved, solve)
    return grows(exponents(squares))


CASES: tuple[Case, ...] = (
    Case(
        "squeal",
        "steady sliding that flutters: two masses, and a block by eigenvalues and in time",
        "frequencies of two masses that merge, (k₁₂ + (k₁ − k₂)²/(4 k₂₁))/k₃; the program's own "
        "motion from the same state",
        _squeal,
    ),
)
