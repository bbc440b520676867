"""Failures in words and as exit codes, signals among them; no rank waits, no answer is lost.

Failures in words and as exit codes; no rank waits for them, and no answer is lost. Errors that all
ranks raise together are Python's ordinary ones. One that hits a rank alone leaves the others in a
collective call for ever, so it ends them all, with its message.
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any, ClassVar, TypeVar

from mpi4py import MPI
from petsc4py import PETSc

from fenics_contact.common.errors import (
    FenicsContactError,
    InputError,
    MachineError,
    NotConvergedError,
    StoppedError,
)
from fenics_contact.common.form_cache import COMPILER_SAID
from fenics_contact.common.parallel import of_every_rank
from fenics_contact.common.wording import printable

logger = logging.getLogger(__name__)

T = TypeVar("T")

# Seconds in which all ranks come to an error that they share.
_PATIENCE = 4.0
_PAUSE = 0.01

BUG = 1
READER_LEFT = 128 + signal.SIGPIPE  # as the shell has it
_NO_MEMORY = 55  # PETSC_ERR_MEM
_NO_MEMORY_SAID = "PETSc error code is: 55,"  # by dolfinx, in a plain RuntimeError
_LONGEST = 200  # of what a compiler or a library said
# Exit codes of what ends no run that has an answer: faults of the machine do, and who stops it.
_KEPT = {BUG, InputError.exit_code, NotConvergedError.exit_code}
_SOLVERS = "fenics_contact.solve"

LESS_MEMORY = "use a coarser mesh, a lower degree, or more machines"


def explain(error: BaseException) -> tuple[int, str]:
    """Exit code and what to say of an error: a sentence or, of a bug, where it is.

    Args:
        error: As it was raised.
    """
    error = original(error)
    if isinstance(error, FenicsContactError):
        return error.exit_code, str(error)
    if isinstance(error, KeyboardInterrupt):
        return StoppedError.exit_code, "interrupted"
    if _is_want_of_memory(error):
        said = f": {error}" if isinstance(error, MemoryError) and str(error) else ""
        return MachineError.exit_code, f"the machine failed: out of memory{said}; {LESS_MEMORY}"
    if _is_of_compiler(error):
        said = " ".join(str(error).split())[:_LONGEST]
        return MachineError.exit_code, (
            f"the machine failed: a form could not be compiled: {said}; is there a C compiler, and "
            "room in the cache of FEniCSx (XDG_CACHE_HOME, else ~/.cache)?"
        )
    if isinstance(error, BrokenPipeError) or _is_of_printing(error):
        return READER_LEFT, "nobody reads the output any more"
    if isinstance(error, OSError):
        return MachineError.exit_code, f"the machine failed: {error}"
    lines = "".join(traceback.format_exception(error)).rstrip()
    return BUG, f"a fault of the program, or of a function passed to it:\n{lines}"


def original(error: BaseException) -> BaseException:
    """The error of a callback in place of PETSc's, through which it came."""
    while isinstance(error, PETSc.Error) and error.__cause__ is not None:
        error = error.__cause__
    return error


def _is_want_of_memory(error: BaseException) -> bool:
    if isinstance(error, PETSc.Error):
        return bool(getattr(error, "ierr", 0) == _NO_MEMORY)
    is_said = isinstance(error, RuntimeError) and _NO_MEMORY_SAID in str(error)
    return is_said or isinstance(error, MemoryError)


def _is_of_printing(error: BaseException) -> bool:
    """Return whether PETSc failed to print to a reader that has left."""
    return isinstance(error, PETSc.Error) and "Broken pipe" in str(error)


def _is_of_compiler(error: BaseException) -> bool:
    by_name = type(error).__name__ == "VerificationError"  # cffi's, on one rank
    return by_name or (isinstance(error, RuntimeError) and bool(COMPILER_SAID.search(str(error))))


def say(text: str) -> None:
    """Tell the user, after all that was said before."""
    for stream, what in ((sys.stdout, ""), (sys.stderr, f"fenics-contact: {printable(text)}\n")):
        with suppress(OSError):  # who does not read it, or has no room for it, has the exit code
            stream.write(what)
            stream.flush()


