"""Stored energies Ψ(F) of compressible isotropic materials, in UFL, for models in plane strain.

Each is written with Lamé's constants G and λ, and agrees with Hooke's law in small strains. Tensors
are 3 × 3, as in linear elasticity; out of the plane the stretch is 1.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import ufl
from ufl.core.expr import Expr

from fenics_contact.body.elasticity import Isotropic
from fenics_contact.scene.laws import energies

# Of (d/m)² in ``_squared_difference_of_logarithms``: below it a power series takes the place of the
# formula, whose derivatives are 0/0 at equal stretches. Nine terms leave 1e-18 of it.
_SERIES, _TERMS = 0.01, 9


def deformation_gradient(displacement: Expr) -> Expr:
    """F = 1 + ∇u of a displacement in the plane, (3, 3); the stretch across the plane is 1."""
    slopes = ufl.grad(displacement)
    return ufl.as_tensor(
        [[1 + slopes[0, 0], slopes[0, 1], 0], [slopes[1, 0], 1 + slopes[1, 1], 0], [0, 0, 1]]
    )


@dataclass(frozen=True)
class Constants:
    """Constants of a stored energy.

    Attributes:
        shear: G (stress).
        lame_lambda: λ (stress).
        own: Those that the scene gives, by their names (stress).
    """

    shear: Expr
    lame_lambda: Expr
    own: Mapping[str, float]


def stored_energy(name: str, gradient: Expr, law: Isotropic, own: Mapping[str, float]) -> Expr:
    """Ψ(F) over undeformed volume (energy/volume).

    Args:
        name: Of the energy, as in a scene.
        gradient: F, (3, 3).
        law: Hooke's law that it has in small strains.
        own: Constants of the energy's own, by their names (stress); mostly none.
    """
    shear = ufl.as_ufl(law.shear_modulus)
    lame_lambda = ufl.as_ufl(law.bulk_modulus - 2 * law.shear_modulus / 3)
    return ENERGIES[name](gradient, Constants(shear, lame_lambda, own))


def _neo_hookean(gradient: Expr, of: Constants) -> Expr:
    logarithm = ufl.ln(ufl.det(gradient))
    first = ufl.inner(gradient, gradient)
    return of.shear / 2 * (first - 3) - of.shear * logarithm + of.lame_lambda / 2 * logarithm**2


def _mooney_rivlin(gradient: Expr, of: Constants) -> Expr:
    c10, c01 = of.own["c10"], of.own["c01"]
    right = gradient.T * gradient
    first, logarithm = ufl.tr(right), ufl.ln(ufl.det(gradient))
    second = 0.5 * (first**2 - ufl.inner(right, right))
    volumetric = (of.lame_lambda / 2 - 2 * c01) * logarithm**2
    return c10 * (first - 3) + c01 * (second - 3) - 2 * (c10 + 2 * c01) * logarithm + volumetric


def _yeoh(gradient: Expr, of: Constants) -> Expr:
    c10, c20, c30 = of.own["c10"], of.own["c20"], of.own["c30"]
    stretched, logarithm = ufl.inner(gradient, gradient) - 3, ufl.ln(ufl.det(gradient))
    volumetric = (of.lame_lambda / 2 - 4 * c20) * logarithm**2
    powers = c10 * stretched + c20 * stretched**2 + c30 * stretched**3
    return powers - 2 * c10 * logarithm + volumetric


def _st_venant_kirchhoff(gradient: Expr, of: Constants) -> Expr:
    strain = 0.5 * (gradient.T * gradient - ufl.Identity(3))
    return of.lame_lambda / 2 * ufl.tr(strain) ** 2 + of.shear * ufl.inner(strain, strain)


def _hencky(gradient: Expr, of: Constants) -> Expr:
    """Σ ln²λ_i = ½ (ln λ₁ + ln λ₂)² + ½ (ln λ₁ − ln λ₂)² in the plane, where λ₃ = 1."""
    logarithm = ufl.ln(ufl.det(gradient))
    squares = 0.5 * logarithm**2 + 0.5 * _squared_difference_of_logarithms(gradient)
    return of.shear * squares + of.lame_lambda / 2 * logarithm**2


def _squared_difference_of_logarithms(gradient: Expr) -> Expr:
    """(ln λ₁ − ln λ₂)² of the stretches in the plane, also at equal ones.

    With the mean m of the eigenvalues λ² of FᵀF in the plane, and half their difference d, it is
    artanh²(d/m), a power series in (d/m)².
    """
    right = gradient.T * gradient
    mean = 0.5 * (right[0, 0] + right[1, 1])
    half = 0.5 * (right[0, 0] - right[1, 1])
    square = (half**2 + right[0, 1] ** 2) / mean**2
    series, factor = ufl.as_ufl(0.0), 0.0
    for power in range(1, _TERMS + 1):
        factor += 1 / (2 * power - 1)
        series += factor / power * square**power
    ratio = ufl.sqrt(ufl.conditional(ufl.lt(square, _SERIES), _SERIES, square))
    artanh = 0.5 * ufl.ln((1 + ratio) / (1 - ratio))
    return ufl.conditional(ufl.lt(square, _SERIES), series, artanh**2)


#: Name in a scene → Ψ of F and constants.
ENERGIES: Mapping[str, Callable[[Expr, Constants], Expr]] = {
    energies.NEO_HOOKEAN: _neo_hookean,
    energies.MOONEY: _mooney_rivlin,
    energies.YEOH: _yeoh,
    energies.HENCKY: _hencky,
    energies.ST_VENANT: _st_venant_kirchhoff,
}
