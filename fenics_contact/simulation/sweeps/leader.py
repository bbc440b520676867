"""The process that leads a sweep: it hands points to others, and keeps what they find."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from fenics_contact.common.errors import MachineError, StoppedError
from fenics_contact.simulation.sweeps.journal import Done, Journal
from fenics_contact.simulation.sweeps.points import Group, Point
from fenics_contact.simulation.sweeps.processes import DiedError, WorkerProcess, ready
from fenics_contact.simulation.sweeps.sharing import Shares

logger = logging.getLogger(__name__)

_PAUSE = 0.25  # seconds between two looks at an interrupt
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

    def solve(self, groups: Sequence[Group], jobs: int) -> None:
        """Have points solved, each of them kept at once.

        Args:
            groups: Those to be solved.
            jobs: The most processes.

        Raises:
            StoppedError: The user asked to stop; what is done is kept.
            MachineError: The journal could not be written, or processes die one after the other.
        """
        jobs = min(jobs, sum(len(group.points) for group in groups))
        with tempfile.TemporaryDirectory(prefix="fenics_contact_") as folder:
            self._folder, self._shares = Path(folder), Shares(groups, jobs)
            try:
                for number in range(jobs):
                    self._give(number)
                while self._at_work:
                    if self._stopped():
                        raise StoppedError("interrupted")
                    for number in ready(self._processes, _PAUSE):
                        self._take(number)
                        self._give(number)
            finally:
                for process in self._processes.values():
                    process.close()

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

    def _take(self, number: int) -> None:
        """What a process has found, or that it has died."""
        point = self._at_work.pop(number)
        try:
            content = self._processes[number].answer()
            self._deaths = 0
        except DiedError as error:
            content = self._bury(number, point, str(error))
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
