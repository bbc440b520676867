"""Displacements from one mesh to another of the same body, as a start for Newton's method.

At each new node a quadratic polynomial is fitted to the displacements of the nearest old nodes of
the same connected part. So boundaries that are curved, and meshes that touch each other, need no
search for cells; and what error it makes is of the order of that of the old mesh.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.accepted_step import Unknowns

# Old nodes that a polynomial is fitted to, by dimension: half as many again as it has terms.
_NEAREST = {2: 10, 3: 16}
# Of the largest entry, added to the normal equations: nodes on a line do not determine all terms.
_RIDGE = 1e-9
_AT_ONCE = 20_000  # nodes, so that the stencils do not fill the memory


def moved_over(old: Problem, new: Problem, unknowns: Unknowns) -> Unknowns:
    """The state of a load step on another mesh; collective.

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
    rows = gather_rows(old.comm, rows)
    points, values, of_row = rows[:, : old.spaces.components], rows[:, 3:-1], rows[:, -1]
    displacement = np.zeros_like(new.load)
    for part in range(new.spaces.parts.count):
        mine = np.flatnonzero(new.spaces.parts.of_node == part)
        there = of_row == part
        at = new.spaces.coordinates[mine, : old.spaces.components]
        displacement[mine] = fitted(points[there], values[there], at)
    return Unknowns(unknowns.time, lambda: displacement, unknowns.scalars, unknowns.mean_stress)


def fitted(points: Array, values: Array, at: Array) -> Array:
    """Values at other points, each by the quadratic polynomial that fits the nearest best.

    Args:
        points: With known values, (points, dimension) (length).
        values: Of any number of components, (points, components).
        at: Where to, (others, dimension) (length).

    Returns:
        Shape (others, components).
    """
    if len(at) == 0 or len(points) == 0:
        return np.zeros((len(at), values.shape[1]))
    number = min(_NEAREST[points.shape[1]], len(points))
    tree = cKDTree(points)
    found = [
        _fitted(points, values, at[i : i + _AT_ONCE], tree, number)
        for i in range(0, len(at), _AT_ONCE)
    ]
    return np.concatenate(found)


def _fitted(points: Array, values: Array, at: Array, tree: cKDTree, number: int) -> Array:
    distances, nearest = tree.query(at, k=[*range(1, number + 1)])
    size = np.maximum(distances[:, -1:], np.finfo(float).tiny)
    away = (points[nearest] - at[:, None]) / size[:, :, None]
    weights = np.exp(-((2 * distances / size) ** 2)) + 1e-12
    terms = _quadratic(away)
    normal = np.einsum("nki,nk,nkj->nij", terms, weights, terms)
    normal += _RIDGE * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(terms.shape[2])
    right = np.einsum("nki,nk,nkc->nic", terms, weights, values[nearest])
    return np.asarray(np.linalg.solve(normal, right)[:, 0])


def _quadratic(away: Array) -> Array:
    """1, the coordinates, and their products: (others, points, terms)."""
    dimension = away.shape[2]
    pairs = [(i, j) for i in range(dimension) for j in range(i, dimension)]
    products = [away[:, :, i] * away[:, :, j] for i, j in pairs]
    return np.stack([np.ones_like(products[0]), *np.moveaxis(away, 2, 0), *products], axis=2)
