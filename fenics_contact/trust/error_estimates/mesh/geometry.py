"""Errors by the cells' geometry: what straight or quadratic facets miss of curved surfaces.

Pressures of surfaces that nearly conform follow from small differences of large gaps; bodies lack
weight, stiffness and length of sides between their facets and the curve. The last load step is
solved again with gaps as they are between surfaces that pass smoothly through the mesh's nodes
(``smooth_surface``), and with forces for what the bodies lack (``missed_body``): the difference is
the error, but for parts of higher order.

Part of a given contact pressure that a mesh misses. Between its nodes a function is interpolated,
and so are normals: at the ends of a curved surface these are those of the last facet. The pressure
as it is given acts on facets, and on what these miss of a curve.

Parts of a body and its loads that a mesh misses, as forces and energies. That is what lies between
facets and the curves that they stand for, and what functions that loads are given by are between
nodes.

A body with straight cells lacks its own weight there, stiffness, and length of sides that loads
act on. Where the curve lies outside of facets by d, ½ a(v, v) lacks ½ ∫ d σ(v) : e(v) on them,
but for higher order. Where a side is held, displacements vanish on the curve and not on facets:
that is so much less, not more.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.evaluate.contact_quantities import resultant
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad
from fenics_contact.problem.loads.disturbance import Disturbance
from fenics_contact.problem.loads.given_values import Pressure
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_FORCE,
    EXTERNAL_WORK,
    FRICTION_FORCE,
    FRICTION_WORK,
    HEAT_FLOW,
    NORMAL_FORCE,
    PRESSURE_INTEGRAL,
    SLIP_AREA,
    STICK_AREA,
    STRAIN_ENERGY,
)
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.error_estimates.mesh.heat_problems import missed_heat
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Quantities,
)


@dataclass(frozen=True)
class MissedPressure:
    """Missed part of one contact's given pressure.

    Attributes:
        nodal: Forces, (nodes, components) (force).
        force: The length of their sum (force).
        share: By how much more the pressure's integral is, over what it is.
    """

    nodal: Array
    force: float
    share: float


def missed_pressure(
    contact: ContactSurface, sides: CurvedSides, time: float
) -> MissedPressure | None:
    """Return the missed part of a contact's given pressure; collective.

    Returns:
        None where the pressure is not given, or where it is one number on a flat surface.
    """
    spaces, group, given = contact.spaces, contact.trace.group, contact.contact.pressure
    if given is None or not contact.normal.loads:
        return None
    is_curved = total(spaces.comm, int(sides.within(group).sum())) > 0
    load = Pressure(group, spaces, "contact.pressure", None, (given,))
    if load.is_constant and not is_curved:
        return None
    load, test = load.as_given(), ufl.TestFunction(spaces.displacement_space)
    surface, (form, path) = contact.trace.surface, contact.normal.loads[0]
    factor = path(time)
    nodal = spaces.assemble(form_cache.form(load.work(test)))
    nodal -= surface.on_body(surface.assemble(form))
    whole = spaces.weight * load.value * spaces.boundary(group)
    parts = [float(fem.assemble_scalar(form_cache.form(whole)))]
    if is_curved:
        nodal += spaces.assemble(form_cache.form(load.missed_work(test, sides)))
        more = spaces.weight * load.value * sides.stretch * sides.measure(sides.within(group))
        parts.append(float(fem.assemble_scalar(form_cache.form(more))))
    present = float(contact.trace.integral(contact.pressure()))
    true = factor * float(total(spaces.comm, sum(parts)))
    return MissedPressure(
        factor * nodal,
        abs(factor) * float(np.linalg.norm(resultant(spaces, nodal[: spaces.owned_nodes]))),
        abs(true - present) / (abs(present) or 1.0),
    )


@dataclass(frozen=True)
class MissedForces:
    """Forces of the missed parts, and their work on a solution.

    Attributes:
        nodal: All forces, (nodes, components) (force).
        elastic: Work of those by missed stiffness on the displacement (energy).
        loads: Work of those by missed loads on it (energy).
        heat: Missed heat at the nodes of all ranks, (nodes,) (power); None where none flows.
    """

    nodal: Array
    elastic: float
    loads: float
    heat: Array | None


class MissedBody:
    """Parts of a body and its loads that the mesh misses; collective.

    The outer boundary of a half-space is none of a body's: it moves as the far field does there.

    Args:
        problem: The model.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        outer = problem.scene.half_space
        names = () if outer is None else outer.on
        groups = [problem.body.group(name, "half_space.on") for name in names]
        self._sides = CurvedSides(problem.spaces, groups)

    @property
    def is_none(self) -> bool:
        """Whether nothing is missed."""
        problem = self._problem
        functions = not all(load.acting.is_constant for load in problem.loads)
        functions |= any(callable(contact.pressure) for contact in problem.scene.contact)
        functions |= any(callable(heat.flux) for heat in problem.scene.heat)
        return self._sides.offset is None and not functions

    def forces(self, solution: Solution, time: float) -> MissedForces:
        """Forces that move a solution as what is missed does; collective.

        Args:
            solution: Of the problem, which is in its state.
            time: Its pseudo-time.
        """
        spaces, moved = self._problem.spaces, solution.displacement
        loads = np.zeros_like(moved)
        for load in self._problem.loads:
            loads += load.path(time) * self._of_load(load.acting)
        for number in range(len(self._problem.contacts)):
            pressure = self.of_pressure(number, time)
            loads += 0.0 if pressure is None else pressure.nodal
        elastic = np.zeros_like(moved) if self._sides.offset is None else self._elastic()
        owned = slice(0, spaces.owned_nodes)
        works = [np.sum((moved * found)[owned]) for found in (elastic, loads)]
        done = total(self._problem.comm, np.array(works))
        heat = missed_heat(self._problem, self._sides)
        return MissedForces(elastic + loads, float(done[0]), float(done[1]), heat)

    def _of_load(self, load: ActingLoad) -> Array:
        """Nodal forces of a load missed, where its path is 1."""
        spaces = self._problem.spaces
        test = ufl.TestFunction(spaces.displacement_space)
        found = np.zeros_like(self._problem.load)
        if not load.is_constant:
            for sign, whole in ((1.0, load.as_given()), (-1.0, load)):
                found += sign * spaces.assemble(form_cache.form(whole.work(test)))
        if self._sides.offset is not None:
            found += load.missed(self._sides)
        return found

    def of_pressure(self, number: int, time: float) -> MissedPressure | None:
        """Return the missed part of a contact's given pressure; None for nothing; collective."""
        return missed_pressure(self._problem.contacts[number], self._sides, time)

    def longer(self, number: int) -> float:
        """How far a contact's surface is from what its points stand for, over this; collective.

        By what cells miss of a curve, and by what the rule of the points misses of curved cells:
        Simpson's rule of a parabola through three points of a circle falls short by as much as this
        parabola does, so that counts twice.
        """
        spaces, sides = self._problem.spaces, self._sides
        if sides.offset is None and spaces.geometry_order == 1:
            return 0.0
        trace = self._problem.contacts[number].trace
        parts = [spaces.weight * spaces.boundary(trace.group)]
        if sides.offset is not None:
            within = sides.measure(sides.within(trace.group))
            parts.append(spaces.weight * sides.stretch * within)
        found = [float(fem.assemble_scalar(form_cache.form(part))) for part in parts]
        whole, *more = total(self._problem.comm, np.array(found))
        missed = 2 * abs(whole - trace.area) + abs(sum(more))
        return float(missed / trace.area)

    def _elastic(self) -> Array:
        """Nodal forces of the stiffness missed, in the state of the solution."""
        problem, sides = self._problem, self._sides
        spaces, elastic = problem.spaces, problem.elastic
        test = ufl.TestFunction(spaces.displacement_space)
        density = spaces.weight * sides.offset
        density *= ufl.inner(elastic.stress(), elastic.strain(test))
        held = sides.held(problem.free) | self._glued()
        of_held, of_others = (
            spaces.assemble(form_cache.form(density * sides.measure(chosen)))
            for chosen in (held, ~held)
        )
        return of_held - of_others

    def _glued(self) -> Flags:
        """Return for each facet whether it is glued to an obstacle."""
        found = np.zeros(len(self._sides.facets), dtype=bool)
        for contact in self._problem.contacts:
            if contact.normal.sticks and contact.contact.obstacle is not None:
                found |= self._sides.within(contact.trace.group)
        return found


