"""What Newton's method has found, read from its present state."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fenics_contact.solve.newton.solution import Solution

if TYPE_CHECKING:
    from fenics_contact.solve.newton.newton import Newton


def solution_of(newton: Newton, outer_iterations: int, strategy: str) -> Solution:
    """The present state as a solution; collective.

    Args:
        newton: After a solve.
        outer_iterations: Passes of a loop on the pressure.
        strategy: Which way to Coulomb friction it was.
    """
    with newton.timings.phase("solve"):
        find_body = newton.system.finish()
    for contact in newton.problem.contacts:
        contact.touch()
    problem = newton.problem
    scalars = problem.scalar_states(find_body().displacement) if problem.body_scalars else ()
    return Solution(
        find_body=find_body,
        normal_force=[c.forces.of(c.normal_term)[c.trace.numbers] for c in problem.contacts],
        friction_force=[c.forces.of(c.friction_term)[c.trace.numbers] for c in problem.contacts],
        friction_bound=[contact.friction.bound.copy() for contact in problem.contacts],
        states=[contact.state() for contact in problem.contacts],
        residual_history=tuple(newton.imbalances),
        newton_iterations=newton.steps,
        outer_iterations=outer_iterations,
        strategy=strategy,
        imbalance_limit=newton.limit,
        factorisations=newton.system.factorisations,
        scalars=scalars,
    )
