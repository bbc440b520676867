"""Errors by what the method adds: penalty, regularisation, the meshed piece of a half-space.

Errors by what the method adds to the problem: penalty, regularisation, and the solver's rest.
Quantities depend on ε₁ and on ε smoothly, at first order where these are small (paper, Section 4;
Theorem 2.4): Q(ε) = Q + c ε + …. The answer with a small part of the parameter is a few Newton
steps away, and nearly all of the error is gone there. So the difference is the error. Where that
is large the leading order says little, as where most points only creep, and a still smaller
parameter is tried.

Errors by the piece of a half-space that is meshed: what its boundary leaves out. The outer
boundary moves as under the resultants of the contacts' forces. Here it moves as under the forces
where they act: with their moments, also those of friction that has no resultant. That is the
half-space's displacement but for what the change itself does to the forces, which is smaller by as
much again.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Hashable
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import NotConvergedError
from fenics_contact.common.parallel import gather_rows
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    FRICTION_FORCE,
    MAX_CONTACT_PRESSURE,
    PRESSURE_INTEGRAL,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Measure,
    Quantities,
    begin_at_answer,
    differences,
    last_step_again,
    newton_again,
)

logger = logging.getLogger(__name__)

# The part of ε₁ and ε that is left: enough less for what is left of the error to be small, also
# beyond the leading order, and not so little that round-off of forces, gap over ε₁, shows.
_LEFT = 1 / 32
# What is beyond the leading order, where no more than that is found.
_BEYOND = 1.25
# Share from which an error is large; of these quantities, over the second of each pair, those of
# each contact and those of all.
_LARGE = 1e-2
_OF_A_CONTACT = (
    (PRESSURE_INTEGRAL, PRESSURE_INTEGRAL),
    (FRICTION_FORCE, PRESSURE_INTEGRAL),
)
_OF_ALL = (
    (MAX_CONTACT_PRESSURE, MAX_CONTACT_PRESSURE),
    (CONTACT_AREA, CONTACT_AREA),
    (STICK_AREA, CONTACT_AREA),
    (STRAIN_ENERGY, STRAIN_ENERGY),
)
# Of the solver's tolerance, for what its rest makes; of that of temperatures, the same.
_SHARPER, _SETTLED = 1e-3, 1e-2

Errors = dict[Hashable, float]
Reduce = Callable[[float, Problem], None]


def penalty_errors(load_steps: LoadSteps, again: Again) -> Errors | None:
    """Estimated errors by the penalties ε₁; foundations are as they are; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: How the answer with less of it is found.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        another ε₁ was not found.
    """
    return _parameter_errors(load_steps, again, _stiffen)


def regularisation_errors(load_steps: LoadSteps, again: Again) -> Errors | None:
    """Estimated errors by the ε of friction; all else as of ``penalty_errors``.

    Where points stick they creep anew in every load step.
    """
    return _parameter_errors(load_steps, again, _regularise_less, again.stands_for)


def iteration_errors(load_steps: LoadSteps, measure: Measure) -> Errors | None:
    """Estimated errors by the accepted imbalance and by the loop on the pressure; collective.

    Newton's method goes on from the answer, with a sharper tolerance, on contact and friction
    together: that also finds what a loop has left. Where it fails, one more pass of the loop is
    made, and what further ones would add follows from the loop's contraction.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        As ``penalty_errors``.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    found = _sharper(load_steps, measure)
    if found is not None:
        return differences(answer, found)
    contraction = load_steps.last.solution.contraction
    if contraction is None or contraction >= 1:
        return None
    return differences(answer, _one_more_pass(load_steps, measure), 1 / (1 - contraction))


def _parameter_errors(
    load_steps: LoadSteps, again: Again, reduce: Reduce, factor: float = 1.0
) -> Errors | None:
    found: Errors | None = None
    if again.share < 1:
        by_share = partial(_by_share, reduce)
        leading = again.effects(by_share, factor=_BEYOND * again.stands_for)
        return None if leading is None else _in_series(leading, again.answer)
    for left in (_LEFT, _LEFT**2):
        other = again.changed(partial(reduce, left), None)
        if other is None:
            return found
        # At leading order all is 1 / (1 − left) of what is gone; beyond it, as little more.
        found = differences(again.answer, other, factor / (1 - left) ** 2)
        if found is None or _all_small(found, again.answer, len(load_steps.problem.contacts)):
            break
    return found


