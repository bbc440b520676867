"""The process that leads a sweep: it hands points to others, and keeps what they find."""

from __future__ import annotations

import logging
import tempfile
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from fenics_contact.common.errors import MachineError, StoppedError
from fenics_contact.common.memory import cores, free_memory
from fenics_contact.simulation.sweeps.journal import Done, Journal
from fenics_contact.simulation.sweeps.points import Point, PointGroup
from fenics_contact.simulation.sweeps.processes import DiedError, WorkerProcess, ready


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

    def __init__(self, groups: Sequence[PointGroup], jobs: int) -> None:
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
        """Cost of a share to a process: 0 if it has the body, 1 if the mesh, more if neither."""
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


def _parts(groups: Sequence[PointGroup], jobs: int) -> list[int]:
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


logger = logging.getLogger(__name__)

_PAUSE = 0.25  # seconds between two looks at an interrupt
_PROGRAM = 0.4e9  # bytes that a process needs before it has a mesh
_MOST_DEATHS = 3  # of processes in a row, without an answer between them

Announce = Callable[[int, Done], None]


class Leader:
    """Has points solved side by side.

    Args:
        points: All of a sweep.
        journal: That keeps them.
        announce: Called with number and outcome of every point that is done.
        stopped: Whether the user asked to stop.
    """

    def __init__(
        self,
        points: Sequence[Point],
        journal: Journal,
        announce: Announce,
        stopped: Callable[[], bool],
    ) -> None:
        self._points, self._journal = points, journal
        self._announce, self._stopped = announce, stopped
        self._processes: dict[int, WorkerProcess] = {}
        self._at_work: dict[int, Point] = {}
        self._deaths = 0

    def solve(self, groups: Sequence[PointGroup], jobs: int | None) -> None:
        """Have points solved, each of them kept at once.

        Args:
            groups: Those to be solved.
            jobs: The most processes; None: one a core, if memory has room for them.

        Raises:
            StoppedError: The user asked to stop; what is done is kept.
            MachineError: The journal could not be written, or processes die one after the other.
        """
        most = min(jobs or cores(), sum(len(group.points) for group in groups))
        with tempfile.TemporaryDirectory(prefix="fenics_contact_") as folder:
            self._folder, self._shares = Path(folder), Shares(groups, most)
            # Those after the first wait until it knows how much memory it needs.
            first = 1 if jobs is None else most
            self._later = range(first, most)
            try:
                for number in range(min(first, most)):
                    self._give(number)
                while self._at_work:
                    if self._stopped():
                        raise StoppedError("interrupted")
                    for number in ready(self._processes, _PAUSE):
                        self._hear(number)
            finally:
                for process in self._processes.values():
                    process.close()

    def _hear(self, number: int) -> None:
        """Take what a process sends: a solved point, its need of memory, or that it has died."""
        try:
            said = self._processes[number].hear()
        except DiedError as error:
            said = self._bury(number, self._at_work[number], str(error))
        else:
            self._deaths = 0
        if isinstance(said, float):
            self._start_others(said)
        else:
            self._keep(self._at_work.pop(number), said)
            self._give(number)

    def _start_others(self, memory: float) -> None:
        """Start as many processes as there is memory for.

        Args:
            memory: That each needs (bytes).
        """
        later, self._later = self._later, range(0)
        room = int(max(free_memory() / (memory + _PROGRAM) - 1, 0))
        if room < len(later):
            said = "memory has room for %d processes of %.2g GB, of %d"
            logger.info(said, room + 1, (memory + _PROGRAM) / 1e9, len(later) + 1)
        for number in later[:room]:
            self._give(number)

    def _give(self, number: int) -> None:
        """A further point to a process, which is started where there is none."""
        chosen = self._shares.next(number)
        if chosen is None:
            process = self._processes.pop(number, None)
            if process is not None:
                process.close()
            return
        if number not in self._processes:
            try:
                self._processes[number] = WorkerProcess(self._folder)
            except OSError as error:
                raise MachineError(
                    f"the machine failed: a process cannot be started: {error}"
                ) from None
        point = self._points[chosen]
        assert point.scene is not None
        self._at_work[number] = point
        try:
            self._processes[number].give(point.scene, point.digest)
        except DiedError:
            logger.debug("process %d has died", number)  # which is seen when it is asked

    def _keep(self, point: Point, content: bytes) -> None:
        """Keep the outcome of a point in the journal, and announce it."""
        done, _ = Done.unpacked(content)
        self._journal.add(done, content)
        self._announce(point.number, done)
        if self._deaths >= _MOST_DEATHS:
            raise MachineError(
                f"the machine failed: {self._deaths} processes of the sweep have died one after "
                f"the other, of the last {done.said}; try fewer --jobs, and --resume"
            )

    def _bury(self, number: int, point: Point, how: str) -> bytes:
        """The point of a process that has died has no answer; what else it had goes to others."""
        self._deaths += 1
        self._processes.pop(number).close()
        self._shares.give_back(number)
        said = f"the process that solved it has died: {how}"
        return Done(point.digest, MachineError.exit_code, said).packed({})
