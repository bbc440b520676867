"""Workers that solve scenes at random: started, watched, replaced. Nothing of MPI in here."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

WORKER = Path(__file__).with_name("random_worker.py")
CRASHED, HUNG = -1, -2
# A worker ends itself in time; if it cannot, it is ended so many seconds later.
_GRACE = 30.0
_POLL = 0.2


@dataclass
class Job:
    """Scenes for one worker.

    Attributes:
        ranks: Of the worker.
        numbers: Of the scenes.
        stages: Of each scene.
        done: Pairs of number and stage that are left out.
    """

    ranks: int
    numbers: list[int]
    stages: tuple[str, ...]
    done: set[tuple[int, str]]


@dataclass
class Worker:
    """A process at work.

    Attributes:
        job: What it solves.
        process: That of Python, or of ``mpirun``.
        now: File with number and stage of what is under way.
        log: File of what it prints.
        ended: Whether it was ended because it hung.
    """

    job: Job
    process: subprocess.Popen
    now: Path
    log: Path
    ended: bool = False

    def under_way(self) -> tuple[int, str] | None:
        """Number and stage of the solve that was begun last."""
        if not self.now.exists():
            return None
        number, stage = json.loads(self.now.read_text(encoding="utf-8"))
        return number, stage


@dataclass
class Pool:
    """Solves jobs, some at once.

    Attributes:
        rows: File that workers add lines to.
        folder: For files of the workers.
        seed: Of all scenes.
        kinds: Of scenes, all where there are none.
        seconds: After which a solve hangs.
        slots: Processes at once.
        tell: Called with each new row.
        errors: Those that are estimated, as ``solver.errors`` of a scene.
    """

    rows: Path
    folder: Path
    seed: int
    kinds: tuple[str, ...]
    seconds: float
    slots: int
    tell: Callable[[dict[str, Any]], None]
    errors: str = "all"
    _workers: list[Worker] = field(default_factory=list)
    _started: int = 0
    _read: int = 0

    def run(self, jobs: list[Job]) -> None:
        """All of them; whatever ends this ends the workers.

        Raises:
            RuntimeError: A worker ended before its first scene.
        """
        waiting, self._read = list(jobs), self.rows.stat().st_size
        try:
            while waiting or self._workers:
                while waiting and self._fits(waiting[0]):
                    self._workers.append(self._start(waiting.pop(0)))
                time.sleep(_POLL)
                for worker in list(self._workers):
                    self._end_if_hung(worker)
                    if worker.process.poll() is not None:
                        self._workers.remove(worker)
                        waiting = self._left_by(worker) + waiting
                self._tell_new()
        finally:
            for worker in self._workers:
                _end(worker.process)
            self._workers.clear()

    def _fits(self, job: Job) -> bool:
        """Whether there is room; a job of more ranks than there is room for goes alone."""
        busy = sum(worker.job.ranks for worker in self._workers)
        return not self._workers or busy + job.ranks <= self.slots

    def _start(self, job: Job) -> Worker:
        self._started += 1
        name = self.folder / f"worker{self._started}"
        now, log = name.with_suffix(".now"), name.with_suffix(".log")
        content = {
            "seed": self.seed,
            "kinds": self.kinds,
            "errors": self.errors,
            "numbers": job.numbers,
            "stages": job.stages,
            "done": sorted(job.done),
            "rows": str(self.rows),
            "now": str(now),
            "seconds": self.seconds,
        }
        name.with_suffix(".json").write_text(json.dumps(content), encoding="utf-8")
        command = [sys.executable, str(WORKER), str(name.with_suffix(".json"))]
        if job.ranks > 1:
            command = [_mpirun(), "-n", str(job.ranks), *command]
        with log.open("wb") as file:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=file,
                start_new_session=True,
            )
        return Worker(job, process, now, log)

    def _end_if_hung(self, worker: Worker) -> None:
        if worker.now.exists() and worker.process.poll() is None:
            worker.ended = time.time() - worker.now.stat().st_mtime > self.seconds + _GRACE
            if worker.ended:
                _end(worker.process)

    def _left_by(self, worker: Worker) -> list[Job]:
        """What a worker that ended too early did not do; what it was at is told."""
        if worker.process.returncode == 0:
            return []
        printed = worker.log.read_text(encoding="utf-8", errors="replace")
        words = printed[-3000:]
        at = worker.under_way()
        if at is None:
            raise RuntimeError(f"a worker ended before its first scene:\n{words}")
        hung = worker.ended or "Timeout (" in printed
        row = {
            "number": at[0],
            "ranks": worker.job.ranks,
            "stage": at[1],
            "kind": "",
            "code": HUNG if hung else CRASHED,
            "seconds": self.seconds if hung else 0.0,
            "words": words,
        }
        with self.rows.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        job = worker.job
        left = job.numbers[job.numbers.index(at[0]) :]
        if at[1] == "coarse":
            left = left[1:]
        before = set(job.stages[: job.stages.index(at[1]) + 1])
        done = job.done | {(at[0], stage) for stage in before}
        return [Job(job.ranks, left, job.stages, done)] if left else []

    def _tell_new(self) -> None:
        """Of lines that have come since."""
        with self.rows.open("rb") as file:
            file.seek(self._read)
            text = file.read()
        whole = text[: text.rfind(b"\n") + 1]
        self._read += len(whole)
        for line in whole.splitlines():
            self.tell(json.loads(line))


def _mpirun() -> str:
    """That of this Python's MPI."""
    beside = Path(sys.executable).with_name("mpirun")
    return str(beside) if beside.exists() else shutil.which("mpirun") or "mpirun"


def _end(process: subprocess.Popen) -> None:
    """With its ranks, which ``mpirun`` ends if it is asked to."""
    for how in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, how)
            process.wait(5)
            return
        except subprocess.TimeoutExpired:
            continue
        except ProcessLookupError:
            return
