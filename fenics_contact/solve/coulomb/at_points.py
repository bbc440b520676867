"""A way to Coulomb friction with penalty and smoothing: solved at the points, then confirmed.

A penalty is a give of each point, and smoothing its elastic slip: with both, the laws at the points
are those that Newton's method balances on the whole body. There each point has one of few statuses,
which converges in scenes where steps of the whole body go round in circles. ε follows from the
pressures of an answer without smoothing. At the end Newton's method on the body has to agree.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from fenics_contact.common.errors import NotConvergedError
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.at_points.exact_step import ExactSolver
from fenics_contact.solve.at_points.point_laws import why_not
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.coulomb.monolithic import solve_coupled
from fenics_contact.solve.coulomb.without_friction import set_needed
from fenics_contact.solve.newton import Newton

# Rows at the points, and unknowns, up to which it takes little beside other ways.
_FEW = 3000
# Newton steps that a scene has to allow: one try takes as many.
_STEPS = 30


def solver_at_points(newton: Newton) -> ExactSolver | None:
    """Solver for the points of small condensed problems whose laws it covers; collective.

    Args:
        newton: On a problem with Coulomb contacts.

    Returns:
        The solver, None where it does not cover the problem, would take long, or takes more steps
        than the scene allows.
    """
    system, problem = newton.system, newton.problem
    if not isinstance(system, CondensedSystem) or why_not(problem) is not None:
        return None
    if problem.scene.solver.max_iterations < _STEPS:
        return None
    solver = ExactSolver(problem, system)
    return solver if max(system.width, solver.rows) <= _FEW else None


def solve_at_points(newton: Newton, solver: ExactSolver) -> None:
    """Solve at the points, with the penalties and then ε, and confirm it on the body; collective.

    Args:
        newton: On a problem with Coulomb contacts.
        solver: Of the same.

    Raises:
        NotConvergedError: The points have no answer that is found, or the body has another one.
    """
    problem = newton.problem
    with newton.timings.phase("solve"), _laws_again(problem):
        _take(newton, solver, smoothed=False)
        for contact in problem.coulomb:
            if contact.friction.regularisation.follows_pressure:
                set_needed(contact, contact.pressure())
        _take(newton, solver, smoothed=True)
    solve_coupled(newton)


def _take(newton: Newton, solver: ExactSolver, smoothed: bool) -> None:
    """Go to the answer of the points, with the contacts' own ε₁; collective.

    Args:
        newton: On a problem with Coulomb contacts.
        solver: Of the same.
        smoothed: Whether with their ε, too; else without smoothing.

    Raises:
        NotConvergedError: None was found.
    """
    for contact in newton.problem.contacts:
        contact.take_found(None)
    parameters = {
        contact: (
            contact.penalty_parameter,
            contact.regularisation_parameter if smoothed else 0.0,
        )
        for contact in newton.problem.contacts
    }
    found = solver.solve(parameters=parameters)
    newton.steps += found.steps
    if not found.is_found:
        raise NotConvergedError(
            f"what is left of the laws of the points is {found.residual:.1e} of the forces after "
            f"{found.steps} steps",
            tuple(newton.imbalances),
        )


@contextmanager
def _laws_again(problem: Problem) -> Iterator[None]:
    """Have contacts follow their laws again at the end."""
    try:
        yield
    finally:
        for contact in problem.contacts:
            contact.take_found(None)
