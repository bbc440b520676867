"""Load paths as runs use them: a factor at a pseudo-time, checked when it is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fenics_contact.errors import InputError
from fenics_contact.scene import Scene
from fenics_contact.scene_values import LoadPath, Path

# Of the last, below which two knots are one.
_SAME = 1e-12


@dataclass(frozen=True)
class KeyedPath:
    """A table or a function, and where the scene has it.

    Attributes:
        path: Of the scene.
        key: Where, for messages.
    """

    path: LoadPath
    key: str

    def __call__(self, time: float) -> float:
        """Share of the value at a pseudo-time; the same on every rank.

        Raises:
            InputError: A function fails, or gives no finite number.
        """
        try:
            factor = float(self.path(time))
        except Exception as caught:  # whatever a user's function raises
            said = " ".join(str(caught).split())
            raise InputError(
                f"{self.key}: its function fails at time {time:g}: {type(caught).__name__}: {said}"
            ) from None
        if not math.isfinite(factor):
            raise InputError(f"{self.key}: its function gives {factor} at time {time:g}")
        return factor


def knots(scene: Scene) -> list[float]:
    """Pseudo-times at which any table of a scene may change its slope, increasing."""
    obstacles = [contact.obstacle for contact in scene.contact if contact.obstacle is not None]
    paths = [
        *(support.path for support in scene.support),
        *(load.path for load in scene.load),
        *(contact.pressure_path for contact in scene.contact),
        *(obstacle.path for obstacle in obstacles),
        *(obstacle.displacement_path for obstacle in obstacles),
    ]
    every = sorted({knot for path in paths if isinstance(path, Path) for knot in path.knots})
    close = _SAME * max(every, default=0.0)
    return [b for a, b in zip([-math.inf, *every], every, strict=False) if b - a > close]
