"""The laws of a contact, as an exact solver at the points takes them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.laws.friction.rule import BoundOfPressure
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.at_points.contact_points import ContactPoints
from fenics_contact.solve.exact.local_problem import (
    BONDED,
    COULOMB,
    GIVEN,
    NONE,
    UNILATERAL,
    BoundRule,
    PointLaws,
)


def why_not(problem: Problem) -> str | None:
    """Name the part of a problem that the exact solver does not cover; None where it covers all."""
    if problem.inertia.moves:
        return "motion"
    if problem.conduction is not None:
        return "heat through contacts"
    if problem.discrete.cut is not None:
        return "cyclic symmetry"
    if problem.elastic.joints.has_stops:
        return "springs with a gap"
    for contact in problem.contacts:
        if contact.forces.terms and (found := _not_here(contact)) is not None:
            return f"{found} at '{contact.label}'"
    return None


def _not_here(contact: ContactSurface) -> str | None:
    """Name the law of a contact that the exact solver does not cover; None where it covers all."""
    normal, friction = contact.normal, contact.friction
    if normal.sticks and contact.contact.penalty_parameter not in ("auto", 0):
        return "glue with a penalty_parameter above 0"
    if not (normal.has_penalty or normal.pressure_is_known):
        return normal.called
    if friction.has_friction and (friction.neighbours is not None or friction.rule.follows_speed):
        return friction.called
    if contact.wear.wears:
        return "wear"
    if contact.gap_follows_angle:
        return "an obstacle that a moment turns"
    return None


def laws_of(points: Sequence[ContactPoints]) -> PointLaws:
    """The laws of all points, on every rank; collective.

    Args:
        points: Those of each contact.
    """
    columns = [_of_contact(one) for one in points]
    coefficient, across, along, fixed, elastic = map(np.concatenate, zip(*columns, strict=True))
    give = [
        one.contact.penalty_parameter * one.contact.is_one_sided / one.weights for one in points
    ]
    return PointLaws(
        coefficient=coefficient,
        across=across,
        along=along,
        bound=_bounds_of(points, coefficient),
        fixed_bound=fixed,
        given_force=np.zeros(len(fixed)),
        series_compliance=np.concatenate(give),
        elastic_slip=elastic,
    )


def _bounds_of(points: Sequence[ContactPoints], coefficient: Array) -> BoundRule | None:
    """Bounds where those of some contact are no multiple of the force; else None; collective.

    Args:
        points: Those of each contact.
        coefficient: Of all points, where they are.
    """
    parts: list[tuple[slice, Array, BoundOfPressure]] = []
    first = 0
    for one in points:
        friction, part = one.contact.friction, slice(first, first + one.count)
        first = part.stop
        if one.contact.is_coulomb and not friction.rule.is_linear:
            parts.append((part, one.weights, friction.rule.of_points(one.of_all_ranks)))
    if not parts:
        return None

    def bound(forces: Array) -> tuple[Array, Array]:
        found, slope = coefficient * forces, coefficient.copy()
        for part, areas, of_pressure in parts:
            stress, slope[part] = of_pressure(forces[part] / areas)
            found[part] = stress * areas
        return found, slope

    return bound


def _of_contact(points: ContactPoints) -> tuple[Array, Array, Array, Array, Array]:
    """Coefficients, laws across and along, bounds that are fixed (force), and elastic slips."""
    contact, count = points.contact, points.count
    normal, friction = contact.normal, contact.friction
    everywhere = np.ones(len(contact.trace.weights))
    fixed, elastic = np.full(count, np.nan), np.zeros(count)
    coefficient = np.zeros(count)
    across, along = UNILATERAL, NONE
    if normal.sticks:
        across, along = BONDED, BONDED
    elif normal.pressure_is_known:
        across = GIVEN
    if friction.has_friction:
        along = COULOMB
        if normal.pressure_is_known:
            fixed = points.of_all_ranks(friction.bound) * points.weights
        else:
            coefficient = points.of_all_ranks(friction.bound_of(everywhere))
        elastic = np.full(count, contact.regularisation_parameter)
    return coefficient, np.full(count, across), np.full(count, along), fixed, elastic
