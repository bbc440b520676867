"""Limit analysis: can contact forces within their cones balance the loads on rigid motions?

Forces P_q ≥ 0 across and T_q along the surface at every point q that may touch, |T_q| ≤ μ P_q
where the pressure is not known and |T_q| ≤ g where it is, must do the opposite work of the loads
f on every rigid motion. By duality (Farkas) that fails just if there is a motion a with

  r_n + s μ |r_T| ≤ 0 at all these points,  f(a) > s Σ g |r_T|,

for s = 1: one that slides and rises at no less than the friction angle. The smallest s at which
there is none is the share of the friction that the loads take: 1 at the limit, infinite where no
friction, however rough, would do. No bound on forces is assumed beyond that, so the condition is
necessary: no scene that has an equilibrium fails it.

The circles |r_T| ≤ … are replaced by half planes around them, points and half planes being added
where the last motion found violates them (J. E. Kelley, J. SIAM 8 (1960) 703-712). What satisfies
all of them, to round-off, is a true motion of this kind.
"""

from __future__ import annotations

from itertools import count

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_cones import ContactCones
from fenics_contact.linear_programme import minimised

Array = NDArray[np.float64]

# Of the work of the loads: what is less is round-off of the linear programmes.
_WORK = 2e-9
# By which motions may enter an obstacle, of their size.
_ENTERS = 3e-10
# Of a motion's size: the round-off of jumps, which would make programmes ill-posed.
_ROUND_OFF = 1e-12
_LP_OPTIONS = {
    "primal_feasibility_tolerance": 1e-10,
    "dual_feasibility_tolerance": 1e-10,
    "time_limit": 10.0,
}
_MAX_ROUNDS = 400
_POINTS_A_ROUND = 5
# A share of the friction beyond which none would hold.
_ROUGHEST = 1e6
_SHARE_TOLERANCE = 1e-5
# Loads come so near to the limit that the motion is undetermined.
AT_LIMIT = 1e-7
# Share of a motion from which it is named.
_TAKES_PART = 1e-3
# Weight of a motion's size, as small as the work that counts for none.
_SMALL = 1e-10


