"""The facets of a contact surface as plain arrays, and where on them a function is least.

Every rank may hold all of them: nothing here knows a mesh of FEniCSx. For the least value of a
function, between nodes too, each rank samples its own facets, and the most promising ones again and
again around their best sample.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import basix
import numpy as np
from basix.finite_element import FiniteElement

from fenics_contact.common.arrays import AnyIntegers, Array, in_3d

_REFERENCE_SIZES = {"interval": 1.0, "triangle": 0.5, "quadrilateral": 1.0}


# Of spheres through the nodes, by order: corners lie inside in spite of round-off, and a curved
# facet leaves the sphere a little.
_MARGIN = {1: 1.001, 2: 1.2}


@dataclass(frozen=True, eq=False)
class FacetMesh:
    """All facets of a contact surface.

    Points on it are given by their facets (points,) and reference coordinates
    (points, dimension − 1).

    Attributes:
        shape: Reference cell of basix: "interval", "triangle" or "quadrilateral".
        order: Of the geometry, 1 or 2.
        degree: Of the Lagrange space of displacements, 1 or 2.
        geometry: Geometry nodes in the order of basix, (facets, geometry nodes, dimension)
            (length).
        nodes: Numbers of the displacement nodes, (facets, nodes of a facet).
        normals: Outward unit normals at all displacement nodes, (nodes, dimension).
    """

    shape: str
    order: int
    degree: int
    geometry: Array
    nodes: AnyIntegers
    normals: Array

    @property
    def dimension(self) -> int:
        """Dimension of space."""
        return int(self.geometry.shape[2])

    @property
    def node_count(self) -> int:
        """Number of displacement nodes."""
        return len(self.normals)

    @cached_property
    def centres(self) -> Array:
        """Positions of the facets' midpoints, (facets, dimension) (length)."""
        return self.positions(*self._midpoints)

    @cached_property
    def radii(self) -> Array:
        """Radii of spheres about the midpoints that hold the facets, (facets,) (length)."""
        distances = np.linalg.norm(self.geometry - self.centres[:, None], axis=2)
        return distances.max(axis=1, initial=0) * _MARGIN[self.order]

    @property
    def spacing(self) -> Array:
        """From one displacement node to the next on each facet, about, (facets,) (length)."""
        side = 2.0 if self.dimension == 2 else np.sqrt(2.0)
        return np.asarray(side * self.radii / self.degree)

    def shape_functions(self, reference: Array) -> Array:
        """Shape functions at reference points, (points, nodes of a facet)."""
        return np.asarray(_tabulate(self.shape, self.degree, reference, 0)[0])

    def shape_gradients(self, reference: Array) -> Array:
        """Gradients of shape functions, (dimension − 1, points, nodes of a facet)."""
        return _tabulate(self.shape, self.degree, reference, 1)[1:]

    def geometry_functions(self, reference: Array) -> tuple[Array, Array]:
        """Shape functions of the geometry and their gradients.

        Returns:
            (points, geometry nodes) and (dimension − 1, points, geometry nodes).
        """
        table = _tabulate(self.shape, self.order, reference, 1)
        return table[0], table[1:]

    def interpolate(self, nodal: Array, facets: AnyIntegers, reference: Array) -> Array:
        """A function of the space, given at all nodes (nodes, components), at points."""
        return np.asarray(
            np.einsum("pn,pnc->pc", self.shape_functions(reference), nodal[self.nodes[facets]])
        )

    def positions(self, facets: AnyIntegers, reference: Array) -> Array:
        """Places of points, (points, dimension) (length)."""
        values = _tabulate(self.shape, self.order, reference, 0)[0]
        return np.asarray(np.einsum("pn,pnd->pd", values, self.geometry[facets]))

    def tangents(self, facets: AnyIntegers, reference: Array) -> Array:
        """Tangents, ∂x/∂ξ of reference coordinates ξ, (points, dimension, dimension − 1)."""
        _, gradients = self.geometry_functions(reference)
        return np.asarray(np.einsum("kpn,pnd->pdk", gradients, self.geometry[facets]))

    def node_positions(self) -> Array:
        """Places of the displacement nodes, (nodes, dimension) (length)."""
        places = reference_nodes(self.shape, self.degree)
        facets = np.repeat(np.arange(len(self.nodes)), len(places))
        found = np.empty_like(self.normals)
        found[self.nodes.ravel()] = self.positions(facets, np.tile(places, (len(self.nodes), 1)))
        return found

    def normals_at_centres(self) -> Array:
        """Outward normals at ``centres``, as long as the facets' areas, (facets, dimension)."""
        return self.area_normals(*self._midpoints) * _REFERENCE_SIZES[self.shape]

    def area_normals(self, facets: AnyIntegers, reference: Array) -> Array:
        """Outward normals as long as the surface Jacobian, (points, dimension)."""
        return self._raw_normals(facets, reference) * self._orientations[facets, None]

    def moved(self, displacement: Array) -> FacetMesh:
        """The surface displaced; rotations are small, so its normals are those it has.

        Args:
            displacement: At all displacement nodes, (nodes, dimension) (length).
        """
        places = reference_nodes(self.shape, self.order)
        shift = np.einsum("gn,fnd->fgd", self.shape_functions(places), displacement[self.nodes])
        return replace(self, geometry=self.geometry + shift)

    @property
    def sagitta(self) -> float:
        """How far the facets are at most from the smooth surface that normals tell of (length)."""
        return float(self.sagittas.max(initial=0.0))

    @cached_property
    def sagittas(self) -> Array:
        """How far each facet is from the smooth surface that its normals tell of (length).

        An estimate, (facets,): r θ/2 of straight ones of half length r, with normals θ off at their
        ends; r θ³/32 of those of order 2 (the error of a parabola through an arc's ends and
        middle).
        """
        facets, midpoints = self._midpoints
        own = normalised(self.area_normals(facets, midpoints))
        off = np.linalg.norm(self.normals[self.nodes] - own[:, None], axis=2).max(axis=1, initial=0)
        return np.asarray(self.radii * (off / 2 if self.order == 1 else off**3 / 32))

    @property
    def _midpoints(self) -> tuple[AnyIntegers, Array]:
        """All facets, and the midpoint of each, (facets, dimension − 1)."""
        midpoint = reference_nodes(self.shape, 1).mean(axis=0)
        return np.arange(len(self.nodes)), np.tile(midpoint, (len(self.nodes), 1))

    @cached_property
    def _orientations(self) -> Array:
        """1 where the numbering of a facet gives the outward normal, −1 elsewhere, (facets,)."""
        outward = self.interpolate(self.normals, *self._midpoints)
        turned = np.einsum("fd,fd->f", outward, self._raw_normals(*self._midpoints)) < 0
        return np.where(turned, -1.0, 1.0)

    def _raw_normals(self, facets: AnyIntegers, reference: Array) -> Array:
        tangents = self.tangents(facets, reference)
        if self.dimension == 2:
            return np.stack([tangents[:, 1, 0], -tangents[:, 0, 0]], axis=1)
        return np.cross(tangents[:, :, 0], tangents[:, :, 1])


