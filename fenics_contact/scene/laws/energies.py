"""Names and formulas of the stored energies of hyperelastic materials, for finite strains.

Of the deformation gradient F: I₁ = tr(FᵀF), J = det F, E = ½ (FᵀF − 1) and λ_i, the principal
stretches; G = E/2(1 + ν) and λ = E ν/(1 + ν)(1 − 2ν) are Lamé's constants. All agree with Hooke's
law in small strains, whatever else they do in large ones.
"""

from __future__ import annotations

from collections.abc import Mapping

NEO_HOOKEAN, HENCKY, ST_VENANT = "neo-Hookean", "Hencky", "St Venant-Kirchhoff"

#: Name in a scene → formula of the energy over undeformed volume (energy/volume).
FORMULAS: Mapping[str, str] = {
    NEO_HOOKEAN: "G/2 (I₁ − 3) − G ln J + λ/2 ln²J",
    HENCKY: "G Σ ln²λ_i + λ/2 ln²J",
    ST_VENANT: "λ/2 tr²E + G E:E",
}


def names() -> tuple[str, ...]:
    """Names of all energies, in the order in which they are listed."""
    return tuple(FORMULAS)
