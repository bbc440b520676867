"""Puts a problem, a system and Newton's method together, and takes the problem's load steps.

All that solves does it here: a run, a study, derivatives, modes, stability, wear. What is asked of
an answer listens to the load steps, or reads what they leave; it does not change how they are
solved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.listener import StepListener
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.motion_steps import MotionSteps
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import Condense, SolverChoice, choose_solver, create_system
from fenics_contact.solve.systems.system import System


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
    kind = MotionSteps if system.problem.inertia.moves else LoadSteps
    try:
        yield kind(Newton(system.problem, system, timings, stopped), finds_body)
    finally:
        system.destroy()


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
