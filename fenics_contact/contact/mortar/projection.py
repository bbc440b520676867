"""The mortar coupling of two surfaces: its integrals D and M, and the projection P = D⁻¹ M.

P is kept as a sparse factor of D and a sparse M, as it is full: a slave's
node follows all of the master, if less and less so with the distance. It is applied, and never
written out: memory and work grow with the surfaces, not with their square.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from scipy.sparse import csc_array, csc_matrix, csr_matrix, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.overlap import Overlap, nearest_layer, segment_overlap
from fenics_contact.contact.mortar.polygon_overlap import polygon_overlaps

# Share of a facet that faces the master, at the least. Below, quadratic shape functions that vanish
# at the covered end are multiples of each other there to about the share, and the mass of their
# nodes is singular to about its square.
_LEAST_COVERAGE = 1e-4
# Of a facet that faces the master more than once, as a coarse one before a stack of plates does.
_LAYERED = 1e-6


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
    layered = whole.coverage > 1 + _LAYERED
    if layered.any():
        overlaps = partial(_nearest, overlaps, slave, master, mean_normals, layered)
        whole = _summed(slave, master, overlaps(), is_axisymmetric)
    slivers = (whole.coverage > 0) & (whole.coverage < _LEAST_COVERAGE)
    if slivers.any():
        kept = (part.without(slivers) for part in overlaps())
        whole = _summed(slave, master, kept, is_axisymmetric)
    return replace(whole, coverage=np.minimum(whole.coverage, 1.0))


def _nearest(
    overlaps: Callable[[], Iterator[Overlap]],
    slave: FacetMesh,
    master: FacetMesh,
    mean_normals: Array,
    layered: Flags,
) -> Iterator[Overlap]:
    """Overlaps of the slave with the nearest of several layers of the master."""
    return (nearest_layer(part, slave, master, mean_normals, layered) for part in overlaps())


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
    return MortarIntegrals(mass, coupling, coverage)


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


_COLUMNS = 50  # treated at a time: they stay in the processor's cache


class MassFactor:
    """D⁻¹ between the nodes that the mortar space has.

    Args:
        mass: D, symmetric with a positive diagonal, (nodes, nodes) (area).

    Attributes:
        mass: As given.
        parts: Number of the connected part of D that each node belongs to, (nodes,).
    """

    def __init__(self, mass: csr_matrix) -> None:
        self.mass = mass
        # Nodes at the border of the covered part have little mass.
        self._scale = 1 / np.sqrt(mass.diagonal())
        scaling = diags_array(self._scale)
        scaled = csc_array(scaling @ mass @ scaling)
        self._factor = splu(scaled, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        _, self.parts = connected_components(mass, directed=False)

    def solve(self, right: Array, transposed: bool = False) -> Array:
        """D⁻¹, or its transpose to the last digit, times columns, (nodes, columns)."""
        scale = self._scale[:, None]
        return np.asarray(self._factor.solve(scale * right, "T" if transposed else "N") * scale)


class NodalProjection:
    """P of one component, or some rows and columns of it.

    Attributes:
        shape: Numbers of slave and of master nodes.

    Args:
        factor: D⁻¹ between the nodes of the mortar space, None where there are none.
        rows: Of each slave node, its number in the mortar space; −1 where P is 0.
        coupling: M, (nodes of the mortar space, master nodes) (area).
    """

    def __init__(self, factor: MassFactor | None, rows: Integers, coupling: csr_matrix) -> None:
        self._factor, self._rows, self._coupling = factor, rows, coupling
        self._acts = np.flatnonzero(rows >= 0)
        self.shape = len(rows), coupling.shape[1]

    @classmethod
    def between(cls, integrals: MortarIntegrals, fixed: Flags, used: Flags) -> NodalProjection:
        """P of mortar integrals.

        Rows of nodes without a part that faces the master are 0.

        Args:
            integrals: The mortar integrals.
            fixed: Nodes taken out of the mortar space, where P is 0, (slave nodes,).
            used: Nodes whose rows are kept; the others' are 0, (slave nodes,).
        """
        active = np.flatnonzero((integrals.mass.diagonal() > 0) & ~fixed)
        rows = np.full(len(fixed), -1)
        rows[active] = np.arange(len(active))
        rows[~used] = -1
        factor = MassFactor(integrals.mass[active][:, active]) if len(active) else None
        return cls(factor, rows, csr_matrix(integrals.coupling[active]))

    def restricted(self, rows: AnyIntegers, columns: AnyIntegers) -> NodalProjection:
        """Some rows and columns of P, with the same factor."""
        return NodalProjection(self._factor, self._rows[rows], self._coupling[:, columns])

    def times(self, matrix: csr_matrix) -> NodalProjection:
        """P times a matrix of the displacements of master nodes over others, in their place."""
        return NodalProjection(self._factor, self._rows, csr_matrix(self._coupling @ matrix))

    @property
    def equations(self) -> tuple[csr_matrix, Integers, csr_matrix] | None:
        """P v = u as the sparse equations D q = M v, u = q at the rows; None where P is 0.

        Returns:
            D, of each row its number among q (−1 where P is 0), and M.
        """
        return None if self._factor is None else (self._factor.mass, self._rows, self._coupling)

    def apply(self, values: Array) -> Array:
        """P v, (slave nodes, ...), of values (master nodes, ...)."""
        factor = self._factor
        found = np.zeros((self.shape[0], *values.shape[1:]))
        if factor is None or not values.any():
            return found

        def product(columns: Array) -> Array:
            return factor.solve(self._coupling @ columns)[self._rows[self._acts]]

        found[self._acts] = columns_together(product, values, len(self._acts))
        return found

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (master nodes, ...), of forces (slave nodes, ...)."""
        factor = self._factor
        if factor is None:
            return np.zeros((self.shape[1], *forces.shape[1:]))

        def product(columns: Array) -> Array:
            given = np.zeros((self._coupling.shape[0], columns.shape[1]))
            given[self._rows[self._acts]] = columns[self._acts]
            return np.asarray(self._coupling_transposed @ factor.solve(given, transposed=True))

        return columns_together(product, forces, self.shape[1])

    @cached_property
    def _coupling_transposed(self) -> csc_matrix:
        """Mᵀ, of the same entries."""
        return self._coupling.T

    def written_rows(self, rows: AnyIntegers) -> Array:
        """Some rows of P, written out, (rows, master nodes)."""
        units = np.zeros((self.shape[0], len(rows)))
        units[rows, np.arange(len(rows))] = 1.0
        return self.transposed(units).T

    def nonzero_rows(self) -> Flags:
        """Flags of slave nodes for which P has entries, (slave nodes,).

        D⁻¹ is full between nodes of a connected part of D, and 0 between two parts.
        """
        found = np.zeros(self.shape[0], dtype=bool)
        if self._factor is None:
            return found
        parts = self._factor.parts
        coupled = np.zeros(parts.max(initial=-1) + 1, dtype=bool)
        np.logical_or.at(coupled, parts, np.diff(self._coupling.indptr) > 0)
        found[self._acts] = coupled[parts[self._rows[self._acts]]]
        return found

    def nonzero_columns(self) -> Flags:
        """Flags of master nodes with an entry in M, (master nodes,): P is 0 at the others."""
        return np.bincount(self._coupling.indices, minlength=self.shape[1]) > 0


