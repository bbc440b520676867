"""A settable function of values at the contact points of a surface."""

from __future__ import annotations

import numpy as np

from fenics_contact.body.forms import Expr, Function
from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.surface.facet_centres import FacetCentres
from fenics_contact.contact.surface.space import SurfaceSpace


class TraceFunction:
    """A function of values at the nodes, and at the centres of facets where these are points.

    Attributes:
        ufl: What stands in forms.

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
        count = len(surface.coordinates)
        self._values = np.full((count, surface.components) if is_vector else count, empty)
        self._nodal = Function(surface.space if is_vector else surface.scalar_space)
        self._bubble: Function | None = None
        self.ufl: Expr = self._nodal
        if centres is not None:
            self._bubble = Function(centres.vector_space if is_vector else centres.scalar_space)
            self.ufl = self._nodal + self._bubble

    def set(self, values: Array) -> None:
        """Give it values at the points."""
        count = len(self._numbers)
        self._values[self._numbers] = values[:count]
        if values.ndim == 2:
            self._nodal.x.array[:] = self._values.reshape(-1)
        else:
            self._surface.set_scalars(self._nodal, self._values)
        if self._centres is not None:
            self._centres.set_correction(self._nodal, self._bubble, values[count:])
