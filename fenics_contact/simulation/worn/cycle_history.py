"""Results of cycles that wear: the last load step of each computed cycle."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.quantities.names import EXTERNAL_WORK
from fenics_contact.results.records.cycles import CycleEnd, WornCycleEnd
from fenics_contact.simulation.step_history import StepHistory
from fenics_contact.simulation.worn.wear_cycle import WearCycle
from fenics_contact.solve.newton.solution import Solution


class CycleHistory(StepHistory[BulkForces]):
    """The cycles that were computed; friction work is that of all, what else works is not known."""

    def add_cycle(self, time: float, solution: Solution, cycle: WearCycle) -> None:
        """Keep what came out of a cycle, in whose end all is; collective.

        Args:
            time: Pseudo-time of its end.
            solution: Of its last load step, with what is worn then.
            cycle: The cycle.
        """
        self.cycle = cycle
        names = [contact.label for contact in self._problem.contacts]
        end = CycleEnd(
            number=cycle.number,
            change=None,
            advance=None,
            kind="",
            is_kept_changing=True,
            worn=WornCycleEnd(
                passed_over=cycle.passed_over,
                pressure_change=cycle.pressure_change,
                depth_over_width=cycle.depth_over_width,
                stick_areas=dict(zip(names, cycle.stick_areas, strict=True)),
                losses=dict(zip(names, cycle.losses, strict=True)),
                errors=dict(cycle.errors),
            ),
        )
        self.add(time, dataclasses.replace(solution, cycle=end))

    def resume(self, solution: Solution, energy: Sequence[float]) -> None:
        """Take over the last cycle of an earlier run; collective.

        Args:
            solution: Of its last load step, with what is worn then.
            energy: Sums of its energy balance, of no use here.
        """
        self._measure(solution)

    def _of_contact(self, solution: Solution, number: int) -> dict[str, Any]:
        if self.cycle is None:  # resumed, and not computed anew
            return dict(self.steps[-1].contacts[number].quantities)
        return dict(self.cycle.contacts[number])

    def _work_along(self, quantities: dict[str, Any]) -> dict[str, Any]:
        return {EXTERNAL_WORK: None}
