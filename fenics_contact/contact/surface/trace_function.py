"""A settable function of values at the contact points of a surface."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fenics_contact.body.forms import Expr, Function
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.surface.facet_centres import FacetCentres
from fenics_contact.contact.surface.space import SurfaceSpace


class TraceFunction:
    """A function of values at the nodes, and at the centres of facets where these are points.

    It is made when forms first ask for it: laws that are evaluated point by point never do.

    Args:
        surface: The surface.
        numbers: Nodes of the surface that are points.
        centres: Points that are no nodes; None where there are none.
        is_vector: Whether values are (points, components), not (points,).
        empty: Value at nodes that are no points.
    """

    def __init__(
        self,
        surface: SurfaceSpace,
        numbers: AnyIntegers,
        centres: FacetCentres | None,
        is_vector: bool,
        empty: float = 0.0,
    ) -> None:
        self._surface, self._numbers, self._centres = surface, numbers, centres
        self._is_vector, self._empty = is_vector, empty
        self._values = np.zeros(0)
        self._nodal: Function | None = None
        self._bubble: Function | None = None

    @cached_property
    def ufl(self) -> Expr:
        """The function in UFL, for forms."""
        surface, centres = self._surface, self._centres
        self._nodal = Function(surface.space if self._is_vector else surface.scalar_space)
        found: Expr = self._nodal
        if centres is not None:
            space = centres.vector_space if self._is_vector else centres.scalar_space
            self._bubble = Function(space)
            found = self._nodal + self._bubble
        self._fill(self._nodal)
        return found

    def set(self, values: Array) -> None:
        """Give it values at the points."""
        self._values = values.copy()
        if self._nodal is not None:
            self._fill(self._nodal)

    def _fill(self, nodal: Function) -> None:
        surface, values, count = self._surface, self._values, len(self._numbers)
        nodes = len(surface.coordinates)
        at_nodes = np.full((nodes, surface.components) if self._is_vector else nodes, self._empty)
        at_nodes[self._numbers] = values[:count]
        if self._is_vector:
            nodal.x.array[:] = at_nodes.reshape(-1)
        else:
            surface.set_scalars(nodal, at_nodes)
        if self._centres is not None:
            assert self._bubble is not None
            self._centres.set_correction(nodal, self._bubble, values[count:])
