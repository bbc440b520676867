"""Checks of one-sided contact: pressures that the bulk needs against penalty and gap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows, largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import ContactState
from fenics_contact.contact.surface.facet_sizes import relative_facet_size
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.results.result import Check
from fenics_contact.trust.checks.comparison import TRACE, nearer_to_failing, worst_of

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
