"""The cells of a material that have a temperature, and their strain free of stress.

Strains of elements of degree k are of degree k − 1. A thermal strain of a higher degree would find
no displacement whose strain it is, and leave stresses in a free body that oscillate from node to
node: so the temperature is projected to degree k − 1 in each cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.description import HeatedGroup
from fenics_contact.body.elasticity import Law
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.thermal.temperature_field import CellProjection, temperatures_at
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import largest, total
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.temperatures import Temperature


class HeatedPart:
    """Cells of one material that have a temperature; collective.

    Its strain free of stress is (q/L) T D: the scalar q is by how much a length L, the extent of
    the body, would expand freely where it is hottest; T is 1, or how the temperature varies in
    space, at most 1; and D says by how much less it expands along each axis.

    Attributes:
        described: As in the scene.
        spaces: Those of the body.
        cells: Of this rank, owned and ghost.
        scalar: q, a constant in UFL (length).

    Args:
        described: As in the scene.
        materials: Of the scene.
        spaces: Those of the body.
        law: Of the body.

    Raises:
        InputError: The group has no cells, or a function or a file of the temperature fails.
    """

    def __init__(
        self, described: HeatedGroup, materials: tuple[Material, ...], spaces: Spaces, law: Law
    ) -> None:
        self.described, self.spaces, self._law = described, spaces, law
        self.cells = _cells(described, materials[described.material].on, spaces)
        self.scalar = fem.Constant(spaces.body.mesh, 0.0)

    @cached_property
    def is_there(self) -> bool:
        """Whether any rank has such cells; collective when first asked for."""
        return bool(total(self.spaces.comm, len(self.cells)) > 0)

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the part, with the quadrature of the body's stiffness."""
        return self.spaces.over_cells(self.cells, {"quadrature_degree": self.spaces.bulk_degree})

    def stressless_strain(self, scalar: Expr) -> Expr:
        """(q/L) T D, (3, 3), inside the part; in plane stress with the thickness it goes with."""
        varies = self.described.field is not None or self.described.is_found
        field = self._field if varies else 1.0
        return scalar / self.spaces.size * field * self._directions

    @property
    def present_strain(self) -> Expr:
        """Present strain that is free of stress, anywhere in the body: 0 outside of the part."""
        return self.scalar / self.spaces.size * self._field * self._directions

    def strain_beyond(self, rise: Expr) -> Expr:
        """Strain free of stress of a rise that was found, less the present one, (3, 3).

        Of the rise in full, not of its projection; 0 outside of the part.

        Args:
            rise: Temperature less the reference, anywhere in the body (temperature).
        """
        beyond = self._inside * rise - self._field
        return self.scalar / self.spaces.size * beyond * self._directions

    @property
    def strain_across(self) -> Expr:
        """Thermal strain across the plane of a plane model, 0 outside of the part."""
        return self.scalar / self.spaces.size * self._field * float(self.described.axes[2])

    def follow(self, rise: Array) -> None:
        """Take a temperature that was found.

        Args:
            rise: Less the reference, at the nodes of this rank, (nodes,) (temperature).
        """
        self._field.x.array[:] = self._projection.of_nodes(rise).x.array

    def work_on_rise(self, stress: Expr) -> ufl.Form:
        """Work of a stress on the strain of a rise that was found, in the rise's projection.

        Args:
            stress: In UFL, (3, 3).
        """
        rise = ufl.TestFunction(self._projection.space)
        strain = self.scalar / self.spaces.size * rise * self._directions
        return self.spaces.weight * ufl.inner(stress, strain) * self.measure

    def onto_nodes(self, values: Array) -> Array:
        """From values at the dofs of a rise's projection to its nodes: as ``transposed`` there."""
        return self._projection.transposed(values)

    def take_field(self, described: HeatedGroup) -> None:
        """Take a temperature that varies in another way in space; collective.

        Args:
            described: Of the same extent.
        """
        self.described = described
        for name in ("_rise", "largest_rise"):
            self.__dict__.pop(name, None)
        if self._rise is not None:
            self._field.x.array[:] = self._rise.x.array / (self.largest_rise or 1.0)

    @cached_property
    def _projection(self) -> CellProjection:
        return CellProjection(self.spaces, self.cells)

    @cached_property
    def _field(self) -> fem.Function:
        """T of degree k − 1 in each cell, 0 outside of the part; collective when first asked."""
        spaces = self.spaces
        if self._rise is not None:
            found = self._rise.copy()
            found.x.array[:] /= self.largest_rise or 1.0
            return found
        if self.described.is_found:
            return self._projection.of_nodes(np.zeros(len(spaces.coordinates)))
        return self._inside

    @cached_property
    def _inside(self) -> fem.Function:
        """1 in the part, 0 outside of it."""
        found = fem.Function(fem.functionspace(self.spaces.body.mesh, ("DG", 0)))
        found.x.array[self.cells] = 1.0
        return found

    @cached_property
    def _rise(self) -> fem.Function | None:
        """Temperature less the reference, where it varies in space; collective (temperature)."""
        described = self.described
        if described.field is None:
            return None
        key, places = f"temperature[{described.table}]", self._projection.places
        given = temperatures_at(described.field, places, key, self.spaces)
        return self._projection.of_places(given - described.reference)

    @cached_property
    def largest_rise(self) -> float:
        """Largest difference from the reference, where it varies in space; else 1; collective."""
        if self._rise is None:
            return 1.0
        return largest(self.spaces.comm, np.abs(self._rise.x.array))

    def temperatures(self, tables: Sequence[Temperature], places: Array) -> Array:
        """Temperatures at places in the part, once the path is 1; collective (temperature).

        Args:
            tables: Those of the scene.
            places: (places, 3) (length).
        """
        number = self.described.table
        return temperatures_at(tables[number], places, f"temperature[{number}]", self.spaces)

    @property
    def _directions(self) -> Expr:
        """D, whose third axis is that across the plane, or around an axis of revolution."""
        x, y, z = (ufl.as_ufl(float(share)) for share in self.described.axes)
        if self.spaces.kinematics == "plane stress":
            z = self._law.thickness_strain(x, y, ufl.as_ufl(0.0))
        return ufl.diag(ufl.as_vector([x, y, z]))


def _cells(described: HeatedGroup, material: str, spaces: Spaces) -> Integers:
    """Cells of this rank that are of the group and of the material."""
    body = spaces.body
    index_map = body.mesh.topology.index_map(body.dimension)
    cells = np.arange(index_map.size_local + index_map.num_ghosts)
    if material:
        cells = np.intersect1d(cells, body.entities(body.group(material, "material.on")))
    if described.on:
        key = f"temperature[{described.table}].on"
        cells = np.intersect1d(cells, body.entities(body.part(described.on, key)))
    return cells
