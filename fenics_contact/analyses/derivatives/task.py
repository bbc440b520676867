"""Derivatives in a run: found by the adjoint once the answer is there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from fenics_contact.analyses.derivatives.asked import asked_derivatives, keys_asked_of
from fenics_contact.analyses.derivatives.record import Derivative
from fenics_contact.analyses.derivatives.uncertainty import uncertainties
from fenics_contact.common.failures import attempt
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Result
from fenics_contact.simulation.analysis_tasks import AnalysisTask
from fenics_contact.simulation.studies.kept_body import KeptBody


class DerivativeTask(AnalysisTask):
    """Finds derivatives, and what tolerances make of them."""

    missing = "No derivatives"

    def require(self, problem: Problem) -> None:
        """Refuse quantities and numbers that have no derivative."""
        self._keys = keys_asked_of(problem)

    def complete(self, result: Result, body: Callable[[], KeptBody], notes: list[str]) -> Result:
        """The result with derivatives and uncertainties."""
        kept = body()
        found = asked_derivatives(kept, self.scene, self._keys)
        result = replace(result, derivatives=found)
        tell, missing = partial(uncertainties, self.scene, result), "No uncertainties"
        comm = kept.discrete.spaces.comm
        return replace(result, uncertainty=attempt(comm, missing, tell, result.uncertainty, notes))

    def unknown(self, result: Result) -> Result:
        """The result with derivatives that nobody knows."""
        asked = self.scene.derivatives
        assert asked is not None
        nothing = Derivative(value=None, spread=None, discrete=None, one_sided=False)
        unknown = {name: dict.fromkeys(self._keys, nothing) for name in asked.of}
        return replace(result, derivatives=unknown)


TASK = DerivativeTask
