"""Fretting in a run: the history of stress near contacts is kept, and evaluated at its end."""

from __future__ import annotations

from pathlib import Path

from fenics_contact.analyses.fretting.criteria_at_places import evaluate_fretting
from fenics_contact.analyses.fretting.field_file import write_fretting
from fenics_contact.analyses.fretting.history import StressHistory
from fenics_contact.analyses.fretting.words import fretting_words
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.simulation.analysis_tasks import AnalysisFinding, AnalysisTask
from fenics_contact.solve.newton.solution import Solution


class FrettingTask(AnalysisTask):
    """Keeps the stress near contacts along the load steps.

    Attributes:
        history: The stress; None before the first load step.
    """

    missing = "Fretting was not evaluated"
    fields = "Fields of fretting were not written"
    history: StressHistory | None = None

    def begin(self, problem: Problem) -> None:
        """Keep stress from the first load step on."""
        assert self.scene.fretting is not None
        self._problem = problem
        self.history = StressHistory(problem, self.scene.fretting)

    def resumed(self) -> None:
        """Stress of load steps of an earlier run is not known."""
        if self.history is not None:
            self.history.resume()

    def accepted(self, time: float, solution: Solution) -> None:
        """Keep the stress of a load step."""
        self._last = solution
        if self.history is not None:
            self.history.add(time, solution)

    def evaluate(self) -> AnalysisFinding:
        """The criteria of fatigue, and where they are worst."""
        asked, history = self.scene.fretting, self.history
        assert asked is not None and history is not None
        record, places = evaluate_fretting(self._problem, asked, history) or (None, None)
        found = {"fretting": record, "fretting_places": places}
        return AnalysisFinding(found, words=fretting_words(asked, record))

    def write_fields(self, problem: Problem, result: Result, folder: Path) -> None:
        """Write ``fretting.pvd``."""
        if result.fretting_places is not None:
            moved = self._last.displacement
            write_fretting(problem.spaces, result.fretting_places, moved, folder)


TASK = FrettingTask
