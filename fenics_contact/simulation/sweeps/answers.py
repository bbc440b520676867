"""What a process of a sweep does: it solves points, and keeps mesh and body between them."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from mpi4py import MPI

from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import BUG, explain
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.adaptive.levels import AdaptiveRun
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.study import Study, mesh_key
from fenics_contact.simulation.sweeps.journal import Done
from fenics_contact.simulation.sweeps.rows import row_of, states_of
from fenics_contact.simulation.sweeps.shared_meshes import SharedMeshes
from fenics_contact.solve.load_steps.accepted_step import Unknowns

_GROWTH = 8  # of memory, from the first mesh on the way to an accuracy to the last, roughly


class Answers:
    """Solves points one after the other, on one rank.

    Args:
        folder: For meshes, which all processes of the sweep have together.
        needs: Called with the memory that a point is expected to take, before it is solved (bytes).
    """

    def __init__(self, folder: Path, needs: Callable[[float], None]) -> None:
        self._meshes, self._needs = SharedMeshes(folder), needs
        self._study: Study | None = None
        self._mesh = ""
        self._other_factorisations = 0  # of studies that are gone, and without one

    def answer(self, scene: Scene, digest: str) -> tuple[Done, bytes]:
        """Solve a point; that it fails is an answer, too.

        Args:
            scene: The point's.
            digest: Of the point.

        Returns:
            What became of it, and the same packed for the journal.
        """
        before, states = self._factorisations, {}
        with _warnings() as heard:
            try:
                result = self._solve(scene)
                done = _done(digest, result)
                states = states_of(result.points) if done.row else {}
            except Exception as error:  # of whatever kind: the other points are not to end with it
                done = self._failed(digest, error, heard)
        made = self._factorisations - before
        done = dataclasses.replace(done, factorisations=made, warnings=tuple(heard))
        return done, done.packed(states)

    def _solve(self, scene: Scene) -> Result:
        """As a run of the scene does.

        Raises:
            InputError: The scene or its mesh cannot be used, or has no equilibrium.
            MachineError: The machine failed.
        """
        if scene.accuracy is not None:
            self.close()
            return self._solve_levels(scene)
        mesh = repr(mesh_key(scene))
        if self._study is None or mesh != self._mesh:
            self.close()
            self._study = Study(scene, MPI.COMM_SELF, self._meshes.body(scene, mesh))
            self._mesh = mesh
        run = self._study.prepare(scene)
        self._needs(run.choice.memory)
        result = run.solve()
        if result.model.solver != "condensed":  # what the study has not made
            self._other_factorisations += result.model.bulk_factorisations or 0
        return result

    def _solve_levels(self, scene: Scene) -> Result:
        """Mesh after mesh, each with a body of its own."""

        def solve_level(run: Run, guess: Unknowns | None) -> Result:
            result = run.solve(guess=guess)
            self._other_factorisations += result.model.bulk_factorisations or 0
            return result

        first = Run(scene, MPI.COMM_SELF)
        self._needs(_GROWTH * first.choice.memory)
        return AdaptiveRun(first).solve(solve_level)

    def _failed(self, digest: str, error: Exception, heard: list[str]) -> Done:
        code, said = explain(error)
        if code == BUG:
            heard.append(said)
            said = said.splitlines()[-1]
        if code != InputError.exit_code:  # what is kept may be broken
            self.close()
        return Done(digest, code, said)

    @property
    def _factorisations(self) -> int:
        """How many were made by this process."""
        kept = 0 if self._study is None else self._study.factorisations
        return kept + self._other_factorisations

    def close(self) -> None:
        """Free what is kept."""
        if self._study is not None:
            self._other_factorisations = self._factorisations
            self._study.close()
            self._study = None


def _done(digest: str, result: Result) -> Done:
    """An answer, or a run that did not converge."""
    return Done(
        digest,
        result.exit_code,
        result.verdict,
        row=row_of(result) if result.converged else {},
        units=None if result.units is None else result.units.as_dict(),
    )


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """What is said meanwhile that everyone is to read."""
    heard: list[str] = []

    class Listener(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            heard.append(record.getMessage())

    logger, listener = logging.getLogger("fenics_contact"), Listener(logging.WARNING)
    logger.addHandler(listener)
    try:
        yield heard
    finally:
        logger.removeHandler(listener)
