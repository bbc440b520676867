"""Can contact and friction hold the body? The paper's condition |f(r)| < j(r), (2.4)-(2.5).

Where the supports leave rigid motions free, friction resists them, and so do obstacles,
one way. A motion r that enters no obstacle (r_n ≤ 0 on Γ_C) and rubs nowhere needs f(r) < 0: the
loads press the body on. All others are left to ``limit_analysis``, whether or not the bound of
friction is known.

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
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.common.parallel import largest, on_root, total
from fenics_contact.problem.existence.friction_cones import contact_cones, separation_from
from fenics_contact.problem.existence.limit_analysis import AT_LIMIT, LimitAnalysis
from fenics_contact.problem.existence.stabilisation import named_motions, stabilise
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions, null_space, reduced
from fenics_contact.scene.loading.load_paths import times_to_judge

# Of the loads: the pressure at all points without which nothing is pressed on.
_PRESSED = 1e-9


@dataclass(frozen=True)
class FreeMotion:
    """Motions that supports leave free, and the share of friction that holds them.

    Attributes:
        modes: Number of independent rigid motions that the supports leave free.
        used_share: Least share of all friction that can hold the loads: 1 at the limit load, 0
            without any; where all bounds of friction are known, the largest f(r)/j(r).
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

    Args:
        problem: At the end of its load steps, as it is made.

    Raises:
        NoEquilibriumError: In one sentence that names the motion, and the time.
    """
    last = problem.scene.load_steps.last
    rigid = RigidMotions(problem)
    motions = tuple(named_motions(problem, rigid))
    if not problem.elastic.is_linear and motions:
        raise NoEquilibriumError(
            f'strains = "finite": the supports leave a rigid motion free ({motions[0]["motion"]}), '
            "which only contact could hold; this is not there yet, so add a support or a plane of "
            "symmetry"
        )
    if problem.inertia.moves:  # what loads do not hold, they move
        return FreeMotion(len(motions), 0.0, "none: bodies move", motions)
    _require_something(problem, rigid)
    earlier = [t for t in times_to_judge(problem.scene, problem.can_update_pairing) if t < last]
    for time in earlier:
        problem.set_time(time)
        rigid = RigidMotions(problem)
        _share_of_friction(problem, rigid, np.eye(rigid.count), f" at time {time:g}")
    if earlier:
        problem.set_time(last)
        rigid = RigidMotions(problem)
    stabilised: tuple[str, ...] = ()
    if problem.scene.solver.stabilisation and motions:
        stabilised = stabilise(problem, rigid, _unresisted(problem, rigid))
        rigid = RigidMotions(problem)
    found = _at_present(problem, rigid)
    return replace(found, modes=len(motions), motions=motions, stabilised=stabilised)


def _require_something(problem: Problem, rigid: RigidMotions) -> None:
    """Anything holds the bodies, touches them or acts on them.

    Raises:
        NoEquilibriumError: Nothing does, so that there is nothing to be found.
    """
    scene = problem.scene
    # Loads of a sector need do no work in any motion that the cut leaves.
    acts = rigid.force_size or largest(problem.comm, np.abs(problem.load))
    if not (scene.support or scene.symmetry or scene.contact or problem.unknowns or acts):
        notes = "".join(f"; {note}" for note in problem.body.notes)
        raise NoEquilibriumError(
            "no equilibrium: the scene has neither a support nor a contact nor a load, and leaves "
            f"nothing to be solved; add them{notes}"
        )


def _at_present(problem: Problem, rigid: RigidMotions) -> FreeMotion:
    """Judge the present loads, whose work on the free motions these tell."""
    if rigid.count == 0:
        return FreeMotion(0, 0.0, "none")
    if rigid.body_is_held and _all_pressed(rigid):
        return FreeMotion(rigid.count, 0.0, "obstacles that forces press on")
    closing = rigid.closings()
    _require_resisted(problem, rigid, closing)
    _require_pressed(problem, rigid, closing)
    among = np.eye(rigid.count)
    if problem.can_update_pairing:  # where Coulomb's friction acts at the end is not known yet
        among = null_space(_friction_gram(problem.comm, rigid.slips(coulomb=True)))
    share, motion = _share_of_friction(problem, rigid, among)
    held_by = rigid.describe(motion) if share > 0 else "none: held by the obstacles"
    return FreeMotion(rigid.count, share, held_by)


def _all_pressed(rigid: RigidMotions) -> bool:
    """Whether all that floats are obstacles that forces press on a surface, which may be left."""
    return all(
        one.drives and one.contact is not None and one.contact.is_one_sided
        for one in rigid.floating
    )


def _share_of_friction(
    problem: Problem, rigid: RigidMotions, among: Array, at_time: str = ""
) -> tuple[float, Array]:
    """Least share of all friction that can hold the present loads, and what it holds; collective.

    Args:
        problem: The model.
        rigid: Its free motions.
        among: The combinations of them that are judged, as columns.
        at_time: When, for the message.

    Raises:
        NoEquilibriumError: It is 1 or more.
    """
    if rigid.count == 0 or rigid.force_size == 0:
        return 0.0, np.zeros(rigid.count)
    cones, aligned = contact_cones(problem, rigid).of_motions(among).aligned()
    among = among @ aligned
    analysis = LimitAnalysis(cones, rigid.force @ among, rigid.force_size)
    share, found = on_root(problem.comm, analysis.used_share)
    motion = among @ found
    if share >= 1 - AT_LIMIT:
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


def _friction_gram(comm: MPI.Comm, points: tuple[Array, Array]) -> Array:
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


def _require_resisted(
    problem: Problem, rigid: RigidMotions, closing: tuple[Array, Array, Array]
) -> None:
    """Every free motion meets friction or an obstacle.

    Raises:
        NoEquilibriumError: Neither resists one of them at all.
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


