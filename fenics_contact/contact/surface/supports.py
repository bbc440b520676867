"""What supports hold of a contact surface: there, reactions act beside the contact's forces."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Flags, Integers
from fenics_contact.common.parallel import total
from fenics_contact.contact.surface.trace import Trace

# Of a normal: squares of components below it are round-off.
_NONE = 1e-9


class SurfaceSupports:
    """The components of a surface's nodes that supports hold.

    Args:
        trace: The contact points.
        constrained: Dofs that supports prescribe (local indices, owned and ghost).

    Attributes:
        free_along: Components along which nothing but friction acts along the surface,
            (nodes, components).
        movable: Nodes that can move along such a one. A support at an angle to the surface
            counts for all of a node, since its reaction has a part in every direction.
        free_across: Nodes on which no support acts along the surface's normal.
        free_normals: Of each node's normal the components that nothing holds, (nodes, components).
        held_across: Points that supports hold along the normal, (points,).
    """

    def __init__(self, trace: Trace, constrained: Integers) -> None:
        self._trace = trace
        components = trace.spaces.components
        held = np.zeros(len(trace.spaces.coordinates) * components, dtype=bool)
        held[constrained] = True
        self._held = held.reshape(-1, components)[trace.nodes]
        normals = trace.normals[: len(trace.nodes)]
        squares = normals**2
        along = self._held & (1 - squares > _NONE)
        oblique = (along & (squares > _NONE)).any(axis=1)
        self.free_along = ~along
        self.movable = (along.sum(axis=1) < components - 1) & ~oblique
        self.free_across = ~(self._held & (squares > _NONE)).any(axis=1)
        self.free_normals = np.where(self._held, 0.0, normals)
        self.held_across = np.zeros(len(trace.normals), dtype=bool)
        self.held_across[: len(trace.nodes)] = (squares * ~self._held).sum(axis=1) <= _NONE

    def held_axes(self) -> Flags:
        """Along which axes supports hold more than a tenth of the nodes; collective."""
        comm, owned = self._trace.spaces.comm, self._trace.owned[: len(self._held)]
        return np.asarray(
            total(comm, self._held[owned].sum(axis=0)) > 0.1 * total(comm, owned.sum())
        )
