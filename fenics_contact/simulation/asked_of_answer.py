"""What a scene asks for beside its answer: derivatives, and the modes of what sticks."""

from __future__ import annotations

import dataclasses
import logging
from collections.abc import Callable

from mpi4py import MPI

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.timings import Timings
from fenics_contact.results.records.model import Seconds
from fenics_contact.results.result import Result
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.asked_derivatives.asked import asked_derivatives
from fenics_contact.simulation.asked_derivatives.uncertainty import uncertainties
from fenics_contact.simulation.studies.kept_body import KeptBody
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
    """

    def __init__(self, scene: Scene, keys: list[str], body: Callable[[], KeptBody]) -> None:
        self._scene, self._keys, self._body = scene, keys, body
        self.vibration: Vibration | None = None

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
