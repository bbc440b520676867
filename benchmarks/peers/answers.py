"""What a program answers, and the clock that all of them are measured with."""

from __future__ import annotations

import dataclasses
import resource
import time
from collections.abc import Sequence


@dataclasses.dataclass
class Answer:
    """Of one program to one problem on one mesh.

    Attributes:
        version: Of the program.
        dofs: Unknowns of the bodies.
        solve_seconds: CPU seconds from the mesh and its spaces to the answer: assembly,
            factorisations and all iterations of all load steps.
        newton: Newton steps, or iterations of the method that stands in their place.
        factorisations: Of a matrix of all unknowns.
        values: By quantity; radii and forces of the whole body of revolution.
    """

    version: str
    dofs: int
    solve_seconds: float
    newton: int
    factorisations: int
    values: dict[str, float]


def cpu_seconds() -> float:
    """User and system, of this process and of those that it waited for."""
    waited = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + waited.ru_utime + waited.ru_stime


def sample_places(fine: float, size: float) -> list[float]:
    """Places along a contact, forty in a cell, none at a node."""
    step = size / 40
    return [step * (number + 0.5) for number in range(round(fine / step))]


def crossing(places: Sequence[float], values: Sequence[float]) -> float:
    """The last place up to which values are positive, by straight lines between the places."""
    inside = max(index for index, value in enumerate(values) if value > 0)
    if inside == len(values) - 1:
        return places[inside]
    here, there = values[inside], values[inside + 1]
    return places[inside] + (places[inside + 1] - places[inside]) * here / (here - there)
