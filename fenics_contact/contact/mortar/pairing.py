"""Two surfaces of deformable bodies that face each other, on meshes that need not match.

One is the slave: contact acts at its points. The displacement of the other, the master, is
projected onto its space (mortar method; C. Bernardi, Y. Maday, A. T. Patera 1994; M. A. Puso and
T. A. Laursen, Comput. Methods Appl. Mech. Engrg. 193 (2004) 601-629), so that a uniform pressure
crosses the interface exactly. Forces go back by the transpose: what the slave gets, the master
gives. Both surfaces and the sparse matrices between them are gathered on every rank: their memory
grows with the surfaces, which are small beside the bodies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers, Kind
from fenics_contact.common.parallel import gather_rows, of_every_rank, on_root
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.integrals import MortarIntegrals, integrate
from fenics_contact.contact.mortar.projection import Projection
from fenics_contact.contact.mortar.ray_projection import Hits, face, hits
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.contact.surface.trace import Trace


@dataclass(frozen=True, eq=False)
class _Faced:
    """What faces what, of the whole slave surface.

    Attributes:
        normals: Mean unit normals at its nodes, (nodes, components).
        gaps: Along them to the master, (nodes,); infinite where there is none (length).
        centre_normals: At the centres of its facets, (facets, components), or none.
        centre_gaps: Likewise, (facets,) or none.
        integrals: Between the two surfaces, and how much of each facet faces the master.
        faced: Nodes at which the master's motion is asked for, (nodes,).
    """

    normals: Array
    gaps: Array
    centre_normals: Array
    centre_gaps: Array
    integrals: MortarIntegrals
    faced: Flags


class Pairing:
    """A slave surface and its master.

    Attributes:
        normals: Mean normals at the slave's nodes of this rank, (nodes, components).
        centre_normals: At ``Trace.centres``.
        gaps: Along them from the slave's contact points to what faces them, as meshed: what
            moves is the jump's; infinite where there is nothing (length).
        shares: Of the slave's facets of this rank, how much faces the master.
        projection: P, of the whole surfaces: the displacement opposite is P u.
        faced: Nodes of the whole slave at which anything is opposite; the others have no jump.
        dofs: The body's global number of every dof of the master.
        sagitta: How far facets of either surface are from smooth ones, about (length).

    Args:
        slave: Its contact points.
        master: Those of the other surface.
        constrained: Dofs that supports hold (local indices, owned and ghost).
    """

    def __init__(self, slave: Trace, master: Trace, constrained: Integers) -> None:
        self._slave, self._master = slave, master
        self._comm = slave.spaces.comm
        self._surfaces = gathered(slave), gathered(master)
        self.dofs = master.surface.dofs
        self.sagitta = max(surface.sagitta for surface in self._surfaces)
        held = np.zeros(slave.spaces.coordinates.shape[0] * slave.spaces.components, dtype=bool)
        held[constrained] = True
        at_nodes = held.reshape(-1, slave.spaces.components)[slave.all_nodes]
        self._mirrored = slave.surface.gathered(slave.symmetry.in_planes() & at_nodes)
        self.update()

    def update(self, displacement: Array | None = None) -> None:
        """Find what faces what, the bodies displaced or as meshed; collective.

        Args:
            displacement: At the body's nodes of this rank, (nodes, components) (length).
        """
        slave, master = self._surfaces
        if displacement is not None:
            slave, master = (
                facets.moved(trace.surface.gathered(displacement[trace.all_nodes]))
                for facets, trace in zip(self._surfaces, (self._slave, self._master), strict=True)
            )
        faced = on_root(self._comm, lambda: self._find(slave, master))
        self._moved_master, self._is_moved = master, displacement is not None
        surface = self._slave.surface
        self.projection = Projection.between(faced.integrals, self._mirrored, faced.faced)
        self.faced = faced.faced
        self.normals = self._slave.symmetry.mirrored(faced.normals[surface.numbers])
        counts = of_every_rank(self._comm, len(surface.facet_nodes))
        first = sum(counts[: self._comm.rank])
        mine = slice(first, first + counts[self._comm.rank])
        self.shares = faced.integrals.coverage[mine]
        self.centre_normals = faced.centre_normals[mine]
        at_nodes = faced.gaps[surface.numbers][self._slave.numbers]
        self.gaps = np.concatenate([at_nodes, faced.centre_gaps[mine]])

    def as_meshed(self) -> None:
        """Find what faces what on the bodies as meshed, if it is of displaced ones; collective."""
        if self._is_moved:
            self.update()

    def _find(self, slave: FacetMesh, master: FacetMesh) -> _Faced:
        axisymmetric = self._slave.spaces.kinematics == "axisymmetric"
        normals, found = face(slave.node_positions(), slave.normals, master)
        integrals = integrate(slave, master, normals, axisymmetric)
        gaps = self._gaps(self._surfaces[0].node_positions(), normals, found)
        centre_normals, centre_gaps = np.zeros((0, slave.dimension)), np.zeros(0)
        at = np.isfinite(gaps)
        if not self._slave.nodal:
            own = normalised(self._surfaces[0].normals_at_centres())
            centre_normals, at_centres = face(slave.centres, own, master)
            centre_gaps = self._gaps(self._surfaces[0].centres, centre_normals, at_centres)
            at[slave.nodes[np.isfinite(centre_gaps)]] = True
        # Beyond the master's edge the projection extrapolates, and nothing asks for it.
        at &= integrals.mass.diagonal() > 0
        return _Faced(normals, gaps, centre_normals, centre_gaps, integrals, at)

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
        there = self._master.surface.gathered(field[self._master.all_nodes])
        numbers = self._slave.surface.numbers
        found = field[self._slave.all_nodes] - self.projection.apply(there)[numbers]
        found[~self.faced[numbers]] = 0.0
        return np.asarray(found)

    def on_master(self, force: Array) -> Array:
        """What forces on the slave do to the master, −Pᵀ f, at the body's nodes; collective.

        Args:
            force: At the slave's nodes of this rank, (nodes, components) (force).
        """
        given = self._slave.surface.gathered(force)
        surface = self._master.surface
        return surface.on_body(-self.projection.transposed(given)[surface.numbers])

    def master_nodes(self) -> Flags:
        """Which of the body's nodes are the master's; collective."""
        return self._master.surface.on_body(np.ones(len(self._master.all_nodes))) > 0

    def faced_masters(self) -> Flags:
        """Which of the body's nodes are the master's and move the slave at all; collective."""
        surface = self._master.surface
        columns = [part.nonzero_columns() for part in self.projection.components]
        moves = np.any(columns, axis=0)[surface.numbers]
        return surface.on_body(moves.astype(np.float64)) > 0

    def distances_from(self, points: Array, normals: Array) -> Array:
        """Along normals (points, components) from points (points, 3) to the master (length)."""
        return hits(self._moved_master, points[:, : normals.shape[1]], normals).distance

    def missed_opposite(self, points: Array, normals: Array) -> Array:
        """How far the curve lies outside of the master's facets, where points face them (length).

        Collective.

        Args:
            points: Of the slave as it stands, (points, 3) (length).
            normals: At these, (points, components).
        """
        found = hits(self._moved_master, points[:, : normals.shape[1]], normals)
        faces = found.facet >= 0
        missed = np.zeros(len(points))
        facets, reference = found.facet[faces], found.reference[faces]
        missed[faces] = SmoothSurface(self._surfaces[1]).offsets(facets, reference)
        return missed


def gathered(trace: Trace) -> FacetMesh:
    """A whole surface on every rank; collective."""
    surface, comm = trace.surface, trace.spaces.comm
    mesh, size = surface.mesh, surface.components
    count = len(surface.facet_nodes)
    points = mesh.geometry.x[compat.geometry_nodes(mesh)[:count]][..., :size]
    return FacetMesh(
        shape=mesh.topology.cell_name(),
        order=trace.spaces.geometry_order,
        degree=trace.spaces.degree,
        geometry=_joined(comm, points),
        nodes=_joined(comm, surface.numbers[surface.facet_nodes]),
        normals=surface.gathered(trace.normals_at_nodes),
    )


def _joined(comm: MPI.Comm, rows: NDArray[Kind]) -> NDArray[Kind]:
    """Rows of all ranks; collective."""
    return gather_rows(comm, rows)
