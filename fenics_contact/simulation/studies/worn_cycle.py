"""What is said of cycles of loads that wear: which, how far they are passed over, what came out."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from fenics_contact.common.errors import InputError
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.scene.loading.load_paths import require_back
from fenics_contact.scene.scene import Scene


@dataclass(frozen=True)
class Jumps:
    """How far cycles are passed over.

    Attributes:
        pressure_change: Largest change of a pressure in a jump, over the largest pressure.
        error: About the largest estimated error at the end of all: of the depths over the deepest,
            and of the volume over itself.
        fixed: How many cycles further on every next one is, in place of the control; None with it.
    """

    pressure_change: float = 0.2
    error: float = 0.01
    fixed: int | None = None

    def __post_init__(self) -> None:
        for name in ("pressure_change", "error", "fixed"):
            value = getattr(self, name)
            if value is not None and not value > 0:
                raise InputError(f"{name} = {value}: must be > 0")


@dataclass(frozen=True, eq=False)
class WornCycle:
    """A cycle that was computed.

    Attributes:
        number: Of the cycle, from 1.
        passed_over: How many cycles before it were not computed, since the last one that was.
        pressure_change: Largest change of a pressure since then, over the largest pressure.
        errors: Estimated error of all jumps so far: ``worn_volume`` (volume) and
            ``max_wear_depth`` (length), absolute.
        friction_work: To the end of the cycle (energy).
        depth_over_width: Deepest wear over half the width that is worn, about a slope; beyond .1
            the linear theory of gaps ends.
        contacts: Quantities of each contact at its end, in scene order.
        points: The contact points then.
    """

    number: int
    passed_over: int
    pressure_change: float
    errors: dict[str, float]
    friction_work: float
    depth_over_width: float
    contacts: list[dict[str, Any]]
    points: ContactPoints

    @property
    def worn_volume(self) -> float:
        """Of all contacts (volume)."""
        return float(sum(found.get("worn_volume", 0.0) for found in self.contacts))

    @property
    def max_wear_depth(self) -> float:
        """The deepest (length)."""
        return float(max(found.get("max_wear_depth", 0.0) for found in self.contacts))


def one_cycle(scene: Scene, begin: float | None, cycles: int | None) -> tuple[Scene, float, int]:
    """A scene whose load steps end with the first of its cycles; their begin, and how many.

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
        once = dataclasses.replace(scene, cycles=dataclasses.replace(said, number=1))
        scene = dataclasses.replace(scene, cycles=None, steps=once.load_steps)
        begin = said.begin if begin is None else begin
        cycles = said.number if cycles is None else cycles
    if begin is None or cycles is None:
        raise InputError("begin and cycles are missing, and the scene has no [cycles]")
    if cycles < 1:
        raise InputError(f"cycles = {cycles}: must be >= 1")
    try:
        require_back(scene, begin, scene.steps.last)
    except ValueError as error:
        raise InputError(str(error)) from None
    return scene, begin, cycles
