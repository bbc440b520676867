"""The plane on which the parameter of Smith, Watson and Topper is largest."""

from __future__ import annotations

from functools import cache

import numpy as np

from fenics_contact.common.arrays import Array, Integers

# Of the planes that are tried first, as an angle between neighbours; the best is then improved.
_FIRST_ANGLE = np.radians(6.0)
# So many of them are begun at: the best of each hill, and others, as two hills may be close by.
_BEGINS = 8
# The parameter is flat about its largest value: an angle of 1e-5 changes it by some 1e-10.
_LAST_ANGLE, _SHORTER = 1e-5, 0.6
# Numbers of places, times and planes that are kept together.
_AT_ONCE = 2_000_000


def swt(stress: Array, strain: Array) -> tuple[Array, Array]:
    """The largest σ_n,max · Δε_n / 2 over all planes, and the normals of these planes.

    Args:
        stress: A cycle at each place, (places, times, 3, 3) (stress).
        strain: Its strains.

    Returns:
        The parameter, (places,), 0 where no plane is pulled (stress), and normals, (places, 3).

    >>> ones = np.diag([1.0, 0.0, 0.0])
    >>> cycle = np.array([[100 * ones, -100 * ones]])
    >>> parameter, plane = swt(cycle, cycle / 200e3)
    >>> float(parameter[0].round(12)), np.abs(plane[0]).round(5).tolist()
    (0.05, [1.0, 0.0, 0.0])
    """
    parameter, normals = np.zeros(len(stress)), np.zeros((len(stress), 3))
    together = max(_AT_ONCE // (stress.shape[1] * len(_hemisphere())), 1)
    for begin in range(0, len(stress), together):
        piece = slice(begin, begin + together)
        parameter[piece], normals[piece] = _searched(stress[piece], strain[piece])
    return parameter, normals


def _searched(stress: Array, strain: Array) -> tuple[Array, Array]:
    """Return ``swt`` and its normals, searched from the best of planes all around."""
    best, normals = np.full(len(stress), -np.inf), np.zeros((len(stress), 3))
    first = _parameter(stress, strain, _hemisphere())
    is_peak = (first[:, :, None] >= first[:, _neighbours()]).all(axis=2)
    begins = np.argsort(-first * (1 + is_peak), axis=1)[:, :_BEGINS]
    for begin in begins.T:
        value, normal = _improved(stress, strain, _hemisphere()[begin])
        better = value > best
        best[better], normals[better] = value[better], normal[better]
    return np.maximum(best, 0.0), normals


def _improved(stress: Array, strain: Array, normals: Array) -> tuple[Array, Array]:
    """The parameter and the plane at the top of the hill that a plane at each place is on.

    The larger of several smooth hills has edges only in its valleys, so that steps to the best of
    eight planes around, shorter and shorter, come to the top.
    """
    rows = np.arange(len(stress))
    best, normals = _parameter(stress, strain, normals[:, None])[:, 0], normals.copy()
    angle = _FIRST_ANGLE
    while angle > _LAST_ANGLE:
        tried = _around(normals, angle)
        values = _parameter(stress, strain, tried)
        most = values.argmax(axis=1)
        better = values[rows, most] > best
        best[better] = values[rows, most][better]
        normals[better] = tried[rows, most][better]
        angle *= _SHORTER
    return best, normals


def _parameter(stress: Array, strain: Array, normals: Array) -> Array:
    """Return the parameter of planes at each place, (places, planes).

    Args:
        stress: As above.
        strain: As above.
        normals: (places, planes, 3), or (planes, 3) of all.
    """
    dyads = (normals[..., :, None] * normals[..., None, :]).reshape(*normals.shape[:-1], 9)
    across = np.swapaxes(dyads, -1, -2)
    places, times = stress.shape[:2]
    pull = (stress.reshape(places, times, 9) @ across).max(axis=1)
    stretch = strain.reshape(places, times, 9) @ across
    return np.asarray(np.maximum(pull, 0.0) * np.ptp(stretch, axis=1) / 2)


@cache
def _hemisphere() -> Array:
    """Normals of planes all around, some 6 degrees apart, with the axes among them."""
    found = []
    for polar in np.linspace(0, np.pi / 2, round(np.pi / 2 / _FIRST_ANGLE) + 1):
        around = max(round(2 * np.pi * np.sin(polar) / _FIRST_ANGLE / 4) * 4, 1)
        angles = 2 * np.pi * np.arange(around) / around
        ring = (np.sin(polar) * np.cos(angles), np.sin(polar) * np.sin(angles))
        found.append(np.column_stack([*ring, np.full(around, np.cos(polar))]))
    return np.concatenate(found)


@cache
def _neighbours() -> Integers:
    """Numbers of the eight planes nearest to each of them, (planes, 8)."""
    planes = _hemisphere()
    return np.asarray(np.argsort(-np.abs(planes @ planes.T), axis=1)[:, 1:9])


def _around(normals: Array, angle: float) -> Array:
    """Eight normals around each, turned by an angle, (places, 8, 3)."""
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    first = np.cross(normals, least)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normals, first)
    turns = np.arange(8) * np.pi / 4
    sideways = np.cos(turns)[:, None] * first[:, None] + np.sin(turns)[:, None] * second[:, None]
    return np.asarray(np.cos(angle) * normals[:, None] + np.sin(angle) * sideways)
