"""Where the time goes, in the words of ``result.json``."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI

logger = logging.getLogger(__name__)

PHASES = (
    *("mesh", "compile", "assemble", "factorise", "solve", "output", "errors", "derivatives"),
    *("vibration", "stability"),
)
ESTIMATING = "estimating errors"
CHECKING, SEARCHING = "checking the answer", "looking for other answers"
LOOKING_AHEAD = "looking by how much loads can grow"
WRITING = "writing files"
# Phases that may take long, in words.
_SAID = {
    "mesh": "making the mesh",
    "compile": "compiling forms",
    "factorise": "factorising the body",
    "errors": ESTIMATING,
    "derivatives": "finding derivatives",
    "vibration": "finding modes",
    "stability": "finding modes of steady sliding",
}
# What is inside of it counts to it.
_WHOLE = "errors"


def doing(words: str, share: float | None = None) -> None:
    """Say what is being done, for who watches how far a run is.

    Args:
        words: In a few words, as of a phase.
        share: Of the work that these words are a part of, what is done, 0 … 1; None where that is
            not known. Work begins anew where it falls.
    """
    logger.debug("%s", words, extra={"share": share})


class Timings:
    """Seconds spent in each phase; a phase inside another is not counted twice.

    What is solved for estimates of errors counts to these.
    """

    def __init__(self) -> None:
        self._start = time.perf_counter()
        self._seconds = dict.fromkeys(PHASES, 0.0)
        self._running: list[str] = []
        self._since = self._start

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count the time of a block to a phase."""
        self._switch()
        if name in _SAID and not {name, _WHOLE} & set(self._running):
            doing(_SAID[name])
        self._running.append(_WHOLE if _WHOLE in self._running else name)
        try:
            yield
        finally:
            self._switch()
            self._running.pop()

    def move(self, source: str, target: str, seconds: float) -> None:
        """Count seconds that a library measured inside one phase to another."""
        if _WHOLE in self._running:
            return
        seconds = min(seconds, self._seconds[source])
        self._seconds[source] -= seconds
        self._seconds[target] += seconds

    def _switch(self) -> None:
        now = time.perf_counter()
        if self._running:
            self._seconds[self._running[-1]] += now - self._since
        self._since = now

    def summary(self, comm: MPI.Comm) -> dict[str, float]:
        """Seconds by phase and in total, the slowest rank's of each; collective."""
        seconds = dict(self._seconds, total=time.perf_counter() - self._start)
        return {name: comm.allreduce(value, op=MPI.MAX) for name, value in seconds.items()}
