"""The body's elasticities as UFL coefficients, from the scene's materials.

Values of the scene's materials at points of the body, and as UFL coefficients. Numbers become
constants where one material fills the body, else functions on cells; what varies in space is
interpolated in each cell, between points inside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from dolfinx import fem

from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elasticity import Anisotropic, Isotropic, Law
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.thermal.point_temperatures import PointTemperatures
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import (
    largest,
    of_every_rank,
    raise_together,
    smallest,
    total,
)
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.body import NEARLY_INCOMPRESSIBLE, Material, ModulusTable
from fenics_contact.scene.values import Value


@dataclass(frozen=True)
class Moduli:
    """Stiffnesses of a body, or of two that touch each other, for estimates.

    Attributes:
        reference: Young's modulus, or the largest eigenvalue of E_ijkl (stress).
        poissons_ratio: −1 where there is none.
        is_plane_stress: Whether the thickness is free.
        opposite: Those of a second body.
    """

    reference: float
    poissons_ratio: float
    is_plane_stress: bool
    opposite: Moduli | None = None

    def against(self, other: Moduli) -> Moduli:
        """Two bodies that touch each other: their compliances add up."""
        return replace(self, opposite=other)

    @cached_property
    def combined(self) -> float:
        """``reference`` of both bodies (stress)."""
        return self._with(self.reference, "combined")

    @cached_property
    def plane_strain(self) -> float:
        """E/(1 − ν²), or E in plane stress; of two bodies E* (K. L. Johnson, (4.1)) (stress)."""
        own = self.reference
        if not self.is_plane_stress and self.poissons_ratio > -1:
            own /= 1 - self.poissons_ratio**2
        return self._with(own, "plane_strain")

    @cached_property
    def confined(self) -> float:
        """E (1 − ν) / ((1 + ν)(1 − 2ν)): stress over uniaxial strain (stress)."""
        own, nu = self.reference, self.poissons_ratio
        if not self.is_plane_stress and nu > -1:
            own *= max((1 - nu) / ((1 + nu) * (1 - 2 * nu)), 1.0)
        return self._with(own, "confined")

    def _with(self, own: float, name: str) -> float:
        if self.opposite is None:
            return own
        return 1 / (1 / own + 1 / float(getattr(self.opposite, name)))


class MaterialPoints:
    """The points of a discontinuous space, and which material each is of; collective.

    Attributes:
        space: Constants in each cell; or, where a value varies, of a degree that energies keep up
            with. Its nodes lie inside the cells, so that a jump between cells stays one.
        owner: Number of the material at each of its points.

    Args:
        materials: Of the scene.
        spaces: Of the body.
        varies: Whether any of the values is a function of position.

    Raises:
        InputError: A cell has no material, or two.
    """

    def __init__(self, materials: Sequence[Material], spaces: Spaces, varies: bool) -> None:
        self._spaces, self._materials = spaces, materials
        self._keys = [
            f"material[{i}]" if len(materials) > 1 else "material" for i in range(len(materials))
        ]
        mesh, degree = spaces.body.mesh, 0
        if varies:
            degree = spaces.degree - (0 if compat.is_tensor_cell(mesh) else 1)
        self.space = fem.functionspace(mesh, compat.interior_element(mesh, degree))
        self._points = self.space.tabulate_dof_coordinates().T
        self.owner = self._find_owners()

    def _find_owners(self) -> Integers:
        """Number of the material at each point; every cell must have exactly one."""
        body, comm = self._spaces.body, self._spaces.comm
        index_map = body.mesh.topology.index_map(body.dimension)
        owner = np.full(index_map.size_local + index_map.num_ghosts, -1)
        error = None
        for number, (key, material) in enumerate(zip(self._keys, self._materials, strict=True)):
            cells: AnyIntegers | slice = slice(None)
            if material.on:
                group = body.group(material.on, f"{key}.on")
                if group.dimension != body.dimension:
                    raise InputError(f"{key}.on = '{material.on}': must be a part of the body")
                cells = body.entities(group)
            if (owner[cells] >= 0).any():
                error = InputError(
                    f"{key}.on = '{material.on}': shares cells with another material"
                )
            owner[cells] = number
        raise_together(comm, error)
        if (owner < 0).any():
            error = InputError("material: some cells of the body have none; give each its own")
        raise_together(comm, error)
        owner_of_point = np.empty(self._points.shape[1], dtype=np.int64)
        owner_of_point[self.space.dofmap.list] = owner[:, None]
        return owner_of_point

    def owners(self, group: Group | None) -> list[int]:
        """Return the numbers of the materials that some cells have; collective.

        Args:
            group: The cells; None for those of the whole body.
        """
        if group is None:
            return list(range(len(self._materials)))
        points = self.space.dofmap.list[self._spaces.body.entities(group)]
        mine = set(np.unique(self.owner[points]).tolist())
        return sorted(set().union(*of_every_rank(self._spaces.comm, mine)))

    def evaluate(
        self,
        name: str,
        values: Sequence[Value | ModulusTable],
        temperature: Array | None = None,
    ) -> Array:
        """One coefficient at all points: value i where material i is; collective.

        Args:
            name: Of the coefficient.
            values: Of the materials.
            temperature: At all points, of values that follow it (temperature).

        Raises:
            InputError: A function fails, or gives what is not finite.
        """
        found = np.zeros(len(self.owner))
        for number, value in enumerate(values):
            mine = self.owner == number
            if isinstance(value, ModulusTable):
                assert temperature is not None
                found[mine] = value.at(temperature[mine])
                continue
            key = f"{self._keys[number]}.{name}"
            found[mine] = self._spaces.evaluate_at(value, self._points[:, mine], key)
        return found

    def coefficient(self, values: Array, is_kept: bool = True) -> fem.Constant | fem.Function:
        """A constant where the values are all the same, else a function; collective.

        Args:
            values: At all points.
            is_kept: Whether these are the only ones that it will have.
        """
        comm = self._spaces.comm
        least = smallest(comm, values)
        if is_kept and least == largest(comm, values):
            return fem.Constant(self._spaces.body.mesh, least)
        function = fem.Function(self.space)
        function.x.array[:] = values
        return function


_STEEP = " (between the points where it is evaluated, too: a jump needs materials of its own)"


class Elasticities:
    """Values of the scene's materials at the points of a discontinuous space.

    Attributes:
        law: Isotropic or anisotropic Hooke's law with UFL coefficients.
        moduli: Of each connected part, at the first temperatures.
        temperatures: At the points, where moduli follow them; else None.
        largest_poissons_ratio: Of isotropic materials; −1 for a tensor.
    """

    def __init__(self, description: BodyDescription, spaces: Spaces) -> None:
        self.spaces = spaces
        self.materials = description.material
        self._follows = any(material.follows_temperature for material in self.materials)
        varies = any(callable(value) for m in self.materials for value in _values(m))
        self._at = MaterialPoints(self.materials, spaces, varies or self._follows)
        self.temperatures: PointTemperatures | None = None
        self._temperature: Array | None = None
        if self._follows:
            known = self._at.space, self._at.owner, self.materials, spaces
            self.temperatures = PointTemperatures(*known)
            self._temperature = self.temperatures.given(description.temperatures)
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
        young, poisson = self._moduli_at_points()
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
        tables = [m.poissons_ratio for m in self.materials]
        highest = [max(one.values) for one in tables if isinstance(one, ModulusTable)]
        self.largest_poissons_ratio = max([largest(comm, poisson), *highest])
        self._stiffnesses, self._ratios = young, poisson
        return Isotropic(
            self._at.coefficient(young, not self._follows),
            self._at.coefficient(poisson, not self._follows),
        )

    def _moduli_at_points(self) -> tuple[Array, Array]:
        """Young's modulus and Poisson's ratio at the points, at present temperatures."""
        young = [material.modulus for material in self.materials]
        poisson = [material.poissons_ratio for material in self.materials]
        return (
            self._at.evaluate("youngs_modulus", young, self._temperature),  # type: ignore[arg-type]
            self._at.evaluate("poissons_ratio", poisson, self._temperature),  # type: ignore[arg-type]
        )

    def follow(self, temperature: Array) -> bool:
        """Take the moduli at other temperatures; whether they have changed; collective.

        Args:
            temperature: At the points (temperature).
        """
        self._temperature, law = temperature, self.law
        assert isinstance(law, Isotropic)
        has_changed = False
        for function, values in zip(
            (law.youngs_modulus, law.poissons_ratio), self._moduli_at_points(), strict=True
        ):
            assert isinstance(function, fem.Function)
            has_changed |= not np.array_equal(function.x.array, values)
            function.x.array[:] = values
        return bool(total(self.spaces.comm, int(has_changed)) > 0)

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


def _values(material: Material) -> list[Value | ModulusTable | None]:
    """All the values that a material is given by."""
    if material.stiffness is not None:
        return [value for row in material.stiffness for value in row]
    return [material.modulus, material.poissons_ratio]


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
