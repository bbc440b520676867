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
        self._fits: dict[int, Array] = {}
        self._smooth: dict[int, list[int]] = {}

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
        turning = turning[np.argsort(facet[turning], kind="stable")]
        numbers, firsts = np.unique(facet[turning], return_index=True)
        for number, at in zip(numbers.tolist(), np.split(turning, firsts)[1:], strict=True):
            powers = _powers(local[at, :-1], self._degree(number))
            found[at] = powers @ self._fits[number] - local[at, -1]
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

    def _degree(self, number: int) -> int:
        """Degree of the polynomial of a facet, which is made when it is first asked for."""
        if number not in self._fits:
            self._fits[number] = self._fit(number)
        dimension, count = self._facets.dimension - 1, len(self._fits[number])
        return next(d for d in range(1, 5) if len(_exponents(dimension, d)) == count)

    def _fit(self, number: int) -> Array:
        """Coefficients of the height over the facet's middle plane, in its radii."""
        dimension = self._facets.dimension
        wanted = _DEGREES[dimension][self._facets.order]
        own = self._node_numbers[number]
        others = np.setdiff1d(
            self._nodes_around(number, len(_exponents(dimension - 1, wanted))), own
        )
        nodes = np.concatenate([own, others])
        degree = max(
            d for d in range(1, wanted + 1) if len(_exponents(dimension - 1, d)) <= len(nodes)
        )
        local = self._local(np.full(len(nodes), number), self._places[nodes])
        distances = np.maximum(np.linalg.norm(local[:, :-1], axis=1), 1.0)
        weights = np.where(np.arange(len(nodes)) < len(own), _OWN, distances**-_FADING)
        powers = _powers(local[:, :-1], degree)
        found, *_ = np.linalg.lstsq(weights[:, None] * powers, weights * local[:, -1], rcond=None)
        return np.asarray(found)

    def _nodes_around(self, number: int, enough: int) -> AnyIntegers:
        """Geometry nodes of a facet and of those around it that no edge parts from it.

        Without those that are turned so far that no height over this facet describes them well.
        """
        rings, normals = {number}, self._frames[:, -1]
        for _ in range(_RINGS):
            around = {other for facet in rings for other in self._neighbours(facet)}
            rings |= {other for other in around if normals[other] @ normals[number] > _EDGE}
            nodes = np.unique(self._node_numbers[sorted(rings)])
            if len(nodes) >= enough:
                break
        return nodes

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

    def _neighbours(self, facet: int) -> list[int]:
        """Neighbours of a facet by a node, that go on from it smoothly."""
        if facet not in self._smooth:
            near = self._near[facet]
            near = near[near >= 0]
            self._smooth[facet] = near[self._go_on(facet, near)].tolist()
        return self._smooth[facet]

    @cached_property
    def _share_node(self) -> csr_matrix:
        """How many nodes any two facets share, (facets, facets); also a facet with itself."""
        numbers = self._node_numbers
        facet = np.repeat(np.arange(len(numbers)), numbers.shape[1])
        has_node = csr_matrix((np.ones(facet.size), (facet, numbers.ravel())))
        return csr_matrix(has_node @ has_node.T)

    @cached_property
    def _near(self) -> AnyIntegers:
        """All other facets with a node of each facet, (facets, most of them); −1 for none."""
        one, other = self._share_node.nonzero()
        one, other = one[one != other], other[one != other]
        counts = np.bincount(one, minlength=len(self._node_numbers))
        found = np.full((len(counts), counts.max(initial=0)), -1)
        found[np.arange(found.shape[1]) < counts[:, None]] = other[np.argsort(one, kind="stable")]
        return found

    def _go_on(self, facet: int, near: AnyIntegers) -> Flags:
        """Whether there is no edge between a facet and each of others near it, (others,).

        A curve turns at every node. Where all around is parallel to one facet or to the other,
        there is an edge between the two, however blunt.
        """
        normals = self._frames[:, -1]
        own, others = normals[facet], normals[near]
        around = np.concatenate([np.tile(near, (len(near), 1)), self._near[near]], axis=1)
        counts = (around >= 0) & (around != facet) & (around != near[:, None])
        turn = np.linalg.norm(others - own, axis=1)
        from_own = np.linalg.norm(normals[around] - own, axis=2)
        from_other = np.linalg.norm(normals[around] - others[:, None], axis=2)
        apart = np.minimum(from_own, from_other) > _PARALLEL * turn[:, None]
        is_smooth = (turn <= _FLAT) | ~counts.any(axis=1) | (apart & counts).any(axis=1)
        return np.asarray(is_smooth & (others @ own > _EDGE))

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
