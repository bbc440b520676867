"""Where load steps rest: at the last one that was accepted, as it was solved, or at the start."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.snapshot import ContactMemory, recall, recall_pairing, remember
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.solve.coulomb.friction_scale import follow_pressure
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep, Unknowns
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.slack import take_up_slack

# Of pseudo-times that are the same.
_SAME = 1e-9


class StepRollback:
    """A problem between load steps: begins one, and goes back where it was.

    That slip counts no more, and that two bodies are paired where they stand now, comes before the
    next try: so whoever goes back, in this run or in another one, goes back to the same.

    Attributes:
        newton: Newton's method on the problem.
        problem: The problem.
        last: The last accepted step, None before there is one.

    Args:
        newton: Made for the problem, not started.
    """

    def __init__(self, newton: Newton) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.last: AcceptedStep | None = None
        self._untouched = [remember(contact) for contact in self.problem.contacts]
        self._begins = _begins_of_cycles(self.problem)
        self._has_moved_on = False

    @property
    def time(self) -> float:
        """Pseudo-time of the last accepted step."""
        return self.last.unknowns.time if self.last else 0.0

    def _begin(self, time: float, predicted: Unknowns | None) -> None:
        """Bring all to a pseudo-time; collective."""
        newton, problem = self.newton, self.problem
        if self.last is None:
            problem.reach(np.zeros(len(problem.unknowns)))
            problem.set_time(time)
            newton.begin.anew()
            if predicted is not None:
                self._place(predicted)
                newton.begin.from_last_step()
            take_up_slack(newton, None)
            return
        self._move_on(self.last)
        problem.reach(self.last.unknowns.scalars)
        problem.set_time(time)
        if predicted is not None:
            self._place(predicted)
            if newton.begin.is_out_of_touch():  # an obstacle that turns leaves the straight line
                self._place(self.last.unknowns)
        newton.begin.from_last_step()
        take_up_slack(newton, self.last.solution)

    def _move_on(self, last: AcceptedStep) -> None:
        """From the last step as it was solved to the beginning of the next one; collective."""
        if self._has_moved_on:
            return
        for contact in self.problem.contacts:
            contact.accept()
            if self._begins_cycle(last.unknowns.time):
                contact.last_step.begin_cycle()
            # A guess of what the next step needs.
            follow_pressure(contact, last.solution.imbalance_limit)
        self.newton.begin.update_pairing(last.solution)
        self._has_moved_on = True

    def _begins_cycle(self, time: float) -> bool:
        return bool(np.any(np.abs(self._begins - time) <= _SAME * self._begins))

    def go_back(self) -> None:
        """To the last accepted step as it was solved, or to none; collective."""
        problem = self.problem
        self._has_moved_on = False
        if self.last is None:
            self._recall(self._untouched)
            return
        unknowns = self.last.unknowns
        problem.reach(unknowns.scalars)
        problem.set_time(unknowns.time)
        self._recall(self.last.contacts)
        self._place(unknowns)
        problem.displacement.x.array[:] = unknowns.displacement.reshape(-1)
        for contact in problem.contacts:  # also of those that exert no forces
            contact.kinematics.move(contact.kinematics.relative(unknowns.displacement))

    def go_back_to(self, step: AcceptedStep) -> None:
        """To a load step that was accepted, from a later one; collective."""
        self.last = step
        self.go_back()

    def _recall(self, memories: list[ContactMemory]) -> None:
        """Take the contacts back to what is kept of them, and their pairing; collective."""
        pairs = list(zip(self.problem.contacts, memories, strict=True))
        if any([recall_pairing(contact, memory) for contact, memory in pairs]):
            self.newton.begin.follow_pairing()
        for contact, memory in pairs:
            recall(contact, memory)

    def _place(self, unknowns: Unknowns) -> None:
        mixed = self.problem.elastic.mixed
        if mixed is not None:
            mixed.mean_stress.x.array[:] = unknowns.mean_stress
        self.newton.begin.at(unknowns.position_in(self.newton.system), unknowns.scalars)


def _begins_of_cycles(problem: Problem) -> Array:
    """Pseudo-times at which cycles of loads begin, but for the start."""
    cycles = cycles_of(problem.scene)
    starts = () if cycles is None else cycles.repetition.starts
    return np.array([time for time in starts if time > 0])
