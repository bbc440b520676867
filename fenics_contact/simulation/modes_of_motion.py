"""How many modes a motion needs: twice as many, until what they change and miss is small enough.

Shocks need nearly all that a mesh has; then it moves as a whole, and says so.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.quantities.names import (
    CONTACT_FORCE,
    KINETIC_ENERGY,
    LEFT_OUT_KINETIC_ENERGY,
    STRAIN_ENERGY,
)
from fenics_contact.results.records.steps import StepRecord
from fenics_contact.results.result import Check, Result
from fenics_contact.scene.loading.motion import MotionModes
from fenics_contact.scene.scene import Scene

logger = logging.getLogger(__name__)

# Numbers that are tried, each twice the one before.
_FIRST, _MOST = 5, 160
# Of what half of the modes change: blocks that hit a cylinder are up to 3.3 times as far off.
_SAFETY = 4.0


@dataclass(frozen=True, eq=False)
class ChosenModes:
    """The modes that a motion moves in.

    Attributes:
        scene: With their number, or with no modes.
        half: Forces and kinetic energy of the motion in half as many; None where there is none.
        why: Why it moves in none, in a sentence, or nothing.
    """

    scene: Scene
    half: Sequence[Array] | None = None
    why: str = ""

    def error(self, steps: Sequence[StepRecord]) -> float | None:
        """How far it may be off, over the largest; None where that is not known.

        Four times what half of the modes change, or the kinetic energy that none of them has, if
        that is more: where an axial blow meets modes that bend alone, more of these change nothing.

        Args:
            steps: Of the motion so far.
        """
        if self.half is None or not steps:
            return None
        return _error(self.half, steps)

    def words(self, steps: Sequence[StepRecord]) -> str:
        """A sentence on them, or nothing; as of ``error``."""
        error, number = self.error(steps), self._asked and self._asked.number
        if error is None:
            return self.why
        said = f"by an estimate forces and energy are right to {error:.1e} of the largest"
        return f" It moves in {number} free modes, rigid motions beside; {said}."

    def check(self, steps: Sequence[StepRecord]) -> dict[str, Check]:
        """Whether they are enough; as of ``error``."""
        error = self.error(steps)
        return {} if error is None else {"free_modes": Check(error, self._asked.accuracy)}

    @property
    def _asked(self) -> Any:
        return self.scene.motion and self.scene.motion.modes


def modes_ahead(asked: MotionModes) -> int:
    """How many modes it is going to take at least."""
    return 2 * _FIRST if asked.number == "automatic" else asked.number


def choose_modes(scene: Scene, asked: MotionModes, again: Callable[[Scene], Result]) -> ChosenModes:
    """Solve with few modes and with more, as many as needed, or with half of what is asked for.

    Args:
        scene: Of a motion; collective.
        asked: Its modes, whose number it leaves to the program, or not.
        again: Solves a motion.
    """
    if asked.number != "automatic":
        return ChosenModes(scene, *_half(scene, asked, asked.number, again))
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
            error = _error(before, result.steps)
            logger.info("%d free modes: by an estimate the motion is right to %.2g", number, error)
            if error <= asked.accuracy:
                return ChosenModes(_with(scene, replace(asked, number=number)), before)
        before, number = history, 2 * number
    logger.warning("free modes do not suffice (%s): all that the mesh can do moves", why)
    words = f" Free modes do not suffice for motion.modes.accuracy = {asked.accuracy:g}: {why}. So "
    return ChosenModes(_with(scene, None), why=words + "all that the mesh can do moves.")


def _half(
    scene: Scene, asked: MotionModes, number: int, again: Callable[[Scene], Result]
) -> tuple[Sequence[Array] | None, str]:
    """The motion in half of a number of modes, or a sentence on why there is none; collective."""
    unknown = f" It moves in {number} free modes, rigid motions beside; what others would add "
    unknown += "is not known."
    if number == 1:
        return None, unknown
    try:
        result = again(_with(scene, replace(asked, number=number // 2)))
    except InputError:  # so will all of them, and say why
        return None, unknown
    return (_history(result.steps), "") if result.converged else (None, unknown)


def _with(scene: Scene, modes: MotionModes | None) -> Scene:
    assert scene.motion is not None
    return replace(scene, motion=replace(scene.motion, modes=modes))


def _history(steps: Sequence[StepRecord]) -> list[Array]:
    """Forces of contacts and kinetic energy over their largest, (steps, …) each.

    Of energies that of strains counts for the largest, too: what rests has no other.
    """
    forces = [[row.quantities[CONTACT_FORCE] for row in step.contacts] for step in steps]
    kinetic, stored = (
        np.array([step.quantities[name] for step in steps])
        for name in (KINETIC_ENERGY, STRAIN_ENERGY)
    )
    pairs = (np.array(forces), np.array(forces)), (kinetic, kinetic + stored)
    return [found / (np.abs(of).max(initial=0.0) or 1.0) for found, of in pairs]


def _error(before: Sequence[Array], steps: Sequence[StepRecord]) -> float:
    """Return the error of ``ChosenModes``, by steps and by results in half of the modes."""
    return max(_SAFETY * _difference(before, _history(steps)), _left_out(steps))


def _left_out(steps: Sequence[StepRecord]) -> float:
    """The largest kinetic energy that no mode has, over the largest energy."""
    names = KINETIC_ENERGY, STRAIN_ENERGY
    energies = [sum(step.quantities[name] for name in names) for step in steps]
    left = max(step.quantities[LEFT_OUT_KINETIC_ENERGY] for step in steps)
    return float(left / (max(energies) or 1.0))


def _difference(before: Sequence[Array], now: Sequence[Array]) -> float:
    """The largest of any; of a motion that was stopped, up to there."""
    pairs = zip(before, now, strict=True)
    every = [np.abs(one[: len(other)] - other[: len(one)]) for one, other in pairs]
    return float(max(off.max(initial=0.0) for off in every))
