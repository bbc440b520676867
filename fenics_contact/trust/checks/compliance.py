"""Checks of how far the springs of the method give way: penalties across, ε along the surface.

Both are compared with what the bodies themselves give way under the same tractions: a
compliance of 1 % more changes contact forces by 1 % at most.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fenics_contact.common.arrays import Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.state import STICK
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import nearer_to_failing, size_of, worst_of
from fenics_contact.trust.checks.friction import ComparedFriction
from fenics_contact.trust.checks.normal import ComparedPressures

# Of what the bodies give way.
_LARGEST_SHARE = 1e-2
# Penetration over the shortest edge of the cells: beyond, it shows on the mesh. Automatic
# penalties keep 3e-4 p/M, far below, up to any pressure p that small strains allow.
_LARGEST_IN_CELL = 0.1
# Round-off of the slip, over the machine's, beside the displacements that it is made of.
_SLIP_ROUND_OFF = 20.0


def penetration_depth(
    forces: InternalForces, contacts: list[ComparedPressures], numbers: Sequence[int]
) -> Check | None:
    """Deepest penetration of one-sided contacts, against two lengths; collective.

    - p L/E*, what the peak pressure p that the bulk needs closes over the size L of the area
      in contact (of Hertz's contacts, the indentation but for a factor near 1).
    - The shortest edge of the cells at the contact.

    Of glue, ∫ |σ n| |w| against ∫ |σ n|² L/E*, with the forces that the bulk needs.

    Left out are nodes that supports hold across the surface (of glue, in any direction).

    Args:
        forces: Of a solution.
        contacts: What is compared of those that push. No foundations: their depth is asked for.
        numbers: Of all contacts that are asked, glue among them.
    """
    worst = _glue(forces, numbers)
    for compared in contacts:
        contact, state = compared.contact, compared.state
        if not compared.tells:
            continue
        counted = contact.trace.owned.copy()
        counted[: len(contact.nodes)] &= contact.supports.free_across
        counted &= np.isfinite(state.gap)
        deepest, place = worst_of(
            compared.comm, -state.gap[counted], contact.trace.coordinates[counted]
        )
        deepest = float(np.maximum(deepest, 0.0))  # keeps what is not a number
        closed = np.where(state.contact_pressure > 0, 1.0, 0.0)
        size = size_of(contact, float(contact.trace.integral(closed)))
        gives = largest(compared.comm, compared.bulk) * size / contact.moduli.plane_strain
        share = deepest / gives if gives > 0 else float("nan")
        for check in (
            Check(share, _LARGEST_SHARE, contact.label, place, kind="closing"),
            Check(deepest / contact.facet_size, _LARGEST_IN_CELL, contact.label, place, "cell"),
        ):
            worst = nearer_to_failing(worst, check)
    return worst


def _glue(forces: InternalForces, numbers: Sequence[int]) -> Check | None:
    """How far glue gives way, over what the bodies do; collective."""
    worst: Check | None = None
    comm = forces.problem.comm
    for number in numbers:
        contact = forces.problem.contacts[number]
        if not contact.normal.sticks or not forces.carries(number):
            continue
        state, nodes = forces.solution.states[number], slice(0, len(contact.nodes))
        counted = (
            contact.owned_nodes
            & forces.problem.free[contact.nodes].all(axis=1)
            & np.isfinite(state.gap[nodes])
        )
        needed = np.linalg.norm(forces.at_contact(number), axis=1)[counted]
        apart = np.hypot(state.gap[nodes], np.linalg.norm(state.slip[nodes], axis=1))[counted]
        area = contact.trace.to_nodes(contact.trace.weights)[counted]
        sums = np.array([(needed * apart).sum(), (needed**2 / area).sum(), area.sum()])
        opened, squares, glued = total(comm, sums)
        gives = squares * size_of(contact, glued) / contact.moduli.plane_strain
        if gives > 0 or gives != gives:
            check = Check(opened / gives, _LARGEST_SHARE, contact.label, kind="glue")
            worst = nearer_to_failing(worst, check)
    return worst


def stick_creep(contacts: list[ComparedFriction], steps: int) -> Check | None:
    """Creep of points that stick, |u_T| ≤ ε, by two comparisons; collective.

    - Friction from the bulk against g |u_T|/ε at each node (paper, (2.8)), over the largest g;
      g |M M u_T|/ε where friction feels slip by M.
      Left out where points lie between nodes: a node's force is not that of one slip.
    - ∫ |σ_T| |u_T| over points that stick, against ∫ |σ_T|² L/E over all: what the body gives
      way along the surface under the same friction, L the size of the area where it acts. By
      the incremental law points creep anew in every load step.

    Args:
        contacts: What is compared.
        steps: Load steps taken.
    """
    worst: Check | None = None
    for compared in contacts:
        for check in (_creep_law(compared), _creep_share(compared, steps)):
            worst = worst if check is None else nearer_to_failing(worst, check)
    return worst


def _creep_law(compared: ComparedFriction) -> Check | None:
    contact, sticks = compared.contact, _sticks(compared)
    if not compared.nodal or compared.comm.allreduce(int(sticks.sum())) == 0:
        return None
    epsilon = contact.regularisation_parameter
    creep = compared.crept / epsilon
    carried = np.linalg.norm(compared.bulk, axis=1)
    off = np.abs(carried - compared.bound * creep)[sticks]
    value, place = worst_of(compared.comm, off, compared.places[sticks])
    moved = largest(compared.comm, np.abs(compared.displacement))
    lost = _SLIP_ROUND_OFF * float(np.finfo(float).eps) * moved / epsilon
    return Check(value, compared.limit + lost, contact.label, place, "law")


def _creep_share(compared: ComparedFriction, steps: int) -> Check | None:
    contact, sticks = compared.contact, _sticks(compared)
    carried = np.linalg.norm(compared.bulk, axis=1)
    if largest(compared.comm, carried[sticks]) <= compared.limit:
        return None  # nothing but round-off
    creep = np.where(sticks, np.linalg.norm(compared.slip, axis=1), 0.0)
    rough = np.where(compared.bound > 0, 1.0, 0.0)
    sums = [compared.area * part for part in (carried * creep, carried**2, rough)]
    crept, squares, area = total(compared.comm, np.array([part.sum() for part in sums]))
    gives = compared.strongest * size_of(contact, area) / contact.moduli.combined
    creeps_on = contact.friction.follows_path and not contact.last_step.acts_all_along
    anew = steps if creeps_on else 1
    value = float(anew * crept / (squares * gives))
    return Check(value, _LARGEST_SHARE, contact.label, kind="share")


def _sticks(compared: ComparedFriction) -> Flags:
    return np.asarray(compared.status == STICK)
