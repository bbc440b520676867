"""What results say of the model: how it is solved, and each contact's sides and parameters."""

from __future__ import annotations

from typing import Any

from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.normal import law_of
from fenics_contact.problem.problem import Problem
from fenics_contact.results.records.contacts import ContactRecord, LawAnswers
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


def record_of(contact: ContactSurface) -> ContactRecord:
    """A contact as ``result.json`` has it, before anything is known of its answer.

    Of two bodies it says whose points carry it, what stands opposite, and why it is so.
    """
    sides, law = contact.sides, law_of(contact.contact)
    of_two = sides.opposite is not None
    return ContactRecord(
        name=contact.label,
        contact=contact.contact.kind,
        law=contact.friction.kind,
        answers=LawAnswers(
            pressure_is_given=law.pressure_is_known,
            is_rigid=law.has_penalty,
            carries_shear=contact.can_shear,
        ),
        slave=sides.slave if of_two else None,
        master=sides.master if of_two else None,
        slave_reason=sides.why if of_two else None,
        parameters=_parameters_of(contact),
        quantities={},
    )


def regularisation_of(contact: ContactSurface) -> float | None:
    """The ε of a load step; None where it follows from pressures to come."""
    is_open = contact.is_coulomb and not contact.friction.is_scaled
    return None if is_open else contact.regularisation_parameter


def _parameters_of(contact: ContactSurface) -> dict[str, Any]:
    """A contact's parameters as used; what varies in space is said so."""
    scene = contact.contact
    given = contact.parameters | {"friction_coefficient": scene.friction_coefficient}
    used = {
        "regularisation_parameter": regularisation_of(contact),
        "penalty_parameter": contact.penalty_parameter or None,
        "force": contact.force,
        **{name: "varies" if callable(value) else value for name, value in given.items()},
    }
    return {name: value for name, value in used.items() if value is not None}
