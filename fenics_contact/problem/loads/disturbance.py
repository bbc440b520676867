"""Forces besides the loads of a scene: such as grow from nothing, or drive to and fro."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.scene.values import Repetition


@dataclass(frozen=True, eq=False)
class Drive:
    """Forces to and fro about a state.

    Attributes:
        nodal: Largest of them, (nodes, components) (force).
        rest: Pseudo-time at which all load paths of the scene rest.
        share: Factor over the pseudo-time since then.
    """

    nodal: Array
    rest: float
    share: Callable[[float], float]

    def at(self, time: float) -> Array:
        """The forces at a pseudo-time."""
        return self.nodal * self.share(time - self.rest)


@dataclass(frozen=True, eq=False)
class Disturbance:
    """Forces besides the scene's that grow from nothing, to see what they do.

    In straight lines through all that are known, and on as the last two lead.

    Attributes:
        times: Pseudo-times at which they are known, increasing, > 0; of loads that come again and
            again up to the end of the first cycle.
        nodal: The forces, each (nodes, components) (force).
        repetition: Of the loads, if they come again and again: then so do these.
    """

    times: Sequence[float]
    nodal: Sequence[Array]
    repetition: Repetition | None = None

    @classmethod
    def growing(cls, nodal: Array, time: float) -> Disturbance:
        """Evenly, to be so large at a pseudo-time."""
        return cls([time], [nodal])

    def at(self, now: float) -> Array:
        """The forces at a pseudo-time of the load steps."""
        time = now if self.repetition is None else self.repetition.first_time(now)
        place = min(int(np.searchsorted(self.times, time)), len(self.times) - 1)
        begin = self.times[place - 1] if place else 0.0
        first = self.nodal[-1] if time < now else 0.0  # a cycle begins where the last one ended
        before = self.nodal[place - 1] if place else first
        share = (time - begin) / (self.times[place] - begin)
        return np.asarray(before + share * (self.nodal[place] - before))