def reference_nodes(shape: str, degree: int) -> Array:
    """Nodes of a Lagrange element on the reference cell, (nodes, dimension − 1)."""
    return np.asarray(_element(shape, degree).points)


def normalised(vectors: Array) -> Array:
    """Vectors of length 1, (vectors, dimension)."""
    return np.asarray(vectors / np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None])


def _tabulate(shape: str, degree: int, reference: Array, order: int) -> Array:
    """Shape functions and, of order 1, gradients, (1 + dimension − 1, points, nodes)."""
    element = _element(shape, degree)
    if len(reference) == 0:  # of no points, basix 0.9 aborts
        return np.zeros((1 + order * reference.shape[1], 0, element.dim))
    table = element.tabulate(order, np.ascontiguousarray(reference))
    return np.asarray(table[..., 0])


@lru_cache
def _element(shape: str, degree: int) -> FiniteElement:
    # Equispaced at these degrees: the element of both the geometry and the displacement.
    return basix.create_element(
        basix.ElementFamily.P,
        getattr(basix.CellType, shape),
        degree,
        basix.LagrangeVariant.gll_warped,
    )


# So many facets are looked at more closely: they may all lie in one contact.
_PROMISING = 64
# Samples between two neighbours of the best one, in each direction, by the dimension of facets.
# Few rounds of many samples take less along a line, many rounds of few in a face.
_CLOSER = {1: 8, 2: 2}
#: How close samples come together at last, over the distance of the first ones: for a place.
CLOSEST = 2.0**-16
#: The same for a depth alone: a smooth one is then off by 1e-5 of what it differs by between these.
CLOSE = 2.0**-8


