"""Public numbers from a solution: resultants, areas, energies, contact points."""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows, largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, SLIP, STICK, ContactState
from fenics_contact.evaluate.contact_areas import Zones, contact_area, stick_area
from fenics_contact.evaluate.contact_radii import radii
from fenics_contact.evaluate.contact_resultants import resultants
from fenics_contact.evaluate.needed_forces import NeededForces, own_dofs
from fenics_contact.evaluate.recovered_pressure import pressure_of_facets
from fenics_contact.problem.problem import Problem
from fenics_contact.results.contact_points import ContactPoints
from fenics_contact.results.point_arrays import WRITTEN
from fenics_contact.results.records.contacts import PreloadRecord, SupportRecord
from fenics_contact.scene.quantity_names import OF_ONE_CONTACT
from fenics_contact.solve.newton.solution import Solution


def contact_quantities(problem: Problem, solution: Solution, number: int) -> dict[str, Any]:
    """The interface's quantities of one contact, by its number in scene order; collective."""
    contact = problem.contacts[number]
    comm = contact.spaces.comm
    state = solution.states[number]
    zones = Zones(contact, state)
    closed = contact_area(zones)
    sticking = min(stick_area(zones), closed)
    depth = np.where(np.isfinite(state.gap), -state.gap, 0.0)
    slip = np.linalg.norm(state.slip[state.status != OPEN], axis=1)
    return {
        **resultants(contact, state, solution.friction_force[number]),
        "max_contact_pressure": largest(comm, pressure_of_facets(contact, state)),
        "contact_area": closed,
        "stick_area": sticking,
        "slip_area": closed - sticking,
        **radii(zones),
        "max_penetration": max(largest(comm, depth), 0.0) if contact.is_one_sided else 0.0,
        "max_slip": largest(comm, slip),
        "friction_work": contact.work.of_friction(state),
        "penalty_energy": float(contact.trace.integral(state.penalty_energy)),
        **contact.wear.quantities(state),
        **_stored_along(contact, state),
        **_undecided(contact, state),
        **_of_two_bodies(contact, state),
        **_motion(problem, contact),
    }


def _of_two_bodies(contact: ContactSurface, state: ContactState) -> dict[str, float]:
    """How far they slid, over the contact's size, and the widest gap that closed; collective.

    The slip is since it was found what faces what, the gap that of the meshes.
    """
    if contact.sides.opposite is None:
        return {}
    gap = np.abs(contact.kinematics.gap[state.status != OPEN])
    return {**slid(contact), "closed_gap": largest(contact.spaces.comm, gap)}


def slid(contact: ContactSurface) -> dict[str, float]:
    """How far two bodies slid since it was found what faces what, if they do; collective."""
    if contact.sides.opposite is None:
        return {}
    return {"slip_since_pairing": contact.slid_share()}


def _stored_along(contact: ContactSurface, state: ContactState) -> dict[str, float]:
    """Energy of elastic slip, where friction has such; collective."""
    if not contact.friction.stores_energy:
        return {}
    return {"elastic_slip_energy": contact.work.in_elastic_slip(state)}


def _undecided(contact: ContactSurface, state: ContactState) -> dict[str, int]:
    """How many points slip by less than 2ε: with an ε twice as large they may stick.

    A point that sticks creeps by ε times the share of its bound that it carries, whatever ε:
    that it creeps by nearly ε says that friction is nearly used up, not that ε decides.
    """
    if not contact.friction.has_regularisation:
        return {}
    slip = np.linalg.norm(contact.friction.scaled_slip(state.slip), axis=1)
    slips = contact.trace.owned & (state.status == SLIP) & (contact.friction_bound > 0)
    near = slips & (slip < 2 * contact.regularisation_parameter)
    return {"undecided_points": int(total(contact.spaces.comm, near.sum()))}


def _motion(problem: Problem, contact: ContactSurface) -> dict[str, Any]:
    """How far an obstacle went in, and besides; nothing where there is none, or no datum."""
    obstacle, kinematics = contact.contact.obstacle, contact.kinematics
    if obstacle is None:
        return {}
    found: dict[str, Any] = {}
    if problem.has_datum:
        found["indentation"] = kinematics.brought_up + kinematics.indentation
    if obstacle.displacement is not None:
        found["obstacle_displacement"] = kinematics.displacement.tolist()
    return found


def support_records(forces: NeededForces) -> list[SupportRecord]:
    """A row a support: its resultant, and the mean displacement of what it holds; collective.

    Along each axis, None along others (length).
    """
    problem = forces.problem
    size = problem.spaces.owned_nodes * problem.spaces.components
    return [
        SupportRecord(
            name=support.label,
            on=support.on,
            reaction=reaction.tolist(),
            displacement=_mean_displacement(forces, dofs[dofs < size]),
        )
        for support, reaction, dofs in zip(
            problem.applied_supports, forces.of_supports, own_dofs(problem), strict=True
        )
    ]


def preload_records(problem: Problem, solution: Solution) -> dict[str, PreloadRecord]:
    """Each preload of an answer, by its name."""
    return {
        preload.scene.label: PreloadRecord(
            on=preload.scene.on,
            force=state.force,
            elongation=state.shortening,
            initial_strain=state.initial_strain,
            locked=state.is_locked,
        )
        for preload, state in zip(problem.preloads, solution.preloads, strict=True)
    }


