"""How many modes a motion needs: twice as many, until what they change is small enough.

Shocks need nearly all that a mesh has; then it moves as a whole, and says so.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Result
from fenics_contact.scene.loading.motion import MotionModes
from fenics_contact.scene.scene import Scene

logger = logging.getLogger(__name__)

# Numbers that are tried, each twice the one before.
_FIRST, _MOST = 5, 160


@dataclass(frozen=True, eq=False)
class ChosenModes:
    """What a motion moves in.

    Attributes:
        scene: With their number, or with no modes.
        error: What half of them change of the motion, over its largest; None where that is not
            known.
        words: A sentence on it.
    """

    scene: Scene
    error: float | None = None
    words: str = ""


def choose_modes(scene: Scene, again: Callable[[Scene], Result]) -> ChosenModes:
    """Solve with few modes and with more; collective.

    Args:
        scene: That leaves their number to the program, or not.
        again: Solves a motion.
    """
    asked = None if scene.motion is None else scene.motion.modes
    if asked is None:
        return ChosenModes(scene)
    if asked.number != "automatic":
        return ChosenModes(scene, words=_words(asked.number, "what others would add is not known"))
    number, why, before = _FIRST, f"{_MOST} are not enough", None
    while number <= _MOST:
        try:
            result = again(_with(scene, replace(asked, number=number)))
        except InputError:
            why = f"a mesh of so few nodes has not many more than {number // 2} that count"
            break
        if not result.converged:
            why = f"with {number} it has no answer"
            break
        history = _history(result.steps)
        if before is not None:
            error = _difference(before, history)
            logger.info("%d free modes: half as many change the motion by %.2g", number, error)
            if error <= asked.accuracy:
                said = f"half as many change forces and energy by {error:.1e} of the largest"
                chosen = _with(scene, replace(asked, number=number))
                return ChosenModes(chosen, error, _words(number, said))
        before, number = history, 2 * number
    logger.warning("free modes do not suffice (%s): all that the mesh can do moves", why)
    words = f" Free modes do not suffice for motion.modes.accuracy = {asked.accuracy:g}: {why}. So "
    return ChosenModes(_with(scene, None), words=words + "all that the mesh can do moves.")


def _words(number: int, said: str) -> str:
    return f" It moves in {number} free modes, rigid motions beside; {said}."


def _with(scene: Scene, modes: MotionModes | None) -> Scene:
    assert scene.motion is not None
    return replace(scene, motion=replace(scene.motion, modes=modes))


def _history(steps: Sequence[StepRecord]) -> list[Array]:
    """Forces of contacts and kinetic energy, (steps, …) each."""
    forces = [[row.quantities["contact_force"] for row in step.contacts] for step in steps]
    energies = [step.quantities["kinetic_energy"] for step in steps]
    return [np.array(each, dtype=np.float64) for each in (forces, energies)]


def _difference(before: Sequence[Array], now: Sequence[Array]) -> float:
    """The largest, over the largest of each."""
    found = [
        np.abs(one - other).max(initial=0.0) / (np.abs(other).max(initial=0.0) or 1.0)
        for one, other in zip(before, now, strict=True)
    ]
    return float(max(found))
