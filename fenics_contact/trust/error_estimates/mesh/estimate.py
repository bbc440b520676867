"""Errors of a run's quantities by its mesh.

Five things make them. The elements cannot follow the exact displacement: local problems tell by
how much (``local_problems``), and forces that move the solution likewise tell what that does to
each quantity. The edges of contact and stick lie somewhere inside elements: as the load, or a small
change of something else, moves them through these, quantities scatter about smooth functions of
it. A peak of the contact pressure lies between what the penalty makes of gaps and what the bulk
needs. Facets miss curved surfaces, which changes gaps (``geometry``). And how large a
contact is that touches in single points, no mesh as coarse tells (``singular_places``), nor what a
surface does where an obstacle sinks in between its points (``unseen_zones``), or ends there
(``singular_places``).

What the last of these tells of an edge's or a peak's place is added to the others as an independent
error is, by the sum of squares: the one has no reason to come with the other. All else goes in full
on top of that, as of forces below a sphere both parts may have the same cause.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from functools import partial

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.evaluate.contact_areas import Zones, contact_area, cut_areas, radii, stick_area
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.quantities.names import (
    CONTACT_AREA,
    CONTACT_RADIUS,
    EXTERNAL_WORK,
    FRICTION_WORK,
    HEAT_FLOW,
    MAX_CONTACT_PRESSURE,
    MAX_TEMPERATURE,
    SLIP_AREA,
    STICK_AREA,
    STICK_RADIUS,
    STRAIN_ENERGY,
    TEMPERATURE_OF_POINTS,
)
from fenics_contact.scene.loading.load_paths import cycles_of
from fenics_contact.scene.quantity_names import LossOfCycle
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.systems.solution import Solution
from fenics_contact.trust.convergence.unseen import unseen_depth_errors
from fenics_contact.trust.error_estimates.measured import TOO_STIFF, HeldBack, OfCycles
from fenics_contact.trust.error_estimates.mesh.edge_places import edge_place_errors
from fenics_contact.trust.error_estimates.mesh.followed_loads import FollowedLoads, drawn_forces
from fenics_contact.trust.error_estimates.mesh.geometry import geometry_errors
from fenics_contact.trust.error_estimates.mesh.load_scatter import load_scatter, piece_share
from fenics_contact.trust.error_estimates.mesh.local_problems import ForcesOfErrors, LocalErrors
from fenics_contact.trust.error_estimates.mesh.singular_places import (
    obstacle_edge_errors,
    single_point_errors,
    torn_errors,
    touches_in_points,
)
from fenics_contact.trust.error_estimates.mesh.unseen_zones import unknown_by_pinned, unseen_zones
from fenics_contact.trust.error_estimates.solving_again import (
    Again,
    Measure,
    Quantities,
)

# Weighed with all cases of ``fenics-contact verify --errors``, those that test included, and 60
# scenes at random; tested on scenes drawn afterwards.
# Of what local problems give, by degree: they see nothing beyond one degree more, which beside
# corners is less of the error the higher that is.
_LOCAL = {1: 1.75, 2: 2.0}
_DRAWS = 2  # of signs, lest cells' errors seem to cancel
_DRAWS_BY_TANGENTS = 1  # the same where that takes all load steps once more
_SCATTER = 2.5  # of the scatter over loads, to be beyond most of it
_PEAK = 2.5  # of the distance between the two pressures at their peaks
_CURVED = 1.25  # of what facets miss of curved surfaces: what is left is of higher order
# Of the pieces that an edge passes through, to which its place is found by the fields of a smooth
# edge. These are of first order in the distance from it, so that is less where pieces are smaller
# than this share of the zone.
_EDGE, _CLOSE = 0.15, 0.2
# All is of the leading order: with an edge that may be half a piece from where it is found, that is
# of more doubt the larger the piece is beside its zone, up to this factor. Not so of contacts that
# touch in single points, of which that is estimated.
_HALF, _MOST = 0.5, 3.0
# Nor of energies: the potential energy is least at the answer, so that an edge's place changes it
# at second order only, and its two parts follow it nearly. That is no theorem for each of them with
# friction; in the 44 scenes at random with edges in large pieces all their bars held without it.
_STATIONARY = (STRAIN_ENERGY, EXTERNAL_WORK)
# Distance of the two peaks, of the peak itself, from which it may have no bound at all: under
# corners of obstacles it grows with every refinement.
_UNBOUNDED = 0.2

# What the local errors' energy ½ a(e, e) is of energies, at the least.
_ENERGIES = {STRAIN_ENERGY: 1.0, EXTERNAL_WORK: 2.0}


def mesh_errors(
    load_steps: LoadSteps,
    measure: Measure,
    recorded: Sequence[tuple[float, Quantities]],
    again: Again,
    drawn: Again | None = None,
    single: Again | None = None,
    notes: list[str] | None = None,
    tell: Callable[[float], None] = lambda share: None,
) -> tuple[dict[Hashable, float] | None, LocalErrors | None]:
    """Estimated errors of the last load step's quantities by the mesh; collective.

    Args:
        load_steps: At their end; all is there again afterwards.
        measure: Quantities of a solution, called in its state; of a contact by its number and
            the name; collective.
        recorded: Pseudo-time and quantities of every load step.
        again: How answers under further forces are found, from the start or of the last step.
        drawn: The same of forces of which signs are drawn, where another way is shorter.
        single: The same of changes at the surfaces, of the last step; by default solved anew.
        notes: Gets a sentence where the mesh is too stiff for an estimate.
        tell: Is called with the share of the work that is done, about.

    Returns:
        By those keys: absolute, of vectors the length of the difference; without peaks of pressure
        that may have no bound. And the local errors they come from. None for the first where a
        solve for it failed, or the mesh hides all. What a mesh hides that is too stiff
        (``held_back``) is left out, but where meshes are made for an accuracy, to which it is
        enough.
    """
    problem = load_steps.problem
    if load_steps.last is None:
        return None, None
    solution = load_steps.last.solution
    load_steps.go_back()
    local = LocalErrors(problem)
    draws = _DRAWS if again.share == 1 else _DRAWS_BY_TANGENTS
    followed = FollowedLoads(load_steps, local, again, draws)
    local.solve(BulkForces(problem, solution), load_steps.time)
    held = HeldBack(problem, solution, again.displacement, again.share)
    single = single or Again.of_last_step(load_steps, measure)
    tell(0.2)
    changes = _changes(load_steps, local, followed, again, drawn or again, held, draws)
    tell(0.5)
    if single.share < 1:
        scatter = edge_place_errors(load_steps, single)
    else:
        scatter = load_scatter(load_steps, measure, recorded)
    tell(0.8)
    curved = geometry_errors(load_steps, single)
    places = _in_places(load_steps, measure, single)
    if changes is None or scatter is None or curved is None or places is None:
        return None, local
    whole, at_random = changes
    _add_between_nodes(whole, local, solution.states)
    of_errors = _energies(recorded[-1][1], 0.5 * local.total**2)
    if problem.is_sprung:  # their energy and the body's may change against each other
        of_errors[STRAIN_ENERGY] *= 2
    for key, energy in of_errors.items():
        if key in whole:
            whole[key] = max(whole[key], energy)
    at_contacts = _at_contacts(problem, solution)
    pinned, unseen = unknown_by_pinned(problem, solution), unseen_zones(problem, solution)
    of_cycles = OfCycles(cycles_of(problem.scene), [time for time, _ in recorded])
    scatter = of_cycles.of_ends(scatter)
    curved = of_cycles.of_steps(curved)
    places = of_cycles.of_steps(places)
    losses = [key for key in whole if isinstance(key, LossOfCycle)]
    unseen = of_cycles.of_swings(unseen, losses)
    doubt = _doubt(problem, solution)
    found, hidden = {}, []
    for key in set(whole).intersection(scatter, curved, places):
        at_contact = at_contacts.get(key, 0.0)
        if at_contact is None:
            continue
        change = max(whole[key], at_random[key])
        is_stiff = not _is_of_heat_alone(problem, key)
        is_judged = is_stiff and problem.scene.accuracy is None
        if is_judged and held.hides(change, recorded[-1][1][key]):
            hidden.append(key)
            continue
        of_cells = _LOCAL[problem.spaces.degree] * change
        of_cells *= held.all_steps if is_stiff else 1.0
        of_mesh = float(np.hypot(of_cells + _SCATTER * scatter[key], at_contact))
        leading = of_mesh + _CURVED * curved[key]
        of_nodes = pinned.get(key, 0.0) + unseen.get(key, 0.0)
        longer = 1.0 if key in _STATIONARY else doubt
        found[key] = longer * leading + places[key] + of_nodes
    if hidden and notes is not None:
        notes.append(TOO_STIFF)
    return found or None, local  # no errors at all would say that the mesh makes none


def _is_of_heat_alone(problem: Problem, key: Hashable) -> bool:
    """Whether no displacement changes a quantity: a temperature that no pressure changes."""
    conduction = problem.conduction
    if conduction is None or conduction.follows_pressures or not isinstance(key, str):
        return False
    return key == MAX_TEMPERATURE or key.startswith(TEMPERATURE_OF_POINTS)


def _add_between_nodes(
    whole: dict[Hashable, float], local: LocalErrors, states: Sequence[ContactState]
) -> None:
    """Add to changes what the errors of cells make besides those of nodes; collective.

    Args:
        whole: By quantity.
        local: Solved.
        states: Of all contacts.
    """
    found: dict[Hashable, float] = {STRAIN_ENERGY: abs(local.energy_of_heat())}
    found.update(local.at_points())
    across = local.heat_across(states)
    found |= {(number, HEAT_FLOW): heat for number, heat in across.items()}
    found[HEAT_FLOW] = sum(across.values())
    for key, error in found.items():
        if key in whole:
            whole[key] += error


def _in_places(
    load_steps: LoadSteps, measure: Measure, single: Again
) -> dict[Hashable, float] | None:
    """Errors of single places, each from an answer with another one, as a sum; collective.

    Where an obstacle ends between points it sinks in there as well: the larger of both counts.

    Args:
        load_steps: As of ``mesh_errors``.
        measure: Likewise.
        single: Likewise.

    Returns:
        By quantity; None where one of the answers was not found.
    """
    torn = torn_errors(load_steps, single)
    points = single_point_errors(load_steps, single)
    sunk = unseen_depth_errors(load_steps, single)
    ended = obstacle_edge_errors(load_steps, measure)
    if torn is None or points is None or sunk is None or ended is None:
        return None
    known = torn.keys() & points.keys() & sunk.keys() & ended.keys()
    return {key: torn[key] + points[key] + max(sunk[key], ended[key]) for key in known}


def _doubt(problem: Problem, solution: Solution) -> float:
    """How much longer bars are where edges pass through pieces large beside zones; collective."""
    pairs = zip(problem.contacts, solution.states, strict=True)
    share = piece_share([pair for pair in pairs if not touches_in_points(*pair)])
    return min(_MOST, float(np.hypot(1.0, _HALF * share)))


def _energies(answer: Quantities, error: float) -> dict[Hashable, float]:
    """Return the changes of energies and works by the energy of local errors.

    To the friction work in the root of the share that it has of the strain energy: friction's share
    of the errors works on those of the whole body at the most (Cauchy and Schwarz).

    Args:
        answer: Quantities of the last load step.
        error: Energy of the local errors.
    """
    found: dict[Hashable, float] = {name: part * error for name, part in _ENERGIES.items()}
    whole = float(np.linalg.norm(answer.get(STRAIN_ENERGY, 0.0)))
    for key, value in answer.items():
        of_friction = key == FRICTION_WORK or (isinstance(key, tuple) and key[1] == FRICTION_WORK)
        if of_friction or isinstance(key, LossOfCycle):
            work = float(np.linalg.norm(value))
            found[key] = error * min(1.0, float(np.sqrt(work / whole))) if whole > 0 else error
    return found


def _changes(
    load_steps: LoadSteps,
    local: LocalErrors,
    followed: FollowedLoads,
    again: Again,
    drawn: Again,
    held: HeldBack,
    draws: int,
) -> tuple[dict[Hashable, float], dict[Hashable, float]] | None:
    """Return the changes by local errors, and by such errors with random signs; collective.

    The first of these says how much the mesh holds the body back.
    """
    found = []
    last = drawn_forces(local, draws)
    every = followed.every([one.nodal for one in last])
    load_steps.newton.system.precompute_loads([forces for rows in every for forces in rows])
    for number, (forces, at_end) in enumerate(zip(every, last, strict=True)):
        on_scalars = at_end.on_scalars
        disturb = partial(_disturb, followed, forces, at_end, load_steps.time)
        way = drawn if number else again
        change = way.effects(disturb, None if number else held.look)
        if change is None:
            return None
        for scalar, more in zip(load_steps.problem.body_scalars, on_scalars, strict=True):
            if (key := scalar.key_of_force) is not None:
                # One whose force is given has it: what the errors add was taken off.
                change[key] = change[key] + abs(float(more)) if scalar.is_locked else 0.0
        found.append(change)
    whole, *others = found
    known = [key for key in whole if all(key in change for change in others)]
    at_random = {
        key: float(np.sqrt(np.mean([change[key] ** 2 for change in others]))) for key in known
    }
    return {key: whole[key] for key in known}, at_random


def _disturb(
    followed: FollowedLoads,
    forces: Sequence[Array],
    at_end: ForcesOfErrors,
    last: float,
    share: float,
    problem: Problem,
) -> None:
    """Add nodal forces, as they follow the loads; collective.

    Forces given on the body's scalars are so much less as errors add to them; of springs errors are
    a part of the stretch.
    """
    problem.disturbance = followed.along([share * one for one in forces])
    problem.scalar_disturbance = -share * at_end.on_scalars / last
    problem.feet.disturbance = [share * one / last for one in at_end.on_springs]
    if problem.conduction is not None and at_end.heat is not None:
        problem.conduction.disturb(share * at_end.heat, last)
    problem.set_time(last)


def _at_contacts(problem: Problem, solution: Solution) -> dict[Hashable, float | None]:
    """Return additions for areas and peak pressures, at each contact and in all; collective.

    None for peaks that may have no bound.
    """
    forces = BulkForces(problem, solution)
    areas = {CONTACT_AREA: 0.0, STICK_AREA: 0.0, SLIP_AREA: 0.0}
    added: dict[Hashable, float | None] = {}
    peaks: list[float | None] = []
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        found = Zones(contact, state)
        zones = contact_area(found), stick_area(found)
        touching, sticking = (
            _place_of_edge(cut, zone)
            for cut, zone in zip(cut_areas(contact, state), zones, strict=True)
        )
        slipping = float(np.hypot(touching, sticking))
        cuts = {CONTACT_AREA: touching, STICK_AREA: sticking, SLIP_AREA: slipping}
        for name, cut in cuts.items():
            added[number, name] = cut
            areas[name] += cut
        for name, cut in _radii_cut(contact, state, cuts).items():
            added[number, name] = added[name] = cut
        peaks.append(_peak_error(forces, number))
        added[number, MAX_CONTACT_PRESSURE] = peaks[-1]
    known = [peak for peak in peaks if peak is not None]
    of_all = max(known, default=0.0) if len(known) == len(peaks) else None
    return added | areas | {MAX_CONTACT_PRESSURE: of_all}


def _place_of_edge(cut: float, zone: float) -> float:
    """How much area of a zone is not known, as its edge lies somewhere in pieces."""
    return _EDGE * cut * (min(1.0, cut / (_CLOSE * zone)) if zone > 0 else 1.0)


def _radii_cut(
    contact: ContactSurface, state: ContactState, cuts: dict[str, float]
) -> dict[str, float]:
    """Return the errors of discs' radii by areas at their edges, dA = 2πr dr; collective."""
    areas = {CONTACT_RADIUS: CONTACT_AREA, STICK_RADIUS: STICK_AREA}
    found = radii(Zones(contact, state))
    return {name: cuts[areas[name]] / (2 * np.pi * r) for name, r in found.items() if r}


def _peak_error(forces: BulkForces, number: int) -> float | None:
    """Return the error of a contact's largest pressure, None if that has no bound; collective."""
    problem, contact = forces.problem, forces.problem.contacts[number]
    if contact.normal.pressure_is_known:
        return 0.0
    peak = largest(problem.comm, forces.solution.states[number].contact_pressure)
    needed = largest(problem.comm, forces.pressure(number)[contact.trace.numbers])
    apart = abs(peak - needed)
    return None if apart > _UNBOUNDED * peak else _PEAK * apart
