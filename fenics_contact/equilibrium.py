"""Can contact and friction hold the body? The paper's condition |f(r)| < j(r), (2.4)-(2.5).

Where the supports leave rigid motions free, friction resists them, and so do obstacles,
one way. A motion r that enters no obstacle (r_n ≤ 0 on Γ_C) needs f(r) < j(r); without
friction f(r) < 0: the loads press the body on. The largest f(r) over the free motions
with j(r) ≤ 1 is the share of the limit load that is used; it is found by cutting planes:
every linear programme bounds it from above, every motion tried from below.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.errors import NoEquilibriumError
from fenics_contact.parallel import largest, total
from fenics_contact.problem import Problem
from fenics_contact.rigid import RigidMotions, null_space

# Round-off of the sums over the contact points.
_ROUND_OFF = 1e-9
_GAP = 1e-8
_MAX_CUTS = 200
_LP_OPTIONS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FreeMotion:
    """What the supports leave free, and how much of the friction it takes to hold it.

    Attributes:
        modes: Number of independent rigid motions that the supports leave free.
        used_share: Largest f(r)/j(r) over them: 1 at the limit load, 0 without any.
        motion: The motion at which it is reached, in words.
    """

    modes: int
    used_share: float
    motion: str


def require_equilibrium(problem: Problem) -> FreeMotion:
    """Refuse a scene whose loads contact, friction and supports cannot hold; collective.

    Raises:
        NoEquilibriumError: In one sentence that names the motion.
    """
    rigid = RigidMotions(problem)
    if rigid.count == 0:
        return FreeMotion(0, 0.0, "none")
    if rigid.body_is_held and all(contact.is_one_sided for contact in rigid.floating):
        return FreeMotion(rigid.count, 0.0, "obstacles that forces press on")
    closing = rigid.closings()
    motions = _resisted_motions(problem, rigid, closing)
    # What Coulomb's friction can hold depends on pressures that are not known yet.
    rough = _scaled(rigid.slips(coulomb=True), motions)
    motions = motions @ null_space(_friction_gram(problem.comm, rough))
    if motions.shape[1] == 0:
        return FreeMotion(rigid.count, 0.0, "none: held by the obstacles and their friction")
    force = rigid.force @ motions
    points = _scaled(rigid.slips(), motions)
    closings = closing[1] @ motions
    _require_pressed(problem, rigid, motions, points, closing[0], closings, closing[2])
    if total(problem.comm, points[0].sum()) == 0:
        return FreeMotion(rigid.count, 0.0, "none: held by the obstacles")
    share, best = _used_share(problem.comm, points, force, closings)
    motion = rigid.describe(motions @ best)
    if share >= 1 - _ROUND_OFF:
        raise NoEquilibriumError(
            f"no equilibrium: the supports leave a rigid motion free ({motion}), and the loads "
            f"are {share:.6g} times what friction can hold back; add a support or friction, or "
            "lower the loads"
        )
    return FreeMotion(rigid.count, share, motion)


def _scaled(points: tuple[Array, Array], motions: Array) -> tuple[Array, Array]:
    return points[0], points[1] @ motions


def _friction_gram(comm: Any, points: tuple[Array, Array]) -> Array:
    return np.asarray(total(comm, np.einsum("q,qci,qcj->ij", points[0], points[1], points[1])))


def _resisted_motions(
    problem: Problem, rigid: RigidMotions, closing: tuple[Array, Array, Array]
) -> Array:
    """Free motions scaled so that ∫ g |r_T|² + c ∫ r_n² is 1 for each, as columns.

    Raises:
        NoEquilibriumError: Neither friction nor an obstacle resists one of them at all.
    """
    friction = _friction_gram(problem.comm, rigid.slips())
    rough = _friction_gram(problem.comm, rigid.slips(coulomb=True))
    friction = friction + rough * ((np.trace(friction) or 1.0) / (np.trace(rough) or 1.0))
    weights, normal, _ = closing
    across = np.einsum("q,qi,qj->ij", weights, normal, normal)
    # Only ratios within one motion matter, so that the unit of c is free.
    share = np.trace(across)
    gram = friction + across * ((np.trace(friction) or 1.0) / share if share > 0 else 0.0)
    unresisted = null_space(gram)
    if unresisted.shape[1]:
        motion = rigid.describe(unresisted[:, 0])
        pushed = np.abs(rigid.force @ unresisted).max() > 1e-10 * rigid.force_size
        raise NoEquilibriumError(
            "no equilibrium: neither supports nor friction nor obstacles resist a rigid motion "
            f"({motion})"
            + (", which the loads push" if pushed else "; its size is left undetermined")
            + "; add a support or friction"
        )
    values, vectors = np.linalg.eigh(gram)
    return np.asarray(vectors / np.sqrt(values))


def _require_pressed(
    problem: Problem,
    rigid: RigidMotions,
    motions: Array,
    points: tuple[Array, Array],
    weights: Array,
    closings: Array,
    gaps: Array,
) -> None:
    """Every motion away from the obstacles that friction does not resist needs f(r) < 0.

    The largest f(r) over the motions with r_n ≤ 0 and −∫ r_n = 1, a linear programme.
    """
    from scipy.optimize import linprog

    loose = null_space(_friction_gram(problem.comm, points))
    if loose.shape[1] == 0 or len(weights) == 0:
        return
    force = rigid.force @ motions @ loose
    rows = closings @ loose
    one_sided = np.unique(np.round(rows / np.abs(rows).max(), 12), axis=0)
    found = linprog(
        -force / (np.abs(force).max() or 1.0),
        A_ub=one_sided,
        b_ub=np.zeros(len(one_sided)),
        A_eq=[weights @ rows / (np.abs(weights @ rows).max() or 1.0)],
        b_eq=[-1.0],
        bounds=(None, None),
        options=_LP_OPTIONS,
    )
    infeasible = 2
    if found.status == infeasible:  # no motion leaves all obstacles: they hold it both ways
        if np.abs(force).max() == 0 and gaps.min() > 0 and rigid.force_size > 0:
            raise NoEquilibriumError(
                "no equilibrium: the body has clearance between its obstacles, and nothing presses "
                "it against one of them; close a gap, or add a support or a load"
            )
        return
    unbounded = found.x is None
    best = loose @ (np.ones(loose.shape[1]) if unbounded else found.x)
    work = np.inf if unbounded else -found.fun
    work = problem.comm.bcast(work)
    if work < -_ROUND_OFF and np.abs(force).max() > 0:
        return
    motion = rigid.describe(motions @ best)
    pushed = "the loads push it away from" if work > _ROUND_OFF else "nothing presses it against"
    raise NoEquilibriumError(
        f"no equilibrium: a rigid motion is free ({motion}), and {pushed} the obstacles; add a "
        "support, or a load or force that presses them together"
    )


def _used_share(
    comm: Any, points: tuple[Array, Array], force: Array, closings: Array
) -> tuple[float, Array]:
    """Maximise f(a) subject to j(a) = Σ w g |S a| ≤ 1 and r_n ≤ 0, by cutting planes.

    j is convex and homogeneous, so j ≤ 1 is the set of all its supporting half
    spaces, and a motion a bounds the maximum from below by f(a)/j(a).

    Returns:
        The maximum (from above, so that a doubt never lets a scene pass), and the
        motion at which it is reached.
    """
    from scipy.optimize import linprog

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
        found = linprog(
            -force,
            A_ub=np.array([*cuts, *one_sided]),
            b_ub=np.concatenate([np.ones(len(cuts)), np.zeros(len(one_sided))]),
            bounds=(-reach, reach),
            options=_LP_OPTIONS,
        )
        above, trial = comm.bcast((float(-found.fun), found.x))  # the same path on all ranks
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
