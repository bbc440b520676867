"""Load paths as runs use them: a factor at a pseudo-time, checked when it is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.errors import InputError
from fenics_contact.scene.scene import Scene
from fenics_contact.scene.values import LoadPath, Path

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


def _tables(scene: Scene) -> list[Path]:
    """All load paths of a scene that are no functions."""
    obstacles = [contact.obstacle for contact in scene.contact if contact.obstacle is not None]
    paths = [
        *(support.path for support in scene.support),
        *(load.path for load in scene.load),
        *(preload.path for preload in scene.preload),
        *(contact.pressure_path for contact in scene.contact),
        *(contact.interference_path for contact in scene.contact if contact.interference),
        *(obstacle.path for obstacle in obstacles),
        *(obstacle.displacement_path for obstacle in obstacles),
    ]
    return [path for path in paths if isinstance(path, Path)]


def knots(scene: Scene) -> list[float]:
    """Pseudo-times at which a table may change its slope, or a bolt is locked, increasing."""
    locked = {p.locked_from for p in scene.preload if p.locked_from is not None}
    every = sorted({knot for path in _tables(scene) for knot in path.knots} | locked)
    close = _SAME * max(every, default=0.0)
    return [b for a, b in zip([-math.inf, *every], every, strict=False) if b - a > close]


def times_to_judge(scene: Scene, first_only: bool) -> list[float]:
    """Ends of load steps between which loads are combinations of those at them, increasing.

    Of steps between two entries of the tables the first and the last; all entries where steps
    are automatic, as none passes over one. Loads that come again, as in cycles, are judged once.

    Args:
        scene: What is to be run.
        first_only: Leave out what comes after the first step.
    """
    steps = scene.steps
    ends = list(steps.all_times)
    turns = [knot for knot in knots(scene) if 0 < knot < steps.last]
    if steps.automatic:
        times = [] if first_only else [*turns, steps.last]
    elif first_only:
        times = ends[:1]
    else:
        places = np.searchsorted(ends, turns, side="left")
        near = {0, len(ends) - 1, *places.tolist(), *(places - 1).clip(0).tolist()}
        near |= {min(place + 1, len(ends) - 1) for place in places.tolist()}
        times = [ends[place] for place in sorted(near)]
    tables, seen = _tables(scene), set()
    kept = []
    for time in times:
        state = tuple(round(path(time), 12) for path in tables)
        if state not in seen:
            seen.add(state)
            kept.append(time)
    return kept
