"""Names and formulas of the stored energies of hyperelastic materials, for finite strains.

Of the deformation gradient F: C = FᵀF, I₁ = tr C, I₂ = ½ (tr²C − tr C²), J = det F, E = ½ (C − 1)
and λ_i, the principal stretches; G = E/2(1 + ν) and λ = E ν/(1 + ν)(1 − 2ν) are Lamé's constants.
All agree with Hooke's law in small strains, whatever else they do in large ones.
"""

from __future__ import annotations

from collections.abc import Mapping

NEO_HOOKEAN, MOONEY, YEOH = "neo-Hookean", "Mooney-Rivlin", "Yeoh"
HENCKY, ST_VENANT = "Hencky", "St Venant-Kirchhoff"

#: Name in a scene → formula of the energy over undeformed volume (energy/volume).
FORMULAS: Mapping[str, str] = {
    NEO_HOOKEAN: "G/2 (I₁ − 3) − G ln J + λ/2 ln²J",
    MOONEY: "c10 (I₁ − 3) + c01 (I₂ − 3) − 2 (c10 + 2 c01) ln J + (λ/2 − 2 c01) ln²J",
    YEOH: "c10 (I₁ − 3) + c20 (I₁ − 3)² + c30 (I₁ − 3)³ − 2 c10 ln J + (λ/2 − 4 c20) ln²J",
    HENCKY: "G Σ ln²λ_i + λ/2 ln²J",
    ST_VENANT: "λ/2 tr²E + G E:E",
}


#: Name of those that have constants of their own → names of these, in place of Young's modulus.
CONSTANTS: Mapping[str, tuple[str, ...]] = {MOONEY: ("c10", "c01"), YEOH: ("c10", "c20", "c30")}


def shear_modulus(law: str, constants: Mapping[str, float]) -> float:
    """G in small strains, of an energy with constants of its own (stress).

    Args:
        law: Name of the energy.
        constants: By their names (stress).
    """
    return 2 * (constants["c10"] + (constants["c01"] if law == MOONEY else 0.0))


def names() -> tuple[str, ...]:
    """Names of all energies, in the order in which they are listed."""
    return tuple(FORMULAS)
