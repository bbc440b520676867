"""Distance of the facets of a curved surface from the curve that they replace.

Nodes of a mesh lie on the curve, facets between them do not. Through the nodes of a facet and of
its neighbours goes a polynomial of higher degree than the facet's own: what is between the two is
the facet's error but for a part of higher order. A quadratic facet on an arc of radius R needs
degree 4: the error of the parabola through its ends and middle is x² (r² − x²)/(8R³).
"""

from __future__ import annotations

from functools import cache, cached_property
from itertools import combinations_with_replacement

import numpy as np
from scipy.sparse import csr_matrix

from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised, reference_nodes

# Cosine of the angle between neighbouring facets beyond which there is an edge between them; and
# beyond which one says nothing of what the other misses. Eighths of a circle are common facets, and
# their angle is no more: not round-off is to decide what they are.
_EDGE = float(np.cos(np.pi / 4)) - 1e-9
# Degree of the polynomials by the facets' order, of lines and of surfaces. Beside a triangle with
# straight sides there are about twelve other nodes: enough for degree 2, which has its error.
_DEGREES = {2: {1: 3, 2: 4}, 3: {1: 2, 2: 4}}
# Of the turn between two facets, below which others are parallel to one of them.
_PARALLEL = 0.25
# The facet's own nodes count so much more than its neighbours': the polynomial is to pass them.
_OWN = 1e3
# Power of the distance, in the facet's radii, with which other nodes count less: what the surface
# is beyond the polynomial's degree grows with the distance, and is not to turn what is near.
_FADING = 4
# Facets whose polynomials are made at a time.
_AT_A_TIME = 500
# Rings of neighbours, at the most, until there are enough nodes: at ends of the surface two.
_RINGS = 3
# Distances over the facet's radius that are round-off of coordinates.
_FLAT = 1e-9


