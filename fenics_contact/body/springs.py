"""Springs to the ground: the elastic supports of a body.

Their energy is ½ ∫ k_i (u_i − ū_i)² over the surface that they hold, ū the displacement of their
foot. Its second derivative, ∫ k_i u_i v_i, is part of the stiffness of the body; ∫ k_i ū_i v_i acts
as a load, which the problem has with the path of the support.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.description import SpringGroup
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.values import AXES


def springs_of(described: Sequence[SpringGroup], spaces: Spaces) -> list[Springs]:
    """Return the springs of a body, whose forms may be added up; collective.

    Args:
        described: What the scene says of them.
        spaces: Those of the body.

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
        Springs(each, number, groups[number], facets, spaces)
        for number, each in enumerate(described)
    ]


class Springs:
    """The springs of a support, spread evenly over a surface; collective.

    Attributes:
        support: Number of the support.
        group: The surface.
        stiffness: k by area, 0 along components that are free, (components,) (stress/length).
        area: Of the surface, over the thickness or the whole ring as for loads.

    Args:
        described: What the scene says of them.
        number: Of the surface among ``facets``.
        group: The surface.
        facets: Numbers and facets of the surfaces of all springs of the body.
        spaces: Those of the body.

    Raises:
        InputError: The surface has no area.
    """

    def __init__(
        self,
        described: SpringGroup,
        number: int,
        group: Group,
        facets: list[tuple[int, Any]],
        spaces: Spaces,
    ) -> None:
        self._spaces, self.support = spaces, described.support
        self._number, self.group, self._facets = number, group, facets
        key = f"support[{described.support}].on"
        self._measure = self.measure(spaces.bulk_degree + 2)
        own = fem.assemble_scalar(form_cache.form(spaces.weight * self._measure))
        self.area = float(total(spaces.comm, float(np.real(own))))
        if self.area <= 0:
            raise InputError(f"{key} = '{described.on}': has no area to spread springs over")
        self.stiffness = np.zeros(spaces.components)
        for axis, value in described.stiffness:
            self.stiffness[AXES.index(axis)] = value if described.by_area else value / self.area
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
        """∫ k_i u_i v_i in UFL (energy).

        Args:
            moved: u, by which the springs are stretched.
            virtual: v.
            measure: Of the surface, by default with the rule of the stiffness.
        """
        k = self._constant
        density = sum(k[i] * moved[i] * virtual[i] for i in range(self._spaces.components))
        return self._spaces.weight * density * (self._measure if measure is None else measure)

    def pull(self, stretch: Array) -> Array:
        """Nodal forces ∫ k_i u_i φ that stretch the springs by u, (nodes, components) (force).

        Args:
            stretch: u at the nodes of this rank, (nodes, components) (length).
        """
        self._moved.x.array[:] = stretch.reshape(-1)
        return self._spaces.assemble(self.form)
