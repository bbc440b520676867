"""A run's files: ``scene.toml``, ``result.json``, ``contact.csv``, ``steps.csv``, fields."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from mpi4py import MPI

from fenics_contact.analyses import registry
from fenics_contact.common.atomic_files import make_folder, naming, replace_file
from fenics_contact.common.errors import InputError
from fenics_contact.common.failures import attempt, failing_together
from fenics_contact.common.parallel import on_root
from fenics_contact.common.timings import WRITING, doing
from fenics_contact.results.load_history import Announce
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Steps
from fenics_contact.scene.writing import write_scene
from fenics_contact.simulation.output.fields import FieldSeries
from fenics_contact.simulation.output.tables import StepTable, contact_rows
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.state_file import SavedRun, StateFile
from fenics_contact.solve.load_steps.accepted_step import Unknowns


def require_writable(folder: Path, comm: MPI.Comm) -> None:
    """Refuse an output folder that cannot be made or written to, before any work.

    Raises:
        InputError: On every rank.
    """
    on_root(comm, lambda: _require_writable(folder))


def _require_writable(folder: Path) -> None:
    """Make a file in the folder, or where it will be made; another run may be making it now."""
    there = next(path for path in (folder, *folder.parents) if path.exists())
    try:
        with tempfile.TemporaryFile(dir=there):
            pass
    except OSError as error:
        raise InputError(f"--out '{folder}': cannot be written to: {error.strerror}") from None


def solve_and_write(
    run: Run,
    folder: Path,
    state: StateFile | None = None,
    saved: SavedRun | None = None,
    stopped: Callable[[], bool] | None = None,
    announce: Announce | None = None,
    guess: Unknowns | None = None,
) -> Result:
    """Solve, and write the files of a run, those of steps as they are accepted; collective.

    Without convergence they are of the last accepted load step; if there is none, only
    ``result.json`` is written, with the history. An answer is written as soon as it is there, and
    again with its error bars and all else that follows it.

    Args:
        run: Made ready.
        folder: Where to.
        state: As for ``Run.solve``.
        saved: Likewise; then its files are kept.
        stopped: Likewise.
        announce: Likewise.
        guess: Likewise.

    Raises:
        MachineError: A file could not be written; those of before are whole.
    """
    with failing_together(run.problem.comm):
        scene = _write_scene(run, folder)
        return _solve(run, folder, scene, state, saved, stopped, announce, guess)


def _solve(
    run: Run,
    folder: Path,
    scene: str,
    state: StateFile | None,
    saved: SavedRun | None,
    stopped: Callable[[], bool] | None,
    announce: Announce | None,
    guess: Unknowns | None,
) -> Result:
    """As ``solve_and_write``, without the scene's file; its text goes into the result's."""
    steps = StepFiles(run, folder, None if saved is None else saved.time)

    def answered(result: Result) -> None:
        with run.timings.phase("output"):
            on_root(run.problem.comm, lambda: _write_tables(result, folder, scene))

    result = run.solve(state, saved, stopped, announce, steps.add, guess, answered)
    with run.timings.phase("output"):
        steps.complete()
    return _finish(run, result, folder, scene, steps.notes)


def solve_levels_and_write(
    first: Run,
    folder: Path,
    stopped: Callable[[], bool] | None = None,
    announce: Announce | None = None,
) -> Result:
    """Solve a scene that asks for an accuracy, and write the files of its last level; collective.

    Each level after the first is written beside the one before, and takes its place once it is
    whole.

    Args:
        first: Made ready on the first mesh.
        folder: Where to.
        stopped: As for ``Run.solve``.
        announce: Likewise.

    Raises:
        MachineError: A file could not be written; those of before are whole.
    """
    from fenics_contact.simulation.adaptive.levels import AdaptiveRun

    comm, aside = first.problem.comm, folder / _LEVEL
    levels = AdaptiveRun(first)

    def solve_level(run: Run, guess: Unknowns | None) -> Result:
        is_first = not levels.levels  # whose answer there is nothing before to stand for
        place = folder if is_first else aside
        result = _solve(run, place, scene, None, None, stopped, announce, guess)
        if result.converged and not is_first:
            on_root(comm, lambda: _take_place(aside, folder))
        return result

    with failing_together(comm):
        on_root(comm, lambda: _clear(folder, _of_a_run()))
        scene = _write_scene(first, folder)
        result = levels.solve(solve_level)
        notes: list[str] = []
        levels.run.analyses.write_fields(levels.run.problem, result, folder, notes)
        result = _noted(result, notes)
        on_root(comm, lambda: _write_level(result, folder, aside, scene))
    return result


def _take_place(aside: Path, folder: Path) -> None:
    """Files of a level that is whole take the place of those of the one before."""
    with naming(folder):
        _clear(folder, _of_a_run())
        for path in sorted(aside.iterdir(), key=lambda path: path.name == "result.json"):
            path.replace(folder / path.name)


def _write_level(result: Result, folder: Path, aside: Path, scene: str) -> None:
    """Write the last level's result, with all levels and whether they reached the accuracy."""
    with naming(folder):
        shutil.rmtree(aside, ignore_errors=True)
    _write_result(result, folder, scene)


def write(run: Run, result: Result, folder: Path) -> None:
    """Write the files of a run that was solved, fields of its last step only; collective.

    Without convergence only ``result.json`` and ``steps.csv`` are written, with the history.

    Raises:
        MachineError: A file could not be written.
    """
    with failing_together(run.problem.comm):
        scene = _write_scene(run, folder)
        steps = StepFiles(run, folder)
        steps.catch_up()
        if run.solution is not None:
            steps.add_fields()
        _finish(run, result, folder, scene, steps.notes)


