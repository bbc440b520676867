"""Vibration in a run: modes about the last state, and what joints damp of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from fenics_contact.analyses.vibration.errors import with_errors
from fenics_contact.analyses.vibration.mode_files import write_modes
from fenics_contact.analyses.vibration.vibration import Vibration, damping_scenes, vibration_of
from fenics_contact.common.failures import attempt
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.studies.kept_body import KeptBody


class VibrationTask(AnalysisTask):
    """Finds modes and drives them.

    Attributes:
        found: Modes with their shapes; None before these are found.
    """

    missing = "No modes"
    fields = "Fields of modes were not written"

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene)
        damping_scenes(scene)  # refuses what cannot be varied
        self.found: Vibration | None = None

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with modes and damping, and their error bars."""
        kept, scene = body(), self.scene
        found = vibration_of(kept, scene)
        if scene.solver.errors == "all":
            estimate = partial(with_errors, found, kept, scene, result.contacts)
            missing = "Errors of modes were not estimated"
            found = attempt(kept.discrete.spaces.comm, missing, estimate, found, notes)
        self.found = found
        return replace(
            result,
            modes=list(found.modes),
            damping=list(found.damping),
            verdict=" ".join([result.verdict, *found.notes]),
        )

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``modes.pvd``."""
        if self.found is not None:
            write_modes(problem.spaces, self.found.shapes, folder)


TASK = VibrationTask
