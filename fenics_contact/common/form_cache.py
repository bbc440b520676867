"""Compiled forms, which FEniCSx keeps in a cache that all programs of a user share.

A program that compiles a form first makes an empty file; others that find it wait for the result.
One that is killed meanwhile leaves the file behind, and all would wait in vain. So every program
of ours holds a lock while it compiles, which the system gives back however the program ends: where
nobody holds it, a form that is not done never will be, and is begun anew.
"""

from __future__ import annotations

import fcntl
import logging
import math
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any, TypeVar

import ufl
from dolfinx import fem, jit
from mpi4py import MPI

from fenics_contact.common.parallel import from_root

logger = logging.getLogger(__name__)

T = TypeVar("T")

# How dolfinx begins what it says of a form that could not be had, on rank 0 and on others; and
# FFCx when it has waited in vain, with the file of the form.
COMPILER_SAID = re.compile(
    "(JIT|just-in-time) (compilation|cache load)|compilation failed on root", re.IGNORECASE
)
_NOT_DONE = re.compile(r"JIT compilation timed out.*\(e\.g\. remove (.+\.c)\)", re.DOTALL)
# Seconds without a change after which no program without our lock compiles the form, either.
_QUIET = 10.0
# Seconds between two looks at it.
_PAUSE = 0.2
# Seconds after which another program's compilation is given up.
_LONGEST = 900.0


def form(terms: Any) -> Any:
    """A form in UFL, compiled; collective over the mesh's ranks.

    Args:
        terms: Integrals over one mesh.
    """
    return _compiled(terms, lambda options: fem.form(terms, jit_options=options))


def expression(terms: Any, points: Any) -> fem.Expression:
    """An expression in UFL at points of the reference cell, compiled; collective.

    Args:
        terms: The expression, over one mesh.
        points: Of the reference cell, (points, dimension).
    """
    return _compiled(terms, lambda options: fem.Expression(terms, points, jit_options=options))


def _compiled(terms: Any, build: Callable[[dict[str, Any]], T]) -> T:
    """Build from what the cache has or, where another program is compiling it, will have."""
    is_form = isinstance(terms, ufl.Form)
    domain = terms.ufl_domain() if is_form else ufl.domain.extract_unique_domain(terms)
    comm = domain.ufl_cargo().comm
    end = time.monotonic() + _LONGEST
    waits = False
    while True:
        try:
            with _holding_lock(comm):
                return build({"timeout": 1})
        except (RuntimeError, TimeoutError) as error:
            if COMPILER_SAID.search(str(error)) is None:
                raise
            # Every rank has an error of the compiler, of which rank 0 knows more.
            found = _NOT_DONE.search(str(error)) if time.monotonic() < end else None
            file = from_root(comm, None if found is None else Path(found[1]))
            if file is None:
                raise
        if not waits:
            logger.info("waiting for another program that compiles the same form")
            waits = True
        if comm.rank == 0:
            _wait_for(file, end)


@contextmanager
def _holding_lock(comm: MPI.Comm) -> Iterator[None]:
    """Rank 0, which compiles, says so as long as it does."""
    folder = jit.get_options()["cache_dir"]
    with suppress(OSError):  # compiling says better what is wrong with the folder
        folder.mkdir(parents=True, exist_ok=True)
    with _lock_file(folder) as lock:
        if comm.rank == 0 and lock is not None:
            fcntl.flock(lock, fcntl.LOCK_SH)
        yield


@contextmanager
def _lock_file(folder: Path) -> Iterator[IO[bytes] | None]:
    """The file that is locked while forms are compiled; None where it cannot be had."""
    try:
        lock = (folder / "fenics_contact.lock").open("ab")
    except OSError:
        yield None
        return
    with lock:
        yield lock


def _wait_for(file: Path, end: float) -> None:
    """Until a form is compiled, or nobody compiles it any more.

    Without our lock: programs that only wait would keep each other from finding that out.

    Args:
        file: That says that somebody compiles it.
        end: When to give up, by the monotonic clock.
    """
    done = file.with_suffix(".c.cached")
    while file.exists() and not done.exists() and time.monotonic() < end:
        _forget_if_abandoned(file)
        time.sleep(_PAUSE)


def _forget_if_abandoned(file: Path) -> None:
    """Remove the file of a form that nobody compiles any more, so that it is compiled anew.

    Args:
        file: That says that somebody does.
    """
    with _lock_file(file.parent) as lock:
        try:
            if lock is None or time.time() - _last_change(file) < _QUIET:
                return
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:  # somebody compiles, has just finished, or the system has no locks
            return
        if not file.with_suffix(".c.cached").exists():
            logger.info("a form that a killed program left half compiled is compiled anew")
            file.unlink(missing_ok=True)


def _last_change(file: Path) -> float:
    """When anything of the form's files changed last (seconds)."""
    parts = file.parent.glob(f"{file.stem}.*")
    return max((part.stat().st_mtime for part in parts), default=math.inf)
