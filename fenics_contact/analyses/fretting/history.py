"""The history of stress near contacts, gathered as load steps are accepted."""

from __future__ import annotations

import numpy as np

from fenics_contact.analyses.fretting.region import StressRegion
from fenics_contact.analyses.fretting.table import Fretting
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.state import OPEN
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.solve.newton.solution import Solution

# Of pseudo-times that are the same.
_SAME = 1e-9


class _Cycle:
    """States of a cycle: stress and strain of each, on rank 0, and which points touched."""

    def __init__(self, touched: list[Flags]) -> None:
        self.samples: list[Array | None] = []
        self.touched = touched

    def add(self, samples: Array | None, touching: list[Flags]) -> None:
        self.samples.append(samples)
        for before, now in zip(self.touched, touching, strict=True):
            before |= now


class StressHistory:
    """Stress and strain near the contacts over the last cycle of loads; collective.

    Args:
        problem: The model.
        fretting: What its scene asks for.

    Attributes:
        region: Where.
    """

    def __init__(self, problem: Problem, fretting: Fretting) -> None:
        self._problem = problem
        self.region = StressRegion(problem, fretting.depth)
        self._cycles = cycles_of(problem.scene)
        self._begin = fretting.begin if self._cycles is None else self._cycles.begin
        self._done: _Cycle | None = None
        self._present: _Cycle | None = None
        if self._begin == 0:
            self._begin_cycle(self._at_rest(), self._nowhere())

    def resume(self) -> None:
        """Take up the load steps of another run, whose stress is not known."""
        self._done = self._present = None
        self._begin = np.inf if self._cycles is None else self._begin

    def add(self, time: float, solution: Solution) -> None:
        """Keep the stress of a load step that was accepted.

        Args:
            time: Its pseudo-time.
            solution: Of it.
        """
        if time < self._begin * (1 - _SAME):
            return
        starts = self._cycles is None or time <= self._begin * (1 + _SAME)
        if self._present is None and not starts and solution.cycle is None:
            return  # somewhere in a cycle whose begin is not known
        _ = solution.displacement  # which brings the body's fields to this step
        samples = self.region.samples()
        touching = [state.status != OPEN for state in solution.states]
        if self._present is not None:
            self._present.add(samples, touching)
        if self._present is None or solution.cycle is not None:
            self._done = self._present if solution.cycle is not None else None
            self._begin_cycle(samples, touching)

    @property
    def states(self) -> int:
        """How many there are of the cycle, 0 where none is complete."""
        found = self._last
        return 0 if found is None else len(found.samples)

    @property
    def samples(self) -> Array | None:
        """The states of the last cycle, (states, samples, 12) as of ``StressRegion``; on rank 0."""
        found = self._last
        if found is None or found.samples[0] is None:
            return None
        return np.stack([values for values in found.samples if values is not None])

    def touched(self) -> Array:
        """Places of the points that touched in it, (points, 3) (length); collective."""
        found = self._last
        return self.region.touched(self._nowhere() if found is None else found.touched)

    @property
    def _last(self) -> _Cycle | None:
        return self._present if self._cycles is None else self._done

    def _begin_cycle(self, samples: Array | None, touching: list[Flags]) -> None:
        self._present = _Cycle(self._nowhere())
        self._present.add(samples, touching)

    def _nowhere(self) -> list[Flags]:
        return [np.zeros(len(c.trace.weights), dtype=bool) for c in self._problem.contacts]

    def _at_rest(self) -> Array | None:
        """Return the state of the body without any load."""
        cells = self.region.cells
        return None if cells is None else np.zeros((cells.samples[..., 0].size, 12))
