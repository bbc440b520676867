"""Checks of one-sided contact, and of how far the springs of the method give way.

Penalties give way across the surface and ε along it. Both are compared with what the bodies
themselves give way under the same tractions: a compliance of 1 % more changes contact forces by 1 %
at most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import gather_rows, largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import STICK, ContactState
from fenics_contact.contact.surface.facets import relative_facet_size
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.comparison import TRACE, nearer_to_failing, size_of, worst_of
from fenics_contact.trust.friction_checks import ComparedFriction

# Of a normal's square the share along components that no support holds, for nodes to be compared.
_LEAST_FREE = 0.5
# A penalty that holds this share of the elastic energy changes contact forces by about as much.
_LARGEST_PENETRATION = 2e-3
# Penalty pressure against that from reactions, over √(facet size / contact size), by degree:
# those of linear elements oscillate.
_RECOVERY_OVER_ROOT = {1: 2.5, 2: 1.6}
_LARGEST_RECOVERY = 0.8


@dataclass(frozen=True, eq=False)
class ComparedPressures:
    """Forces that the bulk needs at a contact's nodes, in components that no support holds.

    In the others what it needs is also a reaction, of which any part along the normal would count
    as pressure. So forces are compared along what is left of the normal without these components.
    Left out are nodes where that is less than half of it.

    Attributes:
        number: Of the contact, in scene order.
        contact: It pushes.
        state: What happens at its points.
        bulk: Normal force on the body over area, by its free components: a pressure (stress).
            Less that of friction, which on curved facets with points between nodes is not all
            along the nodes' surface.
        law: The same from penalty or foundation (stress).
        gap: At the nodes (length).
        places: Undeformed coordinates of these, (nodes, 3) (length).
        limit: What round-off and the accepted imbalance may leave (stress).
        peak: Largest pressure of the contact, all ranks (stress).
        tells: Whether it carries more than what solver and round-off leave: a contact that has
            been unloaded to nothing has pressures of no account, which no ratio is to be made of.
    """

    number: int
    contact: ContactSurface
    state: ContactState
    bulk: Array
    law: Array
    gap: Array
    places: Array
    limit: float
    peak: float
    tells: bool

    @property
    def comm(self) -> MPI.Comm:
        """Communicator."""
        return self.contact.spaces.comm

    def share(self, pressures: Array) -> Check:
        """The largest of pressures at the nodes, over the peak, as a check; collective."""
        found, place = worst_of(self.comm, pressures, self.places)
        return Check(found / self.peak, self.limit, self.contact.label, place)


def compared_pressures(forces: InternalForces) -> list[ComparedPressures]:
    """All contacts that push, in scene order; collective."""
    problem, solution = forces.problem, forces.solution
    found = []
    comm = problem.comm
    for number, (contact, state) in enumerate(zip(problem.contacts, solution.states, strict=True)):
        if not contact.is_one_sided:
            continue
        normals = contact.supports.free_normals
        shares = np.einsum("ij,ij->i", normals, normals)
        free = contact.owned_nodes & (shares > _LEAST_FREE)
        peak = largest(comm, state.contact_pressure)
        if total(comm, free.sum()) == 0 or peak <= 0:
            continue
        trace = contact.trace
        area = trace.to_nodes(trace.weights)
        along = normals[free] / (shares * area)[free, None]
        needed = forces.at_contact(number) - solution.friction_force[number]
        bulk = -np.einsum("ij,ij->i", needed[free], along)
        law = -np.einsum("ij,ij->i", solution.normal_force[number][free], along)
        lightest = smallest(comm, (np.sqrt(shares) * area)[free])
        found.append(
            ComparedPressures(
                number=number,
                contact=contact,
                state=state,
                bulk=bulk,
                law=law,
                gap=state.gap[: len(contact.nodes)][free],
                places=trace.coordinates[: len(contact.nodes)][free],
                limit=TRACE + 2 * solution.imbalance_limit / (lightest * peak),
                peak=peak,
                tells=forces.carries(number),
            )
        )
    return found


def contact_law(contacts: list[ComparedPressures]) -> Check | None:
    """Nodal pressure of the bulk against that of the penalty (paper, (4.4)), over the peak."""
    worst: Check | None = None
    for compared in contacts:
        worst = nearer_to_failing(worst, compared.share(np.abs(compared.bulk - compared.law)))
    return worst


def complementarity(contacts: list[ComparedPressures]) -> Check | None:
    """Pressure of the bulk where the gap is open, over the peak: p = 0 or no gap (paper, (1.1))."""
    worst: Check | None = None
    for compared in contacts:
        if not compared.contact.trace.nodal:
            continue  # a node's force is also that of the points around it
        held = np.where(compared.gap > 0, np.abs(compared.bulk), 0.0)
        worst = nearer_to_failing(worst, compared.share(held))
    return worst


def tension(contacts: list[ComparedPressures]) -> Check | None:
    """Tension that the bulk needs at a node, over the peak pressure: contact cannot pull."""
    worst: Check | None = None
    for compared in contacts:
        if not compared.contact.trace.nodal:
            continue
        worst = nearer_to_failing(worst, compared.share(np.maximum(-compared.bulk, 0.0)))
    return worst


def penetration(forces: InternalForces, contacts: list[ComparedPressures]) -> Check | None:
    """Energy in penalties over that in the body: the share by which contact forces are off.

    Args:
        forces: Of a solution.
        contacts: Those whose springs stand for no give at all: no depth is asked for.
    """
    sunk, pushing = 0.0, False
    for compared in contacts:
        contact, energy = compared.contact, compared.state.penalty_energy
        if compared.tells:
            sunk, pushing = sunk + float(contact.trace.integral(energy)), True
    if not pushing:
        return None
    elastic = forces.strain_energy
    return Check(sunk / elastic if elastic > 0 else float("nan"), _LARGEST_PENETRATION)


def pressure_recovery(forces: InternalForces, contacts: list[ComparedPressures]) -> Check | None:
    """Penalty pressure against that from reactions: median difference over the mean pressure.

    They differ at first order in the facet size over the contact's, but at singular edges and
    corners, where that from reactions oscillates: hence the median, by area.
    """
    problem = forces.problem
    worst: Check | None = None
    for compared in (compared for compared in contacts if compared.tells):
        trace, state = compared.contact.trace, compared.state
        closed = np.where(state.contact_pressure > 0, 1.0, 0.0)
        area, whole = (float(trace.integral(part)) for part in (closed, np.ones_like(closed)))
        flat = problem.spaces.components == 2 and problem.spaces.kinematics != "axisymmetric"
        share = area / whole if flat else np.sqrt(area / whole)
        relative_size = relative_facet_size(trace.surface) / share
        limit = _RECOVERY_OVER_ROOT[problem.spaces.degree] * float(np.sqrt(relative_size))
        if limit > _LARGEST_RECOVERY:
            continue  # a contact of one facet or two resolves no pressure
        consistent = trace.at_points(forces.pressure(compared.number))
        difference = np.abs(consistent - state.contact_pressure)
        loaded = (closed > 0) | (consistent > 0.1 * largest(problem.comm, consistent))
        mean = float(
            trace.integral(state.contact_pressure) / trace.integral(np.where(loaded, 1.0, 0.0))
        )
        rows = np.stack([difference, trace.weights], axis=1)[trace.owned & loaded]
        found = _median(gather_rows(problem.comm, rows)) / mean
        worst = nearer_to_failing(worst, Check(found, limit, compared.contact.label))
    return worst


def _median(rows: Array) -> float:
    """Median of the first column, weighted by the second."""
    values, weights = rows[np.argsort(rows[:, 0])].T
    return float(values[np.searchsorted(np.cumsum(weights), 0.5 * weights.sum())])


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
    """
    worst: Check | None = None
    for compared in contacts:
        if compared.contact.regularisation_parameter == 0:
            continue  # nothing creeps: ``friction_law`` asks that
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
