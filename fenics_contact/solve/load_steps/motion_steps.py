"""The steps of a motion: load steps that begin where bodies would fly to, and remember velocities.

Each is a problem of statics (``Inertia``); going back and accepting are those of load steps.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.problem.inertia.moving import MovingInertia, moving
from fenics_contact.problem.inertia.states import MovingState, StepForces
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import AcceptedStep
from fenics_contact.solve.load_steps.auxiliary_state import AuxiliaryState
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution

# Of a step, by which lengths of steps may differ.
_SAME = 1e-9


class MotionSteps(LoadSteps):
    """All steps of a motion; as of load steps."""

    seconds_unkept = 2.0  # its steps are many, and each costs less than to write its state
    _began_at: MovingState | None = None  # of the last accepted step

    @property
    def _inertia(self) -> MovingInertia:
        return moving(self.problem.inertia)

    def _try(self, time: float) -> Solution:
        """Solve a step, from where bodies would be if nothing acted on them; collective."""
        if self.last is not None:
            self._move_on(self.last)
        found = self._step_to(time)
        return self._step_to(time) if self._inertia.goes_by_end() else found

    def _step_to(self, time: float) -> Solution:
        newton, problem = self.newton, self.problem
        newton.forget()
        if self.last is not None:
            problem.reach(self.last.unknowns.scalars)
        problem.set_time(time)
        newton.begin.where_it_flies(self._inertia.predicted)
        return solve_step(newton)

    def _move_on(self, last: AcceptedStep) -> None:
        """From the last step as it was solved to the beginning of the next one; collective."""
        if self._has_moved_on:
            return
        step = forces_of_step(self.problem, last.solution)
        self._inertia.advance(
            last.unknowns.time, last.solution.displacement, step, self.problem.given_load
        )
        super()._move_on(last)

    def _accept(self, time: float, found: Solution) -> None:
        self._began_at = self._inertia.state
        super()._accept(time, found)

    @property
    def auxiliary(self) -> AuxiliaryState:
        """The state from which the last step began; collective."""
        assert self._began_at is not None
        said, nodal = self._began_at.parts
        said["size"] = self._inertia.size
        return AuxiliaryState(said, self._began_at.at_points, nodal)

    def resume(
        self, last: AcceptedStep, pace: Sequence[float], forces: float, auxiliary: AuxiliaryState
    ) -> Solution:
        """Take up a motion that another run began, where its last step began; collective.

        Raises:
            InputError: Its steps were of another length.
        """
        size, other = self._inertia.size, auxiliary.said["size"]
        if abs(size - other) > _SAME * size:
            raise InputError(
                f"--resume: motion.end makes steps of {size:g}, not of {other:g} as before; "
                "choose one that is a multiple of motion.step"
            )
        self._began_at = MovingState.of(auxiliary.said, auxiliary.nodal, auxiliary.at_points)
        return super().resume(last, pace, forces, auxiliary)

    def go_back(self) -> None:
        """To the last accepted step as it was solved, or to none; collective."""
        if self._began_at is not None:
            self._inertia.state = self._began_at
        super().go_back()


def forces_of_step(problem: Problem, solution: Solution) -> StepForces:
    """Forces of a step of motion at the nodes, in whose state the problem is; collective.

    Args:
        problem: Of bodies that move.
        solution: Of the step.
    """
    pressed: Array = np.zeros_like(problem.load)
    for contact, force in zip(problem.contacts, solution.normal_force, strict=True):
        pressed += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
    return moving(problem.inertia).forces(
        solution.displacement, solution.internal_force, problem.load, pressed
    )
