"""A load of a scene with its path, and its nodal forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.problem.loads.acting_load import ActingLoad


@dataclass(frozen=True, eq=False)
class GivenLoad:
    """A load of a scene with its path.

    Attributes:
        name: For results.
        acting: The load where the path is 1.
        path: Its factor over pseudo-time.
    """

    name: str
    acting: ActingLoad
    path: Callable[[float], float]

    @cached_property
    def form(self) -> fem.Form:
        """Linear form of its work, compiled; collective when first asked for."""
        return _compiled(self.acting)

    def nodal(self) -> Array:
        """Return the nodal forces where the path is 1, (nodes, components); collective (force)."""
        return self.acting.spaces.assemble(self.form)

    def nodal_of_units(self, found: dict[Any, list[Array]]) -> Array:
        """Return the nodal forces, by units of its components that are assembled once; collective.

        Args:
            found: Nodal forces of units of earlier loads on the body; those of this one are added.
        """
        acting = self.acting
        if not acting.is_constant:
            return self.nodal()
        key = type(acting), acting.group
        if key not in found:
            size = range(len(acting.given))
            units = [acting.of_unit(component) for component in size]
            found[key] = [acting.spaces.assemble(_compiled(unit)) for unit in units]
        return np.tensordot(np.array(acting.given, dtype=np.float64), found[key], axes=(0, 0))


def _compiled(acting: ActingLoad) -> fem.Form:
    """The work of a load as a linear form."""
    return form_cache.form(acting.work(ufl.TestFunction(acting.spaces.displacement_space)))
