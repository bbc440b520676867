"""Rigid slip: how much of what friction can hold it does hold, and jumps without facets' turns.

How much of what friction can hold against rigid slip it does hold. Friction found at the points of
contacts, τ with |τ| ≤ g, does work on a rigid motion r; it could do ∫ g |[r]_T| at the most. The
largest ratio of the two over motions along the contacts is the share of friction that is used: 0
where friction has no resultant, 1 where all of it slips as one. It is also the least s for which
tractions within s g have the same force and moment (a linear function over a norm; R. T.
Rockafellar, Convex Analysis, 1970, Theorem 16.4). Plain arrays, on any one rank.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface

# Of the slip that a motion makes: what it may move across surfaces and yet be one along them.
_ALONG = 1e-3
# Of the largest: combinations of motions that slip less than that do not slip.
_NO_SLIP = 1e-12
# Of the work of varying loads: what is less on motions that friction resists is round-off.
_NO_WORK = 1e-9
# Of the least denominator: steps after which it counts as found, and how many there may be.
_SETTLED, _STEPS = 1e-11, 500
# Of the largest slip at a point: what is less counts as that much while weights are found.
_LEAST_SLIP = 1e-9


@dataclass(frozen=True)
class RigidSlip:
    """Slips of rigid motions at the closed points of contacts, of all ranks.

    Attributes:
        across: Σ over the contacts of ∫ r_n r_n′, of those that resist it, (motions, motions).
        allowed: Σ of the square of what r_n may be of r_T, times ∫ r_T · r_T′, likewise.
        work: Of the friction found on each motion, or of what it is to hold, (motions,)
            (force × length).
        bounds: Friction bound times area at the points, (points,) (force).
        slips: Slips there as friction feels them, (points, components, motions).
    """

    across: Array
    allowed: Array
    work: Array
    bounds: Array
    slips: Array

    def share(self) -> tuple[float | None, Array]:
        """The share of friction that is used, and the motion that shows it.

        Returns:
            None where no motion of these slips on friction without moving across contacts, and
            the motion, (motions,), of any size; 0 where there is none.
        """
        along = self._resisted()
        if along is None:
            return None, np.zeros(len(self.work))
        motion = along @ _least_denominator(self.bounds, self.slips @ along, self.work @ along)
        work = float(self.work @ motion)
        return (work / self._most(motion), motion) if work > 0 else (0.0, np.zeros_like(motion))

    def factor(self, varying: Array, present: float) -> float | None:
        """The factor of varying loads at which parts slip as one, with the bounds of friction kept.

        The least (j(r) − f₀(r))/f₁(r) over motions of f₁(r) > 0, where j(r) is the most that
        friction takes, and f₀ is the work of the constant loads.

        Args:
            varying: Work f₁ of the varying loads on each motion, for a factor of 1, (motions,)
                (force × length).
            present: The factor with which the friction was found.

        Returns:
            None where the varying loads do no work on motions that friction resists.
        """
        along = self._resisted()
        if along is None or np.abs(varying @ along).max() <= _NO_WORK * np.abs(varying).max():
            return None
        constant, varying = (self.work - present * varying) @ along, varying @ along
        motion = _least_denominator(self.bounds, self.slips @ along, varying, constant)
        return self._most(along @ motion) - float(constant @ motion)

    def _resisted(self) -> Array | None:
        """Motions along contacts that slip where friction acts, as columns; None if none do."""
        along, _ = motions_along(self.across, self.allowed)
        if along.shape[1] == 0 or not self.bounds.any():
            return None
        values, vectors = np.linalg.eigh(_gram(self.bounds, self.slips @ along))
        resisted = vectors[:, values > _NO_SLIP * max(values.max(initial=0.0), 0.0)]
        return along @ resisted if resisted.shape[1] else None

    def _most(self, motion: Array) -> float:
        """The most work that friction can take of a motion (force × length)."""
        return float(self.bounds @ np.linalg.norm(self.slips @ motion, axis=1))


def motions_along(across: Array, allowed: Array) -> tuple[Array, Array]:
    """Motions that do not move across contacts: r_n² ≤ (allowed r_T)² in the mean.

    Of all motions of the space that they span.

    Args:
        across: As of ``RigidSlip``.
        allowed: Likewise.

    Returns:
        They, as columns, (motions, found), and rows that tell how much of each is in a motion,
        (found, motions).
    """
    whole = across + allowed
    values, vectors = np.linalg.eigh(whole)
    moves = values > 1e-14 * values.max(initial=0.0)
    whitened = vectors[:, moves] / np.sqrt(values[moves])
    shares, combined = np.linalg.eigh(whitened.T @ across @ whitened)
    found = whitened @ combined[:, shares <= 0.5]
    return found, found.T @ whole


def allowance(facet_turn: float) -> float:
    """Motion across a surface that a slip along it may have, over the slip.

    Normals of facets tell those of the surface no better than by how far they are turned from them.

    Args:
        facet_turn: Angle between facets and the normals averaged over them (radians).
    """
    return max(_ALONG, facet_turn)


def _least_denominator(
    bounds: Array, slips: Array, work: Array, constant: Array | None = None
) -> Array:
    """The motion a of work · a = 1 that minimises Σ g |slips a| − constant · a, by weights.

    The weights follow the motion: a sum of lengths is least where that of squares over lengths is
    (E. Weiszfeld, 1937).

    Args:
        bounds: g, (points,).
        slips: Of independent motions, (points, components, motions).
        work: Of each motion, (motions,).
        constant: Work of other loads, (motions,); None for nothing.
    """
    if not work.any():
        return np.zeros_like(work)
    constant = np.zeros_like(work) if constant is None else constant
    weights, least = bounds, np.inf
    best = np.zeros_like(work)
    for _ in range(_STEPS):
        sides = np.column_stack([work, constant])
        by_work, by_constant = np.linalg.lstsq(_gram(weights, slips), sides, rcond=1e-15)[0].T
        motion = by_constant + by_work * (1 - work @ by_constant) / (work @ by_work)
        lengths = np.linalg.norm(slips @ motion, axis=1)
        found = float(bounds @ lengths - constant @ motion)
        if found < least:
            best = motion
        if found > (1 - _SETTLED) * least:
            break
        least = found
        weights = bounds / np.maximum(lengths, _LEAST_SLIP * lengths.max())
    return best


def _gram(weights: Array, slips: Array) -> Array:
    """Σ w s_i · s_j over points, (motions, motions)."""
    rows = (np.sqrt(weights)[:, None, None] * slips).reshape(-1, slips.shape[2])
    return np.asarray(rows.T @ rows)


# Of the slip of a motion: what is less across a surface is round-off.
_FLAT = 1e-12
# Of the jumps of all motions: what is round-off once that is taken off.
_ROUND_OFF = 1e-9


def smooth_closing(contact: ContactSurface, closing: Array, jumps: Array, acts: Flags) -> Array:
    """Normal jumps without those that facets make of motions along a curved surface; collective.

    A shaft turns in a hub of facets as in a round one: its facets do not hold it.

    Args:
        contact: The contact.
        closing: Normal jumps, (points, motions).
        jumps: Of the motions, (points, components, motions).
        acts: Which points count.
    """
    comm, weights = contact.spaces.comm, contact.trace.weights[acts]
    every = np.einsum("q,qci,qcj->ij", weights, jumps[acts], jumps[acts])
    normal = np.einsum("q,qi,qj->ij", weights, closing[acts], closing[acts])
    every, across = total(comm, np.stack([every, normal]))
    allowed = allowance(contact.kinematics.facet_turn) ** 2 * (every - across)
    along, shares = motions_along(across, allowed)
    left = largest(comm, np.abs(closing[acts] @ along).ravel())
    size = largest(comm, np.abs(jumps[acts] @ along).ravel())
    is_flat = left <= _FLAT * size  # or round for them: there is nothing but round-off to take off
    smooth = closing.copy() if is_flat else closing - (closing @ along) @ shares
    small = _ROUND_OFF * largest(comm, np.abs(jumps[acts]).ravel())
    # A motion is taken off as a whole: of single numbers, sums would no longer vanish.
    sizes = [largest(comm, np.abs(column)) for column in smooth[acts].T]
    smooth[:, np.array(sizes) <= small] = 0.0
    return smooth