def drop_output() -> None:
    """Let what is still to be printed go nowhere, as its reader has left."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
    os.close(nowhere)


@contextmanager
def failing_together(comm: MPI.Comm) -> Iterator[None]:
    """Let an error pass if every rank has one; else end all ranks with it; collective.

    A rank that has an error waits some seconds for the others to have one, too. If they do not,
    they wait for it in a collective call, or will in the next one: then it says what happened
    and calls ``MPI_Abort`` with the error's exit code. On one rank nothing is done.

    Args:
        comm: Communicator of those that work together.
    """
    if comm.size == 1:
        yield
        return
    watch = comm.Dup()  # where ranks wait here, no call of the work itself can answer
    try:
        yield
    except BaseException as error:
        if not _all_come(watch):
            _end_all(watch, error)
        raise
    finally:
        watch.Free()


def _all_come(watch: MPI.Comm) -> bool:
    """Whether every rank comes here in time."""
    request = watch.Ibarrier()
    end = time.monotonic() + _PATIENCE
    while not request.Test():
        if time.monotonic() > end:
            return False
        time.sleep(_PAUSE)
    return True


def _end_all(comm: MPI.Comm, error: BaseException) -> None:
    code, said = explain(error)
    say(f"rank {comm.rank} of {comm.size} failed, and with it the run: {said}")
    comm.Abort(code)
    os._exit(code)  # some MPIs come back from it


def attempt(
    comm: MPI.Comm,
    missing: str,
    action: Callable[[], T],
    instead: T,
    notes: list[str],
    expected: tuple[type[Exception], ...] = (),
) -> T:
    """Try an estimate, a picture or the like, without which the answer still stands; collective.

    A rank that fails alone, while others wait for it, still ends them all.

    Args:
        comm: Communicator of those that do it together.
        missing: What there is not if it fails: ``The error by the mesh was not estimated``.
        action: What is done; collective.
        instead: Returned if it fails.
        notes: To which that sentence is added, with the reason, once.
        expected: Errors that are the caller's to catch.

    Raises:
        StoppedError: Somebody asked to stop.
        MachineError: The machine failed, as do ``MemoryError`` and ``OSError``.

    >>> notes = []
    >>> attempt(MPI.COMM_SELF, "There is no mean", lambda: 1 / 0, None, notes)
    >>> notes
    ['There is no mean: a fault of the program (ZeroDivisionError: division by zero).']
    """
    try:
        with failing_together(comm):
            return action()
    except expected:
        raise
    except Exception as error:  # of whatever kind: the answer is not to end with it
        if not _KEPT.issuperset(of_every_rank(comm, explain(error)[0])):
            raise
        reason = of_every_rank(comm, reason_of(error))[0]
        logger.debug("%s", missing, exc_info=error)
        note = f"{missing}: {reason.rstrip('.')}."
        if note not in notes:
            notes.append(note)
        return instead


def reason_of(error: Exception) -> str:
    """Why something failed, in a line.

    Args:
        error: As it was raised.
    """
    error = original(error)  # type: ignore[assignment]
    said = " ".join(str(error).split())
    if isinstance(error, FenicsContactError):
        return said
    return f"a fault of the program ({type(error).__name__}: {said[:_LONGEST]})"


@contextmanager
def silently() -> Iterator[None]:
    """Say nothing of how solvers get on, unless all is told: it is not the answer's.

    That a solve for an error bar took another way would read as if the answer had.
    """
    solvers = logging.getLogger(_SOLVERS)
    before = solvers.level
    if solvers.isEnabledFor(logging.INFO) and not solvers.isEnabledFor(logging.DEBUG):
        solvers.setLevel(logging.WARNING)
    try:
        yield
    finally:
        solvers.setLevel(before)


_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_MESSAGE = "\nfenics-contact: stopping at the last {} that is done; again to kill\n"


class Interrupts:
    """While entered, signals only set a mark on this rank; handlers of before come back.

    Args:
        what: Of what the last that is done is kept.
    """

    entered: ClassVar[list[Interrupts]] = []

    def __init__(self, what: str = "load step") -> None:
        self._message = _MESSAGE.format(what).encode()
        self._requested = False
        self._before: dict[signal.Signals, Any] = {}

    def requested(self) -> bool:
        """Whether this rank was asked to stop."""
        return self._requested

    def __enter__(self) -> Interrupts:
        for number in _SIGNALS:
            self._before[number] = signal.signal(number, self._handle)
        self.entered.append(self)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.entered.remove(self)
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        if self._requested:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
        self._requested = True
        os.write(2, self._message)


def requested() -> bool:
    """Whether this rank was asked to stop, for what is called while it waits for something."""
    return any(found.requested() for found in Interrupts.entered)
