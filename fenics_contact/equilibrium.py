"""Can friction hold the body? The paper's condition |f(r)| < j(r), (2.4)-(2.5).

Where the supports leave rigid motions free, only friction resists them. The
largest f(r) over the free motions with j(r) ≤ 1 is the share of the limit load
that is used; it is found by cutting planes: every linear programme bounds it
from above, every motion tried from below.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.errors import NoEquilibriumError
from fenics_contact.parallel import largest, total
from fenics_contact.problem import Problem
from fenics_contact.scene import AXES

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
    """Refuse a scene whose loads friction and supports cannot hold; collective.

    Raises:
        NoEquilibriumError: In one sentence that names the motion.
    """
    rigid = _RigidModes(problem)
    modes = rigid.free(problem)
    if modes.shape[1] == 0:
        return FreeMotion(0, 0.0, "none")
    resisted, force = _resisted_modes(problem, rigid, modes)
    share, best = _used_share(problem.comm, _slips(problem, rigid, resisted), force)
    motion = rigid.describe(resisted @ best)
    if share >= 1 - _ROUND_OFF:
        raise NoEquilibriumError(
            f"no equilibrium: the supports leave a rigid motion free ({motion}), and the loads "
            f"are {share:.6g} times what friction can hold back; add a support or friction, or "
            "lower the loads"
        )
    return FreeMotion(modes.shape[1], share, motion)


class _RigidModes:
    """Rigid motions at the nodes: translations, then rotations scaled to the body's size."""

    def __init__(self, problem: Problem) -> None:
        spaces = problem.spaces
        self.owned = spaces.owned_nodes
        points = spaces.coordinates
        count = total(problem.comm, self.owned)
        self.centre = total(problem.comm, points[: self.owned].sum(axis=0)) / count
        offset = points - self.centre
        self.size = largest(problem.comm, np.abs(offset[: self.owned]).ravel(), empty=1.0)
        offset = offset / self.size
        self.names: list[tuple[str, int]] = []
        fields: list[Array] = []
        axes = range(spaces.components) if spaces.kinematics != "axisymmetric" else (1,)
        for axis in axes:
            field = np.zeros((len(points), 3))
            field[:, axis] = 1.0
            fields.append(field)
            self.names.append(("translation", axis))
        spins = {"3D": (0, 1, 2), "axisymmetric": ()}.get(spaces.kinematics, (2,))
        for axis in spins:
            fields.append(np.cross(np.eye(3)[axis], offset))
            self.names.append(("rotation", axis))
        # (nodes, components, modes)
        self.fields = np.stack(fields, axis=-1)[:, : spaces.components]

    def free(self, problem: Problem) -> Array:
        """Combinations (modes, free) that vanish on every constrained dof."""
        components = problem.spaces.components
        dofs = problem.constrained[problem.constrained < self.owned * components]
        rows = self.fields.reshape(-1, self.fields.shape[-1])[dofs]
        return _null_space(total(problem.comm, rows.T @ rows))

    def describe(self, combination: Array) -> str:
        """A motion in words."""
        translation, rotation = np.zeros(3), np.zeros(3)
        for (kind, axis), share in zip(self.names, combination, strict=True):
            (translation if kind == "translation" else rotation)[axis] += share
        scale = np.abs(combination).max() or 1.0
        words = []
        for kind, vector in (("translation along", translation), ("rotation about", rotation)):
            axes = [AXES[i] for i in range(3) if abs(vector[i]) > 1e-6 * scale]
            if axes:
                words.append(f"{kind} {' and '.join(axes)}")
        return ", ".join(words)


def _null_space(gram: Array) -> Array:
    """Null space of a symmetric positive semi-definite matrix, as columns."""
    values, vectors = np.linalg.eigh(gram)
    null = values <= 1e-13 * max(values.max(initial=0.0), np.finfo(float).tiny)
    return vectors[:, null]


def _slips(problem: Problem, rigid: _RigidModes, modes: Array) -> tuple[Array, Array]:
    """Weights w g and slips (points, components, modes) of modes at this rank's points."""
    weights, slips = [np.zeros(0)], [np.zeros((0, problem.spaces.components, modes.shape[1]))]
    for contact in problem.frictional:
        moved = contact.trace.at_points(rigid.fields) @ modes
        tangential = np.stack(
            [contact.tangential(moved[..., i]) for i in range(modes.shape[1])], axis=-1
        )
        weights.append((contact.trace.weights * contact.friction_bound)[contact.trace.owned])
        slips.append(tangential[contact.trace.owned])
    return np.concatenate(weights), np.concatenate(slips)


def _resisted_modes(problem: Problem, rigid: _RigidModes, modes: Array) -> tuple[Array, Array]:
    """Free modes scaled so that ∫ g |r_T|² is 1 for each, and the loads' work on them.

    Raises:
        NoEquilibriumError: Friction does not resist one of them at all.
    """
    weights, slips = _slips(problem, rigid, modes)
    gram = total(problem.comm, np.einsum("q,qci,qcj->ij", weights, slips, slips))
    unresisted = _null_space(gram)
    work = problem.load[: rigid.owned, :, None] * rigid.fields[: rigid.owned]
    force = total(problem.comm, work.sum(axis=(0, 1)))
    size = total(problem.comm, np.abs(work).sum(axis=(0, 1))).max()
    if unresisted.shape[1]:
        motion = rigid.describe(modes @ unresisted[:, 0])
        pushed = np.abs(force @ modes @ unresisted).max() > 1e-10 * size
        raise NoEquilibriumError(
            f"no equilibrium: neither supports nor friction resist a rigid motion ({motion})"
            + (", which the loads push" if pushed else "; its size is left undetermined")
            + "; add a support or friction"
        )
    values, vectors = np.linalg.eigh(gram)
    scaled = modes @ (vectors / np.sqrt(values))
    force[np.abs(force) <= 1e-12 * size] = 0.0
    return scaled, force @ scaled


def _used_share(comm: Any, points: tuple[Array, Array], force: Array) -> tuple[float, Array]:
    """Maximise f(a) subject to j(a) = Σ w g |S a| ≤ 1, by cutting planes.

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
    cuts: list[Array] = []
    above: float = np.finfo(float).max
    below, best = 0.0, trial
    while len(cuts) < 2 * _MAX_CUTS and above - below > _GAP * above:
        dissipation, slope = _dissipation(comm, weights, slips, trial)
        if force @ trial / dissipation > below:
            below, best = float(force @ trial) / dissipation, trial
        cuts += [slope, -slope]
        found = linprog(
            -force,
            A_ub=np.array(cuts),
            b_ub=np.ones(len(cuts)),
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
