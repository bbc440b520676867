"""How far to go along a Newton step: where the energy's derivative along it vanishes.

What is searched by bracketing never goes beyond the step, and always ends near the zero. Secants
ask for a few tries at most, and are for where steps follow that correct each other.
"""

from __future__ import annotations

from collections.abc import Callable

# Derivative at the end over that at the start, from which it has vanished; and from
# which secants are content.
_FLAT = 0.1
_NEARLY_FLAT = 0.5
_MOST_SECANTS = 5
_SHORTEST, _LONGEST = 0.05, 2.0
_MOST_TRIALS = 80
# Ratio of the derivatives at the ends from which they are alike.
_ALIKE = 10.0


def share_of_step(slope_at: Callable[[float], float]) -> float:
    """Share of a step up to which energy falls, at most the whole; a bracket that shrinks.

    Secants alone go to and fro without end where a soft body meets a stiff penalty: on one side
    of the point where it closes the slope is nearly even, on the other side it is a million times
    steeper. So the interval is halved until its ends are alike, and then cut by false position,
    with the end that stays weighted down (the Illinois rule: M. Dowell, P. Jarratt, BIT 11 (1971)
    168-174).

    Args:
        slope_at: Derivative of the energy along the step, at a share of it.

    Returns:
        The share, > 0; 1 where energy falls all the way, or does not fall at the start.
    """
    low, high = 0.0, 1.0
    first = at_low = slope_at(low)
    at_high = slope_at(high)
    if first >= 0 or at_high <= -_FLAT * first:
        return high
    last = 0.0
    for _ in range(_MOST_TRIALS):
        share = (low * at_high - high * at_low) / (at_high - at_low)
        if at_high > -_ALIKE * first or not low < share < high:
            share = 0.5 * (low + high)
        found = slope_at(share)
        if abs(found) <= -_FLAT * first:
            return share
        weight = 0.5 if found * last > 0 else 1.0
        if found > 0:
            high, at_high, at_low = share, found, weight * at_low
        else:
            low, at_low, at_high = share, found, weight * at_high
        last = found
    return high  # where what closes is seen by the next step


def search_by_secants(slope_at: Callable[[float], float], slope: float) -> float:
    """Secants for a zero of the energy's derivative along a step, from the whole step.

    Args:
        slope_at: Derivative of the energy along the step, at a share of it.
        slope: At its start.

    Returns:
        The share that was tried last; it may be more than 1.
    """
    near, near_slope = 0.0, slope
    share, found = 1.0, slope_at(1.0)
    for _ in range(_MOST_SECANTS):
        if abs(found) <= _NEARLY_FLAT * abs(slope) or found == near_slope:
            break
        following = share - found * (share - near) / (found - near_slope)
        near, near_slope = share, found
        share = min(max(following, _SHORTEST), _LONGEST)
        found = slope_at(share)
    return share
