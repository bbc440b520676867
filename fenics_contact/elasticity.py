"""Linear elasticity: the paper's ½ a(v, v) (Section 2.1).

Strains are kept as 3 × 3 tensors for every kinematics, so that one formula
serves all; UFL drops the zeros.
"""

from __future__ import annotations

from typing import Any

import ufl

from fenics_contact.scene import Kinematics


def measure_weight(kinematics: Kinematics, position: Any) -> Any:
    """Factor of every integral: 2πr for a full revolution, else 1."""
    return 2 * ufl.pi * position[0] if kinematics == "axisymmetric" else ufl.as_ufl(1.0)


def strain(displacement: Any, kinematics: Kinematics, position: Any, poissons_ratio: Any) -> Any:
    """Infinitesimal strain, shape (3, 3).

    Out of plane: 0 (plane strain), the value that makes the stress vanish
    (plane stress), u_r / r (axisymmetric).
    """
    e = ufl.sym(ufl.grad(displacement))
    if kinematics == "3D":
        return e
    out_of_plane: Any = 0
    if kinematics == "plane stress":
        out_of_plane = -poissons_ratio / (1 - poissons_ratio) * (e[0, 0] + e[1, 1])
    elif kinematics == "axisymmetric":
        out_of_plane = displacement[0] / position[0]
    return ufl.as_tensor([[e[0, 0], e[0, 1], 0], [e[1, 0], e[1, 1], 0], [0, 0, out_of_plane]])


def stress(strain_tensor: Any, youngs_modulus: Any, poissons_ratio: Any) -> Any:
    """Hooke's law σ = λ tr(e) 1 + 2 G e, shape (3, 3), unit stress."""
    shear_modulus = youngs_modulus / (2 * (1 + poissons_ratio))
    lame_lambda = (
        youngs_modulus * poissons_ratio / ((1 + poissons_ratio) * (1 - 2 * poissons_ratio))
    )
    return lame_lambda * ufl.tr(strain_tensor) * ufl.Identity(3) + 2 * shear_modulus * strain_tensor


def strain_energy(
    displacement: Any,
    kinematics: Kinematics,
    position: Any,
    youngs_modulus: Any,
    poissons_ratio: Any,
    weight: Any,
    measure: Any,
) -> Any:
    """½ a(v, v) = ½ ∫ σ : e (paper, (2.1))."""
    e = strain(displacement, kinematics, position, poissons_ratio)
    return 0.5 * weight * ufl.inner(stress(e, youngs_modulus, poissons_ratio), e) * measure
