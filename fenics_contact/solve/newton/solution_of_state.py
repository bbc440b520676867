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
    nodes = [contact.trace.numbers for contact in newton.problem.contacts]
    normal = newton.system.contact_forces("normal")
    friction = newton.system.contact_forces("friction_term")
    problem = newton.problem
    scalars = problem.scalar_states(find_body().displacement) if problem.body_scalars else ()
    return Solution(
        find_body=find_body,
        normal_force=[force[n] for force, n in zip(normal, nodes, strict=True)],
        friction_force=[force[n] for force, n in zip(friction, nodes, strict=True)],
        friction_bound=[contact.friction.bound.copy() for contact in newton.problem.contacts],
        states=[contact.state() for contact in newton.problem.contacts],
        residual_history=tuple(newton.imbalances),
        newton_iterations=newton.steps,
        outer_iterations=outer_iterations,
        strategy=strategy,
        imbalance_limit=newton.limit,
        factorisations=newton.system.factorisations,
        scalars=scalars,
    )
