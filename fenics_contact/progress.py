"""How far a run is: a line that changes on a terminal, a line a load step elsewhere."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from mpi4py import MPI
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Column

from fenics_contact.scene import Steps

Announce = Callable[[int, dict[str, Any]], None]


def step_line(number: int, step: dict[str, Any]) -> str:
    """A load step in one line.

    Args:
        number: Counted from 1.
        step: Its record, as in ``result.json``.
    """
    found = step["quantities"]
    passes = step["outer_iterations"]
    counted = f", {passes} pass{'es' if passes > 1 else ''}" if passes else ""
    return (
        f"step {number}: time {step['load_factor']:.6g}, {step['newton_iterations']} Newton steps"
        f"{counted}, contact area {found['contact_area']:.4g}, sticking {found['stick_area']:.4g}"
    )


@contextmanager
def activity(steps: Steps, comm: MPI.Comm, quiet: bool = False) -> Iterator[Announce | None]:
    """What a run is doing, on the terminal of rank 0; collective.

    How far the load steps are, phases, and Newton steps. It vanishes at the end where there is a
    single load step. Without a terminal, or on one that cannot move its cursor, there is nothing
    but lines for load steps, which are logged.

    Args:
        steps: Of the scene.
        comm: Communicator.
        quiet: Whether to show nothing.

    Yields:
        What to call with number and record of every load step, or None where they are logged.
    """
    console = Console(stderr=True)
    shows = console.is_terminal and not console.is_dumb_terminal and not quiet
    if not comm.bcast(shows):
        yield None
        return
    if comm.rank > 0:
        yield lambda number, step: None
        return
    bar = (BarColumn(bar_width=20),) if steps.several else (SpinnerColumn(),)
    columns = (*bar, TextColumn("{task.description}"), TimeElapsedColumn(), _Doing())
    with (
        Progress(*columns, console=console, transient=not steps.several) as progress,
        _logging_above(),
    ):
        task = progress.add_task("", total=steps.last, doing="")

        def announce(number: int, step: dict[str, Any]) -> None:
            if steps.several:
                line = step_line(number, step)
                progress.update(task, completed=step["load_factor"], description=line, doing="")

        with _listening(lambda message: progress.update(task, doing=message)):
            yield announce


class _Doing(TextColumn):
    """What is being done now: the last thing that was logged, cut where the terminal ends."""

    def __init__(self) -> None:
        column = Column(no_wrap=True, overflow="ellipsis", ratio=1)
        super().__init__("{task.fields[doing]}", style="dim", markup=False, table_column=column)


class _Listener(logging.Handler):
    """Passes messages of all levels on."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        super().__init__(logging.DEBUG)
        self._tell = tell

    def emit(self, record: logging.LogRecord) -> None:
        self._tell(record.getMessage().strip())


@contextmanager
def _listening(tell: Callable[[str], None]) -> Iterator[None]:
    """Have all messages of the program told, whatever its other handlers leave out."""
    logger = logging.getLogger("fenics_contact")
    listener, level = _Listener(tell), logger.level
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
