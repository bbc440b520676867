"""Forces that stand for the errors of the mesh, along all load steps.

Errors of the mesh follow the loads. So their forces grow evenly up to the last load step; where
loads come again and again they go to and fro as these do, in straight lines between the turns of a
cycle, at each of which they are found.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.scene.loading.load_paths import cycles_of, knots
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.mesh.local_problems import ForcesOfErrors, LocalErrors
from fenics_contact.trust.error_estimates.solving_again import Again

# Of pseudo-times that are the same.
_SAME = 1e-9

# Of each draw of signs.
Drawn = list[ForcesOfErrors]


def drawn_forces(local: LocalErrors, draws: int) -> Drawn:
    """Return the forces of the errors as they are, then with random signs; collective.

    Args:
        local: Solved.
        draws: How often signs are drawn.
    """
    return [local.forces(draw) for draw in (None, *range(draws))]


class FollowedLoads:
    """How forces of errors follow the loads, from those at the turns of the last cycle; collective.

    Args:
        load_steps: At their end.
        local: Local problems; they are solved for other load steps here.
        again: How the history is taken again.
        draws: As of ``drawn_forces``.
    """

    def __init__(self, load_steps: LoadSteps, local: LocalErrors, again: Again, draws: int) -> None:
        self._load_steps, self._local, self._draws = load_steps, local, draws
        self._is_linear = again.share < 1
        self._cycles = cycles_of(load_steps.problem.scene)
        self._known: dict[float, Drawn] = {}
        turns = self._turns()
        if turns and again.walk is not None:
            self._turning_at = turns
            again.walk(self._look)
            load_steps.go_back()

    def _turns(self) -> list[float]:
        """Pseudo-times inside the last cycle at which loads turn."""
        cycles, problem = self._cycles, self._load_steps.problem
        if cycles is None:
            return self._turns_of_path() if self._is_linear else []
        close = _SAME * cycles.repetition.period
        end = self._load_steps.time
        begin = end - cycles.repetition.period
        return [knot for knot in knots(problem.scene) if begin + close < knot < end - close]

    def _turns_of_path(self) -> list[float]:
        """Pseudo-times before the end at which loads turn."""
        end = self._load_steps.time
        return [
            knot for knot in knots(self._load_steps.problem.scene) if 0 < knot < end - _SAME * end
        ]

    def _look(self, time: float, solution: Solution) -> None:
        """Find the forces of a load step, where loads turn at its end."""
        period = _SAME * time
        turn = next((turn for turn in self._turning_at if abs(turn - time) <= period), None)
        if turn is None:
            return
        problem = self._load_steps.problem
        problem.displacement.x.array[:] = solution.displacement.reshape(-1)
        self._local.solve(BulkForces(problem, solution), time)
        self._known[turn] = drawn_forces(self._local, self._draws)

    def every(self, last: Sequence[Array]) -> list[list[Array]]:
        """All forces of each draw: those at turns, then those at the end.

        Args:
            last: At the end, of each draw.
        """
        return [
            [*(drawn[number].nodal for _, drawn in sorted(self._known.items())), forces]
            for number, forces in enumerate(last)
        ]

    def along(self, forces: Sequence[Array]) -> Disturbance:
        """Over all load steps.

        Args:
            forces: Of a draw, of ``every``.
        """
        end, cycles = self._load_steps.time, self._cycles
        if not self._known:
            return Disturbance.growing(forces[-1], end)
        if cycles is None:
            return Disturbance([*sorted(self._known), end], list(forces))
        # A cycle begins as it ends.
        first = [(cycles.begin, forces[-1])] if cycles.begin > 0 else []
        into = end - cycles.repetition.period - cycles.begin
        times = [time - into for time in (*sorted(self._known), end)]
        rows = [*first, *zip(times, forces, strict=True)]
        return Disturbance(
            list(np.array([time for time, _ in rows])),
            [nodal for _, nodal in rows],
            cycles.repetition,
        )
