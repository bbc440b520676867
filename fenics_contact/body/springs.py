"""Springs to the ground: the elastic supports of a body, and those along directions of their own.

Their energy is ½ ∫ k_i (d_i · (u − ū))² over the surface that they hold, d_i unit vectors, ū the
displacement of their foot. Its second derivative is part of the stiffness of the body; ∫ k_i (d_i ·
ū) (d_i · v) acts as a load, which the problem has with the path of the support. Where a support
holds along such directions, as across a cylinder, its springs are so stiff that they give way by
little beside what the body does.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.description import SpringGroup
from fenics_contact.body.directions import directions_of
from fenics_contact.body.spaces import Spaces, surface_integrals
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group

# How far springs that hold give way: over the displacement of a body of the extent of the surface.
GIVES_WAY = 1e-5


def springs_of(described: Sequence[SpringGroup], spaces: Spaces, modulus: float) -> list[Springs]:
    """Return the springs of a body, whose forms may be added up; collective.

    Args:
        described: What the scene says of them.
        spaces: Those of the body.
        modulus: Largest stiffness of the body, where it cannot give way sideways (stress).

    Raises:
        InputError: A surface is no boundary, or has no area.
    """
    keys = [f"support[{each.support}].on" for each in described]
    groups = [spaces.body.boundary(each.on, key) for each, key in zip(described, keys, strict=True)]
    topology = spaces.body.mesh.topology
    facets = [
        (number, compat.boundary_entities(topology, spaces.body.entities(group)))
        for number, group in enumerate(groups)
    ]
    return [
        Springs(each, number, groups[number], facets, spaces, modulus)
        for number, each in enumerate(described)
    ]


class Springs:
    """The springs of a support, spread evenly over a surface; collective.

    Attributes:
        support: Number of the support.
        group: The surface.
        stiffness: k by area, 0 along directions that are free, (directions,) (stress/length).
        directions: Of the springs; None for the axes of the mesh.
        holds: Whether they stand for a support that holds.
        area: Of the surface, over the thickness or the whole ring as for loads.

    Args:
        described: What the scene says of them.
        number: Of the surface among ``facets``.
        group: The surface.
        facets: Numbers and facets of the surfaces of all springs of the body.
        spaces: Those of the body.
        modulus: Largest stiffness of the body, where it cannot give way sideways (stress).

    Raises:
        InputError: The surface has no area, or no normal.
    """

    def __init__(
        self,
        described: SpringGroup,
        number: int,
        group: Group,
        facets: list[tuple[int, Any]],
        spaces: Spaces,
        modulus: float,
    ) -> None:
        self._spaces, self.support = spaces, described.support
        self._number, self.group, self._facets = number, group, facets
        key = f"support[{described.support}]"
        self._measure = self.measure(spaces.bulk_degree + 2)
        own = fem.assemble_scalar(form_cache.form(spaces.weight * self._measure))
        self.area = float(total(spaces.comm, float(np.real(own))))
        if self.area <= 0:
            raise InputError(f"{key}.on = '{described.on}': has no area to spread springs over")
        self.directions = (
            None if described.axes is None else directions_of(described.axes, group, key, spaces)
        )
        self.stiffness = np.zeros(1 if described.axes == "normal" else spaces.components)
        stiff = modulus / (GIVES_WAY * spaces.size)
        self.holds = any(np.isinf(value) for _, value in described.stiffness)
        for place, value in described.stiffness:
            by_area = value if described.by_area else value / self.area
            self.stiffness[place] = stiff if self.holds else by_area
        self._constant = fem.Constant(spaces.body.mesh, self.stiffness)
        self._moved = fem.Function(spaces.displacement_space)
        test = ufl.TestFunction(spaces.displacement_space)
        self.form = form_cache.form(self.work(self._moved, test))

    def measure(self, degree: int) -> ufl.Measure:
        """Measure of the surface; of all springs of a body of the same data.

        Args:
            degree: Of the quadrature.
        """
        mesh, rule = self._spaces.body.mesh, {"quadrature_degree": degree}
        on = ufl.Measure("ds", domain=mesh, subdomain_data=self._facets, metadata=rule)
        return on(self._number)

    def work(self, moved: Expr, virtual: Expr, measure: ufl.Measure | None = None) -> ufl.Form:
        """∫ k_i (d_i · u) (d_i · v) in UFL (energy).

        Args:
            moved: u, by which the springs are stretched.
            virtual: v.
            measure: Of the surface, by default with the rule of the stiffness.
        """
        k = self._constant
        if self.directions is None:
            density = sum(k[i] * moved[i] * virtual[i] for i in range(self._spaces.components))
        else:
            ways = enumerate(self.directions.vectors(self._spaces.position))
            density = sum(k[i] * ufl.dot(d, moved) * ufl.dot(d, virtual) for i, d in ways)
        return self._spaces.weight * density * (self._measure if measure is None else measure)

    def along(self, nodes: AnyIntegers) -> Array:
        """Unit vectors of the springs at nodes of this rank, (directions, nodes, components)."""
        spaces = self._spaces
        if self.directions is None:
            axes = np.eye(spaces.components)[:, None]
            return np.broadcast_to(axes, (spaces.components, len(nodes), spaces.components))
        return self.directions.at(spaces.coordinates[nodes])

    def mean(self, displacement: Array) -> list[float]:
        """Mean displacement of the surface, (components,); collective (length).

        Args:
            displacement: At the nodes of this rank, (nodes, components) (length).
        """
        self._moved.x.array[:] = displacement.reshape(-1)
        _, *sums = surface_integrals(self._moved, self._measure, self._spaces)
        return [float(x) / self.area for x in sums]

    def pull(self, stretch: Array) -> Array:
        """Nodal forces ∫ k_i (d_i · u) d_i φ that stretch the springs by u; collective (force).

        Args:
            stretch: u at the nodes of this rank, (nodes, components) (length).

        Returns:
            (nodes, components).
        """
        self._moved.x.array[:] = stretch.reshape(-1)
        return self._spaces.assemble(self.form)
