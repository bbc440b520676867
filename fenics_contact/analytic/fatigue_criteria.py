"""The smallest ball around the points of a path, of many paths at once.

Its radius grows with every point that is taken up, always the farthest one outside, until none
is outside any more (B. Gärtner, Fast and robust smallest enclosing balls, ESA 1999, LNCS 1643,
325-338). Of the few points that the ball rests on all subsets are tried, so that it is exact
also where they lie on a line or in a plane.

Fatigue criteria of a history of stress: Smith, Watson and Topper, Crossland, Dang Van. A history
is an array (places, times, 3, 3) of stresses, or of the strains with them, over one cycle of
loads. All numbers are exact but for round-off, and for the planes that are searched.

Sources: K. N. Smith, P. Watson, T. H. Topper, J. Materials 5 (1970) 767-778; of the plane on which
their parameter is largest: A. Fatemi, D. F. Socie, Fatigue Fract. Eng. Mater. Struct. 11 (1988)
149-165. B. Crossland, Int. Conf. on Fatigue of Metals, London (1956) 138-149. K. Dang Van, ASTM
STP 1191 (1993) 120-130.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers

# Of the radius: a point that is outside by less is on the ball.
_ON_IT = 1e-12
# Points whose simplex is flatter than this, in sines squared, hold no ball: fewer of them do.
_FLAT = 1e-13
_MOST_ROUNDS = 1000


def smallest_balls(paths: Array) -> tuple[Array, Array]:
    """Centres, (paths, components), and radii, (paths,), of the smallest balls around paths.

    Args:
        paths: Points of each, (paths, points, components), in a space of a few dimensions.

    A square is enclosed by its diagonal, and so is a point inside it:

    >>> square = np.array([[[0, 0], [2, 0], [2, 2], [0, 2], [1, 0.5]]], dtype=float)
    >>> [values.round(12).tolist() for values in smallest_balls(square)]
    [[[1.0, 1.0]], [1.414213562373]]
    """
    count, _, components = paths.shape
    every = np.arange(count)
    # The farthest two points of a sort; −1 where a place for a point to rest on is free.
    rests = np.full((count, components + 1), -1)
    rests[:, 0] = _farthest(paths, paths[:, 0])
    centres, radii = paths[every, rests[:, 0]].copy(), np.zeros(count)
    scale = np.linalg.norm(paths - centres[:, None], axis=2).max(axis=1, initial=0.0)
    open_ = every
    for _ in range(_MOST_ROUNDS):
        outside = _farthest(paths[open_], centres[open_])
        reached = np.linalg.norm(paths[open_, outside] - centres[open_], axis=1)
        beyond = reached > radii[open_] + _ON_IT * scale[open_]
        open_, outside = open_[beyond], outside[beyond]
        if len(open_) == 0:
            break
        found, radius, rests_on = _around(paths[open_], rests[open_], outside)
        grown = radius > radii[open_] * (1 + _ON_IT)  # else it is round-off that is outside
        open_ = open_[grown]
        centres[open_], radii[open_], rests[open_] = found[grown], radius[grown], rests_on[grown]
    return centres, np.linalg.norm(paths - centres[:, None], axis=2).max(axis=1, initial=0.0)


def _farthest(paths: Array, centres: Array) -> Integers:
    """Number of the point of each path that is farthest from its centre."""
    return np.asarray(((paths - centres[:, None]) ** 2).sum(axis=2).argmax(axis=1))


def _around(paths: Array, rests: Integers, new: Integers) -> tuple[Array, Array, Integers]:
    """Centres, radii and the points that it rests on, of balls around some points of each path.

    Args:
        paths: As above.
        rests: Numbers of the points that the last ball rests on, −1 where there are fewer.
        new: Of one outside, on which the new ball rests.
    """
    count, places = rests.shape
    rows = np.arange(count)
    best, radii = paths[rows, new].copy(), np.full(count, np.inf)
    rests_on = np.full_like(rests, -1)
    chosen = np.where(rests >= 0, rests, new[:, None])
    held = paths[rows[:, None], np.column_stack([chosen, new])]  # (paths, places + 1, components)
    for subset in _subsets(places):
        there = np.flatnonzero((rests[:, subset] >= 0).all(axis=1))
        centre, sound = _circumcentres(held[there][:, subset], held[there, -1])
        there, centre = there[sound], centre[sound]
        radius = np.linalg.norm(held[there] - centre[:, None], axis=2).max(axis=1, initial=0.0)
        better = radius < radii[there] * (1 - _ON_IT)
        there, centre, radius = there[better], centre[better], radius[better]
        best[there], radii[there] = centre, radius
        rests_on[there] = -1
        rests_on[there[:, None], np.arange(len(subset))] = rests[there[:, None], subset]
        rests_on[there, len(subset)] = new[there]
    return best, radii, rests_on


def _subsets(places: int) -> Iterator[list[int]]:
    """Yield subsets of places that may rest with a new point, small ones first."""
    for size in range(1, places):
        yield from (list(subset) for subset in combinations(range(places), size))


def _circumcentres(others: Array, new: Array) -> tuple[Array, Flags]:
    """Centres as far from all points, in the plane through them, and whether there is one.

    Args:
        others: (paths, points, components).
        new: One more point, (paths, components).
    """
    edges = others - new[:, None]
    lengths = np.linalg.norm(edges, axis=2)
    sound = (lengths > 0).all(axis=1)
    lengths = np.where(lengths > 0, lengths, 1.0)
    units = edges / lengths[:, :, None]
    cosines = units @ units.transpose(0, 2, 1)
    sound &= np.linalg.det(cosines) > _FLAT
    cosines[~sound] = np.eye(others.shape[1])
    shares = np.linalg.solve(cosines, lengths[:, :, None] / 2)
    return new + (shares * units).sum(axis=1), sound


# An orthonormal basis of the symmetric tensors without a trace.
_DEVIATORS = np.array(
    [
        np.diag([2.0, -1.0, -1.0]) / np.sqrt(6),
        np.diag([0.0, 1.0, -1.0]) / np.sqrt(2),
        np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) / np.sqrt(2),
        np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) / np.sqrt(2),
        np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]) / np.sqrt(2),
    ]
)


def mean_stress(history: Array) -> Array:
    """A third of the trace, > 0 in tension, (places, times) (stress)."""
    return np.asarray(np.trace(history, axis1=2, axis2=3) / 3)


def deviator_paths(history: Array) -> Array:
    """The deviators in an orthonormal basis, (places, times, 5) (stress)."""
    return np.asarray(np.einsum("ptij,kij->ptk", history, _DEVIATORS))


def deviator_amplitudes(history: Array) -> tuple[Array, Array]:
    """√J₂ of the smallest ball around the path of the deviator, (places,), and its middle.

    Args:
        history: Stresses.

    Returns:
        Radii over √2 (stress), and the balls' centres, (places, 3, 3) (stress).
    """
    centres, radii = smallest_balls(deviator_paths(history))
    return radii / np.sqrt(2), np.asarray(np.einsum("pk,kij->pij", centres, _DEVIATORS))


def crossland(history: Array, alpha: float) -> Array:
    """√J₂a + α p_max, which is at most the fatigue limit in torsion, (places,) (stress).

    Args:
        history: Stresses.
        alpha: Factor of the largest mean stress.
    """
    return deviator_amplitudes(history)[0] + alpha * mean_stress(history).max(axis=1)


def dang_van(history: Array, alpha: float) -> Array:
    """The largest τ(t) + α p(t), which is at most the fatigue limit in torsion, (places,) (stress).

    τ is half the difference of the largest and the least principal stress of what is left of the
    deviator once the middle of the smallest ball around its path is taken away, as the residual
    stress that a grain settles at does.

    Args:
        history: Stresses.
        alpha: Factor of the mean stress.
    """
    settled = history - deviator_amplitudes(history)[1][:, None]
    principal = np.linalg.eigvalsh(settled)
    shear = (principal[..., 2] - principal[..., 0]) / 2
    return np.asarray((shear + alpha * mean_stress(history)).max(axis=1))


def crossland_alpha(torsion: float, tension: float) -> float:
    """The α with which both fatigue limits, each to and fro, are on the criterion's line.

    Args:
        torsion: Amplitude of the shear stress that is endured (stress).
        tension: That of tension and compression (stress).
    """
    return 3 * torsion / tension - float(np.sqrt(3))


def dang_van_alpha(torsion: float, tension: float) -> float:
    """Return the α with which both limits (stress) are on the line of Dang Van's criterion."""
    return 3 * torsion / tension - 1.5