# Of the extent of a contact: what is missed is round-off of the nodes.
_NONE = 1e-12
# What goes with the length of a surface; and with its pressure's integral where that is given.
_AREAS = (CONTACT_AREA, STICK_AREA, SLIP_AREA)
_OF_PRESSURE = (PRESSURE_INTEGRAL, FRICTION_FORCE, FRICTION_WORK)
_ALL = (*_AREAS, *_OF_PRESSURE, HEAT_FLOW)


def geometry_errors(load_steps: LoadSteps, again: Again) -> dict[Hashable, float] | None:
    """Estimated errors of the last load step's quantities by the geometry; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        again: How the answer to its last one is found with something changed.

    Returns:
        By quantity: absolute, of vectors the length of the difference; None where the answer with
        other gaps and forces was not found.
    """
    assert load_steps.last is not None
    problem, solution = load_steps.problem, load_steps.last.solution
    answer = again.answer
    gaps, body = _missed_gaps(problem), MissedBody(problem)
    forces = None if body.is_none else body.forces(solution, load_steps.time)
    found: dict[Hashable, float] | None = dict.fromkeys(answer, 0.0)
    if gaps or forces is not None:
        found = _again(load_steps, again, gaps, forces)
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
    again: Again,
    gaps: list[tuple[ContactSurface, Array]],
    forces: MissedForces | None,
) -> dict[Hashable, float] | None:
    """What other gaps and further forces change; collective."""
    before = [contact.kinematics.gap for contact, _ in gaps]
    time = load_steps.time

    def narrow(share: float, problem: Problem) -> None:
        if forces is not None:
            problem.disturbance = Disturbance.growing(share * forces.nodal, time)
            if problem.conduction is not None and forces.heat is not None:
                problem.conduction.disturb(share * forces.heat, time)
            problem.set_time(time)
        for (contact, one), gap in zip(gaps, before, strict=True):
            contact.set_gap(gap - share * one)

    try:
        return again.effects(narrow)
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
        errors = {name: longer * sizes[name] for name in (*_AREAS, HEAT_FLOW)}
        pressure = None if forces is None else body.of_pressure(number, load_steps.time)
        if pressure is not None:
            errors |= {name: pressure.share * sizes[name] for name in _OF_PRESSURE}
            errors[NORMAL_FORCE] = pressure.force
            errors[CONTACT_FORCE] = pressure.force + errors[FRICTION_FORCE]
        for name, error in errors.items():
            found[number, name] = error
            found[name] = found.get(name, 0.0) + error
    return found
