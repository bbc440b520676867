"""The processes of a sweep, seen from the one that leads it."""

from __future__ import annotations

import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path

import fenics_contact
from fenics_contact.common.parallel import environment_alone
from fenics_contact.contact.laws.allowed import allowed_modules
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sweeps import worker
from fenics_contact.simulation.sweeps.worker import FOUND

_WORKER = worker.__name__
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_LAST_WORDS = 2000  # bytes of what a process said last
_PATIENCE = 5.0  # seconds that a process may take to end


class DiedError(Exception):
    """A process has ended, in the midst of a point or before."""


class WorkerProcess:
    """A process that solves points one after the other, on one rank and one thread.

    It is a group of its own, which Ctrl-C in a terminal does not reach.

    Args:
        folder: Where it and the others keep what they need together; what it leaves in case it
            is killed is there, too.

    Raises:
        OSError: It cannot be started.
    """

    def __init__(self, folder: Path) -> None:
        self._said = tempfile.TemporaryFile(dir=folder)  # noqa: SIM115 - closed with the process
        ours, theirs = Pipe()
        package = str(Path(fenics_contact.__file__).parent.parent)
        environment = environment_alone() | dict.fromkeys(_ONE_THREAD, "1")
        given = [str(theirs.fileno()), str(folder), *allowed_modules()]
        paths = [package, *filter(None, [environment.get("PYTHONPATH")])]
        environment |= {"PYTHONPATH": os.pathsep.join(paths), "TMPDIR": str(folder)}
        try:
            self._process = subprocess.Popen(
                # -P: files where it is started must not stand in for modules
                [sys.executable, "-P", "-m", _WORKER, *given],
                stdin=subprocess.DEVNULL,
                stdout=self._said,
                stderr=self._said,
                env=environment,
                pass_fds=(theirs.fileno(),),
                start_new_session=True,
            )
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        self.connection: Connection = ours

    def give(self, scene: Scene, digest: str) -> None:
        """Have it solve a point.

        Args:
            scene: The point's.
            digest: Of the point.

        Raises:
            DiedError: It has ended.
        """
        try:
            self.connection.send_bytes(pickle.dumps((scene, digest)))
        except OSError:
            raise DiedError(self._death()) from None

    def hear(self) -> bytes | float:
        """Return its answer, packed for the journal; or before, the memory that it needs (bytes).

        Raises:
            DiedError: It has ended.
        """
        try:
            said = self.connection.recv_bytes()
        except (EOFError, OSError):
            raise DiedError(self._death()) from None
        return said[1:] if said[:1] == FOUND else float(struct.unpack("d", said[1:])[0])

    def close(self) -> None:
        """End it, and all that it has started."""
        self.connection.close()
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._said.close()

    def _death(self) -> str:
        """How it ended, in words."""
        try:
            code = self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            return "it closed its connection"
        self._said.seek(max(self._said.seek(0, os.SEEK_END) - _LAST_WORDS, 0))
        lines = self._said.read().decode("utf-8", "replace").strip().splitlines()
        last = f": {lines[-1]}" if lines else ""
        if code == -signal.SIGKILL:
            return "it was killed, most likely for want of memory"
        if code < 0:
            return f"it crashed ({signal.Signals(-code).name}){last}"
        return f"it ended with exit code {code}{last}"


def ready(processes: Mapping[int, WorkerProcess], seconds: float) -> Iterable[int]:
    """Numbers of the processes that have something to say, or have ended.

    Args:
        processes: By their numbers.
        seconds: How long to wait for the first.
    """
    numbers = {id(process.connection): number for number, process in processes.items()}
    found = wait([process.connection for process in processes.values()], seconds)
    return [numbers[id(connection)] for connection in found]