def _mean_displacement(forces: NeededForces, dofs: Integers) -> list[float | None]:
    """Of owned dofs of all ranks by component, None where there are none; collective."""
    components = forces.problem.spaces.components
    moved = forces.displacement.reshape(-1)[dofs]
    sums = [np.bincount(dofs % components, w, components) for w in (moved, np.ones(len(dofs)))]
    summed, counts = total(forces.problem.comm, np.stack(sums))
    return [float(s / n) if n > 0 else None for s, n in zip(summed, counts, strict=True)]


def global_quantities(forces: NeededForces, contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """The interface's quantities of the whole model.

    Resultants of contacts are those of the only one, None where there are several: a sum over
    surfaces that point in different directions means nothing.
    """
    problem, solution = forces.problem, forces.solution
    work = forces.given_work
    acting = zip(problem.contacts, solution.contact_force, solution.states, strict=True)
    for surface, force, state in acting:
        pushed = total(problem.comm, force[surface.owned_nodes].sum(axis=0))
        driven = surface.kinematics.brought_up + surface.kinematics.indentation
        work += pushed @ surface.kinematics.direction * driven
        work += pushed @ surface.kinematics.displacement
        pressure = float(surface.trace.integral(state.contact_pressure))
        work += pressure * surface.kinematics.pressing_interference
    work += sum(state.force * state.shortening for state in solution.preloads)
    made = of_all_contacts(contacts)
    return {
        **{key: made[key] for key in OF_ONE_CONTACT},
        "reaction": forces.of_all_supports.tolist(),
        **made,
        "strain_energy": forces.strain_energy,
        "external_work": float(work),
        **forces.at_points(),
    }


def of_all_contacts(contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """Quantities of the whole model that those of its contacts make.

    Args:
        contacts: Of each contact.
    """
    summed = ("contact_area", "stick_area", "slip_area", "friction_work", "penalty_energy")
    greatest = ("max_contact_pressure", "max_penetration", "max_slip")
    return {
        **{key: contacts[0][key] if len(contacts) == 1 else None for key in OF_ONE_CONTACT},
        **{key: max((c[key] for c in contacts), default=0.0) for key in greatest},
        **{key: float(sum(c[key] for c in contacts)) for key in summed},
        **_of_some(contacts),
        **_of_the_only(contacts),
    }


def _of_some(contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """Of the whole model what only some contacts have, such as those that wear."""
    found: dict[str, Any] = {}
    summed = ("worn_volume", "worn_volume_on", "worn_volume_against", "elastic_slip_energy")
    greatest = ("max_wear_depth", "max_wear_depth_on", "max_wear_depth_against")
    for name in (*summed, *greatest):
        together = sum if name in summed else max
        have = [contact[name] for contact in contacts if name in contact]
        found |= {name: float(together(have))} if have else {}
    return found


def _of_the_only(contacts: list[dict[str, Any]]) -> dict[str, Any]:
    """Quantities of the whole model that not every contact has, where one contact has them."""
    found: dict[str, Any] = {}
    for name in ("contact_radius", "stick_radius", "indentation"):
        have = [contact[name] for contact in contacts if name in contact]
        found |= {name: have[0]} if len(have) == 1 else {}
    return found


def contact_points(problem: Problem, solution: Solution) -> ContactPoints:
    """All contact points on every rank; only contact data is gathered."""
    rows = [_rows(number, problem, solution) for number in range(len(problem.contacts))]
    written = (*WRITTEN, *problem.own_arrays)
    widths = [2, 3, 3, *(len(array.columns) for array in written), 1]
    table = np.concatenate(rows) if rows else np.zeros((0, sum(widths)))
    table = gather_rows(problem.comm, table)
    size = np.abs(table[:, 2:5]).max(initial=np.finfo(float).tiny)
    order = np.lexsort((*np.round(table[:, [4, 3, 2]] / size, 9).T, table[:, 0]))
    table = table[order]
    codes, coordinates, normals, *arrays, weights = np.split(table, np.cumsum(widths)[:-1], axis=1)
    found = {
        array.name: part if array.is_vector else part[:, 0]
        for array, part in zip(written, arrays, strict=True)
    }
    own = {array.name: found.pop(array.name) for array in problem.own_arrays}
    return ContactPoints(
        contact=codes[:, 0].astype(np.int64),
        status=np.array([OPEN, STICK, SLIP])[codes[:, 1].astype(int)],
        coordinates=coordinates,
        normals=normals,
        weights=weights[:, 0],
        **found,
        own=own,
    )


def _rows(number: int, problem: Problem, solution: Solution) -> Array:
    """Owned points of one contact as numbers, in the order of ``contact_points``."""
    trace = problem.contacts[number].trace
    state = solution.states[number]
    status = np.select([state.status == OPEN, state.status == STICK], [0.0, 1.0], 2.0)
    none = np.full(len(status), np.nan)
    own = [
        state.own.get(array.name, np.stack([none] * len(array.columns), axis=1))
        for array in problem.own_arrays
    ]
    columns = [
        np.full((len(status), 1), float(number)),
        status[:, None],
        trace.coordinates,
        _three(trace.normals),
        *(
            _three(values) if array.is_vector else values.reshape(-1, 1)
            for array, values in [
                *((array, getattr(state, array.name)) for array in WRITTEN),
                *zip(problem.own_arrays, own, strict=True),
            ]
        ),
        trace.weights[:, None],
    ]
    return np.asarray(np.hstack(columns)[trace.owned])


def _three(vectors: Array) -> Array:
    """Vectors padded to three components."""
    return np.hstack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])
