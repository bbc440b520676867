"""The surface that a contact acts on, and the one that stands opposite."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.contact.choice_of_slaves import NamedSurfaces
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.surface.facets import smallest_edge
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.contact.surface.trace import Trace

# Where mean normals are shorter, no direction stands for the whole surface.
_SHORTEST_AXIS = 0.5


class ContactSides:
    """The surface whose points a contact acts at, the slave, and the master opposite, if any.

    Attributes:
        slave: Name of the slave's group.
        master: Name of the master's, empty against an obstacle.
        why: Why it is the slave; empty against an obstacle.
        group: The slave's facets.
        trace: Its contact points.
        opposite: The master's, None against an obstacle.
        pairing: What faces what of the two, None against an obstacle.
        on_sign: 1 where the slave is the surface `on`, else −1: what acts on the body of `on` is
            what acts on the slave, or the opposite of it.

    Args:
        named: The surfaces as the scene names them.
        keeps: Whether ``on`` is the slave.
        why: Why, empty against an obstacle.
        constrained: Dofs that supports hold (local indices, owned and ghost).
    """

    def __init__(self, named: NamedSurfaces, keeps: bool, why: str, constrained: Integers) -> None:
        slave, master = named.on, named.against
        self.on_sign = 1.0
        if master is not None and not keeps:
            slave, master = master, slave
            self.on_sign = -1.0
        self.slave, self.group, self.trace = slave.name, slave.group, slave.trace
        self.master, self.why = "", why
        self.opposite: Trace | None = None
        self.pairing: Pairing | None = None
        if master is not None:
            self.master, self.opposite = master.name, master.trace
            self.pairing = Pairing(self.trace, self.opposite, constrained)

    @property
    def surfaces(self) -> list[SurfaceSpace]:
        """The slave's surface, and the master's against a body."""
        return [side.surface for side in (self.trace, self.opposite) if side is not None]

    @cached_property
    def facet_size(self) -> float:
        """Shortest edge of the cells at both surfaces (length); collective when first asked for."""
        found = smallest_edge(self.trace.surface)
        if self.opposite is None:
            return found
        return min(found, smallest_edge(self.opposite.surface))

    def axis(self, given: Array | None = None) -> Array | None:
        """Unit vector into the body of `on` along which normal forces are measured; collective.

        Components across planes of symmetry that a surface ends in, and the radius of a
        revolution, are left out: there, forces of the mirror images cancel.

        Args:
            given: That of an obstacle, (components,); else it is the mean normal of the whole
                surface, of two bodies that of `against` less that of `on`.

        Returns:
            None where that vector is short, as on surfaces that wrap around.
        """
        left_out = self.trace.symmetry.cut_axes()
        inward = -self.on_sign * self.trace.averaged.mean
        if self.opposite is not None:
            left_out += self.opposite.symmetry.cut_axes()
            inward = inward + self.on_sign * self.opposite.averaged.mean
        inward = np.array(inward if given is None else given)
        inward[left_out] = 0.0
        length = float(np.linalg.norm(inward))
        return inward / length if length >= _SHORTEST_AXIS else None
