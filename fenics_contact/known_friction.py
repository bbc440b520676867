"""The limit load of friction of known bound: the paper's |f(r)| < j(r), (2.4)-(2.5).

The largest f(r) over the free motions with j(r) ≤ 1 is the share of the limit load that is used;
it is found by cutting planes: every linear programme bounds it from above, every motion tried
from below.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.linear_programme import minimised
from fenics_contact.parallel import largest, total

_GAP = 1e-8
_MAX_CUTS = 200
_LP_OPTIONS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}

Array = NDArray[np.float64]


def used_share(
    comm: Any, points: tuple[Array, Array], force: Array, closings: Array
) -> tuple[float, Array]:
    """Maximise f(a) subject to j(a) = Σ w g |S a| ≤ 1 and r_n ≤ 0, by cutting planes.

    j is convex and homogeneous, so j ≤ 1 is the set of all its supporting half
    spaces, and a motion a bounds the maximum from below by f(a)/j(a).

    Returns:
        The maximum (from above, so that a doubt never lets a scene pass), and the
        motion at which it is reached.
    """
    weights, slips = points
    number = len(force)
    if not force.any():
        return 0.0, np.eye(number)[0]
    # With ∫ g |r_T|² = |a|², j(a) ≥ |a| / max|S| bounds the feasible motions.
    reach = largest(comm, np.linalg.norm(slips, axis=(1, 2)))
    trial = force / np.linalg.norm(force)
    one_sided = np.unique(np.round(closings / (np.abs(closings).max(initial=0) or 1), 12), axis=0)
    cuts: list[Array] = []
    above: float = np.finfo(float).max
    below, best = 0.0, trial
    while len(cuts) < 2 * _MAX_CUTS and above - below > _GAP * above:
        dissipation, slope = _dissipation(comm, weights, slips, trial)
        if dissipation > 0 and force @ trial / dissipation > below:
            below, best = float(force @ trial) / dissipation, trial
        cuts += [slope, -slope]
        found = minimised(
            -force,
            A_ub=np.array([*cuts, *one_sided]),
            b_ub=np.concatenate([np.ones(len(cuts)), np.zeros(len(one_sided))]),
            bounds=(-reach, reach),
            options=_LP_OPTIONS,
        )
        found = comm.bcast(None if found.x is None else (float(-found.fun), found.x))
        if found is None:  # the bound of the last programme still holds
            break
        above, trial = found  # the same path on all ranks
    return above, best


def _dissipation(comm: Any, weights: Array, slips: Array, motion: Array) -> tuple[float, Array]:
    """j(a) and a subgradient; j(a) = slope · a."""
    vectors = slips @ motion
    lengths = np.linalg.norm(vectors, axis=1)
    moving = lengths > 0
    directions = np.zeros_like(vectors)
    directions[moving] = vectors[moving] / lengths[moving, None]
    slope = total(comm, np.einsum("q,qc,qci->i", weights, directions, slips))
    return float(slope @ motion), slope
