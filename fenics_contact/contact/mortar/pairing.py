"""Two surfaces of deformable bodies that face each other, on meshes that need not match.

One is the slave: contact acts at its points. The displacement of the other, the master, is
projected onto its space (mortar method; C. Bernardi, Y. Maday, A. T. Patera 1994; M. A. Puso and
T. A. Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629), so that a uniform pressure
crosses the interface exactly. Forces go back by the transpose: what the slave gets, the master
gives. Every rank looks for what its own facets of the slave face, so it holds all of the master;
the matrices between the two are spread over the ranks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.folded_projection import AcrossCut, FoldedOnRanks, RimAcrossCut
from fenics_contact.contact.mortar.projection import MortarIntegrals, Projection, integrate
from fenics_contact.contact.mortar.ray_projection import Hits, face, hits
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.contact.mortar.spread_projection import SlaveRows, SpreadProjection
from fenics_contact.contact.mortar.turned_copies import TurnedCopies
from fenics_contact.contact.surface.trace import Trace


@dataclass(frozen=True, eq=False)
class _Faced:
    """Opposites of the slave's nodes and facets of this rank.

    Attributes:
        normals: Mean unit normals at the nodes, (nodes, components).
        gaps: Along them to the master, (nodes,); infinite where there is none (length).
        centre_normals: At the centres of the facets, (facets, components), or none.
        centre_gaps: Likewise, (facets,) or none.
        integrals: Over these facets, and how much of each faces the master.
        faced: Nodes at which the master's motion is asked for, (nodes,).
    """

    normals: Array
    gaps: Array
    centre_normals: Array
    centre_gaps: Array
    integrals: MortarIntegrals
    faced: Flags


@dataclass(frozen=True, eq=False)
class _Paired:
    """A pairing as it was found.

    Attributes:
        faced: What faces what, on this rank.
        master: The master's facets with their copies, where they stood.
        rows: The mortar integrals of this rank.
        projection: P, spread over the ranks.
    """

    faced: _Faced
    master: FacetMesh
    rows: SlaveRows
    projection: SpreadProjection | FoldedOnRanks

    @cached_property
    def whole(self) -> Projection:
        """P of the whole surfaces, on every rank; collective when first asked for."""
        return self.rows.gathered()


class Pairing:
    """A slave surface and its master.

    That of the bodies as meshed is kept: every problem on them begins with it.

    Attributes:
        master: The surface of the master.
        master_as_meshed: All of its facets, on every rank.
        copies: The master in other sectors of a ring that the slave may face.
        sagitta: How far facets of either surface are from smooth ones, about (length).

    Args:
        slave: Its contact points.
        master: Those of the other surface.
        constrained: Dofs that supports hold (local indices, owned and ghost).
    """

    def __init__(self, slave: Trace, master: Trace, constrained: Integers) -> None:
        self._slave, self._master = slave, master
        self._comm = slave.spaces.comm
        self.master = master.surface
        self.master_as_meshed = gathered(master)
        own = own_facets(slave)
        points = gather_rows(self._comm, own.centres)
        self.copies = TurnedCopies.facing(points, self.master_as_meshed, slave.cut)
        self._surfaces = own, self.copies.of_surface(self.master_as_meshed)
        sagitta = max(surface.sagitta for surface in self._surfaces)
        self.sagitta = largest(self._comm, np.array([sagitta]))
        held = np.zeros(slave.spaces.coordinates.shape[0] * slave.spaces.components, dtype=bool)
        held[constrained] = True
        at_nodes = held.reshape(-1, slave.spaces.components)[slave.all_nodes]
        self._across = AcrossCut(self.copies, self._rim())
        self._mirrored = slave.symmetry.in_planes() & at_nodes
        self._as_meshed = self._present = self._pair(*self._surfaces)

    def _rim(self) -> RimAcrossCut | None:
        """Nodes of the slave that follow from others of it across a cut; collective."""
        cut, surface = self._slave.cut, self._slave.surface
        if cut is None:
            return None
        nodes, shares = cut.shares_among(surface.dofs[:: surface.components] // surface.components)
        return RimAcrossCut(nodes, shares, cut.rotation) if len(nodes) else None

    @property
    def dofs(self) -> Integers:
        """The body's global number of every dof of the master; collective when first asked for."""
        return self.master.dofs

    def update(self, displacement: Array | None = None) -> None:
        """Find what faces what, the bodies displaced or as meshed; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        if self._present is not self._as_meshed:
            self._present.projection.destroy()
            self._present = self._as_meshed
        if displacement is not None:
            slave, master = self._surfaces
            slave = slave.moved(displacement[self._slave.all_nodes])
            there = self.master.gathered(displacement[self._master.all_nodes])
            self._present = self._pair(slave, master.moved(self.copies.vectors(there)))

    def copies_of(self, slave: FacetMesh) -> TurnedCopies:
        """The slave in the sectors whose slaves may face the master of this one.

        Args:
            slave: Its facets of this rank.
        """
        return self.copies.seen_from(slave)

    def _pair(self, slave: FacetMesh, master: FacetMesh) -> _Paired:
        faced, surface = self._find(slave, master), self._slave.surface
        known = surface, self.master, faced.integrals, self._mirrored, faced.faced
        rows = SlaveRows(*known, self._across)
        return _Paired(faced, master, rows, rows.on_ranks())

    @property
    def projection(self) -> SpreadProjection | FoldedOnRanks:
        """P: the displacement opposite is P u."""
        return self._present.projection

    @property
    def normals(self) -> Array:
        """Mean normals at the slave's nodes of this rank, (nodes, components)."""
        return self._slave.symmetry.mirrored(self._present.faced.normals)

    @property
    def centre_normals(self) -> Array:
        """Mean normals at ``Trace.centres``, (centres, components)."""
        return self._present.faced.centre_normals

    @property
    def gaps(self) -> Array:
        """Along the normals from the slave's contact points to what faces them (length).

        As meshed: what moves is the jump's; infinite where there is nothing.
        """
        faced = self._present.faced
        return np.concatenate([faced.gaps[self._slave.numbers], faced.centre_gaps])

    @property
    def shares(self) -> Array:
        """Shares of the slave's facets of this rank that face the master, (facets,)."""
        return self._present.faced.integrals.coverage

    @property
    def faced(self) -> Flags:
        """Nodes of this rank at which anything is opposite; the others have no jump, (nodes,)."""
        return self._present.faced.faced

    @property
    def crosses_cut(self) -> bool:
        """Whether the slave faces the master of another sector; collective when first asked for."""
        return self._present.rows.crosses_cut

    @property
    def is_as_meshed(self) -> bool:
        """Whether it is that of the bodies as meshed."""
        return self._present is self._as_meshed

    def whole_projection(self) -> Projection:
        """P of the whole surfaces, on every rank: for solvers that write it out; collective."""
        return self._present.whole

    def whole_integrals(self) -> MortarIntegrals:
        """The mortar integrals of the whole surfaces, on every rank; collective."""
        return self._present.rows.whole_integrals()

    def whole_faced(self) -> Flags:
        """``faced`` of all nodes of the slave, on every rank; collective."""
        return self._slave.surface.gathered(self.faced)

    def _find(self, slave: FacetMesh, master: FacetMesh) -> _Faced:
        trace, surface = self._slave, self._slave.surface
        # Where a node lies on facets of two ranks, both go by its owner.
        normals, found = face(slave.node_positions(), slave.normals, master)
        normals = surface.of_owners(normals)
        gaps = surface.of_owners(self._gaps(self._surfaces[0].node_positions(), normals, found))
        integrals = integrate(slave, master, normals, trace.spaces.kinematics == "axisymmetric")
        centre_normals, centre_gaps = np.zeros((0, slave.dimension)), np.zeros(0)
        at = np.isfinite(gaps).astype(np.float64)
        if not trace.nodal:
            own = normalised(self._surfaces[0].normals_at_centres())
            centre_normals, at_centres = face(slave.centres, own, master)
            centre_gaps = self._gaps(self._surfaces[0].centres, centre_normals, at_centres)
            at[slave.nodes[np.isfinite(centre_gaps)]] = 1.0
        # Beyond the master's edge the projection extrapolates, and nothing asks for it.
        has_mass = surface.summed(integrals.mass.diagonal()[:, None])[:, 0] > 0
        is_faced = (surface.summed(at[:, None])[:, 0] > 0) & has_mass
        return _Faced(normals, gaps, centre_normals, centre_gaps, integrals, is_faced)

    def _gaps(self, points: Array, normals: Array, found: Hits) -> Array:
        """Between points of the slave as meshed and the master's that face them, as meshed."""
        facing = found.facet >= 0
        opposite = self._surfaces[1].positions(found.facet[facing], found.reference[facing])
        gaps = np.full(len(points), np.inf)
        gaps[facing] = np.einsum("ij,ij->i", opposite - points[facing], normals[facing])
        return gaps

    def jump(self, field: Array) -> Array:
        """The jump u − P u' at nodes of the slave (this rank's), 0 if nothing is faced; collective.

        Args:
            field: At the body's nodes of this rank, (nodes, components, ...).
        """
        there = field[self._master.all_nodes][: self.master.owned_nodes]
        opposite = self._slave.surface.of_owners(self.projection.apply(there))
        found = field[self._slave.all_nodes] - opposite
        found[~self.faced] = 0.0
        return np.asarray(found)

    def on_master(self, force: Array) -> Array:
        """Forces on the master by forces f on the slave, −Pᵀ f, at the body's nodes; collective.

        Args:
            force: At the slave's nodes of this rank, (nodes, components) (force).
        """
        given = force[: self._slave.surface.owned_nodes]
        return self.master.on_body(-self.projection.transposed(given))

    def master_nodes(self) -> Flags:
        """Flags of the body's nodes that are the master's, (nodes,); collective."""
        return self._master.surface.on_body(np.ones(len(self._master.all_nodes))) > 0

    def coupled_masters(self) -> Flags:
        """Flags of the master's nodes that move the slave, of the whole master; collective."""
        return self._present.rows.coupled_masters()

    def faced_masters(self) -> Flags:
        """Flags of the master's nodes that move the slave, (the body's nodes,); collective."""
        moves = self.coupled_masters()[self.master.numbers]
        return self.master.on_body(moves.astype(np.float64)) > 0

    def distances_from(self, points: Array, normals: Array) -> Array:
        """Along normals (points, components) from points (points, 3) to the master (length)."""
        return hits(self._present.master, points[:, : normals.shape[1]], normals).distance

    def missed_opposite(self, points: Array, normals: Array) -> Array:
        """How far the curve lies outside of the master's facets, where points face them (length).

        Collective.

        Args:
            points: Of the slave as it stands, (points, 3) (length).
            normals: At these, (points, components).
        """
        found = hits(self._present.master, points[:, : normals.shape[1]], normals)
        faces = found.facet >= 0
        missed = np.zeros(len(points))
        # Copies are as curved as the facets in this sector; and what the slave misses is told
        # without copies, too, so that the same curve on both sides leaves no gap.
        master = self.master_as_meshed
        facets, reference = found.facet[faces] % len(master.nodes), found.reference[faces]
        missed[faces] = SmoothSurface(master).offsets(facets, reference)
        return missed


def gathered(trace: Trace) -> FacetMesh:
    """A whole surface on every rank; collective."""
    own, surface = own_facets(trace), trace.surface
    return replace(
        own,
        geometry=gather_rows(surface.comm, own.geometry),
        nodes=gather_rows(surface.comm, surface.numbers[own.nodes]),
        normals=surface.gathered(own.normals),
    )


def own_facets(trace: Trace) -> FacetMesh:
    """The facets of this rank of a surface, with its numbers of the nodes."""
    surface, mesh = trace.surface, trace.surface.mesh
    count = len(surface.facet_nodes)
    return FacetMesh(
        shape=mesh.topology.cell_name(),
        order=trace.spaces.geometry_order,
        degree=trace.spaces.degree,
        geometry=mesh.geometry.x[compat.geometry_nodes(mesh)[:count]][..., : surface.components],
        nodes=surface.facet_nodes,
        normals=trace.normals_at_nodes,
    )