class SmoothSurface:
    """A surface with what its facets miss.

    Args:
        facets: All of it.
    """

    def __init__(self, facets: FacetMesh) -> None:
        self._facets = facets
        self._wanted = _DEGREES[facets.dimension][facets.order]
        # Of the height of each facet; of lower degrees the further ones are 0.
        self._fits = np.zeros((len(facets.nodes), self._coefficients(self._wanted)))
        self._is_fitted = np.zeros(len(facets.nodes), dtype=bool)

    def offsets(self, facet: AnyIntegers, reference: Array) -> Array:
        """How far the curve lies outside of points on facets, (points,) (length).

        Args:
            facet: That of each point, (points,).
            reference: Where on it, (points, dimension − 1).
        """
        found = np.zeros(len(facet))
        if self._is_flat:
            return found
        local = self._local(facet, self._facets.positions(facet, reference))
        turning = np.flatnonzero(self._turns[facet])
        fits = self._fitted(facet[turning])
        powers = _powers(local[turning, :-1], self._wanted)
        found[turning] = np.einsum("pm,pm->p", powers, fits) - local[turning, -1]
        return found * self._facets.radii[facet]

    def at_nodes(self) -> Array:
        """Offsets at all displacement nodes, the mean of their facets, (nodes,) (length)."""
        mesh = self._facets
        sums, counts = np.zeros(mesh.node_count), np.zeros(mesh.node_count)
        facet = np.repeat(np.arange(len(mesh.nodes)), mesh.nodes.shape[1])
        places = np.tile(reference_nodes(mesh.shape, mesh.degree), (len(mesh.nodes), 1))
        np.add.at(sums, mesh.nodes.ravel(), self.offsets(facet, places))
        np.add.at(counts, mesh.nodes.ravel(), 1.0)
        return sums / np.maximum(counts, 1.0)

    @cached_property
    def _is_flat(self) -> bool:
        places = self._facets.geometry.reshape(-1, self._facets.dimension)
        centred = places - places.mean(axis=0)
        widths = np.linalg.svd(centred, compute_uv=False)
        return bool(widths[-1] <= _FLAT * widths[0])

    @cached_property
    def _turns(self) -> Flags:
        """Facets with another normal next to them, (facets,): others lie flat."""
        mesh = self._facets
        corners = reference_nodes(mesh.shape, 1)
        facet = np.repeat(np.arange(len(mesh.nodes)), len(corners))
        normals = normalised(mesh.area_normals(facet, np.tile(corners, (len(mesh.nodes), 1))))
        numbers = self._node_numbers[:, : len(corners)]
        lowest = np.full((len(self._places), mesh.dimension), np.inf)
        highest = -lowest
        np.minimum.at(lowest, numbers.ravel(), normals)
        np.maximum.at(highest, numbers.ravel(), normals)
        low, high = lowest[numbers].min(axis=1), highest[numbers].max(axis=1)
        beside = (high - low).max(axis=1) > _FLAT
        return np.asarray(beside & self._is_near_curve(normals.reshape(len(mesh.nodes), -1)))

    def _is_near_curve(self, at_corners: Array) -> Flags:
        """Facets whose polynomial may be no plane, (facets,): a curved one is in their rings.

        One that is curved itself, or that turns from a neighbour by less than an edge does. What
        lies in the rings of others is flat, as on the sides of a block.

        Args:
            at_corners: Normals at the facets' corners, (facets, corners × dimension).
        """
        share_node, normals = self._share_node, self._frames[:, -1]
        one, other = share_node.nonzero()
        turns = np.linalg.norm(normals[one] - normals[other], axis=1) > _FLAT
        turns &= np.einsum("pi,pi->p", normals[one], normals[other]) > _EDGE
        middles = np.tile(normals, at_corners.shape[1] // normals.shape[1])
        found = np.abs(at_corners - middles).max(axis=1) > _FLAT
        found[one[turns]] = True
        for _ in range(_RINGS):
            found = share_node @ found > 0
        return np.asarray(found)

    def _fitted(self, numbers: AnyIntegers) -> Array:
        """Polynomials of facets, (facets, coefficients); each is made when it is asked for first.

        Args:
            numbers: Of the facets, (facets,); those of one may stand there several times.
        """
        missing = np.unique(numbers[~self._is_fitted[numbers]])
        for first in range(0, len(missing), _AT_A_TIME):
            self._fit(missing[first : first + _AT_A_TIME])
        return np.asarray(self._fits[numbers])

    def _fit(self, numbers: AnyIntegers) -> None:
        """Find the heights of facets over their middle planes, in their radii.

        By least squares, of all facets with polynomials of the same degree together. Where several
        are as near, by the one with the least coefficients.

        Args:
            numbers: Of the facets, (facets,), each once.
        """
        dimension = self._facets.dimension - 1
        own, nodes = self._node_numbers[numbers], self._nodes_around(numbers)
        counts = (nodes >= 0).sum(axis=1)
        is_own = (nodes[:, :, None] == own[:, None, :]).any(axis=2)
        where = np.repeat(numbers, nodes.shape[1])
        local = self._local(where, self._places[nodes.ravel()]).reshape(*nodes.shape, -1)
        distances = np.maximum(np.linalg.norm(local[..., :-1], axis=-1), 1.0)
        weights = np.where(is_own, _OWN, distances**-_FADING) * (nodes >= 0)
        sizes = [self._coefficients(degree) for degree in range(self._wanted + 1)]
        degrees = np.searchsorted(sizes, counts, side="right") - 1
        for degree in np.unique(degrees).tolist():
            rows = np.flatnonzero(np.minimum(degrees, self._wanted) == degree)
            powers = _powers(local[rows, :, :-1].reshape(-1, dimension), degree)
            powers = powers.reshape(len(rows), nodes.shape[1], -1)
            heights = local[rows, :, -1]
            found = _least_squares(powers, heights, weights[rows], counts[rows])
            self._fits[numbers[rows], : sizes[degree]] = found
        self._is_fitted[numbers] = True

    def _coefficients(self, degree: int) -> int:
        """Number of coefficients of a polynomial."""
        return len(_exponents(self._facets.dimension - 1, degree))

    def _nodes_around(self, numbers: AnyIntegers) -> AnyIntegers:
        """Geometry nodes of facets and of those around each that no edge parts from it.

        Without those that are turned so far that no height over the facet describes them well.

        Args:
            numbers: Of the facets, (facets,).

        Returns:
            (facets, most nodes), −1 for none.
        """
        normals, every = self._frames[:, -1], np.arange(len(numbers))
        shape = len(numbers), len(normals)
        rings = csr_matrix((np.ones(len(numbers)), (every, numbers)), shape=shape)
        growing = np.ones(len(numbers), dtype=bool)
        for _ in range(_RINGS):
            of, other = (rings @ self._goes_on).nonzero()
            kept = growing[of] & (_dots(normals[numbers[of]], normals[other]) > _EDGE)
            grown = np.ones(kept.sum()), (of[kept], other[kept])
            rings = rings + csr_matrix(grown, shape=shape)
            nodes = csr_matrix(rings @ self._has_node)
            growing = np.diff(nodes.indptr) < self._fits.shape[1]
        return _padded(nodes)

    @cached_property
    def _numbering(self) -> tuple[Array, AnyIntegers]:
        """Places of geometry nodes, each once, and their numbers, (facets, geometry nodes)."""
        mesh = self._facets
        places = mesh.geometry.reshape(-1, mesh.dimension)
        size = np.abs(places).max(initial=0.0) or 1.0
        _, first, numbers = np.unique(
            np.round(places / size, 9), axis=0, return_index=True, return_inverse=True
        )
        return places[first], numbers.reshape(mesh.geometry.shape[:2])

    @property
    def _places(self) -> Array:
        return self._numbering[0]

    @property
    def _node_numbers(self) -> AnyIntegers:
        return self._numbering[1]

    @cached_property
    def _has_node(self) -> csr_matrix:
        """Incidence matrix of facets and geometry nodes: 1 at the nodes of a facet."""
        numbers = self._node_numbers
        facet = np.repeat(np.arange(len(numbers)), numbers.shape[1])
        return csr_matrix((np.ones(facet.size), (facet, numbers.ravel())))

    @cached_property
    def _share_node(self) -> csr_matrix:
        """How many nodes any two facets share, (facets, facets); also a facet with itself."""
        return csr_matrix(self._has_node @ self._has_node.T)

    @cached_property
    def _goes_on(self) -> csr_matrix:
        """Facets with a node of each facet that go on from it smoothly, (facets, facets).

        Of those alone from which the rings around facets that turn grow.
        """
        grows = self._turns
        for _ in range(_RINGS - 1):
            grows = self._share_node @ grows > 0
        one, other = self._share_node.nonzero()
        kept = grows[one] & (one != other)
        one, other = one[kept], other[kept]
        kept = self._go_on(one, other)
        entries = np.ones(kept.sum()), (one[kept], other[kept])
        return csr_matrix(entries, shape=self._share_node.shape)

    def _go_on(self, one: AnyIntegers, other: AnyIntegers) -> Flags:
        """Whether there is no edge between facets that share a node, (pairs,).

        A curve turns at every node. Where all around is parallel to one facet or to the other,
        there is an edge between the two, however blunt.

        Args:
            one: One facet of each pair, (pairs,).
            other: The other, likewise.
        """
        normals = self._frames[:, -1]
        is_smooth = _dots(normals[one], normals[other]) > _EDGE
        turn = np.linalg.norm(normals[other] - normals[one], axis=1)
        asked = np.flatnonzero(is_smooth & (turn > _FLAT))
        near = _padded(self._share_node)
        for first in range(0, len(asked), _AT_A_TIME):
            pairs = asked[first : first + _AT_A_TIME]
            own, next_to = one[pairs, None], other[pairs, None]
            around = np.concatenate([near[own[:, 0]], near[next_to[:, 0]]], axis=1)
            counts = (around >= 0) & (around != own) & (around != next_to)
            from_own = np.linalg.norm(normals[around] - normals[own], axis=2)
            from_other = np.linalg.norm(normals[around] - normals[next_to], axis=2)
            apart = np.minimum(from_own, from_other) > _PARALLEL * turn[pairs, None]
            is_smooth[pairs] = ~counts.any(axis=1) | (apart & counts).any(axis=1)
        return np.asarray(is_smooth)

    @cached_property
    def _frames(self) -> Array:
        """Tangents and outward normal at the facets' middles, (facets, dimension, dimension)."""
        normals = normalised(self._facets.normals_at_centres())
        if self._facets.dimension == 2:
            return np.stack([np.stack([normals[:, 1], -normals[:, 0]], axis=1), normals], axis=1)
        first = normalised(np.cross(normals, np.eye(3)[np.abs(normals).argmin(axis=1)]))
        return np.stack([first, np.cross(normals, first), normals], axis=1)

    def _local(self, facet: AnyIntegers, places: Array) -> Array:
        """Coordinates in frames of facets, over their radii, (points, dimension)."""
        away = places - self._facets.centres[facet]
        turned = np.einsum("pij,pj->pi", self._frames[facet], away)
        return np.asarray(turned / self._facets.radii[facet, None])


@cache
def _exponents(dimension: int, degree: int) -> list[tuple[int, ...]]:
    """Exponents of all monomials up to a degree."""
    return [
        tuple(chosen.count(axis) for axis in range(dimension))
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(dimension), total)
    ]


