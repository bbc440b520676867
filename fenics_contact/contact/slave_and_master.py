"""Which surface a contact acts on, and which stands opposite."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.body.description import CandidateContact
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import on_root, total
from fenics_contact.contact.mortar.pairing import Pairing, gathered
from fenics_contact.contact.mortar.ray_projection import hits
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.mesh.tagged_mesh import Group

# A surface is covered whose facets, but for this share, have the other before their middle.
_UNCOVERED = 1e-6
# Of two surfaces that are both covered, or both not, one that is finer by this is no slave.
_MUCH_FINER = 0.5
_MORE_COVERED = 0.05
# Where mean normals are shorter, no direction stands for the whole surface.
_SHORTEST_AXIS = 0.5


class ContactSides:
    """The surface whose points a contact acts at, the slave, and the master opposite, if any.

    The slave is to be the surface that the other covers, and not the much finer one.

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
        contact: Its groups.
        key: Where the scene names them, for messages.
        spaces: Those of the body.
        flat_sides: Axis and coordinate of planes of symmetry.
        constrained: Dofs that supports hold (local indices, owned and ghost).
        masters: Groups that can be masters only, as other contacts have them, too.

    Raises:
        InputError: A surface is not on the boundary, or neither can be the slave.
    """

    def __init__(
        self,
        contact: CandidateContact,
        key: str,
        spaces: Spaces,
        flat_sides: list[tuple[int, float]],
        constrained: Integers,
        masters: Sequence[str] = (),
    ) -> None:
        self._spaces, self._key, self._flat_sides = spaces, key, flat_sides
        self.slave, self.master, self.why = contact.on, "", ""
        self.group, self.trace = self._surface("on", contact.on)
        self.opposite: Trace | None = None
        self.pairing: Pairing | None = None
        self.on_sign = 1.0
        if contact.against is not None:
            opposite = self._choose(contact, contact.against, masters)
            self.opposite, self.pairing = opposite, Pairing(self.trace, opposite, constrained)

    def _choose(self, contact: CandidateContact, against: str, masters: Sequence[str]) -> Trace:
        """Choose the slave of the two surfaces, and return the contact points of the master."""
        self.master = against
        group, opposite = self._surface("against", against)
        keeps, self.why = self._keeps(contact, opposite, masters)
        if keeps:
            return opposite
        self.slave, self.master = self.master, self.slave
        self.group = group
        self.trace, opposite = opposite, self.trace
        self.on_sign = -1.0
        return opposite

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

    def _surface(self, side: str, name: str) -> tuple[Group, Trace]:
        group = self._spaces.body.boundary(name, f"{self._key}.{side}")
        if total(self._spaces.comm, len(self._spaces.facets(group))) == 0:
            raise InputError(
                f"{self._key}.{side} = '{name}': no facet of it is on the boundary of the body"
            )
        return group, Trace(self._spaces, group, self._flat_sides)

    def _keeps(
        self, contact: CandidateContact, opposite: Trace, masters: Sequence[str]
    ) -> tuple[bool, str]:
        """Whether `on` is the slave, and why; collective."""
        shared = contact.on in masters, contact.against in masters
        if all(shared):
            raise InputError(
                f"{self._key}: both '{contact.on}' and '{contact.against}' are in other contacts, "
                "too, but one of the two must be in this one alone"
            )
        if contact.slave != "auto":
            keeps = contact.slave == "on"
            if shared[0 if keeps else 1]:
                name = contact.on if keeps else contact.against
                raise InputError(
                    f"{self._key}.slave = '{contact.slave}': '{name}' is in other contacts, too, "
                    "so it cannot be the slave of this one"
                )
            return keeps, "as the scene says"
        if any(shared):
            return shared[1], "the other is in several contacts"
        return self._compared(opposite)

    def _compared(self, opposite: Trace) -> tuple[bool, str]:
        """By what covers what, and by the sizes of facets; collective."""
        surfaces = gathered(self.trace), gathered(opposite)

        def compare() -> tuple[list[float], list[float]]:
            shares, sizes = [], []
            for one, other in (surfaces, surfaces[::-1]):
                normals = one.normals_at_centres()
                areas = np.linalg.norm(normals, axis=1)
                found = hits(other, one.centres, normals / areas[:, None])
                faced = np.isfinite(found.distance)
                shares.append(float(areas[faced].sum() / areas.sum()))
                sizes.append(float(areas.mean()) ** (1 / (one.dimension - 1)))
            return shares, sizes

        shares, sizes = on_root(self._spaces.comm, compare)
        covered = [share > 1 - _UNCOVERED for share in shares]
        if covered[0] != covered[1]:
            return covered[0], "the other covers it"
        if not covered[0] and abs(shares[0] - shares[1]) > _MORE_COVERED:
            return shares[0] > shares[1], "the other covers more of it"
        if sizes[0] < _MUCH_FINER * sizes[1]:
            return False, "it is not the much finer one"
        return True, "it comes first"
