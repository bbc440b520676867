"""Linear elasticity: the paper's ½ a(v, v) (Section 2.1).

Strains are kept as 3 × 3 tensors for every kinematics, so that one formula
serves all; UFL drops the zeros.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

import ufl
from ufl.core.expr import Expr

from fenics_contact.scene.values import VOIGT, Kinematics

Coefficient: TypeAlias = Expr | float


class Law(Protocol):
    """Hooke's law of a material."""

    def stress(self, strain_tensor: Expr) -> Expr:
        """Cauchy stress (3, 3) of a strain (3, 3)."""

    def thickness_strain(self, xx: Expr, yy: Expr, xy: Expr) -> Expr:
        """The e_zz that makes σ_zz vanish (plane stress), from the strains in the plane."""

    def wave_modulus(self, is_plane_stress: bool) -> Expr:
        """ρ c², of the fastest plane wave along an axis."""

    def with_values(self, value_of: Callable[[Coefficient], Coefficient]) -> Law:
        """The law with other things, such as numbers, in place of its coefficients."""


@dataclass(frozen=True)
class Isotropic:
    """σ = λ tr(e) 1 + 2 G e, with UFL coefficients.

    Attributes:
        youngs_modulus: E (stress).
        poissons_ratio: ν.
    """

    youngs_modulus: Coefficient
    poissons_ratio: Coefficient

    @property
    def shear_modulus(self) -> Coefficient:
        """G = E / (2 (1 + ν))."""
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))

    @property
    def bulk_modulus(self) -> Coefficient:
        """K = E / (3 (1 − 2ν))."""
        return self.youngs_modulus / (3 * (1 - 2 * self.poissons_ratio))

    def stress(self, strain_tensor: Expr) -> Expr:
        """Cauchy stress (3, 3) of a strain (3, 3)."""
        lame_lambda = self.bulk_modulus - 2 * self.shear_modulus / 3
        volumetric = lame_lambda * ufl.tr(strain_tensor) * ufl.Identity(3)
        return volumetric + 2 * self.shear_modulus * strain_tensor

    def deviatoric_stress(self, strain_tensor: Expr) -> Expr:
        """2 G (e − tr(e)/3 1), shape (3, 3): the part that no volume change makes."""
        mean = ufl.tr(strain_tensor) / 3 * ufl.Identity(3)
        return 2 * self.shear_modulus * (strain_tensor - mean)

    def thickness_strain(self, xx: Expr, yy: Expr, xy: Expr) -> Expr:
        """−ν/(1−ν) (e_xx + e_yy)."""
        return -self.poissons_ratio / (1 - self.poissons_ratio) * (xx + yy)

    def wave_modulus(self, is_plane_stress: bool) -> Expr:
        """λ + 2 G, in plane stress E/(1 − ν²)."""
        if is_plane_stress:
            return ufl.as_ufl(self.youngs_modulus / (1 - self.poissons_ratio**2))
        return ufl.as_ufl(self.bulk_modulus + 4 * self.shear_modulus / 3)

    def with_values(self, value_of: Callable[[Coefficient], Coefficient]) -> Isotropic:
        """The law with its coefficients replaced by a function of them."""
        return Isotropic(value_of(self.youngs_modulus), value_of(self.poissons_ratio))


@dataclass(frozen=True)
class Anisotropic:
    """σ_ij = E_ijkl e_kl (paper, (1.1)).

    Attributes:
        entries: (row, column) of the 6 × 6 matrix → UFL coefficient; zeros are left out.
    """

    entries: dict[tuple[int, int], Coefficient]

    def stress(self, strain_tensor: Expr) -> Expr:
        """Cauchy stress (3, 3) of a strain (3, 3)."""
        components: list[Coefficient] = [0] * 6
        for (row, column), entry in self.entries.items():
            i, j = VOIGT[column]
            factor = 1 if i == j else 2  # e_ij and e_ji both count
            components[row] += factor * entry * strain_tensor[i, j]
        xx, yy, zz, yz, xz, xy = components
        return ufl.as_tensor([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def thickness_strain(self, xx: Expr, yy: Expr, xy: Expr) -> Expr:
        """−(E_zzxx e_xx + E_zzyy e_yy + 2 E_zzxy e_xy) / E_zzzz."""
        entry = self.entries.get
        in_plane = entry((2, 0), 0) * xx + entry((2, 1), 0) * yy + 2 * entry((2, 5), 0) * xy
        return -in_plane / self.entries[2, 2]

    def wave_modulus(self, is_plane_stress: bool) -> Expr:
        """The largest of E_xxxx, E_yyyy and E_zzzz; in plane stress they are a bound."""
        along = [ufl.as_ufl(self.entries[axis, axis]) for axis in range(3)]
        return ufl.max_value(along[0], ufl.max_value(along[1], along[2]))

    def with_values(self, value_of: Callable[[Coefficient], Coefficient]) -> Anisotropic:
        """The law with its coefficients replaced by a function of them."""
        return Anisotropic({place: value_of(entry) for place, entry in self.entries.items()})


def measure_weight(kinematics: Kinematics, position: Expr, thickness: Expr | None = None) -> Expr:
    """Factor of every integral: 2πr for a full revolution, a thickness, or 1."""
    if kinematics == "axisymmetric":
        return 2 * ufl.pi * position[0]
    return ufl.as_ufl(1.0) if thickness is None else thickness


def strain(displacement: Expr, kinematics: Kinematics, position: Expr, law: Law) -> Expr:
    """Infinitesimal strain, shape (3, 3).

    Out of plane: 0 (plane strain), the value that makes the stress vanish
    (plane stress), u_r / r (axisymmetric).
    """
    e = ufl.sym(ufl.grad(displacement))
    if kinematics == "3D":
        return e
    out_of_plane: Coefficient = 0
    if kinematics == "plane stress":
        out_of_plane = law.thickness_strain(e[0, 0], e[1, 1], e[0, 1])
    elif kinematics == "axisymmetric":
        out_of_plane = displacement[0] / position[0]
    return ufl.as_tensor([[e[0, 0], e[0, 1], 0], [e[1, 0], e[1, 1], 0], [0, 0, out_of_plane]])


def strain_energy(
    strain_tensor: Expr, stress_tensor: Expr, weight: Coefficient, measure: ufl.Measure
) -> ufl.Form:
    """½ a(v, v) = ½ ∫ σ : e (paper, (2.1))."""
    return 0.5 * weight * ufl.inner(stress_tensor, strain_tensor) * measure
