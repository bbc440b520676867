"""The process of Gmsh, or of a reader, seen from outside: its limits, what it says, how it ends.

A script can run for ever, and a size of cells can ask for more than any machine has. Nothing of
it outlives this call: the process and all that it started are killed at the limit, when the run is
interrupted, and (by ``gmsh_process`` itself) when the run is killed.
"""

from __future__ import annotations

import contextlib
import io
import json
import logging
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib import util
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common.errors import InputError, StoppedError
from fenics_contact.common.failures import requested as stop_requested
from fenics_contact.common.memory import free_memory
from fenics_contact.mesh.geometry.file_kinds import Prepared

logger = logging.getLogger(__name__)

Answer = tuple[dict[str, Any], dict[str, NDArray[Any]]]

_PROGRAM, _READER = "gmsh_process.py", "reader_process.py"
# What it imports, where there is such a package.
_IMPORTED = ("gmsh", "numpy", "meshio", "h5py", "rich", "fenics_contact")
_PAUSE = 0.25  # seconds between two looks at an interrupt
_TICK = 0.01  # seconds between two looks at a process that is ending
_FIRST_WORD = 10.0  # seconds until progress is told where no terminal shows it; then twice that, …
_SHOWN = 80  # characters of what Gmsh said last
_KEPT = 4096  # bytes of what Gmsh said last
# Words of Gmsh, C++ and Python when there is no memory left; Gmsh may then also say nothing at all.
_NO_MEMORY = ("bad_alloc", "MemoryError", "out of memory", "Cannot allocate", "Unable to allocate")
# The process may start no other, and threads count as such.
_ONE_THREAD = {"OMP_NUM_THREADS": "1"}
_LIBRARIES = 2**29  # bytes of address space that Gmsh's libraries take, and are no memory


@dataclass(frozen=True)
class Limits:
    """Limits of time and memory of Gmsh.

    Attributes:
        key: Of the scene's mesh, for messages: ``mesh``, or ``mesh[1]``.
        seconds: For this call.
        memory: Bytes, apart from what is free; 0 for no other limit.
        is_reader: Whether they are those of the reader of another program's mesh.
        is_fixed: Whether a scene cannot give more time.
    """

    key: str
    seconds: float
    memory: float = 0.0
    is_reader: bool = False
    is_fixed: bool = False

    @property
    def time(self) -> str:
        """The limit of time in messages, with its key where a scene can change it."""
        return f"{'' if self.is_fixed else f'{self.key}.time_limit = '}{self.seconds:g} s"

    @property
    def remedy(self) -> str:
        """Advice on what to do where the time is over."""
        if self.is_fixed:
            return "simplify the surface, or save it as .stl"
        return "make the mesh coarser, or give more time"

    @property
    def who(self) -> str:
        """Name of the process in messages."""
        return "the reader" if self.is_reader else "Gmsh"


def call(ready: Prepared, job: Mapping[str, Any], sizes: bytes, limits: Limits) -> Answer:
    """Run ``gmsh_process`` on a job: the model's description and the mesh's arrays.

    Args:
        ready: The file.
        job: As ``gmsh_process`` takes it, with ``folder``, where it runs.
        sizes: For its standard input.
        limits: Of time and memory.

    Raises:
        InputError: Gmsh refuses the file, crashes on it, or meets a limit.
        StoppedError: The run was interrupted.
        MemoryError: The system killed Gmsh.
    """
    where = f"{limits.key}.file = '{job['name']}'"
    most = free_memory() + _LIBRARIES
    memory = min(limits.memory or most, most)
    full_job = dict(job) | {"memory": int(memory) if np.isfinite(memory) else 0}
    # -P: the modules of this package must not stand in for those that Gmsh's imports want.
    # -S: where packages are is known here already; to find out takes as long as a small mesh.
    program = str(Path(__file__).with_name(_READER if limits.is_reader else _PROGRAM))
    command = [sys.executable, "-P", "-B", "-S", program, json.dumps(full_job)]
    with tempfile.TemporaryFile() as file:  # unlike a pipe, it may be left unread
        file.write(sizes)
        file.seek(0)
        with _running(command, file.fileno(), job["folder"]) as process:
            watch = _Watch(where, process, limits, ready)
            watch.attend()
    return _answer(where, process.returncode, watch, memory, ready, limits.who)


@contextlib.contextmanager
def _running(command: list[str], standard_input: int, folder: str) -> Iterator[Any]:
    """A process of which nothing is left at the end, be it interrupted.

    It and what it starts are a group of their own, which Ctrl-C in a terminal does not reach. It
    holds the end of a pipe, and ends when the other end, which is held here, is closed.
    """
    theirs, ours = os.pipe()
    try:
        process = subprocess.Popen(
            [*command, str(theirs)],
            stdin=standard_input,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=folder,
            env=os.environ | _ONE_THREAD | {"PYTHONPATH": os.pathsep.join(_packages())},
            pass_fds=(theirs,),
            start_new_session=True,
        )
    except BaseException:
        os.close(ours)
        raise
    finally:
        os.close(theirs)
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        os.close(ours)
        process.wait()
        for stream in (process.stdout, process.stderr):
            assert stream is not None
            stream.close()


