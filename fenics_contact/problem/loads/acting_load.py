"""A load that acts on a body: where, with which force, and what a mesh of flat facets misses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.mass import density_of
from fenics_contact.body.materials import MaterialPoints
from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import SymmetryPlane
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.scene.body import Material
from fenics_contact.scene.loading.conditions import Load
from fenics_contact.scene.values import Value

# Of the body's extent: a node lies in a plane of symmetry.
_IN_PLANE = 1e-9


@dataclass(frozen=True, eq=False)
class LoadSite:
    """The body that loads act on, with its masses and its planes of symmetry.

    Attributes:
        discrete: The body.
        materials: Those of the scene, with their densities.
    """

    discrete: DiscreteBody
    materials: tuple[Material, ...]

    @property
    def spaces(self) -> Spaces:
        """Spaces of the body."""
        return self.discrete.spaces

    @property
    def densities(self) -> tuple[Value | None, ...]:
        """Density of each material, None where the scene gives none (mass/volume)."""
        return tuple(material.density for material in self.materials)

    def density(self, group: Group) -> fem.Constant | fem.Function:
        """Density in a group of cells, a coefficient in UFL (mass/volume); collective.

        Raises:
            InputError: A material of these cells has no density.
        """
        return self.discrete.once(
            ("density", group, self.densities),
            lambda: density_of(self.materials, self.spaces, group),
        )

    def share(self, number: int) -> fem.Constant | fem.Function:
        """Coefficient in UFL that is 1 in a material and 0 in all others; collective."""
        points = MaterialPoints(self.materials, self.spaces, varies=False)
        return points.coefficient(np.where(points.owner == number, 1.0, 0.0))

    def planes_at(self, group: Group) -> list[SymmetryPlane]:
        """Planes of symmetry in which nodes of a group lie; collective."""
        spaces = self.spaces
        places = spaces.coordinates[spaces.nodes(group)]
        return [
            plane
            for plane in self.discrete.held.planes
            if total(
                spaces.comm,
                int((abs(places[:, plane.axis] - plane.at) <= _IN_PLANE * spaces.size).sum()),
            )
        ]


@dataclass(frozen=True, eq=False)
class ActingLoad(ABC):
    """A load of a scene, with its force over area or volume in UFL.

    Attributes:
        kind: The key that a scene gives it by, such as ``pressure``; the first of several.
        is_of_volume: Whether it acts inside the body, as a weight does.
        group: What it acts on.
        spaces: Those of the body.
        key: Of the load, for messages.
    """

    kind: ClassVar[str]
    is_of_volume: ClassVar[bool] = False
    group: Group
    spaces: Spaces
    key: str

    @classmethod
    @abstractmethod
    def of(
        cls, load: Load, components: Sequence[Value], key: str, site: LoadSite
    ) -> ActingLoad | None:
        """Return the load of a scene; collective.

        Args:
            load: As the scene gives it.
            components: Those of its value, or their derivatives by a number of it.
            key: Of the load, such as ``load[0]``.
            site: The body.

        Returns:
            None where it is zero everywhere.

        Raises:
            InputError: The body lacks what it acts on, or cannot take it.
        """

    @classmethod
    def place(cls, group: str, key: str, spaces: Spaces) -> Group:
        """Return the group of the mesh that it acts on, by the scene's name.

        Raises:
            InputError: There is none, or it is no boundary (of loads inside the body: no part).
        """
        if not cls.is_of_volume:
            return spaces.body.boundary(group, key)
        found = spaces.body.group(group, key)
        if found.dimension != spaces.body.dimension:
            raise InputError(f"{key} = '{group}': {cls.kind} needs a part of the body")
        return found

    @property
    @abstractmethod
    def force(self) -> Expr:
        """Force over area or volume, a UFL vector."""

    @property
    def measure(self) -> ufl.Measure:
        """Measure of what it acts on."""
        spaces = self.spaces
        return spaces.part(self.group) if self.is_of_volume else spaces.boundary(self.group)

    def work(self, displacement: Expr) -> ufl.Form:
        """Work on a displacement, an integral in UFL (energy)."""
        return self.spaces.weight * ufl.dot(self.force, displacement) * self.measure

    @property
    def is_constant(self) -> bool:
        """Whether the force between the nodes follows from that at nodes."""
        return True

    def as_given(self) -> ActingLoad:
        """Return the load with values as they are between nodes; collective."""
        return self

    def compiled(self) -> fem.Form:
        """Compiled linear form of its work; collective."""
        return form_cache.form(self.work(ufl.TestFunction(self.spaces.displacement_space)))

    def nodal(self) -> Array:
        """Return the nodal forces, (nodes, components); collective (force)."""
        return self.spaces.assemble(self.compiled())

    def nodal_of_units(self, found: dict[Any, list[Array]]) -> Array:
        """Return the nodal forces by those of unit loads that are assembled once; collective.

        Args:
            found: Nodal forces of units of earlier loads on the body; those of this one are added.
        """
        return self.nodal()

    def nodal_by_density(self, number: int, site: LoadSite) -> Array | None:
        """Return the derivative of the nodal forces by the density of a material; collective.

        Args:
            number: Of the material.
            site: The body.

        Returns:
            (nodes, components) (force over density); None of a load that follows from no mass.
        """
        return None

    def acceleration_at(self, place: Array, nodes: AnyIntegers) -> Array | None:
        """Force over mass at a place that is coupled with a boundary; collective.

        Args:
            place: (components,) (length).
            nodes: Of the boundary, on this rank.

        Returns:
            (components,) (length/time²); None of a load that follows from no mass, or acts on other
            parts of the body.
        """
        return None

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """Work that it does more where curves lie outside of facets, but for higher order.

        A surface that lies further out by d has its normal turned by −∇d, is longer by ½ |∇d|²,
        and moves by d ∂v/∂n more. What lies between has a force of its own.
        """
        density = self.missed_density(displacement, sides)
        return self.spaces.weight * density * sides.measure(sides.within(self.group))

    def missed_density(self, displacement: Expr, sides: CurvedSides) -> Expr:
        """Integrand of ``missed_work`` on the facets, in UFL."""
        if self.is_of_volume:
            return sides.offset * ufl.dot(self.force, displacement)
        more = sides.stretch * displacement + sides.further_motion(displacement)
        return ufl.dot(self.force, more)

    def missed(self, sides: CurvedSides) -> Array:
        """Return the nodal forces of ``missed_work``, (nodes, components); collective (force)."""
        test = ufl.TestFunction(self.spaces.displacement_space)
        return self.spaces.assemble(form_cache.form(self.missed_work(test, sides)))