def _write_scene(run: Run, folder: Path) -> str:
    """First of all, so that a run that is killed has said what it was; returns the text."""

    def written() -> str:
        make_folder(folder)
        return write_scene(run.scene, folder, run.own_mesh)

    return on_root(run.problem.comm, written)


def _finish(run: Run, result: Result, folder: Path, scene: str, notes: list[str]) -> Result:
    """Files of the end; returns the result that says what could not be written."""
    doing(WRITING)
    comm = run.problem.comm
    with run.timings.phase("output"):
        run.analyses.write_fields(run.problem, result, folder, notes)
        result = _noted(result, notes)
        on_root(comm, lambda: _write_tables(result, folder, scene))
    return result


def _noted(result: Result, notes: list[str]) -> Result:
    """With sentences on what the run could not write."""
    return replace(result, verdict=" ".join([result.verdict, *notes])) if notes else result


class StepFiles:
    """``steps.csv`` and ``fields.pvd`` of a run, growing with its steps; collective.

    Files of an earlier run in the same folder are removed first, so that none outlives its run.

    Attributes:
        notes: Sentences on what could not be written.
    """

    def __init__(self, run: Run, folder: Path, resumed: float | None = None) -> None:
        self._run, self._comm = run, run.problem.comm
        self.notes: list[str] = []
        names = _of_the_end() if resumed is not None else _of_a_run()
        on_root(self._comm, lambda: _clear(folder, names))
        self._table = StepTable(folder / "steps.csv")
        self._fields = FieldSeries(run.problem, folder, resumed)
        run.analyses.begin_files(folder, resumed)

    def add(self) -> None:
        """A step was accepted."""
        with self._run.timings.phase("output"):
            self.catch_up()
            self._run.analyses.add_to_files()
            steps = self._run.steps
            cycles, last = self._run.scene.cycles, steps[-1]
            if cycles is not None and cycles.keep == "cycles":
                if last.cycle is not None:
                    self.add_fields()
                return
            before = steps[-2].load_factor if len(steps) > 1 else 0.0
            if is_kept(self._run.scene.load_steps, last.load_factor, before, self._fields.most):
                self.add_fields()

    def complete(self) -> None:
        """No step follows: the last one has its fields."""
        self.catch_up()
        if self._run.solution is not None and not self._has_last:
            self.add_fields()

    def catch_up(self) -> None:
        """Rows of the steps that have none yet."""
        on_root(self._comm, lambda: self._table.follow(self._run.steps))

    def add_fields(self) -> None:
        """Write the fields of the last step."""
        steps = self._run.steps
        write = partial(self._fields.write, self._run.forces, steps[-1].load_factor, len(steps))
        attempt(self._comm, "Fields were not written", write, None, self.notes)

    @property
    def _has_last(self) -> bool:
        return bool(self._fields.last == self._run.steps[-1].load_factor)


def is_kept(steps: Steps, time: float, before: float, most: int) -> bool:
    """Whether a step's fields are written, if at most so many are.

    Args:
        steps: Those of the scene.
        time: Pseudo-time of the step.
        before: That of the step before.
        most: How many steps' fields are kept; of more, those evenly spread in pseudo-time.
    """
    if not steps.automatic and len(steps.all_times) <= most:
        return True
    marks = [int(most * t / steps.last * (1 + 1e-12)) for t in (before, time)]
    return marks[1] > marks[0]


# Files of a run and of its report, and nothing else that may lie in the folder.
_PICTURES = (
    r"(deformed|mesh|axis_stress|surface_displacement|convergence|accuracy|history_\w+"
    r"|contact_\d+|contact_\d+_formula|stress_\d+)\.(png|pdf)|animation_(body|\d+)\.gif"
)
_LEVEL = "next_level"  # folder of a level that is not whole yet
_OF_STEPS = r"steps\.csv|fields\.pvd|fields\d{6}\.p?vtu|fields_p\d+_\d{6}\.vtu"


def _of_the_end() -> str:
    """Names of files that say how a run ended, which is not true any more when it goes on."""
    every = registry.every()
    files = [r"result\.json|contact\.csv|report\.html", _PICTURES]
    files += [analysis.files for analysis in every if analysis.files]
    pictures = "|".join(analysis.pictures for analysis in every if analysis.pictures)
    return "|".join([*files, rf"({pictures})\.(png|pdf|gif)"])


def _of_a_run() -> str:
    """Names of all files of a run and of its report."""
    growing = [analysis.step_files for analysis in registry.every() if analysis.step_files]
    return "|".join([_of_the_end(), _OF_STEPS, *growing])


def _clear(folder: Path, names: str) -> None:
    make_folder(folder)
    with naming(folder):
        for path in folder.iterdir():
            if re.fullmatch(rf"\.?({names})", path.name):  # with a dot: begun, and then killed
                path.unlink()


def _write_tables(result: Result, folder: Path, scene: str) -> None:
    if result.points is not None:
        _replace(folder / "contact.csv", contact_rows(result.points, result.contacts))
    _write_result(result, folder, scene)


def _write_result(result: Result, folder: Path, scene: str) -> None:
    for part in registry.parts_of_result(result, "words"):
        for name, rows in part.WORDS.files(result).items():
            _replace(folder / name, rows)
    # Last, and in one move: where it exists, the run is complete.
    content = _finite(result.record(scene).as_dict())
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    replace_file(folder / "result.json", f"{text}\n".encode())


def _replace(path: Path, rows: list[list[str]]) -> None:
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerows(rows)
    replace_file(path, text.getvalue().encode())


def _finite(value: Any) -> Any:
    """JSON has no infinity: such numbers become null."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_finite(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
