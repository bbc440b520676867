"""A contact surface against another deformable body, or another surface of the same one.

The jump is w = u − P u' with the displacement u' opposite, projected onto this surface (see
``pairing``). Gap and slip are along and across the mean normal n̄ ∝ n − n' of both surfaces: with
either's own normal, closing would turn into slip. What faces what is found on the bodies as they
are meshed, or as they stand after a load step.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags, Integers, in_3d
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.contact.between_points import BetweenPoints, nowhere, require_smooth
from fenics_contact.contact.kinematics import ROUND_OFF, ContactKinematics
from fenics_contact.contact.mortar.pairing import Pairing
from fenics_contact.contact.mortar.ray_projection import hits
from fenics_contact.contact.surface.facets import relative_facet_size
from fenics_contact.contact.surface.trace import Trace

# Of a distance: two ranks with a facet each at the same one.
_SAME = 1e-9


class BodyKinematics(ContactKinematics):
    """The jump w = u − P u' of the slave surface.

    Args:
        trace: The slave's contact points, whose normals become the mean ones.
        opposite: The master's.
        pairing: What faces what of the two.
        key: Where the scene describes the contact, for messages.

    Raises:
        InputError: The surfaces do not face each other.
    """

    faces_body: ClassVar[bool] = True
    pairing: Pairing

    def __init__(self, trace: Trace, opposite: Trace, pairing: Pairing, key: str) -> None:
        super().__init__(trace)
        self._opposite = opposite
        self.pairing = pairing
        pairing.update()
        self._face()
        if total(trace.spaces.comm, self.reached.sum()) == 0:
            raise InputError(
                f"{key}.against: the two surfaces do not face each other: no outward normal of one "
                "meets the other"
            )

    def _face(self) -> None:
        self._known_ends: dict[tuple[int, int], float] = {}
        self._jumps_of_body = None
        pairing = self.pairing
        self.trace.turn(pairing.normals, pairing.centre_normals)
        counts = self.trace.count(pairing.shares)
        gap = np.where(counts, pairing.gaps, np.inf)
        size = self.trace.surface.farthest()
        self._measure(self.without_round_off(self._fitted(gap, ROUND_OFF * size), size))
        self._first_jump = self.jump_at_points()

    def _fitted(self, gap: Array, negligible: float) -> Array:
        """A gap as facets can close it: curved ones that do not match leave others; collective.

        Args:
            gap: At the points, infinite where nothing is faced (length).
            negligible: The round-off in it, which is left as it is (length).
        """
        faces = np.isfinite(gap)
        fitted = self.trace.fitted(gap, faces)
        off = largest(self._spaces.comm, np.abs(fitted[faces] - gap[faces]))
        return fitted if off > negligible else gap

    def require_one_sided(self, key: str) -> None:
        """Refuse surfaces with a sharp edge."""
        super().require_one_sided(key)
        require_smooth(self._opposite, f"{key}.against")

    def update_pairing(self, displacement: Array | None) -> None:
        """Find what faces what on the displaced bodies; collective."""
        self.pairing.update(displacement)
        self.paired_at = displacement
        none = np.zeros((len(self._spaces.coordinates), self._spaces.components))
        present = none if displacement is None else displacement
        moved = self.trace.at_points(present[self.trace.all_nodes])
        self._places = self.trace.coordinates.copy()
        self._places[:, : moved.shape[1]] += moved
        self.move(self.relative(present))
        self._face()

    def relative_sliding(self, closed: Flags) -> float:
        """Slip since it was found what faces what, over the size of the contact; collective."""
        comm, points = self._spaces.comm, self.trace.coordinates[closed].T
        slip = self.tangential(self.jump_at_points() - self._first_jump)[closed]
        extent = np.linalg.norm([largest(comm, x) - smallest(comm, x) for x in points])
        facet = relative_facet_size(self.trace.surface) * self.trace.extent()
        return largest(comm, np.linalg.norm(slip, axis=1)) / max(float(extent), facet)

    @property
    def sagitta(self) -> float:
        """How far the facets of both surfaces are from smooth ones, about (length)."""
        return self.pairing.sagitta

    @property
    def facet_turn(self) -> float:
        """Angle between the facets of either surface and the averaged normals, about (radians)."""
        return max(self.trace.averaged.turn, self._opposite.averaged.turn)

    def missed(self) -> Array:
        """Excess of the gaps by what facets of both surfaces miss; collective.

        At the points, < 0 where they are too narrow (length).
        """
        opposite = self.pairing.missed_opposite(self._places, self.trace.normals)
        return self.trace.fitted(super().missed() + opposite, self.reached)

    def relative(self, displacement: Array) -> Array:
        """U − P u' at all nodes of the surface, (nodes, components, ...); collective.

        It is 0 at nodes that face nothing.
        """
        return self.pairing.jump(displacement)

    def relative_or_own(self, displacement: Array) -> Array:
        """``relative``, or the slave's own displacement where it faces nothing; collective."""
        own = displacement[self.trace.all_nodes]
        return np.where(self.pairing.faced[:, None], self.relative(displacement), own)

    def on_body(self, force: Array) -> Array:
        """Forces on the surface, and their reaction opposite, at the body's nodes; collective."""
        return self.trace.surface.on_body(force) + self.pairing.on_master(force)

    def reaches(self, flags: Flags) -> Flags:
        """The nodes themselves, and all opposite where there are any; collective."""
        found = self.trace.surface.on_body(flags.astype(np.float64)) > 0
        if self._spaces.comm.allreduce(int(flags.sum())):
            found |= self.pairing.master_nodes()
        return found

    def _gap(self, points: Array, normals: Array) -> Array:
        return self.pairing.distances_from(points, normals)

    def end_of_obstacle(self, reached: Integers, beyond: Integers) -> Array:
        """How far the body opposite goes, from points before it to others beyond it (0 … 1).

        Found once for each pair of points, as areas of every answer ask for the same ones: it
        stands where it did until it is paired anew.
        """
        pairs = list(zip(reached.tolist(), beyond.tolist(), strict=True))
        new = [number for number, pair in enumerate(pairs) if pair not in self._known_ends]
        if new:
            found = super().end_of_obstacle(reached[new], beyond[new])
            self._known_ends.update(zip([pairs[n] for n in new], found.tolist(), strict=True))
        return np.array([self._known_ends[pair] for pair in pairs])

    def between_points(self, displacement: Array) -> BetweenPoints:
        """Where nodes of the master are deepest in facets of the slave; collective.

        Of a sector of a ring they may be so in the slave of another sector.
        """
        slave, master = self.facets, self.pairing.master_as_meshed
        if self.paired_at is not None:
            slave = slave.moved(self.paired_at[self.trace.all_nodes])
            master = master.moved(self._of_master(self.paired_at))
            displacement = displacement - self.paired_at
        copies = self.pairing.copies_of(slave)
        every, moved = copies.of_surface(slave), self._of_master(displacement)
        places, normals = master.node_positions(), master.normals
        nearest = np.full(len(places), np.inf)
        if len(slave.nodes):  # the surface may miss this rank
            found = hits(every, places, normals)
            nearest = np.abs(found.distance)
        of_all = np.empty_like(nearest)
        self._spaces.comm.Allreduce(nearest, of_all, op=MPI.MIN)
        met = np.flatnonzero(np.isfinite(nearest) & (nearest <= of_all * (1 + _SAME)))
        if len(met) == 0:
            return nowhere(slave.dimension)
        facets, reference = found.facet[met], found.reference[met]
        of_slave = copies.vectors(displacement[self.trace.all_nodes])
        own = every.interpolate(of_slave, facets, reference)
        closed = np.einsum("ij,ij->i", moved[met] - own, normals[met])
        facets = facets % len(slave.nodes)
        worn = self.trace.at_all_nodes(self.worn[: len(self.trace.nodes)])[:, None]
        narrower = self.interference - slave.interpolate(worn, facets, reference)[:, 0]
        missed = slave.sagittas[facets] + master.sagitta
        return BetweenPoints(
            depth=closed - found.distance[met] + narrower - missed,
            places=in_3d(slave.positions(facets, reference)),
            facets=facets,
            reference=reference,
            spacing=self.facets.spacing[facets],
        )

    def _of_master(self, displacement: Array) -> Array:
        """At all nodes of the master, on every rank; collective."""
        return self.pairing.master.gathered(displacement[self._opposite.all_nodes])

    def leave_out(self, points: Flags) -> None:
        """All points count: what faces none has no gap."""

    def move_to_first_contact(self) -> None:
        """Bodies stand where they are meshed."""

    def displace(self, displacement: Array, angle: float = 0.0) -> None:
        """Bodies are moved by their supports."""

    def stand(self) -> None:
        """Gaps of bodies are those of the last pairing."""

    def touch(self) -> None:
        """Nothing drives a body alone."""
