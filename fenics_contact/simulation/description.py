"""What results say of the model: how it is solved, and each contact's sides and parameters."""

from __future__ import annotations

from typing import Any

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.normal import law_of
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.newton.solution import Solution


def strategy_of(problem: Problem, solution: Solution | None) -> str:
    """How friction and pressure are brought together, or were."""
    if problem.coulomb:
        chosen = problem.scene.solver.strategy
        return f"Coulomb friction: {solution.strategy if solution else chosen}"
    if any(contact.is_one_sided for contact in problem.contacts):
        return "frictionless contact: one Newton solve with a line search on the energy"
    if problem.frictional:
        return "prescribed pressure: one Newton solve, no outer loop"
    return "linear: one Newton step"


def sides_of(contact: ContactSurface) -> dict[str, str]:
    """Of two bodies, the surface whose points carry it, the one opposite, and why it is so."""
    sides = contact.sides
    if sides.opposite is None:
        return {}
    return {"slave": sides.slave, "master": sides.master, "slave_reason": sides.why}


def answers_of(contact: ContactSurface) -> dict[str, bool]:
    """What its laws answer to pages and pictures, as ``results.contact_answers`` reads it."""
    named = law_of(contact.contact)
    return {
        "pressure_is_given": named.pressure_is_known,
        "is_rigid": named.has_penalty,
        "carries_shear": contact.can_shear,
    }


def arrays_of(contact: ContactSurface) -> dict[str, list[dict[str, Any]]]:
    """What its laws keep of their own at the points, if anything, as ``results`` read it."""
    found = [array.as_dict() for array in contact.own_arrays]
    return {"arrays": found} if found else {}


def regularisation_of(contact: ContactSurface) -> dict[str, float]:
    """The ε of a load step; none where it follows from pressures to come."""
    is_open = contact.is_coulomb and not contact.friction.is_scaled
    return {} if is_open else {"regularisation_parameter": contact.regularisation_parameter}


def parameters_of(contact: ContactSurface) -> dict[str, Any]:
    """A contact's parameters as used; what varies in space is said so."""
    scene = contact.contact
    given = contact.parameters | {"friction_coefficient": scene.friction_coefficient}
    used = {
        **regularisation_of(contact),
        "penalty_parameter": contact.penalty_parameter or None,
        "force": contact.force,
        **{name: "varies" if callable(value) else value for name, value in given.items()},
    }
    return {name: value for name, value in used.items() if value is not None}
