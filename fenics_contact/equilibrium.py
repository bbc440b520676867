"""Can contact and friction hold the body? The paper's condition |f(r)| < j(r), (2.4)-(2.5).

Where the supports leave rigid motions free, friction resists them, and so do obstacles,
one way. A motion r that enters no obstacle (r_n ≤ 0 on Γ_C) needs f(r) < j(r) where the bound of
friction is known (``known_friction``); without friction f(r) < 0: the loads press the body on.
What friction of unknown pressure can hold is left to ``limit_analysis``.

Loads are judged at the ends of load steps. Between the entries of the paths' tables all loads and
bounds are linear, and what contacts can hold is a convex cone or set: if it holds the loads at two
times, then between them, so that the first and the last step between two entries suffice. (It does
not where a path is a function, or where a displaced obstacle meets other points: then some steps
are not judged, and none is refused wrongly. Nor is a step that may begin with bodies paired anew.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_cones import contact_cones
from fenics_contact.errors import NoEquilibriumError
from fenics_contact.known_friction import used_share
from fenics_contact.limit_analysis import AT_LIMIT, LimitAnalysis
from fenics_contact.linear_programme import minimised
from fenics_contact.load_paths import times_to_judge
from fenics_contact.motion_names import named_motions
from fenics_contact.parallel import on_root, total
from fenics_contact.problem import Problem
from fenics_contact.rigid import RigidMotions, null_space, reduced
from fenics_contact.stabilisation import stabilise

# Round-off of the sums over the contact points.
_ROUND_OFF = 1e-9
_LP_OPTIONS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FreeMotion:
    """What the supports leave free, and how much of the friction it takes to hold it.

    Attributes:
        modes: Number of independent rigid motions that the supports leave free.
        used_share: Largest f(r)/j(r) over them: 1 at the limit load, 0 without any; with
            friction of unknown pressure, the least share of all friction that can hold the loads.
        motion: The motion at which it is reached, in words.
        motions: All free motions, as in ``model.rigid_motions`` of a result.
        stabilised: The motions that nothing resisted, and that a stabilisation holds, in words.
    """

    modes: int
    used_share: float
    motion: str
    motions: tuple[dict[str, Any], ...] = ()
    stabilised: tuple[str, ...] = ()


def require_equilibrium(problem: Problem) -> FreeMotion:
    """Refuse a scene whose loads contact, friction and supports cannot hold; collective.

    Where the scene asks for it, motions that nothing resists are held first.

    Raises:
        NoEquilibriumError: In one sentence that names the motion, and the time.
    """
    motions = tuple(named_motions(problem, RigidMotions(problem)))
    last = problem.scene.steps.last
    for time in times_to_judge(problem.scene, problem.can_pair_anew):
        if time < last:
            problem.set_time(time)
            _share_of_friction(problem, RigidMotions(problem), f" at time {time:g}")
    problem.set_time(last)
    stabilised: tuple[str, ...] = ()
    if problem.scene.solver.stabilisation and motions:
        rigid = RigidMotions(problem)
        stabilised = stabilise(problem, rigid, _unresisted(problem, rigid))
    found = _at_present(problem)
    return replace(found, modes=len(motions), motions=motions, stabilised=stabilised)


def _at_present(problem: Problem) -> FreeMotion:
    """Judge the present loads."""
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
    share, best, held_by = 0.0, np.zeros(rigid.count), "none: held by the obstacles"
    if motions.shape[1]:
        force = rigid.force @ motions
        points = _scaled(rigid.slips(), motions)
        closings = closing[1] @ motions
        _require_pressed(problem, rigid, motions, points, closing[0], closings, closing[2])
        if total(problem.comm, points[0].sum()) > 0:
            share, found = used_share(problem.comm, points, force, closings)
            best, held_by = motions @ found, ""
            if share >= 1 - _ROUND_OFF:
                raise _beyond_friction(rigid, best, share)
    if problem.coulomb and not problem.can_pair_anew:
        share, best = _share_of_friction(problem, rigid)
        held_by = "" if share > 0 else "none: held by the obstacles"
    return FreeMotion(rigid.count, share, held_by or rigid.describe(best))


def _share_of_friction(
    problem: Problem, rigid: RigidMotions, at_time: str = ""
) -> tuple[float, Array]:
    """Least share of all friction that can hold the present loads, and what it holds; collective.

    Raises:
        NoEquilibriumError: It is 1 or more.
    """
    if rigid.count == 0 or rigid.force_size == 0:
        return 0.0, np.zeros(rigid.count)
    cones = contact_cones(problem, rigid)
    analysis = LimitAnalysis(cones, rigid.force, rigid.force_size)

    def judge() -> tuple[bool, float, Array]:
        is_beyond = analysis.motion_that_runs(1 - AT_LIMIT) is not None
        return is_beyond, *analysis.used_share()

    is_beyond, share, motion = on_root(problem.comm, judge)
    if is_beyond:
        raise _beyond_friction(rigid, motion, share, at_time)
    return share, motion


def _beyond_friction(
    rigid: RigidMotions, motion: Array, share: float, at_time: str = ""
) -> NoEquilibriumError:
    name = rigid.describe(motion)
    if share == np.inf:
        return NoEquilibriumError(
            f"no equilibrium{at_time}: a rigid motion is free ({name}), and no friction, however "
            "large, could hold it against the loads; add a support, or a load or force that "
            "presses it against an obstacle"
        )
    return NoEquilibriumError(
        f"no equilibrium{at_time}: the supports leave a rigid motion free ({name}), and the loads "
        f"are {share:.6g} times what friction can hold back; add a support or friction, or "
        "lower the loads"
    )


def _scaled(points: tuple[Array, Array], motions: Array) -> tuple[Array, Array]:
    return points[0], points[1] @ motions


def _friction_gram(comm: Any, points: tuple[Array, Array]) -> Array:
    return np.asarray(total(comm, np.einsum("q,qci,qcj->ij", points[0], points[1], points[1])))


def _resistance(
    problem: Problem, rigid: RigidMotions, closing: tuple[Array, Array, Array]
) -> Array:
    """∫ g r_T·r_T′ + c ∫ r_n r_n′ of all pairs of free motions, (motions, motions); collective."""
    friction = _friction_gram(problem.comm, rigid.slips())
    rough = _friction_gram(problem.comm, rigid.slips(coulomb=True))
    friction = friction + rough * ((np.trace(friction) or 1.0) / (np.trace(rough) or 1.0))
    weights, normal, _ = closing
    across = np.einsum("q,qi,qj->ij", weights, normal, normal)
    # Only ratios within one motion matter, so that the unit of c is free.
    share = np.trace(across)
    return np.asarray(
        friction + across * ((np.trace(friction) or 1.0) / share if share > 0 else 0.0)
    )


def _unresisted(problem: Problem, rigid: RigidMotions) -> Array:
    """Free motions that neither friction nor an obstacle resists, as columns; collective."""
    return reduced(null_space(_resistance(problem, rigid, rigid.closings())))


def _resisted_motions(
    problem: Problem, rigid: RigidMotions, closing: tuple[Array, Array, Array]
) -> Array:
    """Free motions scaled so that ∫ g |r_T|² + c ∫ r_n² is 1 for each, as columns.

    Raises:
        NoEquilibriumError: Neither friction nor an obstacle resists one of them at all.
    """
    gram = _resistance(problem, rigid, closing)
    unresisted = reduced(null_space(gram))
    if unresisted.shape[1]:
        pushed = np.abs(rigid.force @ unresisted) > 1e-10 * rigid.force_size
        motion = rigid.describe(unresisted[:, int(np.argmax(pushed))])
        raise NoEquilibriumError(
            "no equilibrium: neither supports nor friction nor obstacles resist a rigid motion "
            f"({motion})"
            + (
                ", which the loads push; add a support or friction (a stabilisation holds no loads)"
                if pushed.any()
                else "; its size is left undetermined; add a support or friction, or set "
                "solver.stabilisation = true, which holds it without a force"
            )
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
    loose = null_space(_friction_gram(problem.comm, points))
    if loose.shape[1] == 0 or len(weights) == 0:
        return
    force = rigid.force @ motions @ loose
    rows = closings @ loose
    one_sided = np.unique(np.round(rows / np.abs(rows).max(), 12), axis=0)
    found = minimised(
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
