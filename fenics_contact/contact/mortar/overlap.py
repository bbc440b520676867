"""Quadrature points common to two contact surfaces, and which of their facets share some."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, reference_nodes
from fenics_contact.contact.mortar.ray_projection import entries_behind, near_lines

# Corners of the straight pieces of a facet, in turn, among its geometry nodes. Curved segments
# need none: their ends are projected onto the true facet.
_PIECES = {
    ("interval", 1): [[0, 1]],
    ("interval", 2): [[0, 1]],
    ("triangle", 1): [[0, 1, 2]],
    ("triangle", 2): [[0, 5, 4], [5, 1, 3], [4, 3, 2], [3, 4, 5]],
    ("quadrilateral", 1): [[0, 1, 3, 2]],
    ("quadrilateral", 2): [[0, 4, 8, 5], [4, 1, 6, 8], [5, 8, 7, 2], [8, 6, 3, 7]],
}
LEAST_SHARE = 1e-9  # of a facet's area: smaller overlaps are round-off
_MARGIN = 1.1  # of the radii of straight pieces, for curved ones


@dataclass(frozen=True, eq=False)
class Overlap:
    """Quadrature points on segments or triangles ("cells") common to both surfaces.

    Attributes:
        slave: Slave facet of every cell, (cells,).
        master: Master facet of every cell, (cells,).
        slave_reference: Points on the slave facet, (cells, points, dimension − 1).
        master_reference: The points that face them, (cells, points, dimension − 1).
        weights: Of the integral over the slave's surface, (cells, points) (length^(dimension − 1)).
        shares: Of the slave facet's area, (cells,).
    """

    slave: AnyIntegers
    master: AnyIntegers
    slave_reference: Array
    master_reference: Array
    weights: Array
    shares: Array

    def without(self, facets: Flags) -> Overlap:
        """Cells on other facets of the slave than these.

        Args:
            facets: Which facets of the slave are left out, (slave facets,).
        """
        kept = ~facets[self.slave]
        return Overlap(*(getattr(self, each.name)[kept] for each in fields(self)))


@dataclass(frozen=True, eq=False)
class Pieces:
    """Straight pieces of facets: all of a segment, a whole flat facet, quarters of curved ones.

    Attributes:
        facets: Facet of every piece, (pieces,).
        reference: The piece's centre on it, (pieces, dimension − 1).
        corners: In turn, (pieces, corners, dimension) (length).
        centres: Mean of the corners, (pieces, dimension) (length).
        radii: Of spheres about the centres, (pieces,) (length).
    """

    facets: AnyIntegers
    reference: Array
    corners: Array
    centres: Array
    radii: Array


def pieces(mesh: FacetMesh) -> Pieces:
    """The pieces of all facets, in the order of the facets."""
    table = np.array(_PIECES[mesh.shape, mesh.order])
    count = len(mesh.nodes)
    corners = mesh.geometry[:, table].reshape(-1, table.shape[1], mesh.dimension)
    reference = reference_nodes(mesh.shape, mesh.order)[table].mean(axis=1)
    centres = corners.mean(axis=1)
    return Pieces(
        np.repeat(np.arange(count), len(table)),
        np.tile(reference, (count, 1)),
        corners,
        centres,
        _MARGIN * np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1, initial=0),
    )


def facing_pairs(
    slave: Pieces, directions: Array, spreads: Array, surface: FacetMesh, master: Pieces
) -> tuple[AnyIntegers, AnyIntegers]:
    """Pairs (slave piece, master piece) that may face each other, of several layers the nearest.

    Args:
        slave: Pieces from whose centres the rays begin.
        directions: Mean normals there, (slave pieces, dimension).
        spreads: How much the mean normal differs within each piece, (slave pieces,).
        surface: The other surface.
        master: Its pieces.
    """
    found = near_lines(
        slave.centres, directions, slave.radii, spreads, master.centres, master.radii
    )
    tables = list(found)
    first = np.concatenate([table[0] for table in tables])
    second = np.concatenate([table[1] for table in tables])
    outward = surface.area_normals(master.facets, master.reference)
    opposed = np.einsum("pd,pd->p", directions[first], outward[second]) < 0
    first, second = first[opposed], second[opposed]
    reach = master.centres[second] - slave.centres[first]
    along = np.einsum("pd,pd->p", reach, directions[first])
    size = 2 * (slave.radii[first] + master.radii[second])
    far_behind = along < -size
    if far_behind.any():
        lines = np.unique(first[far_behind])
        reaches = np.full(len(slave.centres), np.inf)
        reaches[lines] = entries_behind(surface, slave.centres[lines], directions[lines])
        kept = ~far_behind | (-along < reaches[first])
        first, second, along, size = first[kept], second[kept], along[kept], size[kept]
    distance = np.abs(along)
    least = np.full(len(slave.centres), np.inf)
    np.minimum.at(least, first, distance)
    near = distance <= least[first] + size
    return first[near], second[near]
