"""A scene under all combinations of values of its keys, from the settings to the files."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from fenics_contact.common.errors import InputError, MachineError, NotConvergedError, StoppedError
from fenics_contact.scene.reading import SceneFile
from fenics_contact.simulation.sweeps.journal import (
    Done,
    Journal,
    write_states,
    write_summary,
    write_table,
)
from fenics_contact.simulation.sweeps.leader import Announce, Leader
from fenics_contact.simulation.sweeps.points import Grid, groups_of, points_of

_NO_ANSWER = NotConvergedError.exit_code
_CHECK_FAILED = 4


class Sweep:
    """A sweep, ready to be solved; nothing is computed or written before.

    Attributes:
        grid: What is varied.
        points: Of the grid.
        done: What became of the points so far, by their numbers.

    Args:
        file: Of the scene.
        overrides: Settings of all points, ``table.key=value``.
        vary: What is varied, each ``KEY=VALUES``.
        folder: For its files.
        resume: Whether to take what an earlier sweep in the folder has done.

    Raises:
        InputError: A setting is wrong, or no point has a scene; or what is to be resumed is another
            sweep, or still being solved.
    """

    def __init__(
        self,
        file: SceneFile,
        overrides: Sequence[str],
        vary: Sequence[str],
        folder: Path,
        resume: bool = False,
    ) -> None:
        self._begun = time.monotonic()
        self._file, self._folder = file, folder
        self.grid = Grid(vary, overrides)
        self.points = points_of(file, overrides, self.grid)
        self._journal = Journal(folder)
        self.done: dict[int, Done] = {
            point.number: Done(point.digest, InputError.exit_code, point.refused)
            for point in self.points
            if point.scene is None
        }
        if resume:
            known = {point.digest: point.number for point in self.points if point.scene is not None}
            self.done |= self._journal.resume(known)
        left = {point.number for point in self.points} - set(self.done)
        self.groups = groups_of(self.points, self.grid, left)

    @property
    def left(self) -> int:
        """How many points are to be solved."""
        return len(self.points) - len(self.done)

    @property
    def has_files(self) -> bool:
        """Whether there is something of it in its folder."""
        return self._journal.is_there

    def solve(self, jobs: int | None, announce: Announce, stopped: Callable[[], bool]) -> None:
        """Solve the points that are left, and write the files; of those that are done if stopped.

        Args:
            jobs: The most processes; None: one a core, if memory has room for them.
            announce: Called with number and outcome of every point that is done.
            stopped: Whether the user asked to stop.

        Raises:
            InputError: No point can be solved; as a run of the first would say. Or another sweep is
                being solved in the folder. Nothing is written.
            StoppedError: The user asked to stop.
            MachineError: The machine failed.
        """

        def note(number: int, done: Done) -> None:
            self.done[number] = done
            announce(number, done)

        self._journal.lock.take()
        try:
            Leader(self.points, self._journal, note, stopped).solve(self.groups, jobs)
        finally:
            if self.has_files:
                self._write()
            self._journal.lock.give_up()
        if not self.has_files:
            raise InputError(self.done[min(self.done)].said)

    @property
    def exit_code(self) -> int:
        """0 if that of all points is; else the first of 1, 5, 130, 3 and 4 that stands for one.

        Points that are refused have no answer, as those that do not converge: 3.
        """
        codes = {done.exit_code for done in self.done.values()}
        if self.left:
            codes.add(StoppedError.exit_code)
        if InputError.exit_code in codes:
            codes.add(_NO_ANSWER)
        concerns = (1, MachineError.exit_code, StoppedError.exit_code, _NO_ANSWER, _CHECK_FAILED)
        return next((code for code in concerns if code in codes), 0)

    @property
    def factorisations(self) -> int:
        """How many were made of bodies, by all processes."""
        return sum(done.factorisations for done in self.done.values())

    def _write(self) -> None:
        """The files, of what is done."""
        nothing = Done("", StoppedError.exit_code, "interrupted")
        every = [self.done.get(point.number, nothing) for point in self.points]
        rows = zip(self.grid.values(), every, strict=True)
        keys = [axis.key for axis in self.grid.axes]
        write_table(self._folder, keys, [(v, d.exit_code, dict(d.row)) for v, d in rows])
        numbers = {point.digest: point.number for point in self.points}
        states = ((numbers[done.digest], found) for done, found in self._journal.states())
        write_states(self._folder, states)
        write_summary(self._folder, self._summary(every))

    def _summary(self, every: Sequence[Done]) -> dict[str, Any]:
        first = next(point.scene for point in self.points if point.scene is not None)
        units = _united([done.units for done in every if done.units is not None])
        return {
            "title": first.title,
            "kinematics": first.kinematics,
            "scene": str(self._file.path),
            "vary": {axis.key: list(axis.values) for axis in self.grid.axes},
            "contacts": [contact.label for contact in first.contact],
            **({} if units is None else {"units": units}),
            "rows": len(every),
            "answered": sum(bool(done.row) for done in every),
            "bulk_factorisations": self.factorisations,
            "seconds": time.monotonic() - self._begun,
            "failures": {
                str(row): done.said for row, done in enumerate(every) if done.exit_code != 0
            },
        }


def _united(units: Sequence[Any]) -> dict[str, Any] | None:
    """Return the units of all answers, some of which may lack quantities of others."""
    if not units:
        return None
    quantities = {name: unit for one in units for name, unit in one["quantities"].items()}
    return dict(units[0]) | {"quantities": quantities}
