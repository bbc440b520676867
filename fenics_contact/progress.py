"""How far the load steps are: a bar on a terminal, a line a step elsewhere."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from mpi4py import MPI
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from fenics_contact.scene import Steps

Announce = Callable[[int, dict[str, Any]], None]


def step_line(number: int, step: dict[str, Any]) -> str:
    """A load step in one line.

    Args:
        number: Counted from 1.
        step: Its record, as in ``result.json``.
    """
    found = step["quantities"]
    passes = f", {step['outer_iterations']} passes" if step["outer_iterations"] else ""
    return (
        f"step {number}: time {step['load_factor']:.6g}, {step['newton_iterations']} Newton steps"
        f"{passes}, contact area {found['contact_area']:.4g}, sticking {found['stick_area']:.4g}"
    )


@contextmanager
def step_bar(steps: Steps, comm: MPI.Comm) -> Iterator[Announce | None]:
    """A bar on the terminal of rank 0; None where lines are to be logged.

    Args:
        steps: Of the scene.
        comm: Communicator.
    """
    console = Console(stderr=True)
    if not comm.bcast(console.is_terminal) or not steps.several:
        yield None
        return
    if comm.rank > 0:
        yield lambda number, step: None
        return
    columns = (BarColumn(bar_width=20), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress, _logging_above():
        task = progress.add_task("load steps", total=steps.last)

        def announce(number: int, step: dict[str, Any]) -> None:
            line = step_line(number, step)
            progress.update(task, completed=step["load_factor"], description=line)

        yield announce


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
