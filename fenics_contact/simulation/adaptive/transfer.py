"""Displacements from one mesh to another of the same body, as a start for Newton's method.

At each new node a quadratic polynomial is fitted to the displacements of the nearest old nodes of
the same connected part. So boundaries that are curved, and meshes that touch each other, need no
search for cells; and what error it makes is of the order of that of the old mesh.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_rank
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.accepted_step import Unknowns

# Old nodes that a polynomial is fitted to, by dimension: half as many again as it has terms.
_NEAREST = {2: 10, 3: 16}
# Of the largest entry, added to the normal equations: nodes on a line do not determine all terms.
_RIDGE = 1e-9
_AT_ONCE = 20_000  # nodes, so that the stencils do not fill the memory


def transfer_state(old: Problem, new: Problem, unknowns: Unknowns) -> Unknowns:
    """Interpolate the state of a load step onto another mesh; collective.

    Args:
        old: On whose mesh it was found.
        new: The same scene on another mesh of the body; its parts have the same order.
        unknowns: The state on the old mesh.
    """
    owned = slice(0, old.spaces.owned_nodes)
    parts = old.spaces.parts.of_node[owned, None]
    rows = np.hstack(
        [old.spaces.coordinates[owned], unknowns.displacement[owned], parts.astype(np.float64)]
    )
    size = old.spaces.components
    at = [
        new.spaces.coordinates[new.spaces.parts.of_node == part, :size]
        for part in range(new.spaces.parts.count)
    ]
    nearest = [_Nearest(places, size) for places in at]
    for rank in range(old.comm.size):  # no rank holds the nodes of all at once
        found = from_rank(old.comm, rows, rank)
        for part, one in enumerate(nearest):
            there = found[found[:, -1] == part]
            one.take(there[:, :size], there[:, 3:-1])
    displacement = np.zeros_like(new.load)
    for part, one in enumerate(nearest):
        displacement[new.spaces.parts.of_node == part] = one.fitted()
    mean_stress = unknowns.mean_stress
    return Unknowns(unknowns.time, lambda: displacement, unknowns.scalars, lambda: mean_stress)


class _Nearest:
    """The old nodes that are nearest to new ones, of all that were shown so far.

    Args:
        at: The new nodes, (nodes, dimension) (length).
        components: Of the values at the old ones.
    """

    def __init__(self, at: Array, components: int) -> None:
        self._at, self._number = at, _NEAREST[at.shape[1]]
        self._distances = np.zeros((len(at), 0))
        self._points = np.zeros((len(at), 0, at.shape[1]))
        self._values = np.zeros((len(at), 0, components))

    def take(self, points: Array, values: Array) -> None:
        """Look at more old nodes.

        Args:
            points: Where they are, (points, dimension) (length).
            values: What is known there, (points, components).
        """
        if len(points) == 0 or len(self._at) == 0:
            return
        number = min(self._number, len(points))
        distances, nearest = cKDTree(points).query(self._at, k=[*range(1, number + 1)])
        distances = np.concatenate([self._distances, distances], axis=1)
        order = np.argsort(distances, axis=1, kind="stable")[:, : self._number]
        self._distances = np.take_along_axis(distances, order, axis=1)
        self._points, self._values = (
            np.take_along_axis(
                np.concatenate([before, known[nearest]], axis=1), order[:, :, None], axis=1
            )
            for before, known in ((self._points, points), (self._values, values))
        )

    def fitted(self) -> Array:
        """Values at the new nodes by the polynomials, (nodes, components)."""
        found = np.zeros((len(self._at), self._values.shape[2]))
        if self._distances.shape[1] == 0:
            return found
        for first in range(0, len(self._at), _AT_ONCE):
            part = slice(first, first + _AT_ONCE)
            found[part] = _fitted(
                self._at[part], self._points[part], self._values[part], self._distances[part]
            )
        return found


def fitted(points: Array, values: Array, at: Array) -> Array:
    """Values at other points, each by the quadratic polynomial that fits the nearest best.

    Args:
        points: With known values, (points, dimension) (length).
        values: Of any number of components, (points, components).
        at: Where to, (others, dimension) (length).

    Returns:
        Shape (others, components).
    """
    nearest = _Nearest(at, values.shape[1])
    nearest.take(points, values)
    return nearest.fitted()


def _fitted(at: Array, points: Array, values: Array, distances: Array) -> Array:
    """Values at places by points (places, nearest, dimension), of each its own."""
    size = np.maximum(distances[:, -1:], np.finfo(float).tiny)
    away = (points - at[:, None]) / size[:, :, None]
    weights = np.exp(-((2 * distances / size) ** 2)) + 1e-12
    terms = _quadratic(away)
    normal = np.einsum("nki,nk,nkj->nij", terms, weights, terms)
    normal += _RIDGE * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(terms.shape[2])
    right = np.einsum("nki,nk,nkc->nic", terms, weights, values)
    return np.asarray(np.linalg.solve(normal, right)[:, 0])


def _quadratic(away: Array) -> Array:
    """1, the coordinates, and their products: (others, points, terms)."""
    dimension = away.shape[2]
    pairs = [(i, j) for i in range(dimension) for j in range(i, dimension)]
    products = [away[:, :, i] * away[:, :, j] for i, j in pairs]
    return np.stack([np.ones_like(products[0]), *np.moveaxis(away, 2, 0), *products], axis=2)
