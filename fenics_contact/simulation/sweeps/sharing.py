"""Distribution of the points of a sweep over its processes."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from fenics_contact.simulation.sweeps.points import Group


@dataclass(eq=False)
class _Share:
    """Points of one body for one process.

    Attributes:
        group: Number of their body.
        mesh: What their mesh follows from.
        points: That are left, neighbours next to each other.
    """

    group: int
    mesh: str
    points: deque[int]


class Shares:
    """Hands out points.

    A body is made by as few processes as keep all of them busy: whole groups go to one process
    where there are enough of them, else the largest are cut into stretches of neighbours. A process
    that is done takes what waits, best of its own mesh, then half of what another one has left of
    the same body.

    Args:
        groups: Points by their bodies.
        jobs: Number of processes.
    """

    def __init__(self, groups: Sequence[Group], jobs: int) -> None:
        self._waiting: list[_Share] = []
        for number, (group, parts) in enumerate(zip(groups, _parts(groups, jobs), strict=True)):
            for part in _cut(group.points, parts):
                self._waiting.append(_Share(number, group.mesh, deque(part)))
        self._taken: dict[int, _Share] = {}

    @property
    def left(self) -> int:
        """How many points nobody has been given."""
        return sum(len(one.points) for one in (*self._waiting, *self._taken.values()))

    def next(self, process: int) -> int | None:
        """The point that a process is to solve next; None if there is nothing for it.

        Args:
            process: Its number.
        """
        share = self._taken.get(process)
        if share is None or not share.points:
            share = self._another(process, share)
            if share is None:
                return None
            self._taken[process] = share
        return share.points.popleft()

    def give_back(self, process: int) -> None:
        """Let the points of a process that has died wait again."""
        share = self._taken.pop(process, None)
        if share is not None and share.points:
            self._waiting.insert(0, share)

    def _another(self, process: int, last: _Share | None) -> _Share | None:
        if self._waiting:
            best = min(self._waiting, key=lambda one: self._distance(one, process, last))
            self._waiting.remove(best)
            return best
        return None if last is None else self._half_of_another(process, last)

    def _distance(self, share: _Share, process: int, last: _Share | None) -> int:
        """How much of the body a process has to make anew, and whether another one does."""
        if last is not None and share.group == last.group:
            return 0
        if last is not None and share.mesh == last.mesh:
            return 1
        others = [one.mesh for number, one in self._taken.items() if number != process]
        return 3 if share.mesh in others else 2

    def _half_of_another(self, process: int, last: _Share) -> _Share | None:
        same = [
            one
            for number, one in self._taken.items()
            if number != process and one.group == last.group and one.points
        ]
        if not same:
            return None
        longest = max(same, key=lambda one: len(one.points))
        kept = len(longest.points) // 2
        taken = [longest.points.pop() for _ in range(len(longest.points) - kept)]
        return _Share(last.group, last.mesh, deque(reversed(taken)))


def _parts(groups: Sequence[Group], jobs: int) -> list[int]:
    """Into how many stretches each group is cut, so that there is one for every process."""
    parts = [1] * len(groups)
    for _ in range(jobs - len(groups)):
        sizes = [len(group.points) / part for group, part in zip(groups, parts, strict=True)]
        longest = max(range(len(groups)), key=sizes.__getitem__)
        if sizes[longest] <= 1:
            break
        parts[longest] += 1
    return parts


def _cut(points: Sequence[int], parts: int) -> list[Sequence[int]]:
    """Stretches of about the same length."""
    ends = [round(len(points) * part / parts) for part in range(parts + 1)]
    return [points[start:end] for start, end in pairwise(ends)]