def _packages() -> list[str]:
    """The folders of what Gmsh's process imports, and those that the user has named."""
    found = [util.find_spec(name) for name in _IMPORTED]
    places = [Path(spec.origin) for spec in found if spec is not None and spec.origin is not None]
    folders = [str(p.parent.parent if p.name == "__init__.py" else p.parent) for p in places]
    return [*dict.fromkeys(folders), *filter(None, [os.environ.get("PYTHONPATH")])]


class _Watch:
    """Waits for a process, and tells how far it is.

    Attributes:
        output: What it wrote to its standard output.
        said: The last of what it said.

    Args:
        where: What begins each message.
        process: With pipes for its output and what it says.
        limits: Of its time.
        ready: Its files, and what the user calls them.
    """

    def __init__(
        self, where: str, process: subprocess.Popen[bytes], limits: Limits, ready: Prepared
    ) -> None:
        self._where, self._process, self._limits, self._ready = where, process, limits, ready
        self._began = time.monotonic()
        self._next_word = _FIRST_WORD
        self._told = ""
        self._pieces: list[bytes] = []
        self._last = b""

    @property
    def output(self) -> bytes:
        return b"".join(self._pieces)

    @property
    def said(self) -> str:
        return self._last.decode("utf-8", "replace")

    def attend(self) -> None:
        """Until the process ends.

        Raises:
            InputError: Its time is over.
            StoppedError: The run was interrupted.
        """
        output, said = self._process.stdout, self._process.stderr
        assert output is not None and said is not None
        with selectors.DefaultSelector() as streams:
            streams.register(output, selectors.EVENT_READ)
            streams.register(said, selectors.EVENT_READ)
            while streams.get_map():
                for key, _ in streams.select(_PAUSE):
                    piece = os.read(key.fd, 2**20)
                    if not piece:
                        streams.unregister(key.fileobj)
                    elif key.fileobj is output:
                        self._pieces.append(piece)
                    else:
                        self._last = (self._last + piece)[-_KEPT:]
                self._look()
        # Not reaped yet: its number must stay its own until its group is killed.
        how = os.WEXITED | os.WNOWAIT | os.WNOHANG
        while os.waitid(os.P_PID, self._process.pid, how) is None:
            self._look()
            time.sleep(_TICK)

    def _look(self) -> None:
        seconds = time.monotonic() - self._began
        if stop_requested():
            raise StoppedError("interrupted")
        if seconds > self._limits.seconds:
            raise InputError(
                f"{self._where}: {self._limits.who} is not done after {self._limits.time}"
                f"{self._doing(', at: ')}; {self._limits.remedy}"
            )
        doing = self._doing("Gmsh: ")
        if doing != self._told:
            logger.debug("%s", doing)
            self._told = doing
        if seconds > self._next_word:
            logger.info(
                "%s: %s works for %.0f s of %s%s",
                *(self._where, self._limits.who, seconds, self._limits.time),
                self._doing(", at: "),
            )
            self._next_word *= 2

    def _doing(self, before: str) -> str:
        """Return the last line of Gmsh's output."""
        lines = [" ".join(line.split()) for line in self.said.splitlines()]
        last = next((line for line in reversed(lines) if line), "").removeprefix("Info : ")
        last = self._ready.translated(last)
        shown = "".join(character for character in last if character.isprintable())
        return f"{before}{shown[:_SHOWN]}" if shown else ""


def _answer(
    where: str, code: int, watch: _Watch, memory: float, ready: Prepared, who: str
) -> Answer:
    """What a process that has ended gave; or what it died of, in a sentence."""
    if code == -signal.SIGKILL:
        raise MemoryError(f"{where}: {who} was killed, most likely for want of memory")
    output = watch.output
    if code != 0 or not output:
        raise InputError(f"{where}: {ready.translated(_death(who, code, watch.said, memory))}")
    with np.load(io.BytesIO(output), allow_pickle=False) as data:
        arrays = dict(data)
    description = json.loads(str(arrays.pop("description")))
    if "refused" in description:
        raise InputError(description["refused"])
    if "failed" in description:
        said, error = description["failed"], description["error"]
        if _is_of_memory(said) or error in _NO_MEMORY or not (said or who != "Gmsh"):
            raise InputError(f"{where}: {_death(who, 1, _NO_MEMORY[0], memory)}")
        if who == "Gmsh":
            raise InputError(f"{where}: Gmsh says: {ready.translated(said)}")
        raise InputError(f"{where}: cannot be read ({error}: {said}); is the file damaged?")
    return description, arrays


def _is_of_memory(said: str) -> bool:
    return any(words in said for words in _NO_MEMORY)


def _death(who: str, code: int, said: str, memory: float) -> str:
    """How a process ended that gave no mesh."""
    if _is_of_memory(said):
        return (
            f"{who} most likely needs more than the {memory / 1e9:.1f} GB of memory that it may "
            "take; make the mesh coarser, or is the file damaged?"
        )
    if code < 0:
        return f"{who} crashed on it ({signal.Signals(-code).name}); is the file damaged?"
    last = said.strip().splitlines()[-1:]
    return f"{who} gave no mesh ({' '.join(last) or 'it ended early'}); is the file damaged?"
