"""Mass of the body: (ρ u, v), consistent and lumped."""

from __future__ import annotations

from collections.abc import Sequence

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from scipy.sparse import csr_matrix
from ufl.core.expr import Expr

from fenics_contact.body.materials import MaterialPoints
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import smallest
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.body import Material


class Mass:
    """Density, and the mass matrix of a body; collective.

    Of a full revolution where axisymmetric; of the thickness, or of a unit of it, in the plane.

    Attributes:
        density: ρ, a coefficient in UFL (mass/volume).
        consistent: Compiled bilinear form ∫ ρ u · v (mass).

    Args:
        materials: Of the scene; each must have a density.
        spaces: Of the body.

    Raises:
        InputError: A material has no density, or it is not greater than 0 everywhere.
    """

    def __init__(self, materials: Sequence[Material], spaces: Spaces) -> None:
        self._spaces = spaces
        self._matrix: csr_matrix | None = None  # of this rank's cells
        self.density = density_of(materials, spaces)
        u = ufl.TrialFunction(spaces.displacement_space)
        v = ufl.TestFunction(spaces.displacement_space)
        self.consistent = form_cache.form(self._weighted * ufl.inner(u, v) * self._measure)

    @property
    def _weighted(self) -> Expr:
        return self._spaces.weight * self.density

    @property
    def _degree(self) -> int:
        """Degree of quadrature, exact in undistorted cells."""
        spaces = self._spaces
        varies = isinstance(self.density, fem.Function)
        return spaces.bulk_degree + (spaces.degree if varies else 0)

    @property
    def _measure(self) -> ufl.Measure:
        mesh = self._spaces.body.mesh
        return ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": self._degree})

    def times(self, nodal: Array) -> Array:
        """M u at the nodes of this rank, (nodes, components); collective.

        Args:
            nodal: u likewise (length).
        """
        if self._matrix is None:
            found = csr_matrix(fem.assemble_matrix(self.consistent).to_scipy(ghosted=True))
            # Columns of nodes that only other ranks' cells have come last, and are empty.
            self._matrix = found[:, : nodal.size]
        product = self._matrix @ nodal.reshape(-1)[: self._matrix.shape[1]]
        return self._spaces.summed(product.reshape(-1, self._spaces.components))

    def lumped(self) -> Array:
        """Masses at the nodes of this rank, (nodes,), all > 0; collective.

        Each cell's mass goes to its nodes in the ratio of the diagonal of its consistent matrix (E.
        Hinton, T. Rock and O. C. Zienkiewicz, Earthq. Eng. Struct. Dyn. 4 (1976) 245-249), which
        is the sum of rows where cells are simplices of degree 1.
        """
        spaces = self._spaces
        mesh = spaces.body.mesh
        points = compat.quadrature_points(mesh, self._degree)
        cell = mesh.basix_cell()
        space = fem.functionspace(mesh, basix.ufl.quadrature_element(cell, degree=self._degree))
        at_points = self._weighted * ufl.TestFunction(space) * self._measure
        vector = fem.assemble_vector(form_cache.form(at_points))
        masses = np.asarray(vector.array)[space.dofmap.list]  # ghosts have none
        scalar = basix.ufl.element("Lagrange", cell, spaces.degree)
        shapes = np.asarray(scalar.tabulate(0, points)[0])
        diagonals = masses @ shapes**2
        sums = diagonals.sum(axis=1)
        shares = np.divide(masses.sum(axis=1), sums, out=np.zeros_like(sums), where=sums > 0)
        nodal = np.zeros((len(spaces.coordinates), 1))
        np.add.at(nodal[:, 0], spaces.displacement_space.dofmap.list, diagonals * shares[:, None])
        return spaces.summed(nodal)[:, 0]


def density_of(
    materials: Sequence[Material], spaces: Spaces, group: Group | None = None
) -> fem.Constant | fem.Function:
    """ρ, a coefficient in UFL (mass/volume); collective.

    Args:
        materials: Of the scene; each of the cells' must have a density.
        spaces: Of the body.
        group: Cells; by default those of the whole body.

    Raises:
        InputError: A material has no density, or it is not greater than 0 everywhere.
    """
    values = [material.density for material in materials]
    points = MaterialPoints(materials, spaces, any(callable(value) for value in values))
    needed = points.owners(group)
    for number in needed:
        if values[number] is None:
            key = f"material[{number}]" if len(materials) > 1 else "material"
            raise InputError(
                f"{key}.density is missing: give the mass of a unit of volume, greater than 0"
            )
    found = points.evaluate("density", [1.0 if value is None else value for value in values])
    least = smallest(spaces.comm, found)
    if least <= 0:
        raise InputError(
            f"material.density: its smallest value is {least:g}, but it must be greater than 0"
        )
    return points.coefficient(found)
