"""The body's elasticities as UFL coefficients, from the scene's materials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elasticity import Anisotropic, Isotropic, Law
from fenics_contact.body.material_points import MaterialPoints
from fenics_contact.body.reference_moduli import Moduli
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest
from fenics_contact.scene.material import Material
from fenics_contact.scene.values import Value

NEARLY_INCOMPRESSIBLE = 0.49
_STEEP = " (between the points where it is evaluated, too: a jump needs materials of its own)"


class Elasticities:
    """Values of the scene's materials at the points of a discontinuous space.

    Attributes:
        law: Isotropic or anisotropic Hooke's law with UFL coefficients.
        moduli: Of each connected part.
        largest_poissons_ratio: Of isotropic materials; −1 for a tensor.
    """

    def __init__(self, description: BodyDescription, spaces: Spaces) -> None:
        self.spaces = spaces
        self.materials = description.material
        varies = any(callable(value) for m in self.materials for value in _values(m))
        self._at = MaterialPoints(self.materials, spaces, varies)
        if all(material.stiffness is None for material in description.material):
            self.law: Law = self._isotropic()
        else:
            self.law = self._anisotropic(plane=description.kinematics != "3D")
        self.moduli = self._moduli_of_parts(description.kinematics == "plane stress")

    @property
    def reference_modulus(self) -> float:
        """Largest stiffness in the body (stress): Young's modulus, or eigenvalue of E_ijkl."""
        return max(moduli.reference for moduli in self.moduli)

    def _moduli_of_parts(self, is_plane_stress: bool) -> list[Moduli]:
        """The stiffest of each connected part; collective."""
        parts, comm = self.spaces.parts, self.spaces.comm
        nodes = self.spaces.displacement_space.dofmap.list
        of_point = np.empty(len(self._at.owner), dtype=np.int64)
        of_point[self._at.space.dofmap.list] = parts.of_node[nodes[:, :1]]
        found = []
        for part in range(parts.count):
            mine = of_point == part
            stiffest = largest(comm, self._stiffnesses[mine])
            found.append(Moduli(stiffest, largest(comm, self._ratios[mine]), is_plane_stress))
        return found

    def _where_used(self, values: Array) -> Array:
        """Values at the nodes, and what they amount to at the points of quadrature."""
        points = compat.quadrature_points(self.spaces.body.mesh, self.spaces.bulk_degree)
        table = self._at.space.ufl_element().tabulate(0, points)[0]
        of_cells = np.moveaxis(values[self._at.space.dofmap.list], 1, -1)
        used = np.moveaxis(of_cells @ table.T, -1, 1).reshape(-1, *values.shape[1:])
        return np.concatenate([values, used])

    def _isotropic(self) -> Isotropic:
        comm = self.spaces.comm
        young = self._at.evaluate("youngs_modulus", [m.youngs_modulus for m in self.materials])  # type: ignore[misc]
        poisson = self._at.evaluate("poissons_ratio", [m.poissons_ratio for m in self.materials])  # type: ignore[misc]
        least = smallest(comm, self._where_used(young))
        if least <= 0:
            raise InputError(
                f"material.youngs_modulus: its smallest value is {least:g}, but it must be "
                f"greater than 0{_STEEP}"
            )
        used = self._where_used(poisson)
        least, most = smallest(comm, used), largest(comm, used)
        if not -1 < least <= most < 0.5:
            raise InputError(
                f"material.poissons_ratio: it reaches from {least:g} to {most:g}, but must lie "
                f"between -1 and 0.5{_STEEP}"
            )
        self.largest_poissons_ratio = largest(comm, poisson)
        self._stiffnesses, self._ratios = young, poisson
        return Isotropic(self._at.coefficient(young), self._at.coefficient(poisson))

    def _anisotropic(self, plane: bool) -> Anisotropic:
        matrices = np.zeros((len(self._at.owner), 6, 6))
        given = [_stiffness(material) for material in self.materials]
        for i in range(6):
            for j in range(6):
                entries = [matrix[i][j] for matrix in given]
                matrices[:, i, j] = self._at.evaluate(f"stiffness[{i}][{j}]", entries)
        self._require_elastic(self._where_used(matrices), plane)
        self._require_compressible(matrices)
        self.largest_poissons_ratio = -1.0
        self._stiffnesses = _eigenvalues(matrices)[:, -1]
        self._ratios = np.full(len(matrices), -1.0)
        # An entry that is zero everywhere is left out of the form, not multiplied.
        size = largest(self.spaces.comm, np.abs(matrices).ravel())
        entries_found = {
            (i, j): self._at.coefficient(0.5 * (matrices[:, i, j] + matrices[:, j, i]))
            for i in range(6)
            for j in range(6)
            if largest(self.spaces.comm, np.abs(matrices[:, i, j])) > 1e-14 * size
        }
        return Anisotropic(entries_found)

    def _require_elastic(self, matrices: Array, plane: bool) -> None:
        """The paper's conditions (1.1): symmetry and ellipticity; and no warping out of plane."""
        comm = self.spaces.comm
        size = np.abs(matrices).max(axis=(1, 2))
        skew = np.abs(matrices - matrices.transpose(0, 2, 1)).max(axis=(1, 2))
        if largest(comm, skew / size) > 1e-10:
            raise InputError("material.stiffness: must be symmetric (E_ijkl = E_klij)")
        eigenvalues = _eigenvalues(matrices)
        if smallest(comm, eigenvalues[:, 0] / size) <= 1e-12:
            raise InputError(
                "material.stiffness: must be positive definite, its least eigenvalue is "
                f"{smallest(comm, eigenvalues.ravel()):g}{_STEEP}"
            )
        coupling = np.abs(matrices[:, 3:5][:, :, [0, 1, 2, 5]]).max(axis=(1, 2))
        if plane and largest(comm, coupling / size) > 1e-10:
            raise InputError(
                "material.stiffness: couples in-plane with out-of-plane shear (rows yz, xz), "
                "which no plane or axisymmetric model can hold; use 3D"
            )

    def _require_compressible(self, matrices: Array) -> None:
        """A tensor near incompressibility would lock: only E and ν have a remedy.

        Isotropic materials have one eigenvalue 3K and five 2G, with K from the inverse
        3K/2G = (1 + ν)/(1 − 2ν).
        """
        if self.spaces.kinematics == "plane stress":
            return
        compliances = np.linalg.inv(matrices)[:, :3, :3].sum(axis=(1, 2))  # 1/K
        ratio = 3 / compliances / _eigenvalues(matrices)[:, -2]
        limit = (1 + NEARLY_INCOMPRESSIBLE) / (1 - 2 * NEARLY_INCOMPRESSIBLE)
        if largest(self.spaces.comm, ratio) >= limit:
            raise InputError(
                "material.stiffness: is nearly incompressible (as Poisson's ratio above "
                f"{NEARLY_INCOMPRESSIBLE}), which locks; give youngs_modulus and poissons_ratio, "
                "for all materials"
            )


