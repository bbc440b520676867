"""Several answers to one scene: the lifted block at large friction.

The block's top is moved by (.02, +.001), so that it may hang free. At μ = 1 that is the only
answer; at μ = 2 the front corner may also touch, and stick or slip. What the program returns
must be one of them. The inequalities are solved from different statuses to find them.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from fenics_contact.scene import Scene
from fenics_contact.verification.case import Finding
from fenics_contact.verification.hard.exact import (
    ALONG,
    BACK,
    OPEN,
    STICK,
    Array,
    ExactAnswer,
    Start,
    Statuses,
    exact_answers,
)
from fenics_contact.verification.hard.hard_case import HardCase, ReferenceFailedError, Trials
from fenics_contact.verification.hard.scenes import (
    EXACT,
    SPECIFICATION,
    compared,
    driven_body,
    driven_scene,
)

THEME = "Non-unique answers"
_AMONG = f"the branches by statuses: {EXACT}; {SPECIFICATION}"


def lifted_scene(coefficient: float) -> Scene:
    """The driven block with its top moved up."""
    return driven_scene(coefficient, 0.02, 0.001)


def branches(coefficient: float) -> list[ExactAnswer]:
    """All answers that were found from different statuses, none twice; collective."""
    return exact_answers(lifted_scene(coefficient), driven_body, _starts())


def _starts() -> Iterator[Start]:
    """All points alike, or the corner at one of the ends alone."""
    for status in (OPEN, STICK, BACK, ALONG):
        yield partial(_alike, status)
        for end in (0, -1):
            yield partial(_alone, status, end)


def _alike(status: int, coordinates: Array) -> Statuses:
    return np.full(len(coordinates), status)


def _alone(status: int, end: int, coordinates: Array) -> Statuses:
    statuses = _alike(OPEN, coordinates)
    statuses[end] = status
    return statuses


def _lifted(coefficient: float, number: int, trials: Trials) -> Iterator[Finding]:
    result = trials.solve(lifted_scene(coefficient), driven_body())
    known = branches(coefficient)
    if len(known) != number:
        raise ReferenceFailedError(f"{len(known)} branches were found, not {number}")

    def far(branch: ExactAnswer) -> float:
        return max(finding.error for finding in compared(result, branch, 1e-3))

    yield from compared(result, min(known, key=far), 1e-3)


CASES: tuple[HardCase, ...] = (
    HardCase(
        "lifted_mu_1", THEME, "lifted block, μ = 1: one answer", _AMONG, partial(_lifted, 1, 1)
    ),
    HardCase(
        "lifted_mu_2", THEME, "lifted block, μ = 2: three answers", _AMONG, partial(_lifted, 2, 3)
    ),
)
