"""The answer of a solve inside the body."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from fenics_contact.common.arrays import Array


@dataclass(frozen=True, eq=False)
class BodyAnswer:
    """Nodal values of this rank, each of shape (nodes, components), ghosts included.

    Attributes:
        displacement: u (length).
        internal_force: K u, from the bulk alone (force).
        round_off: Largest that round-off may leave of the balance inside the body; 0 where the
            imbalance has it already (force).
    """

    displacement: Array
    internal_force: Array
    round_off: float = 0.0


# Gives it; collective.
FindBody = Callable[[], BodyAnswer]


class LazyDisplacement:
    """Finds the answer when it is asked for first, and lets go of what finds it.

    Args:
        find: Collective. It also sets the problem's functions to the answer.
    """

    def __init__(self, find: FindBody) -> None:
        self._find: FindBody | None = find
        self._found: BodyAnswer | None = None

    def __call__(self) -> BodyAnswer:
        """The answer; collective."""
        if self._find is not None:
            self._found, self._find = self._find(), None
        assert self._found is not None
        return self._found
