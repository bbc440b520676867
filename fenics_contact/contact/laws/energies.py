"""Energies of contact and friction in UFL: a given pressure, and the paper's j_ε (Section 2.3).

They see the displacement jump (against a rigid obstacle: the trace), the
normal, parameters, a weight (2πr where axisymmetric) and a measure, and nothing
else: the same function serves a boundary of the body and a contact submesh.
"""

from __future__ import annotations

from collections.abc import Callable

import ufl
from ufl import Form, Measure
from ufl.core.expr import Expr

# How friction feels a vector along the surface: M s of a slip s, linear and symmetric.
Scaling = Callable[[Expr], Expr]


def as_it_is(vector: Expr) -> Expr:
    """A slip that friction feels alike in all directions."""
    return vector


def prescribed_pressure_energy(
    jump: Expr, normal: Expr, contact_pressure: Expr, weight: Expr | float, measure: Measure
) -> Form:
    """∫ p v_n: minus the work of a given contact pressure (paper, (1.8), σ_n = −p)."""
    return weight * contact_pressure * ufl.dot(jump, normal) * measure


def coulomb_residual(
    test: Expr,
    normal: Expr,
    friction_bound: Expr,
    direction: Expr,
    weight: Expr | float,
    measure: Measure,
    scaled: Scaling = as_it_is,
) -> Form:
    """∫ μ p(w_n) q · M v_T: its derivative couples the bound to the pressure.

    With the direction q of the slip held as a coefficient; with ``primal_dual_residual`` for a
    bound that is held, it makes the tangent of Coulomb's law.

    Args:
        test: Test function of the jump's space.
        normal: Outward unit normal.
        friction_bound: μ p of the jump, by the normal law (stress).
        direction: q, a coefficient.
        weight: Factor of the integral (2πr where axisymmetric).
        measure: Measure of the contact surface.
        scaled: M, how friction feels slip.
    """
    moved = scaled(tangential(test, normal))
    return weight * friction_bound * ufl.dot(direction, moved) * measure


def traction_work(
    traction: Expr, test: Expr, normal: Expr, weight: Expr | float, measure: Measure
) -> Form:
    """∫ τ · v_T: the work of a tangential traction that is held."""
    return weight * ufl.dot(traction, tangential(test, normal)) * measure


def tangential(jump: Expr, normal: Expr) -> Expr:
    """The tangential part u_T = u − (u·n) n of a jump (length)."""
    return jump - ufl.dot(jump, normal) * normal


def smoothed_norm(slip: Expr, regularisation_parameter: Expr) -> Expr:
    """φ_ε(v) = |v|²/(2ε) for |v| ≤ ε, |v| − ε/2 beyond (paper, (2.6); length)."""
    epsilon = regularisation_parameter
    square = ufl.dot(slip, slip)
    inside = square / (2 * epsilon)
    beyond = smoothed_length(slip, epsilon) - epsilon / 2
    return ufl.conditional(ufl.le(square, epsilon**2), inside, beyond)


def smoothed_length(slip: Expr, regularisation_parameter: Expr) -> Expr:
    """max(|v|, ε), by which φ_ε′(v) = v / max(|v|, ε) (paper, (2.8); length)."""
    epsilon = regularisation_parameter
    square = ufl.dot(slip, slip)
    # The root is kept away from 0, where its derivative is not a number.
    return ufl.sqrt(ufl.conditional(ufl.le(square, epsilon**2), epsilon**2, square))


def friction_energy(
    jump: Expr,
    normal: Expr,
    friction_bound: Expr,
    regularisation_parameter: Expr,
    weight: Expr | float,
    measure: Measure,
    scaled: Scaling = as_it_is,
) -> Form:
    """j_ε(v) = ∫ g φ_ε(M v_T) (paper, (2.7), where M = 1).

    Args:
        jump: Displacement jump (length).
        normal: Outward unit normal.
        friction_bound: g (stress).
        regularisation_parameter: ε (length).
        weight: Factor of the integral (2πr where axisymmetric).
        measure: Measure of the contact surface.
        scaled: M, how friction feels slip.
    """
    slip = scaled(tangential(jump, normal))
    return weight * friction_bound * smoothed_norm(slip, regularisation_parameter) * measure


def primal_dual_residual(
    jump: Expr,
    test: Expr,
    normal: Expr,
    friction_bound: Expr,
    regularisation_parameter: Expr,
    direction: Expr,
    length: Expr,
    weight: Expr | float,
    measure: Measure,
    scaled: Scaling = as_it_is,
) -> Form:
    """A form whose derivative in the jump is the primal-dual tangent of j_ε.

    With q = φ_ε′ as an unknown of its own, q max(|M u_T|, ε) = M u_T is linear in q, and
    Newton's method on the pair converges for any ε where that on u alone does not
    (T. F. Chan, G. H. Golub, P. Mulet, SIAM J. Sci. Comput. 20 (1999) 1964-1977).

    Args:
        jump: Displacement jump, the unknown (length).
        test: Test function of the jump's space.
        normal: Outward unit normal.
        friction_bound: g (stress).
        regularisation_parameter: ε (length).
        direction: q, a coefficient with |q| ≤ 1.
        length: max(|M u_T|, ε) at the present state, a coefficient (length).
        weight: Factor of the integral (2πr where axisymmetric).
        measure: Measure of the contact surface.
        scaled: M, how friction feels slip.
    """
    slip, moved = scaled(tangential(jump, normal)), scaled(tangential(test, normal))
    defect = slip - direction * smoothed_length(slip, regularisation_parameter)
    return weight * friction_bound / length * ufl.dot(defect, moved) * measure
