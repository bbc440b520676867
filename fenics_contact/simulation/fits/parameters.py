"""The parameters of a fit: keys of a scene, where they start, and between what they stay."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from fenics_contact.common.errors import InputError
from fenics_contact.scene.scene import Scene
from fenics_contact.simulation.sensitivities.values import found_in, numbered

# As a caller gives them: keys with bounds, None for none; or words such as ``KEY=LOW:HIGH``.
Given = Mapping[str, tuple[float, float] | None] | Sequence[str]


@dataclass(frozen=True)
class Parameter:
    """A number of a scene that is to be found.

    Attributes:
        key: As of ``--set``.
        start: The scene's own value, where the search begins.
        low: The least value, perhaps −∞.
        high: The largest value, perhaps ∞.
    """

    key: str
    start: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def scale(self) -> float:
        """Divisor by which parameters of different units get one size."""
        return abs(self.start) or 1.0


def parameters_of(scene: Scene, given: Given) -> list[Parameter]:
    """The parameters of a fit.

    Args:
        scene: Where they start.
        given: Keys and bounds.

    Raises:
        InputError: A key is no number of the scene or given twice, or its bounds exclude it.
    """
    pairs = list(given.items()) if isinstance(given, Mapping) else [_read(word) for word in given]
    if not pairs:
        raise InputError("--parameters: name at least one key of the scene, such as KEY=LOW:HIGH")
    pairs = [(numbered(scene, key), bounds) for key, bounds in pairs]
    keys = [key for key, _ in pairs]
    for key in keys:
        if keys.count(key) > 1:
            raise InputError(f"--parameters {key}: it is named twice")
    return [_parameter(scene, key, bounds) for key, bounds in pairs]


def _parameter(scene: Scene, key: str, bounds: tuple[float, float] | None) -> Parameter:
    try:
        start = found_in(scene, key)
    except InputError:
        raise InputError(
            f"--parameters {key}: the scene has no such key; keys are those of --set, such as "
            "contact.0.friction_coefficient"
        ) from None
    if isinstance(start, bool) or not isinstance(start, float | int):
        said = "chosen automatically" if start == "auto" else "no number"
        raise InputError(
            f"--parameters {key}: in the scene it is {said}; give it a number, where the search "
            "begins"
        )
    low, high = bounds or (-math.inf, math.inf)
    if not low < high:
        raise InputError(f"--parameters {key}={low:g}:{high:g}: LOW must be less than HIGH")
    if not low <= start <= high:
        raise InputError(
            f"--parameters {key}={low:g}:{high:g}: the search begins at the scene's {start:g}, "
            f"which is not between them; change the bounds, or begin elsewhere with --set "
            f"{key}=VALUE"
        )
    return Parameter(key, float(start), float(low), float(high))


def _read(word: str) -> tuple[str, tuple[float, float] | None]:
    """A key, and its bounds if there are some, of ``KEY`` or ``KEY=LOW:HIGH``."""
    key, equals, text = word.partition("=")
    if not equals:
        return key.strip(), None
    try:
        low, high = (float(end) for end in text.split(":"))
    except ValueError:
        low = high = math.nan
    if math.isnan(low) or math.isnan(high):
        raise InputError(f"--parameters {word}: write it as KEY or KEY=LOW:HIGH, with two numbers")
    return key.strip(), (low, high)
