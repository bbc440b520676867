"""Energies of the normal contact: prescribed, penalised (paper, (4.1)), bonded.

Like those of ``friction`` they see the displacement jump, the normal, the gap,
parameters, a weight (2πr where axisymmetric) and a measure, and nothing else.
"""

from __future__ import annotations

from typing import Any

import ufl


def prescribed_pressure_energy(
    jump: Any, normal: Any, contact_pressure: Any, weight: Any, measure: Any
) -> Any:
    """∫ p v_n: minus the work of a given contact pressure (paper, (1.8), σ_n = −p)."""
    return weight * contact_pressure * ufl.dot(jump, normal) * measure


def penetration_energy(
    jump: Any, normal: Any, gap: Any, stiffness: Any, weight: Any, measure: Any
) -> Any:
    """½ ∫ k ((v_n − s)₊)², k = 1/ε₁ or a foundation's stiffness (paper, (4.1))."""
    depth = ufl.dot(jump, normal) - gap
    penetration = ufl.conditional(ufl.gt(depth, 0), depth, 0)
    return 0.5 * weight * stiffness * penetration**2 * measure


def bonded_energy(jump: Any, stiffness: Any, weight: Any, measure: Any) -> Any:
    """½ ∫ k |v|²: glued, along the surface and across it, in pressure and in tension."""
    return 0.5 * weight * stiffness * ufl.dot(jump, jump) * measure
