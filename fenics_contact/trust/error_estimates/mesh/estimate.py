"""Errors of a run's quantities by its mesh.

Five things make them. The elements cannot follow the exact displacement: local problems tell by
how much (``local_errors``), and forces that move the solution likewise tell what that does to each
quantity. The edges of contact and stick lie somewhere inside elements: as the load, or a small
change of something else, moves them through these, quantities scatter about smooth functions of
it. A peak of the contact pressure lies between what the penalty makes of gaps and what the bulk
needs. Facets miss curved surfaces, which changes gaps (``geometry_errors``). And how large a
contact is that touches in single points, no mesh as coarse tells (``single_points``).
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.contact_areas import Zones, cut_areas
from fenics_contact.evaluate.contact_radii import radii
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.quantity_names import OfPreload, Reaction
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.newton.solution import Solution
from fenics_contact.trust.error_estimates.mesh.geometry import geometry_errors
from fenics_contact.trust.error_estimates.mesh.load_scatter import load_scatter
from fenics_contact.trust.error_estimates.mesh.local_problems import LocalErrors
from fenics_contact.trust.error_estimates.mesh.pinned_friction import pinned_friction
from fenics_contact.trust.error_estimates.mesh.single_points import single_point_errors
from fenics_contact.trust.error_estimates.mesh.torn_corners import torn_errors
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Measure,
    Quantities,
    differences,
)

# Found with the paraboloid on a half-space of demos/sphere.toml, μ = 0, .1, .6, with Q2 cells of
# .07 … .28 half widths, and the annulus of demos/annulus.toml; tested on other scenes
# (``fenics-contact verify --errors``).
_LOCAL = 2.0  # of what local problems give, which see nothing beyond one degree more
_DRAWS = 2  # of signs, lest cells' errors seem to cancel
_SCATTER = 2.5  # of the scatter over loads, to be beyond most of it
_PEAK = 2.5  # of the distance between the two pressures at their peaks
_CURVED = 1.25  # of what facets miss of curved surfaces: what is left is of higher order
_EDGE = 0.15  # of the pieces that an edge passes through, to which its place is found
# Distance of the two peaks, of the peak itself, from which it may have no bound at all: under
# corners of obstacles it grows with every refinement.
_UNBOUNDED = 0.2

# Where cells are long and thin the forces leave waves, of no account but for their energy.
# What the local errors' energy ½ a(e, e) does to them, at the most.
_ENERGIES = {"strain_energy": 1.0, "external_work": 2.0}


def mesh_errors(
    load_steps: LoadSteps,
    measure: Measure,
    recorded: Sequence[tuple[float, Quantities]],
    again: Again,
    drawn: Again | None = None,
) -> tuple[dict[Hashable, float] | None, LocalErrors | None]:
    """Estimated errors of the last load step's quantities by the mesh; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; of a contact by its number and
            the name; collective.
        recorded: Pseudo-time and quantities of every load step.
        again: How answers under further forces are found, from the start or of the last step.
        drawn: The same of forces of which signs are drawn, where another way is shorter.

    Returns:
        By those keys: absolute, of vectors the length of the difference; without peaks of pressure
        that may have no bound. And the local errors they come from. None for the first where a
        solve for it failed.
    """
    problem = load_steps.problem
    if load_steps.last is None:
        return None, None
    solution = load_steps.last.solution
    load_steps.go_back()
    local = LocalErrors(problem)
    local.solve(BulkForces(problem, solution), load_steps.time)
    changes = _changes(load_steps, local, again, drawn or again)
    scatter = load_scatter(load_steps, measure, recorded)
    curved = geometry_errors(load_steps, measure)
    torn = torn_errors(load_steps, measure)
    points = single_point_errors(load_steps, measure)
    if changes is None or scatter is None or curved is None or torn is None or points is None:
        return None, local
    for name, error in local.at_points().items():
        changes[name] += error
    energy = 0.5 * local.total**2
    changes |= {name: part * energy for name, part in _ENERGIES.items() if name in changes}
    for key in _frictional_works(problem) & changes.keys():
        changes[key] += energy
    known = changes.keys() & scatter.keys() & curved.keys() & torn.keys() & points.keys()
    found = {
        key: _LOCAL * changes[key] + _SCATTER * scatter[key] + _CURVED * curved[key] + torn[key]
        for key in changes
        if key in known
    }
    for key in found:
        found[key] += points[key]
    for key, unknown in _beside_pinned(problem, solution).items():
        if key in found:
            found[key] += unknown
    for key, addition in _at_contacts(problem, solution).items():
        if addition is None:
            found.pop(key, None)
        elif key in found:
            found[key] += addition
    return found, local


def _frictional_works(problem: Problem) -> set[Hashable]:
    """Keys of the friction works that are not zero whatever the mesh."""
    found: set[Hashable] = {
        (number, "friction_work")
        for number, contact in enumerate(problem.contacts)
        if contact.friction.rubs
    }
    return found | {"friction_work"} if found else found


def _changes(
    load_steps: LoadSteps, local: LocalErrors, again: Again, drawn: Again
) -> dict[Hashable, float] | None:
    """What the local errors change, not less than what such errors would at random; collective."""
    found = []
    for draw in (None, *range(_DRAWS)):
        forces, along = local.forces(draw)
        disturb = partial(_disturb, forces, along, load_steps.time)
        way = again if draw is None else drawn
        change = differences(way.answer, way.changed(disturb))
        if change is None:
            return None
        for preload, more in zip(load_steps.problem.preloads, along, strict=True):
            key = OfPreload(preload.scene.label, "force")
            # One that is tightened to a force has it: what the errors add was taken off.
            change[key] = change[key] + abs(float(more)) if preload.is_locked else 0.0
        found.append(change)
    whole, *draws = found
    return {
        key: max(value, float(np.sqrt(np.mean([change[key] ** 2 for change in draws]))))
        for key, value in whole.items()
        if all(key in change for change in draws)
    }


def _disturb(forces: Array, along: Array, last: float, problem: Problem) -> None:
    """Add nodal forces, which grow evenly up to the last load step; collective.

    Preloads are tightened by so much less as errors add to their forces.
    """
    problem.disturbance = forces / last
    problem.tightening = -along / last
    problem.set_time(last)


def _beside_pinned(problem: Problem, solution: Solution) -> dict[Hashable, float]:
    """What is not known of forces as nodes cannot slip (``pinned_friction``); collective.

    What one contact's friction may be more, supports or another contact's pressure take.
    """
    found: dict[Hashable, float] = {}

    def add(keys: Sequence[Hashable], unknown: float) -> None:
        for key in keys:
            found[key] = found.get(key, 0.0) + unknown

    def of_contact(number: int, *names: str) -> list[Hashable]:
        return [*names, *((number, name) for name in names)]

    labels = [support.label for support in problem.applied_supports]
    for number, pinned in enumerate(pinned_friction(problem, solution)):
        add(of_contact(number, "friction_force", "contact_force"), pinned.whole)
        add(of_contact(number, "stick_area", "slip_area"), pinned.area)
        for support, unknown in pinned.at_supports.items():
            add(["reaction", Reaction(support), Reaction(labels[support])], unknown)
        for other, unknown in pinned.at_contacts.items():
            names = ("normal_force", "pressure_integral", "contact_force")
            add(of_contact(other, *names), unknown)
    return found


def _at_contacts(problem: Problem, solution: Solution) -> dict[Hashable, float | None]:
    """What is added for areas and peaks of pressure, at each contact and in all; collective.

    None for peaks that may have no bound.
    """
    forces = BulkForces(problem, solution)
    areas = {"contact_area": 0.0, "stick_area": 0.0, "slip_area": 0.0}
    added: dict[Hashable, float | None] = {}
    peaks: list[float | None] = []
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        touching, sticking = (_EDGE * cut for cut in cut_areas(contact, state))
        cuts = {"contact_area": touching, "stick_area": sticking, "slip_area": touching + sticking}
        for name, cut in cuts.items():
            added[number, name] = cut
            areas[name] += cut
        for name, cut in _radii_cut(contact, state, cuts).items():
            added[number, name] = added[name] = cut
        peaks.append(_peak_error(forces, number))
        added[number, "max_contact_pressure"] = peaks[-1]
    known = [peak for peak in peaks if peak is not None]
    of_all = max(known, default=0.0) if len(known) == len(peaks) else None
    return added | areas | {"max_contact_pressure": of_all}


def _radii_cut(
    contact: ContactSurface, state: ContactState, cuts: dict[str, float]
) -> dict[str, float]:
    """What areas at the edges are of the radii of discs, dA = 2πr dr; collective."""
    areas = {"contact_radius": "contact_area", "stick_radius": "stick_area"}
    found = radii(Zones(contact, state))
    return {name: cuts[areas[name]] / (2 * np.pi * r) for name, r in found.items() if r}


def _peak_error(forces: BulkForces, number: int) -> float | None:
    """Of the largest pressure of a contact, None if it may have no bound; collective."""
    problem, contact = forces.problem, forces.problem.contacts[number]
    if contact.normal.pressure_is_known:
        return 0.0
    peak = largest(problem.comm, forces.solution.states[number].contact_pressure)
    needed = largest(problem.comm, forces.pressure(number)[contact.trace.numbers])
    apart = abs(peak - needed)
    return None if apart > _UNBOUNDED * peak else _PEAK * apart
