"""Errors by the cells' geometry: what straight or quadratic facets miss of curved surfaces.

Pressures of surfaces that nearly conform follow from small differences of large gaps; bodies lack
weight, stiffness and length of sides between their facets and the curve. The last load step is
solved again with gaps as they are between surfaces that pass smoothly through the mesh's nodes
(``smooth_surface``), and with forces for what the bodies lack (``missed_body``): the difference is
the error, but for parts of higher order.
"""

from __future__ import annotations

from collections.abc import Hashable

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.problem.loads.given_load import Disturbance
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_FORCE,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    SLIP_AREA,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.trust.error_estimates.mesh.missed_body import MissedBody, MissedForces
from fenics_contact.trust.error_estimates.solving_again import (
    Measure,
    Quantities,
    differences,
    last_step_again,
)

# Of the extent of a contact: what is missed is round-off of the nodes.
_NONE = 1e-12
# What goes with the length of a surface; and with its pressure's integral where that is given.
_AREAS = (CONTACT_AREA, STICK_AREA, SLIP_AREA)
_OF_PRESSURE = (PRESSURE_INTEGRAL, FRICTION_FORCE, FRICTION_WORK)
_ALL = (*_AREAS, *_OF_PRESSURE)


def geometry_errors(load_steps: LoadSteps, measure: Measure) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the geometry; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; collective.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        other gaps and forces was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    answer = measure(solution)
    gaps, body = _missed_gaps(problem), MissedBody(problem)
    forces = None if body.is_none else body.forces(solution, load_steps.time)
    found: dict[Hashable, float] | None = dict.fromkeys(answer, 0.0)
    if gaps or forces is not None:
        found = differences(answer, _again(load_steps, measure, gaps, forces))
    if found is None:
        return None
    for key, error in _beside_forces(answer, body, forces, load_steps).items():
        if key in found:
            found[key] += error
    return found


def _missed_gaps(problem: Problem) -> list[tuple[ContactSurface, Array]]:
    """Contacts with what their gaps are too wide by, if it is more than nothing; collective."""
    one_sided = [contact for contact in problem.contacts if contact.is_one_sided]
    missed = [(contact, contact.kinematics.missed()) for contact in one_sided]
    sizes = [largest(problem.comm, np.abs(one)) / c.trace.extent() for c, one in missed]
    return missed if max(sizes, default=0.0) > _NONE else []


def _again(
    load_steps: LoadSteps,
    measure: Measure,
    gaps: list[tuple[ContactSurface, Array]],
    forces: MissedForces | None,
) -> Quantities | None:
    """Quantities with other gaps, and under further forces; collective."""
    before = [contact.kinematics.gap for contact, _ in gaps]
    time = load_steps.time

    def narrow(problem: Problem) -> None:
        if forces is not None:
            problem.disturbance = Disturbance.growing(forces.nodal, time)
            problem.set_time(time)
        for (contact, one), gap in zip(gaps, before, strict=True):
            contact.set_gap(gap - one)

    try:
        return last_step_again(load_steps, measure, narrow)
    finally:
        for (contact, _), gap in zip(gaps, before, strict=True):
            contact.set_gap(gap)


def _beside_forces(
    answer: Quantities, body: MissedBody, forces: MissedForces | None, load_steps: LoadSteps
) -> dict[Hashable, float]:
    """Return the missed parts of quantities, besides those that move the solution; collective."""
    found: dict[Hashable, float] = {}
    if forces is not None:
        energy = abs(forces.elastic) / 2
        found = {STRAIN_ENERGY: energy, EXTERNAL_WORK: 2 * energy + abs(forces.loads)}
    for number in range(len(load_steps.problem.contacts)):
        sizes = {name: float(np.linalg.norm(answer.get((number, name), 0.0))) for name in _ALL}
        longer = body.longer(number)
        errors = {name: longer * sizes[name] for name in _AREAS}
        pressure = None if forces is None else body.of_pressure(number, load_steps.time)
        if pressure is not None:
            errors |= {name: pressure.share * sizes[name] for name in _OF_PRESSURE}
            errors[NORMAL_FORCE] = pressure.force
            errors[CONTACT_FORCE] = pressure.force + errors[FRICTION_FORCE]
        for name, error in errors.items():
            found[number, name] = error
            found[name] = found.get(name, 0.0) + error
    return found
