"""Public numbers from a solution: resultants, areas, energies, contact points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact import OPEN, SLIP, STICK, ContactSurface
from fenics_contact.parallel import gather_rows, largest, total
from fenics_contact.problem import Problem
from fenics_contact.result import ContactPoints
from fenics_contact.solver import Solution
from fenics_contact.spaces import Spaces

Array = NDArray[np.float64]


def status(contact: ContactSurface, displacement: Array) -> NDArray[np.str_]:
    """STICK where |u_T| ≤ ε and friction acts, SLIP beyond, OPEN without pressure."""
    slip = np.linalg.norm(contact.slip(displacement), axis=1)
    sticks = (contact.friction_bound > 0) & (slip <= contact.regularisation_parameter)
    found = np.where(sticks, STICK, SLIP)
    return np.where(contact.contact_pressure > 0, found, OPEN)


def contact_quantities(
    contact: ContactSurface, displacement: Array, friction_force: Array
) -> dict[str, Any]:
    """The interface's quantities of one contact.

    Args:
        contact: The contact.
        displacement: Nodal displacements of this rank, (nodes, components) (length).
        friction_force: Friction forces on the body at the contact's nodes (force).
    """
    comm, integral = contact.spaces.comm, contact.trace.integral
    state = status(contact, displacement)
    area = {kind: float(integral((state == kind) * 1.0)) for kind in (STICK, SLIP)}
    owned = contact.owned_nodes
    dissipated = -total(comm, np.sum((friction_force * displacement[contact.nodes])[owned]))
    return {
        "normal_force": float(integral(contact.contact_pressure)),
        "friction_force": _resultant(contact.spaces, friction_force[owned]).tolist(),
        "max_contact_pressure": largest(comm, contact.contact_pressure),
        "contact_area": area[STICK] + area[SLIP],
        "stick_area": area[STICK],
        "slip_area": area[SLIP],
        "max_penetration": 0.0,
        "max_slip": largest(comm, np.linalg.norm(contact.slip(displacement), axis=1)),
        "friction_work": dissipated,
        "penalty_energy": 0.0,
    }


def support_reactions(problem: Problem, solution: Solution) -> tuple[Array, list[dict[str, Any]]]:
    """Nodal reactions, and the resultant of each support.

    A reaction is what the bulk needs beyond loads and friction; a dof that two
    supports hold counts to the first.

    Returns:
        Reactions of shape (nodes, components), zero at free dofs; and a row a support.
    """
    friction = np.zeros_like(problem.load)
    for contact, force in zip(problem.contacts, solution.friction_force, strict=True):
        friction[contact.nodes] += force
    needed = (solution.internal_force - problem.load - friction).reshape(-1)
    reactions = np.zeros_like(needed)
    counted = np.zeros(len(needed), dtype=bool)
    rows = []
    for support in problem.supports:
        mine = np.zeros_like(needed)
        dofs = support.dofs[~counted[support.dofs]]
        mine[dofs] = needed[dofs]
        counted[dofs] = True
        reactions += mine
        rows.append({"on": support.on, "reaction": resultant(problem, mine).tolist()})
    return reactions.reshape(problem.load.shape), rows


def resultant(problem: Problem, forces: Array) -> Array:
    """Global sum of nodal forces, shape (components,)."""
    return _resultant(
        problem.spaces, forces.reshape(problem.load.shape)[: problem.spaces.owned_nodes]
    )


def _resultant(spaces: Spaces, forces: Array) -> Array:
    """Global sum of forces at owned points; over a revolution, radial ones cancel."""
    summed = total(spaces.comm, forces.sum(axis=0))
    if spaces.kinematics == "axisymmetric":
        summed[0] = 0.0
    return summed


def global_quantities(
    problem: Problem, solution: Solution, reactions: Array, contacts: list[dict[str, Any]]
) -> dict[str, Any]:
    """The interface's quantities of the whole model."""
    owned = slice(0, problem.spaces.owned_nodes)
    u = solution.displacement[owned]
    elastic = 0.5 * total(problem.comm, np.sum(u * solution.internal_force[owned]))
    work = total(problem.comm, np.sum(u * (problem.load + reactions)[owned]))
    summed = ("contact_area", "stick_area", "slip_area", "friction_work", "penalty_energy")
    greatest = ("max_contact_pressure", "max_penetration", "max_slip")
    friction = np.zeros(problem.spaces.components)
    for contact in contacts:
        friction += contact["friction_force"]
    return {
        "normal_force": float(sum(c["normal_force"] for c in contacts)),
        "friction_force": friction.tolist(),
        "reaction": resultant(problem, reactions).tolist(),
        **{key: max((c[key] for c in contacts), default=0.0) for key in greatest},
        **{key: float(sum(c[key] for c in contacts)) for key in summed},
        "strain_energy": elastic,
        "external_work": work,
    }


def contact_points(problem: Problem, solution: Solution) -> ContactPoints:
    """All contact points on every rank; only contact data is gathered."""
    rows = [_rows(number, problem, solution) for number in range(len(problem.contacts))]
    width = 2 + 3 + 3 + 2 + 3 + 3 + 1
    table = np.concatenate(rows) if rows else np.zeros((0, width))
    table = gather_rows(problem.comm, table)
    size = np.abs(table[:, 2:5]).max(initial=np.finfo(float).tiny)
    order = np.lexsort((*np.round(table[:, [4, 3, 2]] / size, 9).T, table[:, 0]))
    table = table[order]
    return ContactPoints(
        contact=table[:, 0].astype(np.int64),
        status=np.array([OPEN, STICK, SLIP])[table[:, 1].astype(int)],
        coordinates=table[:, 2:5],
        normals=table[:, 5:8],
        gap=table[:, 8],
        contact_pressure=table[:, 9],
        friction_traction=table[:, 10:13],
        slip=table[:, 13:16],
        weights=table[:, 16],
    )


def _rows(number: int, problem: Problem, solution: Solution) -> Array:
    """Owned points of one contact as numbers, in the order of ``contact_points``."""
    contact = problem.contacts[number]
    trace = contact.trace
    state = status(contact, solution.displacement)
    columns = [
        np.full((len(state), 1), float(number)),
        np.select([state == OPEN, state == STICK], [0.0, 1.0], 2.0)[:, None],
        trace.coordinates,
        _three(trace.normals),
        np.zeros((len(state), 1)),
        contact.contact_pressure[:, None],
        _three(contact.friction_traction(solution.displacement)),
        _three(contact.slip(solution.displacement)),
        trace.weights[:, None],
    ]
    return np.hstack(columns)[trace.owned]


def _three(vectors: Array) -> Array:
    """Vectors padded to three components."""
    return np.hstack([vectors, np.zeros((len(vectors), 3 - vectors.shape[1]))])