@dataclass(frozen=True, eq=False)
class FacetSamples:
    """Places on facets, as many on each.

    Attributes:
        mesh: The surface.
        facets: Numbers of the facets, (facets,).
        reference: Places on them, (facets, samples, dimension − 1).
    """

    mesh: FacetMesh
    facets: AnyIntegers
    reference: Array

    @cached_property
    def positions(self) -> Array:
        """Places of all samples, those of one facet after those of another, (…, 3) (length)."""
        mesh = self.mesh
        return in_3d(self._summed(self._functions(mesh.order), mesh.geometry[self.facets]))

    def interpolate(self, nodal: Array) -> Array:
        """A function of the space, given at all nodes (nodes, components), at all samples."""
        mesh = self.mesh
        return self._summed(self._functions(mesh.degree), nodal[mesh.nodes[self.facets]])

    def _functions(self, degree: int) -> Array:
        """Shape functions of a degree, (facets, samples, nodes of a facet)."""
        if degree not in self._known:
            flat = self.reference.reshape(-1, self.reference.shape[2])
            found = _tabulate(self.mesh.shape, degree, flat, 0)[0]
            self._known[degree] = found.reshape(*self.reference.shape[:2], found.shape[1])
        return self._known[degree]

    @cached_property
    def _known(self) -> dict[int, Array]:
        return {}

    def _summed(self, functions: Array, of_nodes: Array) -> Array:
        """Shape functions times values at the nodes of each facet, (samples of all, components)."""
        return np.asarray(functions @ of_nodes).reshape(-1, of_nodes.shape[2])


# Values at samples, those of one facet after those of another; infinite where there is none.
PointFunction = Callable[[FacetSamples], Array]


@dataclass(frozen=True, eq=False)
class LowestPoints:
    """The lowest point of each facet.

    Attributes:
        values: There, (facets,); infinite on facets without samples.
        reference: Places on the facets, (facets, dimension − 1).
    """

    values: Array
    reference: Array


def lowest_points(
    mesh: FacetMesh, counts: AnyIntegers, function: PointFunction, closest: float
) -> LowestPoints:
    """Find the lowest point of each facet.

    Args:
        mesh: The surface.
        counts: Samples along a facet's side, (facets,); of none nothing is looked at.
        function: What is to be least.
        closest: How close samples come together at last, over the distance of the first ones.
    """
    middle = reference_nodes(mesh.shape, 1).mean(axis=0)
    values = np.full(len(counts), np.inf)
    reference = np.tile(middle, (len(counts), 1))
    for count in np.unique(counts[counts > 0]):
        facets, samples = np.flatnonzero(counts == count), _samples(mesh.shape, int(count))
        every = np.broadcast_to(samples, (len(facets), *samples.shape))
        found = _at(function, mesh, facets, every)
        best = found.argmin(axis=1)
        values[facets], reference[facets] = found[np.arange(len(facets)), best], samples[best]
    promising = np.argsort(values, kind="stable")[:_PROMISING]
    promising = promising[np.isfinite(values[promising])]
    width, dimension = 1 / np.maximum(counts[promising], 1), reference.shape[1]
    closer = _CLOSER[dimension]
    along = np.linspace(-1.0, 1.0, 2 * closer + 1)
    around = np.stack(np.meshgrid(*[along] * dimension), axis=-1).reshape(-1, dimension)
    rounds = round(np.log(1 / closest) / np.log(closer))
    for _ in range(rounds if len(promising) else 0):
        steps = around * width[:, None, None]
        places = _inside(mesh.shape, reference[promising, None] + steps)
        found = _at(function, mesh, promising, places)
        rows, best = np.arange(len(promising)), found.argmin(axis=1)
        better = found[rows, best] < values[promising]
        values[promising] = np.where(better, found[rows, best], values[promising])
        chosen = np.where(better[:, None], places[rows, best], reference[promising])
        reference[promising] = chosen
        width = width / closer
    return LowestPoints(values, reference)


def _at(function: PointFunction, mesh: FacetMesh, facets: AnyIntegers, places: Array) -> Array:
    """Values at places (facets, samples, dimension − 1), (facets, samples)."""
    return function(FacetSamples(mesh, facets, places)).reshape(places.shape[:2])


def _samples(shape: str, count: int) -> Array:
    """Points spread over a reference cell, (samples, dimension − 1)."""
    along = (np.arange(count) + 0.5) / count
    if shape == "interval":
        return along[:, None]
    places = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
    return places if shape == "quadrilateral" else places[places.sum(axis=1) <= 1.0]


def _inside(shape: str, places: Array) -> Array:
    """Places moved into the reference cell, (..., dimension − 1)."""
    places = np.clip(places, 0.0, 1.0)
    if shape == "triangle":
        beyond = np.maximum(places[..., 0] + places[..., 1] - 1.0, 0.0)
        places = np.clip(places - beyond[..., None] / 2, 0.0, 1.0)
    return np.asarray(places)
