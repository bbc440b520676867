"""Mortar coupling of two contact surfaces whose meshes do not match."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import AnyIntegers, Array
from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.overlap import Overlap
from fenics_contact.contact.mortar.polygon_overlap import polygon_overlaps
from fenics_contact.contact.mortar.segment_overlap import segment_overlap

# Share of a facet that faces the master, at the least. Below, quadratic shape functions that vanish
# at the covered end are multiples of each other there to about the share, and the mass of their
# nodes is singular to about its square.
_LEAST_COVERAGE = 1e-4


@dataclass(frozen=True, eq=False)
class MortarIntegrals:
    """Integrals over the part of the slave that faces the master.

    Both matrices come from the same quadrature points, so that mass⁻¹ coupling reproduces
    constants, and on flat surfaces all functions that lie in both spaces.

    Attributes:
        mass: ∫ N_i N_j of the slave's shape functions, (slave nodes, slave nodes) (area).
        coupling: ∫ N_i(x) N_j(y(x)), the second one the master's, at the point y that faces x,
            (slave nodes, master nodes) (area).
        coverage: Share of each slave facet's area that faces the master, 0 to 1, without the
            weight of rings, (slave facets,).
    """

    mass: csr_matrix
    coupling: csr_matrix
    coverage: Array


def integrate(
    slave: FacetMesh, master: FacetMesh, mean_normals: Array, is_axisymmetric: bool
) -> MortarIntegrals:
    """The mortar integrals, without facets of which next to nothing faces the master.

    Args:
        slave: The surface whose shape functions are the mortar space.
        master: The other surface.
        mean_normals: Directions of rays to the master at the slave's nodes, (nodes, dimension).
        is_axisymmetric: Whether integrals are over rings, with the weight 2πr.
    """
    overlaps = partial(_overlaps, slave, master, mean_normals)
    whole = _summed(slave, master, overlaps(), is_axisymmetric)
    slivers = (whole.coverage > 0) & (whole.coverage < _LEAST_COVERAGE)
    if not slivers.any():
        return whole
    return _summed(slave, master, (part.without(slivers) for part in overlaps()), is_axisymmetric)


def _overlaps(slave: FacetMesh, master: FacetMesh, mean_normals: Array) -> Iterator[Overlap]:
    """Common segments or triangles of both surfaces, some at a time."""
    degree = _quadrature_degree(slave, master)
    if len(slave.nodes) == 0:  # as on a rank that the surface misses
        return
    if slave.dimension == 2:
        yield segment_overlap(slave, master, mean_normals, degree)
    else:
        yield from polygon_overlaps(slave, master, mean_normals, degree)


def _summed(
    slave: FacetMesh, master: FacetMesh, overlaps: Iterable[Overlap], is_axisymmetric: bool
) -> MortarIntegrals:
    """The integrals over common segments or triangles."""
    mass = csr_matrix((slave.node_count, slave.node_count))
    coupling = csr_matrix((slave.node_count, master.node_count))
    coverage = np.zeros(len(slave.nodes))
    for overlap in overlaps:
        coverage += np.bincount(overlap.slave, overlap.shares, minlength=len(coverage))
        ours = _values(slave, overlap.slave_reference)
        theirs = _values(master, overlap.master_reference)
        weighted = ours * _weights(slave, overlap, is_axisymmetric)[:, :, None]
        rows = slave.nodes[overlap.slave]
        mass += _assembled(weighted, ours, rows, rows, mass.shape)
        columns = master.nodes[overlap.master]
        coupling += _assembled(weighted, theirs, rows, columns, coupling.shape)
    return MortarIntegrals(mass, coupling, np.minimum(coverage, 1.0))


def _quadrature_degree(slave: FacetMesh, master: FacetMesh) -> int:
    """Degree that products of shape functions need on flat facets that are not distorted."""
    degree = slave.degree + max(slave.degree, master.degree)
    if slave.dimension == 2:
        return degree + 2  # the radius of rings is of the geometry's order
    return degree * (2 if "quadrilateral" in (slave.shape, master.shape) else 1)


def _values(mesh: FacetMesh, reference: Array) -> Array:
    """Shape functions at the points of cells, (cells, points, nodes of a facet)."""
    flat = mesh.shape_functions(reference.reshape(-1, reference.shape[2]))
    return flat.reshape(*reference.shape[:2], mesh.nodes.shape[1])


def _weights(slave: FacetMesh, overlap: Overlap, is_axisymmetric: bool) -> Array:
    """Weights of the integrals, (cells, points)."""
    if not is_axisymmetric:
        return overlap.weights
    reference = overlap.slave_reference
    facets = np.repeat(overlap.slave, reference.shape[1])
    radii = slave.positions(facets, reference.reshape(-1, reference.shape[2]))[:, 0]
    return 2 * np.pi * radii.reshape(overlap.weights.shape) * overlap.weights


def _assembled(
    weighted: Array, values: Array, rows: AnyIntegers, columns: AnyIntegers, shape: tuple[int, int]
) -> csr_matrix:
    """Σ over points of products of shape functions, summed over cells."""
    local = weighted.transpose(0, 2, 1) @ values
    row = np.broadcast_to(rows[:, :, None], local.shape)
    column = np.broadcast_to(columns[:, None, :], local.shape)
    return csr_matrix((local.ravel(), (row.ravel(), column.ravel())), shape=shape)
