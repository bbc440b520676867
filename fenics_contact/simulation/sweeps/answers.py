"""Work of a process of a sweep: it solves points, and keeps mesh and body between them."""

from __future__ import annotations

import dataclasses
import fcntl
import hashlib
import logging
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.analyses import registry
from fenics_contact.common.atomic_files import replace_file
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import BUG, explain
from fenics_contact.mesh.from_gmsh import MeshArrays
from fenics_contact.mesh.loading import load_arrays, load_body, require_units
from fenics_contact.mesh.tagged_mesh import Body
from fenics_contact.quantities.names import STRAIN_ENERGY
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.simulation.adaptive.levels import AdaptiveRun
from fenics_contact.simulation.adaptive.next_mesh import first_run
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.kept_body import mesh_key
from fenics_contact.simulation.studies.quick_answers import Answer
from fenics_contact.simulation.studies.study import Study
from fenics_contact.simulation.sweeps.journal import Done
from fenics_contact.simulation.sweeps.rows import row_of, row_of_quick, states_of
from fenics_contact.solve.load_steps.accepted_step import Unknowns


class SharedMeshes:
    """Meshes in a folder that only the processes of a sweep read and write.

    Args:
        folder: The folder, which its processes have for themselves.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def body(self, scene: Scene, key: str) -> Body:
        """The mesh that a scene names, on this process.

        The first process that needs it makes it, while the others wait. If it dies, the lock is
        free again, and the next one makes it.

        Args:
            scene: The scene.
            key: What its mesh follows from.

        Raises:
            InputError: It cannot be used, which the next process need not find out again.
        """
        file = self._folder / hashlib.sha256(key.encode()).hexdigest()
        with file.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not file.exists():
                replace_file(file, pickle.dumps(_made(scene)))
        found = pickle.loads(file.read_bytes())
        if isinstance(found, InputError):
            raise found
        comm = MPI.COMM_SELF
        return load_body(scene.mesh, scene.dimension, comm, preloads=scene.preload, arrays=found)


def _made(scene: Scene) -> MeshArrays | InputError:
    """The mesh, or why it cannot be used."""
    if not scene.mesh:
        return InputError("mesh: the scene names no mesh")
    try:
        require_units(scene, MPI.COMM_SELF)
        return load_arrays(scene.mesh, scene.dimension, scene.preload)
    except InputError as error:
        return error


# Every so many is a whole run, so that fields are looked at now and then.
_WHOLE_EVERY = 50
# The check that takes fields asks whether anything is turned inside out or pushed through, which
# needs strains or rotations of this size at least. They follow the root of the strain energy; from
# the last whole run on they may grow by a margin more.
_LARGE, _MARGIN = 0.3, 3.0
# Of a history's largest strain energy, which its last step must have: that step alone is compared.
_AT_THE_END = 0.5


class Shortcut:
    """Judges by the last whole run whether quick answers suffice for points after it."""

    def __init__(self) -> None:
        self._settings: SolverSettings | None = None
        self._since = 0
        self._largest, self._energy = 0.0, 0.0  # strain or rotation, and strain energy

    def learn(self, scene: Scene, result: Result) -> None:
        """Take a whole run into account.

        Args:
            scene: That was solved.
            result: What came out.
        """
        self._settings, self._since = None, 0
        if (
            registry.takes_steps_of(scene) is not None
            or scene.solver.errors != "none"
            or result.model.solver != "condensed"
        ):
            return
        if not result.converged:
            return
        energies = [step.quantities[STRAIN_ENERGY] for step in result.steps]
        if energies[-1] < _AT_THE_END * max(energies):
            return
        self._settings, self._energy = scene.solver, energies[-1]
        self._largest = max(
            step["linear_range"][name].value
            for step in result.steps
            for name in ("strain", "rotation")
        )

    def is_open(self, scene: Scene) -> bool:
        """Whether a quick answer may do for a scene."""
        self._since += 1
        return scene.solver == self._settings and self._since < _WHOLE_EVERY

    def trusts(self, answer: Answer) -> bool:
        """Whether a run would pass as well: all checks do, and strains stay small."""
        if not answer.passed:
            return False
        grown = answer.quantities[STRAIN_ENERGY] * (_MARGIN * self._largest) ** 2
        return bool(grown <= self._energy * _LARGE**2)


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
