"""Loads by masses: of bodies under an acceleration, such as that of gravity, or that rotate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
import ufl
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.loads.acting_load import LoadSite
from fenics_contact.problem.loads.affine import AffineLoad, Moments
from fenics_contact.scene.loading.conditions import Load


@dataclass(frozen=True, eq=False)
class InertiaLoad(AffineLoad):
    """Density times a force over mass that is linear in the place.

    Attributes:
        density: A coefficient in UFL (mass/volume).
    """

    is_of_volume: ClassVar[bool] = True
    density: Expr

    @classmethod
    def of(cls, load: Load, components: Sequence[Any], key: str, site: LoadSite) -> Self | None:
        """Return the load; collective.

        Args:
            load: As the scene gives it.
            components: Of the force over mass g + G x: first g, then the rows of G; or their
                derivatives.
            key: Of the load.
            site: The body.

        Raises:
            InputError: The body lacks what it acts on, or this has no density.
        """
        group = cls.place(load.on, f"{key}.on", site.spaces)
        if not any(components):
            return None
        density = site.density(group)
        moments = site.discrete.once(
            ("moments", group, site.densities), lambda: _moments(density, group, site.spaces)
        )
        size = site.spaces.components
        at_origin = np.array(components[:size], float)
        linear = np.array(components[size:], float).reshape(size, size)
        uniform = at_origin + linear @ moments.centroid
        return cls(group, site.spaces, f"{key}.{load.kind}", uniform, linear, moments, density)

    @property
    def weight(self) -> Expr:
        """Weight of the integrals of the field: the density (mass/volume)."""
        return self.density

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the cells, exact for a density that varies as energies do."""
        return _measure(self.group, self.spaces)

    def acceleration_at(self, place: Array, nodes: AnyIntegers) -> Array | None:
        """Force over mass at a place that is coupled with a boundary of what it acts on."""
        beyond = np.setdiff1d(nodes, self.spaces.nodes(self.group))
        if total(self.spaces.comm, len(beyond)) > 0:
            return None
        return np.asarray(self.uniform + self.linear @ (place - self.moments.centroid))

    def nodal_by_density(self, number: int, site: LoadSite) -> Array:
        """Nodal forces of a density of 1 in one material (force over density)."""
        about = self.moments.centroid
        moments = Moments.of(site.share(number), self.measure, self.spaces, about)
        return moments.nodal(self.uniform, self.linear)


def _measure(group: Group, spaces: Spaces) -> ufl.Measure:
    return spaces.part(group, {"quadrature_degree": spaces.bulk_degree + spaces.degree + 1})


def _moments(density: Expr, group: Group, spaces: Spaces) -> Moments:
    return Moments.of(density, _measure(group, spaces), spaces)


class Acceleration(InertiaLoad):
    """Density times an acceleration that is the same everywhere."""

    kind: ClassVar[str] = "acceleration"


class Rotation(InertiaLoad):
    """Density times what masses on circles about an axis are pulled outwards by."""

    kind: ClassVar[str] = "rotation"