def _powers(points: Array, degree: int) -> Array:
    """Monomials at points, (points, monomials)."""
    count, dimension = points.shape
    each = np.ones((degree + 1, count, dimension))
    np.cumprod(np.broadcast_to(points, (degree, count, dimension)), axis=0, out=each[1:])
    exponents = np.array(_exponents(dimension, degree))
    return np.asarray(np.prod([each[exponents[:, i], :, i] for i in range(dimension)], axis=0).T)


def _dots(one: Array, other: Array) -> Array:
    """Products of vectors with vectors, (vectors,)."""
    return np.asarray(np.einsum("vi,vi->v", one, other))


def _padded(matrix: csr_matrix) -> AnyIntegers:
    """Columns with entries in each row, (rows, most of them); −1 for none."""
    counts = np.diff(matrix.indptr)
    found = np.full((len(counts), counts.max(initial=0)), -1)
    found[np.arange(found.shape[1]) < counts[:, None]] = matrix.indices
    return found


def _least_squares(powers: Array, heights: Array, weights: Array, counts: AnyIntegers) -> Array:
    """Coefficients of polynomials that are nearest to heights, (polynomials, coefficients).

    The least ones where several are as near, to what round-off can tell.

    Args:
        powers: Monomials at the points, (polynomials, points, coefficients).
        heights: There, (polynomials, points).
        weights: Of these, likewise; 0 of points that are none.
        counts: How many points there are, (polynomials,).
    """
    size = powers.shape[-1]
    both = weights[..., None] * np.concatenate([powers, heights[..., None]], axis=-1)
    triangle = np.linalg.qr(both, mode="r")
    left, values, right = np.linalg.svd(triangle[:, :size, :size])
    least = np.finfo(float).eps * counts[:, None] * values[:, :1]
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=values > least)
    shares = inverse * np.einsum("fij,fi->fj", left, triangle[:, :size, size])
    return np.asarray(np.einsum("fij,fi->fj", right, shares))
