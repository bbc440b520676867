"""Contact and friction energies: the paper's f on Γ_C and j_ε (Section 2.3).

They see the displacement jump (against a rigid obstacle: the trace), the
normal, parameters, a weight (2πr where axisymmetric) and a measure, and nothing
else: the same functions serve a boundary of the body and a contact submesh.
"""

from __future__ import annotations

from typing import Any

import ufl


def tangential(jump: Any, normal: Any) -> Any:
    """The tangential part u_T = u − (u·n) n of a jump (length)."""
    return jump - ufl.dot(jump, normal) * normal


def smoothed_norm(slip: Any, regularisation_parameter: Any) -> Any:
    """φ_ε(v) = |v|²/(2ε) for |v| ≤ ε, |v| − ε/2 beyond (paper, (2.6); length)."""
    epsilon = regularisation_parameter
    square = ufl.dot(slip, slip)
    sticks = ufl.le(square, epsilon**2)
    # The root is kept away from 0, where its derivative is not a number.
    length = ufl.sqrt(ufl.conditional(sticks, epsilon**2, square))
    return ufl.conditional(sticks, square / (2 * epsilon), length - epsilon / 2)


def friction_energy(
    jump: Any,
    normal: Any,
    friction_bound: Any,
    regularisation_parameter: Any,
    weight: Any,
    measure: Any,
) -> Any:
    """j_ε(v) = ∫ g φ_ε(v_T) (paper, (2.7))."""
    slip = tangential(jump, normal)
    return weight * friction_bound * smoothed_norm(slip, regularisation_parameter) * measure


def prescribed_pressure_energy(
    jump: Any, normal: Any, contact_pressure: Any, weight: Any, measure: Any
) -> Any:
    """∫ p v_n: minus the work of a given contact pressure (paper, (1.8), σ_n = −p)."""
    return weight * contact_pressure * ufl.dot(jump, normal) * measure
