"""How far a run is: a line that changes on a terminal, elsewhere a line now and then."""

from __future__ import annotations

import logging
import math
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

from mpi4py import MPI

from fenics_contact.common import timings
from fenics_contact.common.parallel import from_root
from fenics_contact.common.terminal import Terminal
from fenics_contact.results.load_history import Announce, step_line
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.scene.scene import Steps
from fenics_contact.scene.units.dimensions import UnitNames

if TYPE_CHECKING:
    from rich.progress import ProgressColumn

logger = logging.getLogger(__name__)

# Seconds without a line before the first one now and then; each wait is twice the one before, up to
# the longest.
_FIRST, _LONGEST = 10.0, 60.0
# Characters of the bar; and of all that stands beside the words.
_BAR = 20
# Share of work that is done from which it is told how long the rest takes.
_TELLS = 0.05
_BESIDE = _BAR + len("  0:00:00 ")


@contextmanager
def activity(
    steps: Steps, comm: MPI.Comm, quiet: bool = False, units: UnitNames | None = None
) -> Iterator[Announce | None]:
    """What a run is doing, on the terminal of rank 0; collective.

    How far the load steps are, phases, and Newton steps; it vanishes at the end. Without a
    terminal, or on one that cannot move its cursor, lines are logged: one for every load step, and
    one now and then of what is being done meanwhile.

    Args:
        steps: Of the scene.
        comm: Communicator.
        quiet: Whether to show nothing.
        units: Of the scene, if any.

    Yields:
        What to call with number and record of every load step, or None where they are logged.
    """
    console = Terminal(stderr=True)
    if not from_root(comm, _can_move(console) and not quiet):
        with nullcontext() if quiet or comm.rank > 0 else _lines_now_and_then():
            yield None
        return
    if comm.rank > 0:
        yield lambda number, step: None
        return
    from rich.progress import Progress

    with Progress(*_columns(steps.several), console=console, transient=True) as progress:
        task = progress.add_task("", total=steps.last)
        where = ""

        def announce(number: int, step: StepRecord) -> None:
            nonlocal where
            if steps.several:
                line = step_line(number, step, units)
                where = line.partition(", ")[0] + ", "
                progress.update(task, completed=step.load_factor, description=cut(line))

        def tell(message: str) -> None:
            progress.update(task, description=cut(where + message))

        def cut(line: str) -> str:
            room = max(console.width - _BESIDE, 1)  # rich would cut the bar as well
            return line if len(line) <= room else f"{line[: room - 1]}…"

        with _logging_above(), _listening(tell):
            yield announce


@contextmanager
def counting(total: int, quiet: bool) -> Iterator[Callable[[int, str], None]]:
    """How many of many things are done, on the terminal, as ``activity``; on one rank.

    Args:
        total: How many there are.
        quiet: Whether to show nothing.

    Yields:
        What to call with how many are done, and with words of it.
    """
    console = Terminal(stderr=True)
    if quiet:
        yield lambda done, words: None
    elif not _can_move(console):
        with _NowAndThen() as watch:
            yield lambda done, words: watch.tell(words)
    else:
        from rich.progress import Progress

        with Progress(*_columns(True), console=console, transient=True) as progress:
            task = progress.add_task("", total=total)
            with _logging_above():
                yield lambda done, words: progress.update(task, completed=done, description=words)


def _can_move(console: Terminal) -> bool:
    """Whether it is a terminal that can move its cursor."""
    return console.is_terminal and not console.is_dumb_terminal


def _columns(several: bool) -> tuple[ProgressColumn, ...]:
    """A bar where there are several things to do; the time; and words."""
    from rich.progress import BarColumn, SpinnerColumn, TextColumn, TimeElapsedColumn

    bar = BarColumn(_BAR) if several else SpinnerColumn()
    return bar, TimeElapsedColumn(), TextColumn("{task.description}", markup=False)