def _require_pressed(
    problem: Problem, rigid: RigidMotions, closing: tuple[Array, Array, Array]
) -> None:
    """Every motion away from the obstacles that rubs nowhere needs f(r) < 0.

    That is so just if the loads can be balanced with some pressure at all points.
    """
    rubs = _friction_gram(problem.comm, rigid.slips())
    rubs = rubs / (np.trace(rubs) or 1.0)
    rough = _friction_gram(problem.comm, rigid.slips(coulomb=True))
    loose = null_space(rubs + rough / (np.trace(rough) or 1.0))
    weights, closings, gaps = closing
    if loose.shape[1] == 0 or len(weights) == 0:
        return
    force, rows = rigid.force @ loose, closings @ loose
    found = on_root(problem.comm, lambda: _push(rows, weights, force, rigid.force_size))
    if found is not None:
        said, motion = found
        raise NoEquilibriumError(
            f"no equilibrium: a rigid motion is free ({rigid.describe(loose @ motion)}), and {said}"
            " the obstacles; add a support, or a load or force that presses them together"
        )
    if gaps.min() > 0 and rigid.force_size > 0 and not force.any():
        raise NoEquilibriumError(
            "no equilibrium: the body has clearance between its obstacles, and nothing presses "
            "it against one of them; close a gap, or add a support or a load"
        )


def _push(closings: Array, weights: Array, force: Array, size: float) -> tuple[str, Array] | None:
    """A motion to which obstacles give way and that the loads drive, or do not resist."""
    pushed = separation_from(closings, force, size)
    if pushed is not None:
        return "the loads push it away from", pushed
    evenly = weights @ closings / weights.sum()
    if separation_from(closings, -evenly, 1.0) is None:
        return None  # no motion leaves all obstacles: they hold it both ways
    pressure = _PRESSED * np.linalg.norm(force) / np.linalg.norm(evenly)
    loads = force - pressure * evenly if force.any() else -evenly
    free = separation_from(closings, loads, 0.0)
    return None if free is None else ("nothing presses it against", free)
