"""Work of a process of a sweep: it solves points, and keeps mesh and body between them."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import BUG, explain
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.adaptive.fine_enough import first_run
from fenics_contact.simulation.adaptive.levels import AdaptiveRun
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.body_of_study import mesh_key
from fenics_contact.simulation.studies.quick_answers import Answer
from fenics_contact.simulation.studies.study import Study
from fenics_contact.simulation.sweeps.journal import Done
from fenics_contact.simulation.sweeps.rows import row_of, row_of_quick, states_of
from fenics_contact.simulation.sweeps.shared_meshes import SharedMeshes
from fenics_contact.simulation.sweeps.shortcut import Shortcut
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
        self._shortcut = Shortcut()
        self._other_factorisations = 0  # of studies that are gone, and without one

    def answer(self, scene: Scene, digest: str) -> tuple[Done, bytes]:
        """Solve a point; that it fails is an answer, too.

        Args:
            scene: The point's.
            digest: Of the point.

        Returns:
            What became of it, and the same packed for the journal.
        """
        before = self._factorisations
        states: dict[str, Any] = {}
        with _warnings() as heard:
            try:
                done, states = self._solve(scene, digest)
            except Exception as error:  # of whatever kind: the other points are not to end with it
                done = self._failed(digest, error, heard)
        made = self._factorisations - before
        done = dataclasses.replace(done, factorisations=made, warnings=tuple(heard))
        return done, done.packed(states)

    def _solve(self, scene: Scene, digest: str) -> tuple[Done, dict[str, Any]]:
        """Solve a point as a run of its scene does.

        Raises:
            InputError: The scene or its mesh cannot be used, or has no equilibrium.
            MachineError: The machine failed.
        """
        if scene.accuracy is not None:
            self.close()
            return _done(digest, self._solve_levels(scene))
        mesh = repr(mesh_key(scene))
        if scene.motion is not None:  # a study keeps the stiffness of a body at rest
            self.close()
            return _done(digest, Run(scene, MPI.COMM_SELF, self._meshes.body(scene, mesh)).solve())
        if self._study is None or mesh != self._mesh:
            self.close()
            self._study = Study(scene, MPI.COMM_SELF, self._meshes.body(scene, mesh))
            self._mesh = mesh
        quick = self._quickly(scene, self._study)
        if quick is not None:
            names = [contact.label for contact in scene.contact]
            row = row_of_quick(quick, names)
            return Done(digest, 0, quick.verdict, row=row), states_of(quick.points)
        run = self._study.prepare(scene)
        self._needs(run.choice.memory)
        result = run.solve()
        self._shortcut.learn(scene, result)
        if result.model.solver != "condensed":  # what the study has not made
            self._other_factorisations += result.model.bulk_factorisations or 0
        return _done(digest, result)

    def _quickly(self, scene: Scene, study: Study) -> Answer | None:
        """An answer from the contacts alone, where it says what a run would."""
        if not self._shortcut.is_open(scene):
            return None
        answer = study.quantities(scene)
        return answer if self._shortcut.trusts(answer) else None

    def _solve_levels(self, scene: Scene) -> Result:
        """Mesh after mesh, each with a body of its own."""

        def solve_level(run: Run, guess: Unknowns | None) -> Result:
            result = run.solve(guess=guess)
            self._other_factorisations += result.model.bulk_factorisations or 0
            return result

        first = first_run(scene, MPI.COMM_SELF)
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


def _done(digest: str, result: Result) -> tuple[Done, dict[str, Any]]:
    """An answer and its contact states, or a run that did not converge."""
    done = Done(
        digest,
        result.exit_code,
        result.verdict,
        row=row_of(result) if result.converged else {},
        units=None if result.units is None else result.units.as_dict(),
    )
    return done, states_of(result.points) if result.converged else {}


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """Collect the warnings that are logged meanwhile."""
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
