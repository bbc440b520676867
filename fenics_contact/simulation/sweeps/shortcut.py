"""When a quick answer says what a whole run would say, so that a point costs milliseconds."""

from __future__ import annotations

from fenics_contact.analyses import registry
from fenics_contact.quantities.names import STRAIN_ENERGY
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene, SolverSettings
from fenics_contact.simulation.studies.quick_answers import Answer

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
