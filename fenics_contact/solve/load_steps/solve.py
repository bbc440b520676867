"""All steps of a problem, with a system that is made for them and destroyed."""

from __future__ import annotations

from collections.abc import Callable

from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.motion_steps import MotionSteps
from fenics_contact.solve.newton.newton import Newton
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.solve.solver_choice import Condense, SolverChoice, choose_solver, create_system


def solve(
    problem: Problem,
    timings: Timings | None = None,
    accepted: Callable[[float, Solution], None] | None = None,
    choice: SolverChoice | None = None,
    begun: Callable[[LoadSteps], None] | None = None,
    kept: Callable[[LoadSteps], None] | None = None,
    stopped: Callable[[], bool] | None = None,
    ended: Callable[[LoadSteps], None] | None = None,
    condense: Condense | None = None,
    drive: Callable[[LoadSteps], Solution] = LoadSteps.solve,
) -> Solution:
    """Solve a problem step by step; collective.

    Args:
        problem: The problem; what its contacts remember moves on with the steps.
        timings: Seconds so far.
        accepted: As of ``LoadSteps``.
        choice: The solver; by default that of the scene and its sizes.
        begun: Called before the first step, which may be one to resume from.
        kept: As of ``LoadSteps``.
        stopped: As of ``Newton``.
        ended: Called after the last step, while the system can still be solved.
        condense: As of ``create_system``.
        drive: Takes the load steps.

    Returns:
        The solution of the last step.

    Raises:
        NotConvergedError: In words, with the history of the force imbalance.
        StoppedError: ``stopped`` said so on some rank.
    """
    timings = timings or Timings()
    choice = choice or choose_solver(problem)
    system = create_system(problem, choice, timings, condense)
    try:
        kind = LoadSteps if problem.inertia is None else MotionSteps
        load_steps = kind(Newton(problem, system, timings), accepted, kept)
        if stopped is not None:
            load_steps.newton.stopped = stopped
        if begun is not None:
            begun(load_steps)
        solution = drive(load_steps)
        if ended is not None:
            ended(load_steps)
        return solution
    finally:
        system.destroy()
