"""Limit analysis: can contact forces within their cones balance the loads on rigid motions?

Forces P_q ≥ 0 across and T_q along the surface at every point q that may touch, |T_q| ≤ μ P_q
where the pressure is not known and |T_q| ≤ g where it is, must do the opposite work of the loads
f on every rigid motion. By duality (Farkas) that fails just if there is a motion a with

  r_n + s μ |r_T| ≤ 0 at all these points,  f(a) > s Σ g |r_T|,

for s = 1: without friction of unknown pressure the paper's f(r) < j(r), (2.4)-(2.5). The smallest
s at which there is none is the share of the friction that the loads take: 1 at the limit, infinite
where no friction, however rough, would do. No bound on forces is assumed beyond that, so the
condition is necessary: no scene that has an equilibrium fails it.

What contacts can balance is a cone in the space of motions, with one coordinate more for bounds
that are known: its rays are c + s μ Sᵀd of each point, d any direction along the surface, and
(s Σ g Tᵀd, 1). Its distance from (f, 1) is F(s); the vector that separates them is the motion. F
falls to 0 at the share, by what the friction dissipates: Newton's method, within bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.problem.existence.friction_cones import (
    NO_DISTANCE,
    ContactCones,
    Ray,
    Separation,
    separation,
)

# A share of the friction beyond which none would hold.
_ROUGHEST = 1e6
_SHARE_TOLERANCE = 1e-6
# Of a trial's share over the last one.
_LARGEST_STEP = 8.0
# One trial of so many halves the interval, whatever is expected.
_HALVES = 6
# Loads come so near to the limit that the motion is undetermined.
AT_LIMIT = 1e-9
# Share of a motion from which it is named.
_TAKES_PART = 1e-3

# Where rays come from, other than the number of a point.
_KNOWN_FRICTION, _UNUSED_FRICTION = -1, -2


@dataclass(frozen=True)
class _Trial:
    """A share of the friction that does not hold the loads.

    Attributes:
        share: Of the friction.
        found: How the loads lie beyond it.
        falls: How fast the distance falls with the share: by what the friction dissipates.
        shown: The largest share that the same motion runs at.
    """

    share: float
    found: Separation
    falls: float
    shown: float


class LimitAnalysis:
    """Judges loads against what contacts can exert; on one rank.

    Args:
        cones: What contacts can exert.
        force: Work of the loads on each motion (force × length).
        size: The same with all contributions positive, for round-off.
    """

    def __init__(self, cones: ContactCones, force: Array, size: float) -> None:
        self._cones = cones
        unit = float(np.linalg.norm(force)) or 1.0
        self._round_off = NO_DISTANCE * max(1.0, size / unit)
        self._bounds = cones.bounds / unit
        self._has_known = bool((cones.bounds > 0).any())
        self._load = np.append(force / unit, 1.0) if self._has_known else force / unit
        self._sizes = np.linalg.norm(cones.closing, axis=1)
        self._rubs = cones.resisted(np.linalg.norm(cones.slips, axis=(1, 2)))
        self._count = len(force)

    def used_share(self) -> tuple[float, Array]:
        """Share of the friction that the loads take, and a motion that shows it.

        Returns:
            The share, from below, to ``_SHARE_TOLERANCE``; at least 1 - ``AT_LIMIT`` just where
            there is a motion that the loads drive; infinite beyond ``_ROUGHEST``. And the motion
            at which it is reached, 0 where the share is.
        """
        low, high = 0.0, 1 - AT_LIMIT
        found = self._separation(high)
        if found is not None:
            low, high = high, np.inf
        else:
            found = self._separation(low)
        if found is None:
            return 0.0, np.zeros(self._count)
        running = [self._trial(low, found)]
        missed = False
        for number in count(1):
            last = running[-1]
            low = min(last.shown, high)
            if low >= _ROUGHEST:
                return np.inf, self._sliding(last.found)
            tolerance = _SHARE_TOLERANCE * max(low, 1.0)
            if high - low <= tolerance:
                return low, self._sliding(last.found)
            if number % _HALVES:
                share = _next_share(running, low, high, tolerance, missed)
            else:
                share = _middle(low, high)
            found = self._separation(share)
            missed = found is None
            if found is None:
                high = share
            else:
                running.append(self._trial(share, found))
        raise AssertionError("the interval shrinks")

    def motion_that_runs(self, share: float) -> Array | None:
        """A motion that the loads drive though all friction is so many times as strong; or None."""
        found = self._separation(share)
        return None if found is None else found.motion[: self._count]

    def running(self) -> tuple[Array, Array] | None:
        """A motion that the loads drive against all friction, and what slides in it; or None."""
        found = self._separation(1.0)
        return None if found is None else (found.motion[: self._count], self._sliding(found))

    def _separation(self, share: float) -> Separation | None:
        """How the loads lie beyond so many times the friction; None where they are held."""
        found = separation(self._load, lambda direction: self._farthest_ray(share, direction))
        if found is None:
            return None
        motion = found.motion[: self._count]
        work = self._load[: self._count] @ motion - share * self._known(motion)[0]
        return found if work > self._round_off * np.linalg.norm(motion) else None

    def _farthest_ray(self, share: float, direction: Array) -> Ray | None:
        """The force that contacts can exert which works most in a motion, for its size."""
        cones, motion = self._cones, direction[: self._count]
        rays = []
        if len(cones.closing):
            vectors, lengths = _slips(cones.slips, motion)
            works = cones.closing @ motion + share * cones.resisted(lengths)
            point = int(np.argmax(works / (self._sizes + share * self._rubs + 1e-300)))
            along = vectors / np.where(lengths > 0, lengths, 1.0)[:, None]
            ray = cones.closing[point] + share * cones.rubbing(point, along)
            rays.append(Ray(np.append(ray, 0.0) if self._has_known else ray, point))
        if self._has_known:
            slope = self._known(motion)[1]
            rays.append(Ray(np.append(share * slope, 1.0), _KNOWN_FRICTION))
            rays.append(Ray(np.append(np.zeros(self._count), 1.0), _UNUSED_FRICTION))
        rays = [ray for ray in rays if ray.along.any()]
        return max(
            rays, key=lambda ray: ray.along @ direction / np.linalg.norm(ray.along), default=None
        )

    def _known(self, motion: Array) -> tuple[float, Array]:
        """j(a) = Σ g |r_T| where the bound is known, over the loads, and its slope."""
        vectors, lengths = _slips(self._cones.bounded_slips, motion)
        weights = (self._bounds / np.where(lengths > 0, lengths, 1.0))[:, None] * vectors
        slope = weights.reshape(-1) @ self._cones.bounded_slips.reshape(-1, self._count)
        return float(self._bounds @ lengths), slope

    def _trial(self, share: float, found: Separation) -> _Trial:
        """Bound of the share to be found, from a motion found at a share."""
        motion, cones = found.motion[: self._count], self._cones
        falls, resisted = 0.0, cones.resisted(_slips(cones.slips, motion)[1])
        for ray, amount in zip(found.rays, found.amounts, strict=True):
            if ray.origin == _KNOWN_FRICTION:
                falls += amount * self._known(motion)[0]
            elif ray.origin != _UNUSED_FRICTION:
                falls += amount * resisted[ray.origin]
        return _Trial(share, found, falls, self._shown_share(share, found))

    def _shown_share(self, share: float, found: Separation) -> float:
        """The largest share at which a motion, found at a share, is still one that runs."""
        motion, cones = found.motion[: self._count], self._cones
        dissipated = self._known(motion)[0]
        _, lengths = _slips(cones.slips, motion)
        rubs = cones.resisted(lengths)
        rises = rubs > 1e-9 * np.linalg.norm(motion)
        shares = -(cones.closing @ motion)[rises] / rubs[rises]
        work = self._load[: self._count] @ motion
        shown = work / dissipated if dissipated > 0 else np.inf
        return float(max(share, min(shown, shares.min(initial=np.inf))))

    def _sliding(self, found: Separation) -> Array:
        """A motion without what makes it rise, for words.

        What friction of unknown pressure just fails to hold rises as it slides, by duality; what
        is seen is that which slides: points that are pressed together stay in contact.
        """
        pressed = [ray.origin for ray in found.rays if ray.origin >= 0]
        rows = self._cones.closing[sorted(set(pressed))]
        motion = found.motion[: self._count]
        motion = motion - np.linalg.pinv(rows, rcond=1e-9) @ (rows @ motion)
        return np.where(np.abs(motion) > _TAKES_PART * np.abs(motion).max(), motion, 0.0)


def _slips(rows: Array, motion: Array) -> tuple[Array, Array]:
    """Slips at points in a motion, (points, components), and their lengths."""
    vectors = (rows.reshape(-1, len(motion)) @ motion).reshape(rows.shape[:2])
    return vectors, np.linalg.norm(vectors, axis=1)


def _next_share(
    running: list[_Trial], low: float, high: float, tolerance: float, missed: bool
) -> float:
    """A share next to that at which the distance is expected to vanish, else the middle."""
    last, root, beside = running[-1], _root(running), 0.4 * tolerance
    share = root + beside
    if missed:
        ahead = root - low
        share = root - max(beside, ahead * min(0.1, ahead))
    elif root < high <= share + beside:
        share = high - 2 * beside
    if high == np.inf:
        share = min(share, _middle(low, high))
    if low < share < high:
        return share
    # The ratio f(a)/j(a) of the last motion is a bound, and often the share (W. Dinkelbach, 1967).
    return low if last.share < low else _middle(low, high)


def _middle(low: float, high: float) -> float:
    """Between two bounds; a large step where there is no upper one."""
    return _LARGEST_STEP * max(low, 1.0) if high == np.inf else 0.5 * (low + high)


def _root(running: list[_Trial]) -> float:
    """Where the distance vanishes, by its values and slopes at the last shares, one or two.

    The share is a polynomial of the distance: by one as in Newton's method, by two a cubic.
    """
    last = running[-1]
    if last.falls <= 0:
        return np.inf
    distance, slope = last.found.distance, -1 / last.falls
    newton = last.share - distance * slope
    if len(running) == 1 or running[-2].falls <= 0:
        return newton
    before = running[-2]
    width = before.found.distance - distance
    if width <= 0:
        return newton
    mean = (before.share - last.share) / width
    bend = (3 * mean - 2 * slope + 1 / before.falls) / width
    twist = (slope - 1 / before.falls - 2 * mean) / width**2
    return newton + bend * distance**2 - twist * distance**3