class LimitAnalysis:
    """The dual linear programmes, with the half planes found so far; on one rank.

    Args:
        cones: What contacts can exert.
        force: Work of the loads on each motion (force × length).
        size: The same with all contributions positive, for round-off.
    """

    def __init__(self, cones: ContactCones, force: Array, size: float) -> None:
        self._cones = cones
        self._unit = size or 1.0
        self._force = force / self._unit
        self._points: list[int] = []
        self._half_planes: list[Array] = []  # of each of these points, the slip along a direction
        self._slopes: list[Array] = []

    def used_share(self) -> tuple[float, Array]:
        """Share of the friction that the loads take, and the motion that it holds.

        Returns:
            The share, to ``_SHARE_TOLERANCE``, infinite beyond ``_ROUGHEST``; and the motion.
        """
        first = self._run(0.0)
        if first is None:
            return 0.0, np.zeros(len(self._force))
        running = [(0.0, *first)]  # shares at which the loads still drive a motion
        high = 1.0
        while (found := self._run(high)) is not None:
            running.append((high, *found))
            if high >= _ROUGHEST:
                return np.inf, found[1]
            high *= 8
        for step in count(1):
            low, _, best = running[-1]
            tolerance = _SHARE_TOLERANCE * max(high, 1.0)
            if high - low <= tolerance:
                return high, self._sliding(best)
            # Their work falls nearly in a straight line: just beside where it is nothing, in turns.
            middle = 0.5 * (low + high)
            end = _end_of_line(running, middle) if step % 3 else middle
            aside = 0.4 * tolerance * (1 if step % 3 == 1 else -1)
            share = float(np.clip(end + aside, low + 0.1 * tolerance, high - 0.1 * tolerance))
            found = self._run(share)
            if found is None:
                high = share
            else:
                running.append((share, *found))
        raise AssertionError("the interval shrinks")

    def motion_that_runs(self, share: float) -> Array | None:
        """A motion that the loads drive though all friction is so many times as strong; or None."""
        found = self._run(share)
        return None if found is None else found[1]

    def _run(self, share: float) -> tuple[float, Array] | None:
        return self._largest_work(share, -np.ones(len(self._force)), np.ones(len(self._force)))

    def _sliding(self, motion: Array) -> Array:
        """A motion without what makes it rise, for words.

        What friction of unknown pressure just fails to hold rises as it slides, by duality; what
        is seen is that which slides: of its parts, those that go with the loads, or are carried.
        """
        motion = np.where(np.abs(motion) > _TAKES_PART * np.abs(motion).max(), motion, 0.0)
        rubs = np.abs(self._cones.slips).max(axis=(0, 1), initial=0.0) > 1e-9
        carried = (np.abs(self._force) <= _WORK) & rubs
        free = np.where(carried, motion, 0.0), motion
        found = self._largest_work(0.0, np.minimum(*free), np.maximum(*free))
        return motion if found is None else found[1]

    def _largest_work(
        self, share: float, lowest: Array, highest: Array
    ) -> tuple[float, Array] | None:
        """Maximise f(a) − s Σ g |r_T| over lowest ≤ a ≤ highest; None where it is 0.

        Of motions that do as much, a small one: η |a|₁ is taken off.
        """
        modes = len(self._force)
        cost = np.concatenate([_SMALL - self._force, _SMALL + self._force, [share]])
        low = np.concatenate([np.maximum(lowest, 0.0), np.maximum(-highest, 0.0), [0.0]])
        high = np.concatenate([np.maximum(highest, 0.0), np.maximum(-lowest, 0.0), [np.inf]])
        for _ in range(_MAX_ROUNDS):
            rows = self._rows(share)
            solved = minimised(
                cost,
                A_ub=np.hstack([rows[:, :-1], -rows[:, :-1], rows[:, -1:]]) if len(rows) else None,
                b_ub=np.zeros(len(rows)) if len(rows) else None,
                bounds=np.column_stack([low, high]),
                options=_LP_OPTIONS,
            )
            if solved.x is None or -solved.fun <= _WORK:
                return None
            motion = solved.x[:modes] - solved.x[modes:-1]
            if not self._add_violated(share, motion, float(solved.x[-1])):
                return -float(solved.fun), motion
        return None  # in doubt, a scene is not refused

    def _rows(self, share: float) -> Array:
        """Half planes found so far: rows of (a, t), ≤ 0."""
        cones, points = self._cones, self._points
        half_planes = np.array(self._half_planes).reshape(len(points), len(self._force))
        rough = share * cones.coefficients[points, None]
        across = (cones.closing[points] + rough * half_planes) / (1 + rough)
        across[np.abs(across) <= _ROUND_OFF] = 0.0
        rows = [np.column_stack([across, np.zeros(len(across))])]
        rows += [np.append(slope, -1.0)[None] for slope in self._slopes]
        return np.concatenate(rows)

    def _add_violated(self, share: float, motion: Array, dissipated: float) -> bool:
        """Add half planes that a motion violates; whether there are any."""
        cones = self._cones
        vectors = cones.slips @ motion
        lengths = np.linalg.norm(vectors, axis=1)
        excess = cones.closing @ motion + share * cones.coefficients * lengths
        excess /= 1 + share * cones.coefficients
        worst = np.argsort(-excess, kind="stable")[:_POINTS_A_ROUND]
        worst = worst[excess[worst] > _ENTERS]
        for point in worst:
            along = vectors[point] / (lengths[point] or 1.0)
            self._points.append(int(point))
            self._half_planes.append(along @ cones.slips[point])
        if share == 0:
            return len(worst) > 0
        slips = cones.bounded_slips @ motion
        sizes = np.linalg.norm(slips, axis=1)
        weights = cones.bounds / self._unit / np.where(sizes > 0, sizes, 1.0)
        slope = np.einsum("q,qc,qci->i", weights, slips, cones.bounded_slips)
        if slope @ motion - dissipated > _ENTERS:
            self._slopes.append(slope)
            return True
        return len(worst) > 0


def _end_of_line(running: list[tuple[float, float, Array]], otherwise: float) -> float:
    """Where the line through the work at the last two shares comes to nothing."""
    if len(running) < 2:
        return otherwise
    (before, more, _), (last, less, _) = running[-2:]
    return last + less * (last - before) / (more - less) if more > less else otherwise
