"""What drives a body to and fro about a state at which all else rests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fenics_contact.common.arrays import Array


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