class TimeLeft:
    """How long work takes that is left, by how long took what is done of it.

    Args:
        now: Tells the time in seconds.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._begun = self._first = self._share = math.nan

    def note(self, share: float | None) -> None:
        """Note how much is done.

        Args:
            share: 0 … 1; less than before of work that begins anew, None of such that is not known.
        """
        share = math.nan if share is None else share
        if not share >= self._share:
            self._begun, self._first = self._now(), share
        self._share = share

    @property
    def words(self) -> str:
        """In words, such as `` (about 1:20 left)``; empty while too little is done to tell."""
        done = self._share - self._first
        if not (done >= _TELLS and self._share < 1):
            return ""
        spent = self._now() - self._begun
        return f" (about {_minutes(spent * (1 - self._share) / done)} left)"


def _minutes(seconds: float) -> str:
    """Minutes and seconds as a clock has them."""
    whole, rest = divmod(round(seconds), 60)
    return f"{whole}:{rest:02d}"


class _Listener(logging.Handler):
    """Passes messages of all levels on, with the time that is left.

    Those of solves for estimates say what they are for; of how far such a solve is, nothing follows
    for the run.
    """

    def __init__(self, tell: Callable[[str], None], said: Callable[[], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell, self._said = tell, said
        self._phase, self._left = "", TimeLeft()

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno > logging.DEBUG:
            self._said()
        if record.name == __name__:
            return
        words = record.getMessage().strip()
        is_phase = record.name == timings.__name__
        estimates = self._phase.startswith(timings.ESTIMATING)
        if is_phase:
            self._phase = words
        elif estimates:
            words = f"{self._phase}: {words}"
        if hasattr(record, "share") and (is_phase or not estimates):
            self._left.note(record.share)
        self._tell(words + self._left.words)


class _NowAndThen:
    """Logs what is being done when nothing has been logged for a while.

    It does so from a thread of its own, as what takes long may say nothing meanwhile.
    """

    def __init__(self) -> None:
        self._start = self._last = time.monotonic()
        self._words, self._wait = "making ready", _FIRST
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> _NowAndThen:
        self._thread.start()
        return self

    def __exit__(self, *raised: object) -> None:
        self._ended.set()
        self._thread.join()

    def tell(self, message: str) -> None:
        """Note what is being done."""
        self._words = message

    def said(self) -> None:
        """Note that a line was logged by others."""
        self._last = time.monotonic()

    def _watch(self) -> None:
        while not self._ended.wait(self._last + self._wait - time.monotonic()):
            now = time.monotonic()
            if now < self._last + self._wait:
                continue
            self._last, self._wait = now, min(2 * self._wait, _LONGEST)
            logger.info("  after %s: %s", _minutes(now - self._start), self._words)


@contextmanager
def _lines_now_and_then() -> Iterator[None]:
    """Have a line logged where a run says nothing for long."""
    with _NowAndThen() as watch, _listening(watch.tell, watch.said):
        yield


@contextmanager
def _listening(
    tell: Callable[[str], None], said: Callable[[], None] = lambda: None
) -> Iterator[None]:
    """Have all messages of the program told, whatever its other handlers leave out.

    Args:
        tell: Called with each.
        said: Called when one is for everyone to read.
    """
    logger = logging.getLogger("fenics_contact")
    listener, level = _Listener(tell, said), logger.level
    logger.addHandler(listener)
    logger.setLevel(logging.DEBUG)
    try:
        yield
    finally:
        logger.removeHandler(listener)
        logger.setLevel(level)


@contextmanager
def _logging_above() -> Iterator[None]:
    """Let messages go where the bar makes room for them."""
    handlers = logging.getLogger("fenics_contact").handlers
    streams = [
        handler
        for handler in handlers
        if isinstance(handler, logging.StreamHandler) and not handler.stream.closed
    ]
    before = [handler.setStream(sys.stderr) for handler in streams]
    try:
        yield
    finally:
        for handler, stream in zip(streams, before, strict=True):
            if stream is not None:
                handler.setStream(stream)