def _in_series(leading: Errors, answer: Quantities) -> Errors:
    """Return errors from those at leading order, as where a penalty is a spring in series.

    A force Q = Q₀/(1 + c ε) is off by e/(1 − e/Q), e being its error at leading order; of such as
    are half of the quantity no more than twice is known.

    Args:
        leading: By quantity.
        answer: Likewise.
    """
    found: Errors = {}
    for key, error in leading.items():
        size = float(np.linalg.norm(answer[key]))
        found[key] = error / (1 - min(error / size, 0.5)) if size > 0 else error
    return found


def _by_share(reduce: Reduce, share: float, problem: Problem) -> None:
    """Take a share of a parameter off."""
    reduce(1 - share, problem)


def _all_small(found: Errors, answer: Quantities, contacts: int) -> bool:
    telling: list[tuple[Hashable, Hashable]] = list(_OF_ALL)
    for number in range(contacts):
        telling += [((number, a), (number, b)) for a, b in _OF_A_CONTACT]
    return all(found[a] <= _LARGE * np.abs(answer[b]) for a, b in telling)


def _stiffen(left: float, problem: Problem) -> None:
    for contact in problem.contacts:
        contact.normal.penalty.soften(left)


def _regularise_less(left: float, problem: Problem) -> None:
    for contact in problem.frictional:
        contact.friction.regularisation.scale(left)


def _sharper(load_steps: LoadSteps, measure: Measure) -> Quantities | None:
    """Return quantities after more Newton steps; None where these lead away; collective."""
    assert load_steps.last is not None
    newton = load_steps.newton
    begin_at_answer(load_steps)
    newton.begin.from_last_step()
    try:
        try:
            tolerance = _SHARPER * load_steps.problem.scene.solver.tolerance
            way = partial(newton_again, load_steps, tolerance)
            solution = load_steps.settled(way, _SETTLED)
        except NotConvergedError as error:
            logger.debug("  a sharper tolerance: %s", error)
            # Round-off may let it come no nearer: so it is as near as can be.
            if (
                not newton.imbalances
                or newton.imbalances[-1] > load_steps.last.solution.imbalance_limit
            ):
                return None
            solution = newton.solution()
        return measure(solution)
    finally:
        load_steps.go_back()


def _one_more_pass(load_steps: LoadSteps, measure: Measure) -> Quantities | None:
    """Return quantities after one more pass with the bound of the answer's pressure; collective."""
    newton = load_steps.newton
    begin_at_answer(load_steps)
    newton.begin.from_last_step()
    try:
        for contact in load_steps.problem.coulomb:
            contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
        return measure(load_steps.settled(partial(_passed, newton)))
    except NotConvergedError as error:
        logger.debug("  one more pass: %s", error)
        return None
    finally:
        load_steps.go_back()


def _passed(newton: Newton) -> Solution:
    """The solution with the bounds of friction there are; collective."""
    newton.run(False)
    return newton.solution()


def domain_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the truncation; collective.

    Args:
        load_steps: Of a scene with a half-space, at its end; it is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        the other boundary was not found.
    """
    assert load_steps.last is not None
    answer = measure(load_steps.last.solution)
    beyond = _left_out(load_steps.problem, load_steps.last.solution)
    time = load_steps.time

    def move_boundary(problem: Problem) -> None:
        assert problem.far_field is not None
        problem.far_field.beyond[:] = beyond
        problem.set_time(time)

    return differences(answer, last_step_again(load_steps, measure, move_boundary))


def _left_out(problem: Problem, solution: Solution) -> Array:
    """Displacement of the outer boundary that the resultants leave out, (dofs,); collective."""
    far_field = problem.far_field
    assert far_field is not None
    found = np.zeros(len(far_field.dofs))
    components = problem.spaces.components
    pairs = zip(problem.contacts, solution.contact_force, strict=True)
    for number, (contact, force) in enumerate(pairs):
        rows = np.zeros((len(contact.nodes), 6))
        rows[:, :3] = problem.spaces.coordinates[contact.nodes]
        rows[:, 3 : 3 + components] = force
        rows = gather_rows(problem.comm, rows[contact.owned_nodes & force.any(axis=1)])
        found += far_field.left_out(number, rows[:, :3], rows[:, 3:])
    return found
