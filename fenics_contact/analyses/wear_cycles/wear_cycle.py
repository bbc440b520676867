"""Cycles of loads that wear: their begin and number, and the result of each."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from fenics_contact.common.errors import InputError
from fenics_contact.quantities.names import MAX_WEAR_DEPTH, WORN_VOLUME
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.scene.loading.load_paths import require_back
from fenics_contact.scene.scene import Scene

# Of a cycle: so much before its begin stands the step after which what was worn is in the gap.
SETTLING = 1e-6


@dataclass(frozen=True, eq=False)
class WearCycle:
    """A cycle that was computed.

    Attributes:
        number: Of the cycle, from 1.
        passed_over: How many cycles before it were not computed, since the last one that was.
        pressure_change: Largest change of a pressure since then, over the largest pressure.
        errors: Estimated error of all jumps so far: ``worn_volume`` (volume) and
            ``max_wear_depth`` (length), absolute.
        losses: What friction dissipates in it at each contact (energy).
        friction_work: To the end of the cycle (energy).
        stick_areas: Of each contact what touched in the cycle and never slipped (area).
        depth_over_width: Deepest wear over half the width that is worn, about a slope; beyond .1
            the linear theory of gaps ends.
        contacts: Quantities of each contact at its end, in scene order.
        points: The contact points then.
    """

    number: int
    passed_over: int
    pressure_change: float
    errors: dict[str, float]
    losses: list[float]
    friction_work: float
    stick_areas: list[float]
    depth_over_width: float
    contacts: list[dict[str, Any]]
    points: ContactPoints

    @property
    def worn_volume(self) -> float:
        """Worn volume of all contacts (volume)."""
        return float(sum(found.get(WORN_VOLUME, 0.0) for found in self.contacts))

    @property
    def max_wear_depth(self) -> float:
        """The deepest (length)."""
        return float(max(found.get(MAX_WEAR_DEPTH, 0.0) for found in self.contacts))


def one_cycle(scene: Scene, begin: float | None, cycles: int | None) -> tuple[Scene, float, int]:
    """A scene whose load steps end with the first of its cycles; their begin, and how many.

    Cycles begin at the end of a load step, and something wears.

    Args:
        scene: Any.
        begin: In place of that of its ``cycles``.
        cycles: In place of their number.

    Raises:
        InputError: They are not given, and the scene has none; or a load is at the end of the
            cycle not as at its begin.
    """
    said = scene.cycles
    if said is not None:
        first = dataclasses.replace(said, number=1, jumps=None, until="end")
        once = dataclasses.replace(scene, cycles=first)
        scene = dataclasses.replace(scene, cycles=None, steps=once.load_steps)
        begin = said.begin if begin is None else begin
        cycles = said.number if cycles is None else cycles
    if begin is None or cycles is None:
        raise InputError("begin and cycles are missing, and the scene has no [cycles]")
    if cycles < 1:
        raise InputError(f"cycles = {cycles}: must be >= 1")
    _require_cycle(scene, begin)
    return scene, begin, cycles


def _require_cycle(scene: Scene, begin: float) -> None:
    """Refuse load steps that do not end with a cycle at whose end loads are as at its begin.

    Raises:
        InputError: They do not, or nothing wears.
    """
    times = np.array(scene.steps.all_times)
    close = SETTLING * (times[-1] - begin)
    if scene.steps.automatic or not (np.abs(times - begin) <= close).any() or begin >= times[-1]:
        raise InputError(
            f"begin = {begin:g}: a cycle begins at the end of a load step and has others to "
            "its own end, the last of all, none of them automatic"
        )
    if not any(contact.wear for contact in scene.contact):
        raise InputError("contact.wear is missing: nothing changes from cycle to cycle")
    try:
        require_back(scene, begin, scene.steps.last)
    except ValueError as error:
        raise InputError(str(error)) from None
