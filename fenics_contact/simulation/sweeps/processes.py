"""The processes of a sweep: as the one that leads it sees them, and what each of them does.

Each is a program of its own, on one rank, which solves the points it is given. It is started with
the number of a socket as its argument, never sees the MPI of the process that started it, and ends
when the socket is closed, be it that the other one was killed.
"""

from __future__ import annotations

import os
import pickle
import signal
import struct
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterable, Mapping
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe, wait
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import fenics_contact
from fenics_contact.common.parallel import environment_alone
from fenics_contact.contact.laws.allowed import allow_laws, allowed_modules
from fenics_contact.scene.scene import Scene

#: What messages of a process begin with: of memory, and of a point that is done.
_NEEDS, _FOUND = b"n", b"f"
_GONE = 130
_THIS = "fenics_contact.simulation.sweeps.processes"
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
                [sys.executable, "-P", "-m", _THIS, *given],
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
        return said[1:] if said[:1] == _FOUND else float(struct.unpack("d", said[1:])[0])

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


def main() -> None:
    """Solve points until there are no more."""
    connection = Connection(int(sys.argv[1]))
    given: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_listen, args=(connection, given), daemon=True).start()

    from fenics_contact.simulation.sweeps.answers import Answers

    for module in sys.argv[3:]:
        allow_laws(module)

    def need(memory: float) -> None:
        connection.send_bytes(_NEEDS + struct.pack("d", memory))

    answers = Answers(Path(sys.argv[2]), need)
    while True:
        scene, digest = pickle.loads(given.get())
        _, packed = answers.answer(scene, digest)
        connection.send_bytes(_FOUND + packed)


def _listen(connection: Connection, given: SimpleQueue[Any]) -> None:
    """Take what comes, also while a point is solved, and end the process with the connection."""
    try:
        while True:
            given.put(connection.recv_bytes())
    except (EOFError, OSError):
        os._exit(_GONE)


if __name__ == "__main__":
    main()