class Projection:
    """P between displacements: one for each of their components, which do not mix.

    Attributes:
        components: P by components, between nodes; equal ones are the same object.
        size: Number of components.
    """

    def __init__(self, components: Sequence[NodalProjection]) -> None:
        self.components = tuple(components)
        self.size = len(self.components)

    @classmethod
    def between(cls, integrals: MortarIntegrals, fixed: Flags, used: Flags) -> Projection:
        """P of mortar integrals.

        Args:
            integrals: The mortar integrals.
            fixed: Nodes taken out of the mortar space, (slave nodes, components).
            used: Nodes whose rows are kept; the others' are 0, (slave nodes,).
        """
        found: list[NodalProjection] = []
        for axis, nodes in enumerate(fixed.T):
            same = [k for k in range(axis) if (fixed[:, k] == nodes).all()]
            made = found[same[0]] if same else NodalProjection.between(integrals, nodes, used)
            found.append(made)
        return cls(found)

    def blocks(self) -> list[tuple[Integers, Integers, NodalProjection]]:
        """Dofs of the slave and of the master, by node and component, and P between them."""
        every = []
        for axis, part in enumerate(self.components):
            slave, master = (np.arange(count) * self.size + axis for count in part.shape)
            every.append((slave, master, part))
        return every

    def apply(self, values: Array) -> Array:
        """P v, (slave nodes, components, ...), of values (master nodes, components, ...)."""
        parts = [part.apply(values[:, axis]) for axis, part in enumerate(self.components)]
        return np.stack(parts, axis=1)

    def transposed(self, forces: Array) -> Array:
        """Pᵀ f, (master nodes, components, ...), of forces (slave nodes, components, ...)."""
        parts = [part.transposed(forces[:, axis]) for axis, part in enumerate(self.components)]
        return np.stack(parts, axis=1)


def columns_together(product: Callable[[Array], Array], values: Array, rows: int) -> Array:
    """A product with values (nodes, ...), some columns at a time, (rows, ...)."""
    flat = values.reshape(len(values), math.prod(values.shape[1:]))
    found = np.empty((rows, flat.shape[1]))
    for part in parts_of(flat.shape[1], _COLUMNS):
        found[:, part] = product(flat[:, part])
    return found.reshape(rows, *values.shape[1:])


def parts_of(count: int, size: int) -> Iterator[slice]:
    """So many numbers, some at a time."""
    return (slice(begin, begin + size) for begin in range(0, count, size))
