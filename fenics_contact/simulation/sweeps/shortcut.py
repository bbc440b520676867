"""When a quick answer says what a whole run would say, so that a point costs milliseconds."""

from __future__ import annotations

import numpy as np

from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.simulation.studies.quick_answers import Answer

# Every so many is a whole run, so that fields are looked at now and then.
_WHOLE_EVERY = 50
# Strains follow the root of the strain energy; of points in between the last whole run and this
# one they may be so much larger.
_STRAIN_MARGIN = 3.0
_NEEDS_FIELDS = "linear_range"


class Shortcut:
    """What the last whole run says of the points after it."""

    def __init__(self) -> None:
        self._settings: SolverSettings | None = None
        self._since = 0
        self._share, self._energy = 0.0, 0.0

    def learn(self, scene: Scene, result: Result) -> None:
        """Take a whole run into account.

        Args:
            scene: That was solved.
            result: What came out.
        """
        makes_bars = scene.solver.errors != "none"
        is_whole = result.converged and result.model.solver == "condensed" and not makes_bars
        self._settings = scene.solver if is_whole else None
        self._since = 0
        if is_whole:
            check = result.checks.get(_NEEDS_FIELDS)
            self._share = 0.0 if check is None else check.value / check.limit
            self._energy = result.quantities["strain_energy"]

    def is_open(self, scene: Scene) -> bool:
        """Whether a quick answer may do for a scene."""
        self._since += 1
        return scene.solver == self._settings and self._since < _WHOLE_EVERY

    def trusts(self, answer: Answer) -> bool:
        """Whether a run would pass as well: all checks do, and strains stay small."""
        if not answer.passed:
            return False
        grown = max(answer.quantities["strain_energy"], 0.0)
        allowed = self._energy / max(_STRAIN_MARGIN * self._share, np.finfo(float).tiny) ** 2
        return bool(self._share == 0 or grown <= allowed)
