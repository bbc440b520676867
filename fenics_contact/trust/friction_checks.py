"""Checks of friction: nodal forces that the bulk needs against the friction law.

And of the loop on the pressure: the bound that friction was solved with is that found.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array, Flags, Words
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.existence.slip_shares import HELD, slip_shares
from fenics_contact.results.result import Check
from fenics_contact.trust.comparison import TRACE, Place, nearer_to_failing, worst_of

# Of the largest displacement: a slip that is round-off.
_NO_SLIP = 1e-9
# Of the tolerance of the loop, which ends when the last pass changes pressures by less.
_LOOP_SAFETY = 10.0


def recovered_friction(forces: InternalForces, number: int) -> Array:
    """Friction forces that the bulk needs at the nodes of a contact.

    Returns:
        K u − f, tangential, shape (nodes, components) (force), less what other contacts
        give to a shared node. On curved facets whose points lie between nodes, pressure is
        along the points' normals, and a part of it along the nodes' surface: less that, too.
        Components that supports hold along the surface are left out first: a reaction there would
        count as friction along the others, by the part that the normal has in it.
    """
    contact = forces.problem.contacts[number]
    needed = forces.at_contact(number) - forces.solution.normal_force[number]
    return contact.kinematics.tangential(np.where(contact.supports.free_along, needed, 0.0))


@dataclass(frozen=True, eq=False)
class ComparedFriction:
    """Quantities that friction checks compare at a contact's nodes where only friction acts.

    Attributes:
        contact: It has friction.
        bulk: Recovered friction, over the largest bound and the node's area: a traction's share.
        law: The friction law's, likewise.
        bound: The most that the points around a node can give it, likewise.
        beyond: How far the recovered friction is beyond all that they can give it, likewise; < 0
            within.
        crept: What the friction law gives a node whose slip is small, for a unit of its slip as
            friction feels it: |M M u_T|.
        slip: That the friction law counts (length).
        displacement: Of the nodes (length).
        moved: Largest displacement of all bodies (length).
        status: OPEN, STICK or SLIP.
        places: Undeformed coordinates, (nodes, 3) (length).
        area: That each stands for.
        strongest: The largest bound (stress).
        share: Of each node in the area of all of these, on all ranks.
        limit: What round-off and the accepted imbalance may leave, likewise.
        nodal: Whether each node is a point of its own, whose law can be asked.
        across: Largest friction of the law across the nodes' surface, where points lie between
            nodes on curved facets, likewise.
        comm: Communicator.
    """

    contact: ContactSurface
    bulk: Array
    law: Array
    bound: Array
    beyond: Array
    crept: Array
    slip: Array
    displacement: Array
    moved: float
    status: Words
    places: Array
    area: Array
    strongest: float
    share: Array
    limit: float
    nodal: bool
    across: float
    comm: MPI.Comm

    def worst(self, values: Array) -> tuple[float, Place]:
        """The largest of values at the nodes, and where it is; collective."""
        return worst_of(self.comm, values, self.places)


def compared_friction(forces: InternalForces) -> list[ComparedFriction]:
    """All contacts with friction to compare, in scene order; collective."""
    problem, solution = forces.problem, forces.solution
    found = []
    for number, contact in enumerate(problem.contacts):
        free, movable = contact.supports.free_along, contact.supports.movable
        counted = contact.owned_nodes & movable
        if not contact.friction.has_friction or problem.comm.allreduce(int(counted.sum())) == 0:
            continue
        trace = contact.trace
        traction = np.linalg.norm(solution.states[number].friction_traction, axis=1)
        strongest = largest(problem.comm, np.maximum(contact.friction_bound, traction))
        if strongest <= 0:  # not touched
            continue
        area = trace.to_nodes(trace.weights)
        unit = area * strongest
        bound = trace.to_nodes(trace.weights * contact.friction_bound) / unit
        bulk = free * recovered_friction(forces, number) / unit[:, None]
        given = solution.friction_force[number] / unit[:, None]
        law = free * contact.kinematics.tangential(given)
        since = contact.friction.effective_slip(solution.states[number].slip)
        moved = largest(problem.comm, np.abs(forces.displacement))
        if contact.regularisation_parameter == 0 and trace.nodal:
            law = free * _without_smoothing(contact, since, moved, bulk, strongest)
        slip = free * since[: len(contact.nodes)]
        metric = contact.friction.rule.metric
        pulled = metric.at(metric.at(since))[: len(contact.nodes)]
        lightest = smallest(problem.comm, unit[contact.owned_nodes])
        found.append(
            ComparedFriction(
                contact=contact,
                bulk=bulk[counted],
                law=law[counted],
                bound=bound[counted],
                beyond=_beyond(contact, bulk, bound, free)[counted],
                crept=np.linalg.norm(free * pulled, axis=1)[counted],
                slip=slip[counted],
                displacement=forces.displacement[contact.nodes][counted],
                moved=moved,
                status=solution.states[number].status[: len(contact.nodes)][counted],
                places=trace.coordinates[: len(contact.nodes)][counted],
                area=area[counted],
                strongest=strongest,
                share=area[counted] / total(problem.comm, area[counted].sum()),
                limit=TRACE + 2 * solution.imbalance_limit / lightest,
                nodal=trace.nodal,
                across=largest(problem.comm, np.abs(contact.kinematics.normal(given))[counted]),
                comm=problem.comm,
            )
        )
    return found


def _without_smoothing(
    contact: ContactSurface, slip: Array, moved: float, bulk: Array, strongest: float
) -> Array:
    """Friction at the nodes as Coulomb's law has it; where nothing slips that of the bulk.

    Args:
        contact: Whose points are nodes.
        slip: That the friction law counts, at the points (length).
        moved: Largest displacement of the body (length).
        bulk: As of ``ComparedFriction``, at all nodes of the contact.
        strongest: The largest bound (stress).
    """
    felt = contact.friction.rule.metric.at(slip)
    sizes = np.linalg.norm(felt, axis=1)
    slides = sizes > _NO_SLIP * moved
    directions = np.where(slides[:, None], felt / np.where(slides, sizes, 1.0)[:, None], 0.0)
    law = contact.friction.traction_from_bound(contact.friction_bound, directions) / strongest
    return np.where(slides[:, None], law, bulk)


def _beyond(contact: ContactSurface, bulk: Array, bound: Array, free: Flags) -> Array:
    """How far nodal friction is beyond what the points around can give, (nodes,).

    Each gives at most g M q, |q| ≤ 1. Along any v they give in all no more than Σ w g |M v|, and
    that is at most √(Σ w g · Σ w g |M v|²): a sum of ellipses lies within the ellipse of their mean
    M². It is asked along the normal of that one, which finds all that lies outside.

    Args:
        contact: The contact.
        bulk: As of ``ComparedFriction``, at all of its nodes.
        bound: Likewise.
        free: Axes along which no support holds a node, (nodes, components).
    """
    squared, trace = contact.friction.rule.metric.squared, contact.trace
    if squared is None:
        return np.asarray(np.linalg.norm(bulk, axis=1) - bound)
    components = bulk.shape[1]
    given = trace.weights * contact.friction_bound
    flat = (given[:, None, None] * squared).reshape(len(given), components**2)
    sums = np.stack([trace.to_nodes(column) for column in flat.T], axis=1)
    whole = trace.to_nodes(given)
    carries = whole > 0
    mean = np.broadcast_to(np.eye(components), (len(whole), components, components)).copy()
    mean[carries] = (sums[carries] / whole[carries, None]).reshape(-1, components, components)
    ways = free * contact.kinematics.tangential(np.linalg.solve(mean, bulk[..., None])[..., 0])
    most = bound * np.sqrt(np.einsum("ni,nij,nj->n", ways, mean, ways))
    sizes = np.linalg.norm(ways, axis=1)
    found = np.einsum("ni,ni->n", bulk, ways) - most
    return np.where(sizes > 0, found / np.where(sizes > 0, sizes, 1.0), -bound)


def _worst(
    contacts: list[ComparedFriction],
    compare: Callable[[ComparedFriction], tuple[float, Place]],
) -> Check | None:
    """The check of the frictional contact that comes nearest to its limit.

    Args:
        contacts: What is compared.
        compare: The global value of the check for one contact, good at or below 0, and where.
    """
    worst: Check | None = None
    for compared in contacts:
        found, place = compare(compared)
        found = found if np.isnan(found) else max(found, 0.0)
        check = Check(found, compared.limit, compared.contact.label, place)
        worst = nearer_to_failing(worst, check)
    return worst


def friction_cone(contacts: list[ComparedFriction]) -> Check | None:
    """|σ_T| − g, over the largest g (paper, (1.6)): traction within its bound.

    Where friction feels slip by M, how far σ_T is outside of the ellipse |M⁻¹ σ_T| ≤ g.
    """

    def excess(compared: ComparedFriction) -> tuple[float, Place]:
        return compared.worst(compared.beyond)

    return _worst(contacts, excess)


def friction_law(contacts: list[ComparedFriction]) -> Check | None:
    """|σ_T + g φ_ε′(u_T)| over the largest g (paper, (2.8)): bulk against friction law.

    Without smoothing the law says nothing where a point does not slip, but that friction is within
    its bound (``friction_cone``); where it slips, −g in the direction of the slip.
    """

    def difference(compared: ComparedFriction) -> tuple[float, Place]:
        return compared.worst(np.linalg.norm(compared.bulk - compared.law, axis=1))

    return _worst(contacts, difference)


def dissipation(contacts: list[ComparedFriction]) -> Check | None:
    """σ_T · u_T ≤ 0 at every point: friction takes energy, nowhere gives it (paper, (1.6)).

    Where points lie between nodes, a node's force is not that of one slip, and only the
    sum must be so: that of the forces, as Σ_i F_i·u_i = Σ_q w_q τ_q·u_q over points q. On
    curved facets that takes forces across the surface, too, and is left to ``friction_law``.
    """

    def given(compared: ComparedFriction) -> tuple[float, Place]:
        # Open points move far, and carry nothing: beside their slip all others are short. Only
        # where neighbours' pressures give them a bound they carry friction, too.
        carries = (compared.status != OPEN) | (compared.bound > 0)
        if compared.contact.regularisation_parameter == 0:  # what sticks slips by round-off
            carries &= np.linalg.norm(compared.slip, axis=1) > _NO_SLIP * compared.moved
        slip = np.where(carries[:, None], compared.slip, 0.0)
        power = np.einsum("ij,ij->i", compared.bulk, slip)
        longest = largest(compared.comm, np.linalg.norm(slip, axis=1)) or 1.0
        if compared.nodal:
            return compared.worst(power / longest)
        return total(compared.comm, compared.share @ power) / longest, ()

    return _worst([contact for contact in contacts if contact.across <= TRACE], given)


def outer_loop(forces: InternalForces, contacts: Sequence[int]) -> Check | None:
    """G of the friction that was solved against μ p of the pressure that came out; collective.

    Over the largest μ p, where it depends on a pressure that is not known. No other check sees a
    loop that ended too early: friction would be within a bound that is larger than it should be, or
    obey one that is smaller.

    Args:
        forces: Of a solution.
        contacts: Numbers of the contacts that are asked.
    """
    problem, solution = forces.problem, forces.solution
    worst: Check | None = None
    limit = TRACE + _LOOP_SAFETY * problem.scene.solver.outer_tolerance
    for number in contacts:
        contact = problem.contacts[number]
        if not contact.is_coulomb:
            continue
        wanted = contact.friction.bound_of(solution.states[number].contact_pressure)
        peak = largest(problem.comm, wanted)
        if peak <= 0 or not forces.carries(number):
            continue
        owned = contact.trace.owned
        off = np.abs(solution.friction_bound[number] - wanted)[owned]
        value, place = worst_of(problem.comm, off, contact.trace.coordinates[owned])
        worst = nearer_to_failing(worst, Check(value / peak, limit, contact.label, place))
    return worst


def slip_limit(forces: InternalForces) -> Check | None:
    """How much of what friction can hold against rigid motions of parts it does hold; collective.

    At all of it parts slip as one, and nothing says how far: pressures of the linear theory change
    with that, until an answer is found that means nothing. None where friction holds no part, and
    of bodies that move.
    """
    found = slip_shares(forces.problem, forces.solution.states) if forces.rests else None
    largest = None if found is None else found.largest()
    if largest is None:
        return None
    return Check(largest.share, HELD, part=" and ".join(largest.parts))
