"""What a scene asks for beside its answer: derivatives, modes of what sticks and of what slides."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable

from mpi4py import MPI

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
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

logger = logging.getLogger(__name__)


class AskedOfAnswer:
    """Adds it to a result; collective.

    Args:
        scene: That was solved.
        keys: Of the scene's numbers, those by which derivatives are asked for.
        body: Gives the body that is kept.

    Attributes:
        vibration: Modes with their shapes, once they are found.
        stability: Of steady sliding, likewise.
    """

    def __init__(self, scene: Scene, keys: list[str], body: Callable[[], KeptBody]) -> None:
        self._scene, self._keys, self._body = scene, keys, body
        self.vibration: Vibration | None = None
        self.stability: SlidingStability | None = None

    def add_to(self, result: Result, timings: Timings, comm: MPI.Comm) -> Result:
        """The result with all that is asked for.

        Args:
            result: Of a run that converged.
            timings: To which what it takes is counted.
            comm: Of the run.
        """
        for phase, is_asked, found in (
            ("derivatives", self._scene.derivatives is not None, self._with_derivatives),
            ("vibration", self._scene.modes is not None, self._with_vibration),
            ("stability", self._scene.stability is not None, self._with_stability),
        ):
            if is_asked:
                with timings.phase(phase):
                    result = found(result)
                seconds = Seconds(**timings.summary(comm))
                result = dataclasses.replace(result, timings=seconds)
        return result

    def _with_derivatives(self, result: Result) -> Result:
        try:
            found = asked_derivatives(self._body(), self._scene, self._keys)
        except NotConvergedError as error:
            logger.warning("no derivatives: %s", error)
            return result
        result = dataclasses.replace(result, derivatives=found)
        return dataclasses.replace(result, uncertainty=uncertainties(self._scene, result))

    def _with_vibration(self, result: Result) -> Result:
        try:
            found = vibration_of(self._body(), self._scene)
            if self._scene.solver.errors == "all":
                found = with_errors(found, self._body(), self._scene, result.contacts)
        except NotConvergedError as error:
            words = f"No modes: {str(error).removeprefix('modes: ')}."
            logger.warning("%s", words)
            return dataclasses.replace(result, verdict=f"{result.verdict} {words}")
        self.vibration = found
        return dataclasses.replace(
            result,
            modes=list(found.modes),
            damping=list(found.damping),
            verdict=" ".join([result.verdict, *found.notes]),
        )

    def _with_stability(self, result: Result) -> Result:
        try:
            found = stability_of(self._body(), self._scene)
        except NotConvergedError as error:
            words = f"No stability: {str(error).removeprefix('stability: ')}."
            logger.warning("%s", words)
            return dataclasses.replace(result, verdict=f"{result.verdict} {words}")
        self.stability = found
        said = [result.verdict, stability_words(found.record, result.units), *found.notes]
        return dataclasses.replace(result, stability=found.record, verdict=" ".join(said))
