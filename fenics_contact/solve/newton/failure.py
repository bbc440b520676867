"""Solves by Newton's method that did not end well: what happened, and what to try, in words."""

from __future__ import annotations

from collections.abc import Sequence

from fenics_contact.common.parallel import largest
from fenics_contact.contact.noise import all_round_off
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions
from fenics_contact.solve.newton.status_cycling import Chatter
from fenics_contact.solve.systems.system import System

# PETSc's reasons, whose names differ between versions.
NO_SOLVE = -3
NOT_A_NUMBER = -4
NO_STEP_FOUND = -6
GROWS = -9
GIVEN_UP = -10
_REASONS = {
    NO_SOLVE: "the linear system could not be solved (a singular matrix: is the body held?)",
    NOT_A_NUMBER: "the forces became infinite or not a number",
    -5: "the Newton steps allowed were used up",
    NO_STEP_FOUND: "the line search found no step",
    GROWS: "the force imbalance grows",
    GIVEN_UP: "pressures are far from those that the regularisation was chosen for",
}
# Newton steps by which an imbalance is judged to fall or not.
_LATEST = 20
# Of the forces: an imbalance that may be round-off.
_SMALL_REST = 1e-3
# Of the forces: an imbalance that is round-off, and yet makes an answer worthless.
_OUT_OF_BALANCE = 2e-3
_RUNAWAY = 1e3  # of the body's size


def not_converged(
    problem: Problem, imbalances: Sequence[float], forces: float, reason: int, chatter: Chatter
) -> str:
    """A solve that ended without an answer; collective.

    Args:
        problem: The model.
        imbalances: Force imbalance before every Newton step of the solve, and at its end (force).
        forces: What these are small against (force).
        reason: PETSc's.
        chatter: What contact points did in the last steps.
    """
    words = _REASONS.get(reason, f"PETSc's reason {reason}")
    left = f"{imbalances[-1]:.2e}" if imbalances else "unknown"
    advice = "Try a larger solver.max_iterations, or a finer mesh at the contact"
    if problem.frictional:
        advice = "Try a larger solver.max_iterations, or a larger regularisation_parameter"
    if RigidMotions(problem).slides_on_coulomb:
        advice = (
            "Only friction holds a body back here: the loads may be more than it can hold, "
            "and then there is no answer"
        )
    if _is_falling(imbalances):
        advice = "It was still falling: try a larger solver.max_iterations"
    elif imbalances and imbalances[-1] <= _SMALL_REST * forces:
        advice = (
            "So small a rest may be round-off: is a penalty_parameter too small, or the "
            "contrast of stiffnesses extreme?"
        )
    return (
        f"not converged after {max(len(imbalances) - 1, 0)} Newton steps: {words}; the force "
        f"imbalance is {left} of {forces:.3g}{chatter.words('Newton steps')}. {advice}"
    )


def _is_falling(imbalances: Sequence[float]) -> bool:
    """Whether the last steps have brought the imbalance down."""
    recent = imbalances[-_LATEST:]
    return len(recent) == _LATEST and recent[-1] < 0.8 * min(recent[: _LATEST // 2])


def runaway(problem: Problem, system: System) -> str | None:
    """No answer of linear elasticity is a thousand times the body away from its start; collective.

    Returns:
        What to say of one that is; None where none is.
    """
    if system.moved() <= _RUNAWAY * problem.spaces.size:
        return None
    if problem.coulomb and RigidMotions(problem).count:
        return (
            "the body runs away: displacements are more than a thousand times its size; friction "
            "is to hold what supports leave free, and the loads may be more than it can hold"
        )
    return (
        "the body runs away: displacements are more than a thousand times its size; is it "
        "held, and are loads and stiffness in the same units?"
    )


def lost_in_roundoff(problem: Problem, left: float, forces: float) -> str | None:
    """No answer is one of which round-off in the stiff springs leaves a part open; collective.

    Round-off is accepted as such by the size of the springs, not of the forces.

    Args:
        problem: The model; its contacts are in the state to judge.
        left: Force imbalance (force).
        forces: What it is small against (force).

    Returns:
        What to say of such an answer; None of others.
    """
    pushing = [contact for contact in problem.contacts if contact.is_one_sided]
    touches = any([largest(problem.comm, contact.pressure()) > 0 for contact in pushing])
    if not touches or left <= _OUT_OF_BALANCE * forces or forces <= 0:
        return None
    if all_round_off(problem.contacts, forces):  # moved along: there is nothing to drown
        return None
    return (
        f"round-off drowns the contact: {left:.2e} of forces of {forces:.3g} are out of "
        "balance for good; a larger penalty_parameter, or less contrast of stiffnesses, "
        "would leave less"
    )
