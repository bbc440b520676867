"""What a scene asks for beside its answer: derivatives, modes of what sticks and of what slides."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial

from mpi4py import MPI

from fenics_contact.common.failures import attempt, silently
from fenics_contact.common.timings import Timings
from fenics_contact.results.records.derivatives import Derivative
from fenics_contact.results.records.model import Seconds
from fenics_contact.results.result import Result
from fenics_contact.results.words.stability import stability_words
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.asked_derivatives.asked import asked_derivatives
from fenics_contact.simulation.asked_derivatives.uncertainty import uncertainties
from fenics_contact.simulation.studies.kept_body import KeptBody
from fenics_contact.simulation.vibration.errors import with_errors
from fenics_contact.simulation.vibration.stability import SlidingStability, stability_of
from fenics_contact.simulation.vibration.vibration import Vibration, vibration_of


class AskedOfAnswer:
    """Adds it to a result; collective.

    Args:
        scene: That was solved.
        keys: Of the scene's numbers, those by which derivatives are asked for.
        body: Gives the body that is kept.
        comm: Of the run.

    Attributes:
        vibration: Modes with their shapes, once they are found.
        stability: Of steady sliding, likewise.
    """

    def __init__(
        self, scene: Scene, keys: list[str], body: Callable[[], KeptBody], comm: MPI.Comm
    ) -> None:
        self._scene, self._keys, self._body, self._comm = scene, keys, body, comm
        self.vibration: Vibration | None = None
        self.stability: SlidingStability | None = None

    def add_to(self, result: Result, timings: Timings) -> Result:
        """The result with all that is asked for.

        Args:
            result: Of a run that converged.
            timings: To which what it takes is counted.
        """
        scene = self._scene
        for phase, is_asked, missing, find in (
            ("derivatives", scene.derivatives, "No derivatives", self._with_derivatives),
            ("vibration", scene.modes, "No modes", self._with_vibration),
            ("stability", scene.stability, "No stability", self._with_stability),
        ):
            if is_asked is not None:
                notes: list[str] = []
                with timings.phase(phase), silently():
                    found = partial(find, result, notes)
                    without = self._without(result, phase)
                    result = attempt(self._comm, missing, found, without, notes)
                words = " ".join([result.verdict, *map(_plain, notes)])
                seconds = Seconds(**timings.summary(self._comm))
                result = dataclasses.replace(result, timings=seconds, verdict=words)
        return result

    def _without(self, result: Result, phase: str) -> Result:
        """Where what is asked for is not found: derivatives that nobody knows."""
        asked = self._scene.derivatives
        if phase != "derivatives" or asked is None:
            return result
        nothing = Derivative(value=None, spread=None, discrete=None, one_sided=False)
        unknown = {name: dict.fromkeys(self._keys, nothing) for name in asked.of}
        return dataclasses.replace(result, derivatives=unknown)

    def _with_derivatives(self, result: Result, notes: list[str]) -> Result:
        found = asked_derivatives(self._body(), self._scene, self._keys)
        result = dataclasses.replace(result, derivatives=found)
        tell, missing = partial(uncertainties, self._scene, result), "No uncertainties"
        uncertainty = attempt(self._comm, missing, tell, result.uncertainty, notes)
        return dataclasses.replace(result, uncertainty=uncertainty)

    def _with_vibration(self, result: Result, notes: list[str]) -> Result:
        body, scene = self._body(), self._scene
        found = vibration_of(body, scene)
        if scene.solver.errors == "all":
            estimate = partial(with_errors, found, body, scene, result.contacts)
            missing = "Errors of modes were not estimated"
            found = attempt(self._comm, missing, estimate, found, notes)
        self.vibration = found
        return dataclasses.replace(
            result,
            modes=list(found.modes),
            damping=list(found.damping),
            verdict=" ".join([result.verdict, *found.notes]),
        )

    def _with_stability(self, result: Result, notes: list[str]) -> Result:
        found = stability_of(self._body(), self._scene)
        self.stability = found
        said = [result.verdict, stability_words(found.record, result.units), *found.notes]
        return dataclasses.replace(result, stability=found.record, verdict=" ".join(said))


def _plain(note: str) -> str:
    """Without the name of the part of the scene, which the sentence has said."""
    missing, _, reason = note.partition(": ")
    for name in ("derivatives", "modes", "stability"):
        reason = reason.removeprefix(f"{name}: ")
    return f"{missing}: {reason}"
