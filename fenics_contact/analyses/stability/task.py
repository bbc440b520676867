"""Steady sliding in a run: complex modes about the last state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from fenics_contact.analyses.stability.field_files import write_complex_modes
from fenics_contact.analyses.stability.stability import SlidingStability, stability_of
from fenics_contact.analyses.stability.words import stability_words
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.studies.kept_body import KeptBody


class StabilityTask(AnalysisTask):
    """Finds the modes of bodies that slide.

    Attributes:
        found: Modes with their shapes; None before these are found.
    """

    missing = "No stability"
    fields = "Fields of complex modes were not written"
    found: SlidingStability | None = None

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with the modes, and with what they tell in words."""
        found = self.found = stability_of(body(), self.scene)
        said = [result.verdict, stability_words(found.record, result.units), *found.notes]
        return replace(result, stability=found.record, verdict=" ".join(said))

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``squeal.pvd``."""
        if self.found is not None:
            write_complex_modes(problem.spaces, self.found.shapes, folder)


TASK = StabilityTask
