"""Builds system and Newton's method for a problem, and takes its load steps or its motion.

The steps of a motion: load steps that begin where bodies would fly to, and remember velocities.
Each is a problem of statics (``Inertia``); going back and accepting are those of load steps.

All that
solves does it here: a run, a study, an analysis. What is asked of an
answer listens to the load steps, or reads what they leave; it does not change how they are solved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError, NotConvergedError
from fenics_contact.common.parallel import total
from fenics_contact.common.timings import Timings
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.loads.disturbance import Drive
from fenics_contact.problem.motion_states import FirstState, MovingState, StepForces, elastic_slip
from fenics_contact.problem.moving import MovingInertia, moving
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.load_steps.accepted_step import (
    AcceptedStep,
    AuxiliaryState,
    StepListener,
    recall,
    remember,
)
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.solver_choice import Condense, SolverChoice, choose_solver, create_system
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.solve.systems.system import System

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
    """Forces of a step of motion at the nodes, in whose state the problem is; collective."""
    pressed: Array = np.zeros_like(problem.load)
    for contact, force in zip(problem.contacts, solution.normal_force, strict=True):
        pressed += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
    return moving(problem.inertia).forces(
        solution.displacement, solution.internal_force, problem.load, pressed, solution.scalars
    )


@contextmanager
def stepping(
    problem: Problem,
    timings: Timings | None = None,
    choice: SolverChoice | None = None,
    condense: Condense | None = None,
    stopped: Callable[[], bool] | None = None,
    finds_body: bool = True,
) -> Iterator[LoadSteps]:
    """The load steps of a problem, with a system that is made for them and destroyed; collective.

    Args:
        problem: The problem; what its contacts remember moves on with the steps.
        timings: Seconds so far.
        choice: The solver; by default that of the scene and its sizes.
        condense: As of ``create_system``.
        stopped: As of ``Newton``.
        finds_body: As of ``LoadSteps``.
    """
    timings = timings or Timings()
    system = create_system(problem, choice or choose_solver(problem), timings, condense)
    with stepping_on(system, timings, stopped, finds_body) as load_steps:
        yield load_steps


@contextmanager
def stepping_on(
    system: System,
    timings: Timings,
    stopped: Callable[[], bool] | None = None,
    finds_body: bool = True,
) -> Iterator[LoadSteps]:
    """The load steps of a system's problem; the system is destroyed at the end; collective.

    Args:
        system: Made for the problem.
        timings: Seconds so far.
        stopped: As of ``Newton``.
        finds_body: As of ``LoadSteps``.
    """
    try:
        yield load_steps_on(system, timings, stopped, finds_body)
    finally:
        system.destroy()


def load_steps_on(
    system: System,
    timings: Timings,
    stopped: Callable[[], bool] | None = None,
    finds_body: bool = True,
) -> LoadSteps:
    """The load steps of a system's problem, none of them taken.

    Args:
        system: Made for the problem, or at its begin again.
        timings: Seconds so far.
        stopped: As of ``Newton``.
        finds_body: As of ``LoadSteps``.
    """
    kind = MotionSteps if system.problem.inertia.moves else LoadSteps
    return kind(Newton(system.problem, system, timings, stopped), finds_body)


def solve(
    problem: Problem,
    timings: Timings | None = None,
    *listeners: StepListener,
    choice: SolverChoice | None = None,
) -> Solution:
    """Solve a problem step by step; collective.

    Args:
        problem: The problem; what its contacts remember moves on with the steps.
        timings: Seconds so far.
        *listeners: Are told of each load step.
        choice: The solver; by default that of the scene and its sizes.

    Returns:
        The solution of the last step.

    Raises:
        NotConvergedError: In words, with the history of the force imbalance.
    """
    with stepping(problem, timings, choice) as load_steps:
        return load_steps.solve(*listeners)


_KEY = "motion.start = 'static'"


def begin_motion(problem: Problem, timings: Timings) -> None:
    """Bring bodies that begin from the static answer under what acts at time 0 there; collective.

    The weights of nodes in contact act where their masses are, so that nothing begins to move.

    Args:
        problem: The model; where it moves so its contacts and its ``inertia`` are brought there.
        timings: To which what it takes is counted.

    Raises:
        InputError: There is no such answer, or none was found.
    """
    motion = problem.scene.motion
    if motion is None or motion.start != "static":
        return
    rest = _at_rest(problem, timings)
    try:
        require_equilibrium(rest)
        found = solve(rest, timings)
    except (InputError, NotConvergedError) as error:
        raise InputError(f"{_KEY}: no static answer at time 0: {error}") from None
    _take(problem, rest, found)


def _at_rest(problem: Problem, timings: Timings) -> Problem:
    """The problem of the scene without masses, under what acts at time 0; collective."""
    scene = problem.scene.at_rest
    rest = Problem(scene, problem.discrete, timings, by_points=True)
    rest.take_loads(problem)
    rest.drive = Drive(np.zeros_like(problem.load), rest=0.0, share=lambda time: 0.0)
    rest.set_time(scene.load_steps.last)
    return rest


def _take(problem: Problem, rest: Problem, found: Solution) -> None:
    """Displacements, forces and what contacts remember, of the static answer; collective."""
    inertia = moving(problem.inertia)
    elastic = tuple(elastic_slip(contact) for contact in rest.contacts)
    energy = _stored(rest, found)
    pressed: Array = np.zeros_like(problem.load)
    pressures = np.zeros((len(rest.contacts), problem.spaces.components))
    for number, (contact, force) in enumerate(zip(rest.contacts, found.normal_force, strict=True)):
        pressed += contact.kinematics.on_body(contact.trace.at_all_nodes(force))
        pressures[number] = total(rest.comm, force[contact.owned_nodes].sum(axis=0))
    for contact, before in zip(problem.contacts, rest.contacts, strict=True):
        before.accept()
        recall(contact, replace(remember(before), dissipated=0.0, left_open=0.0))
    inertia.begin_deformed(
        found.displacement,
        found.internal_force - 0.5 * inertia.points.tied(found.scalars),
        pressed,
        elastic,
        FirstState(
            energy=energy,
            pressures=pressures,
            overlaps=tuple(c.kinematics.interference - c.kinematics.worn for c in rest.contacts),
            scalars=tuple(
                (state.force if scalar.works else 0.0, state.value)
                for scalar, state in zip(problem.body_scalars, found.scalars, strict=True)
            ),
        ),
    )
    for scalar, state in zip(problem.body_scalars, found.scalars, strict=True):
        scalar.reach(state.value)
    problem.set_time(0.0)


def _stored(rest: Problem, found: Solution) -> float:
    """In strains, springs of contacts and elastic slip (energy); collective."""
    own = slice(rest.spaces.owned_nodes)
    works = found.displacement[own] * found.internal_force[own]
    stored = 0.5 * (float(total(rest.comm, np.sum(works))) + found.work_on_scalars)
    stored += rest.elastic.joints.energy(np.array([state.value for state in found.scalars]))
    for contact, state in zip(rest.contacts, found.states, strict=True):
        stored += float(contact.trace.integral(state.penalty_energy))
        stored += contact.work.in_elastic_slip(state) if contact.friction.stores_energy else 0.0
    return stored