def _eigenvalues(matrices: Array) -> Array:
    """Eigenvalues of the tensors, ascending; a strain's energy counts each shear twice."""
    double = np.sqrt([1.0, 1, 1, 2, 2, 2])
    return np.linalg.eigvalsh(matrices * double[:, None] * double)


def _values(material: Material) -> list[Value | None]:
    """All the values that a material is given by."""
    if material.stiffness is not None:
        return [value for row in material.stiffness for value in row]
    return [material.youngs_modulus, material.poissons_ratio]


def _stiffness(material: Material) -> Sequence[Sequence[Value]]:
    """A material's 6 × 6 matrix of values; that of an isotropic one by Lamé's formula."""
    if material.stiffness is not None:
        return material.stiffness

    def entry(i: int, j: int) -> Value:
        def value(points: Array) -> Array:
            young, poisson = (
                v(points) if callable(v) else np.full(points.shape[1], v)
                for v in (material.youngs_modulus, material.poissons_ratio)
            )
            shear = young / (2 * (1 + poisson))
            lame = 2 * shear * poisson / (1 - 2 * poisson)
            return (lame if i < 3 and j < 3 else 0.0) + (2 - (i > 2)) * shear * (i == j)

        return value

    return [[entry(i, j) for j in range(6)] for i in range(6)]
