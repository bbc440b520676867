"""Checks of resultants: contacts against what is put on and against stress, and of the balance.

The bulk is asked what it takes from contacts. Equilibrium of the body holds whatever force an
obstacle exerts, and whatever pressure was assembled: supports take it up. And where no support
acts, it says nothing of the bulk. Between two bodies, what one gets the other gives, at the same
place.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import numpy as np
from dolfinx import fem

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.parallel import largest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.surface.facets import relative_cell_size
from fenics_contact.evaluate.internal_forces import InternalForces
from fenics_contact.problem.problem import Problem
from fenics_contact.results.result import Check
from fenics_contact.trust.comparison import balance, nearer_to_failing

# Between two bodies: round-off of what is handed over, and what its limit is made of: how far the
# surfaces are apart, and their facets from smooth ones, over the contact's extent.
_PAIR_ROUND_OFF = 1e-6
_PAIR_SAFETY = 4.0


def resultant(forces: InternalForces) -> Check | None:
    """Resultants of contacts from the bulk, K u − f, against loads; collective.

    - The force along its direction of an obstacle that a force drives, against that force.
    - The forces of given pressures against ∫ p n, p as reported.
    - The forces of all contacts on a connected part, along axes that no support holds,
      against the loads on it.

    Each relative to the forces that it adds up. None where there is nothing of the kind, and of
    bodies that move.
    """
    if not forces.rests:
        return None
    worst: Check | None = None
    for check in (*_obstacles(forces), *_pressures(forces), *_parts(forces)):
        worst = nearer_to_failing(worst, check)
    return worst


def _obstacles(forces: InternalForces) -> list[Check]:
    """The force of each obstacle that a force drives, or a moment turns, against it; collective."""
    found = []
    free, comm = forces.problem.free, forces.problem.comm
    imbalance = forces.solution.imbalance_limit
    for one in forces.problem.unknowns:
        contact = one.contact
        if contact is None or not one.moves_obstacle or one.own:
            continue
        number = forces.problem.contacts.index(contact)
        given = forces.solution.contact_force[number]
        # Where supports hold, the bulk's forces are theirs, too.
        needed = np.where(free[contact.nodes], forces.at_contact(number), given)
        field = one.field[contact.trace.numbers]
        along = np.einsum("ij,ij->i", needed, field)[contact.owned_nodes]
        pushed, carried = total(comm, np.array([along.sum(), np.abs(along).sum()]))
        force = one.force
        size = max(abs(force), carried)
        found.append(balance(pushed - force, size, imbalance, contact.label, "obstacle"))
    return found


def _pressures(forces: InternalForces) -> list[Check]:
    """The forces of all given pressures together, against ∫ p n; collective."""
    problem, solution = forces.problem, forces.solution
    pairs = zip(problem.contacts, solution.states, strict=True)
    given = [(c, state) for c, state in pairs if c.normal.is_load]
    if not given:
        return []
    pressed = np.zeros(len(problem.load), dtype=bool)
    expected, carried = np.zeros(problem.spaces.components), 0.0
    for contact, state in given:
        pressed |= contact.on_body
        pressure = state.contact_pressure
        expected -= contact.trace.integral(pressure[:, None] * contact.trace.normals)
        carried += float(contact.trace.integral(np.abs(pressure)))
    needed = problem.pressure_load + np.where(problem.free, forces.unbalanced, 0.0)
    owned = slice(0, problem.spaces.owned_nodes)
    found = total(problem.comm, (needed[owned] * pressed[owned, None]).sum(axis=0))
    label = given[0][0].label if len(given) == 1 else ""
    off = float(np.linalg.norm(found - expected))
    return [balance(off, carried, solution.imbalance_limit, label, "pressure")]


def _parts(forces: InternalForces) -> list[Check]:
    """The forces of contacts on each part along axes that no support holds; collective."""
    problem = forces.problem
    spaces, parts = problem.spaces, problem.spaces.parts
    touched = np.zeros(len(problem.load), dtype=bool)
    for contact in problem.contacts:
        if contact.forces.terms:
            everywhere = np.ones(len(contact.trace.all_nodes), dtype=bool)
            touched |= contact.kinematics.reaches(everywhere)
    nodes, loaded = np.flatnonzero(touched[: spaces.owned_nodes]), forces.acting(forces.load)
    needed, load = (forces.unbalanced + forces.contacts)[nodes], forces.load[loaded]
    held = _held_axes(problem)
    resultants = parts.sums(needed, nodes) + parts.sums(load, loaded)
    if problem.discrete.cut is not None:
        resultants += parts.sums(forces.across_cut[: spaces.owned_nodes])
    left = np.where(held, 0.0, resultants)
    carried = parts.sums(np.abs(needed).sum(axis=1), nodes)
    carried += parts.sums(np.abs(load).sum(axis=1), loaded)
    by_contacts = parts.sums(np.ones(len(nodes)), nodes) > 0
    imbalance = forces.solution.imbalance_limit
    return [
        balance(float(np.linalg.norm(left[n])), carried[n], imbalance, kind="part", part=name)
        for n, name in enumerate(parts.names)
        if by_contacts[n] and not held[n].all()
    ]


def _held_axes(problem: Problem) -> Flags:
    """Along which axes supports hold each part, (parts, components); collective."""
    spaces = problem.spaces
    size, dofs = spaces.components, problem.constrained
    dofs = dofs[dofs < spaces.owned_nodes * size]
    along = np.zeros((len(dofs), size))
    along[np.arange(len(dofs)), dofs % size] = 1.0
    held = np.asarray(spaces.parts.sums(along, dofs // size) > 0)
    for springs in problem.elastic.springs:
        nodes = spaces.nodes(springs.group)
        nodes = nodes[nodes < spaces.owned_nodes]
        ways = springs.along(nodes)[springs.stiffness > 0]
        held |= np.asarray(spaces.parts.sums(np.abs(ways).sum(axis=0), nodes) > 0)
    for face in problem.elastic.faces:
        nodes = face.nodes[face.nodes < spaces.owned_nodes]
        held |= np.asarray(spaces.parts.sums(np.ones(len(nodes)), nodes) > 0)[:, None]
    if spaces.kinematics == "axisymmetric":
        held[:, 0] = True  # radial forces have no resultant
    return held


def action_and_reaction(forces: InternalForces) -> Check | None:
    """Forces of a contact on both bodies, and their moments, add up to zero.

    Relative to the forces on the slave, moments over the extent of its surface. Forces are handed
    over between points that face each other, so they may be off by the distance of these. Across
    planes of symmetry forces need not balance. Across the cut of a sector they are turned: there
    forces along the radius and along the axis count, and the moment about the axis.
    """
    worst: Check | None = None
    for contact, given in zip(forces.problem.contacts, forces.solution.contact_force, strict=True):
        if contact.kinematics.faces_body:
            nodal = contact.kinematics.on_body(contact.trace.at_all_nodes(given))
            worst = nearer_to_failing(worst, _handed_over(forces, contact, nodal))
    return worst


def _handed_over(forces: InternalForces, contact: ContactSurface, nodal: Array) -> Check:
    spaces, extent = contact.spaces, contact.trace.extent()
    owned, size = slice(0, spaces.owned_nodes), spaces.components
    vectors, places = np.zeros((2, spaces.owned_nodes, 3))
    vectors[:, :size] = nodal[owned]
    places[:, :size] = spaces.coordinates[owned, :size] + forces.displacement[owned]
    carried = total(spaces.comm, np.linalg.norm(vectors, axis=1).sum()) / 2 or 1.0
    pairing = contact.kinematics.pairing
    if pairing is not None and pairing.crosses_cut:
        left = _left_in_sector(contact, vectors, places)
    else:
        left = _left_of_forces(contact, vectors, places)
    off = np.linalg.norm(left)
    closed = contact.kinematics.reached & (contact.pressure() != 0)
    # By value, sides that touch are as far apart as they overlap.
    drawn = np.abs(contact.kinematics.distance_as_drawn[closed])
    apart = largest(spaces.comm, drawn) + abs(contact.kinematics.interference)
    limit = (
        _PAIR_SAFETY * (apart + contact.kinematics.sagitta) / extent
        + 2 * contact.relative_sliding()
    )
    return Check(float(off) / carried, min(_PAIR_ROUND_OFF + limit, 0.5), contact.label)


def _left_of_forces(contact: ContactSurface, vectors: Array, places: Array) -> Array:
    """Resultant and moment, this over the extent, that need to be zero (force); collective.

    Args:
        contact: Between two bodies.
        vectors: Forces at this rank's own nodes, (nodes, 3) (force).
        places: Where the nodes stand, (nodes, 3) (length).
    """
    spaces, weights = contact.spaces, np.linalg.norm(vectors, axis=1)
    centre = total(spaces.comm, weights @ places) / (total(spaces.comm, weights.sum()) or 1.0)
    moments = np.cross(places - centre, vectors) / contact.trace.extent()
    mirrored = contact.trace.symmetry.axes
    counted = [k for k in range(3) if k not in mirrored]
    turned = [k for k in range(3) if not {0, 1, 2} - {k} & set(mirrored)]
    if spaces.kinematics == "axisymmetric":
        turned = []
    left = total(spaces.comm, np.concatenate([vectors.sum(axis=0), moments.sum(axis=0)]))
    return np.array([*left[counted], *(left[3 + k] for k in turned)])


def _left_in_sector(contact: ContactSurface, vectors: Array, places: Array) -> Array:
    """Resultants that no turn changes: radial, axial, moment about the axis; collective.

    Args:
        contact: Between two bodies of a sector, across its cut.
        vectors: As of ``_left_of_forces``.
        places: Likewise.
    """
    cut = contact.trace.cut
    assert cut is not None
    arms = places - cut.centre
    arms = arms - np.outer(arms @ cut.axis, cut.axis)
    lengths = np.linalg.norm(arms, axis=1)[:, None]
    radial = np.divide(arms, lengths, out=np.zeros_like(arms), where=lengths > 0)
    sums = np.array(
        [
            (radial * vectors).sum(),
            (vectors @ cut.axis).sum(),
            (np.cross(arms, vectors) @ cut.axis).sum() / contact.trace.extent(),
        ]
    )
    return np.asarray(total(contact.spaces.comm, sums))


# What holds a motion that nothing pushes: of the forces applied.
_NO_FORCE = 1e-9
# Of the motions of couplings, round-off.
_NO_MOTION = 1e-12


def equilibrium(forces: InternalForces) -> Check | None:
    """Resultants and moments of loads, support reactions and contact forces add up to zero.

    In every part of the body by itself, relative to the sum of its nodal forces; the part
    nearest to failing counts, and where there are several, each is told. None of bodies that move.
    """
    if not forces.rests:
        return None
    spaces, found = forces.problem.spaces, forces.balances()
    if spaces.kinematics == "axisymmetric":  # radial nodal forces balance around the ring
        left = np.abs(found.resultants[:, 1])
    else:
        left = np.linalg.norm(np.hstack([found.resultants, found.moments]), axis=1)
    imbalance = forces.imbalance
    every = [
        balance(value, sum_of_forces, imbalance, part=name)
        for name, value, sum_of_forces in zip(spaces.parts.names, left, found.carried, strict=True)
    ]
    worst = reduce(nearer_to_failing, every)  # a body has at least one part
    return replace(worst, parts=tuple(every)) if len(every) > 1 else worst


def preloads(forces: InternalForces) -> Check | None:
    """Force along each part that is tightened against the one that it is tightened to; collective.

    None where no force is given.
    """
    return _given_forces(forces, "preload")


def couplings(forces: InternalForces) -> Check | None:
    """Force and moment that the body needs of each coupling, and its motion, against those given.

    Moments over the largest distance of the face from its point, rotations times it. None where
    nothing is given. Collective.
    """
    worst = _given_motions(forces)
    pulled = _given_forces(forces, "coupling")
    if pulled is None:
        return worst
    return nearer_to_failing(worst, replace(pulled, kind="force"))


def _given_motions(forces: InternalForces) -> Check | None:
    """Motions of couplings against those given, over the largest motion; collective."""
    every = zip(forces.problem.body_scalars, forces.scalar_states(), strict=True)
    moved = [(one, state.value) for one, state in every if one.check == "coupling"]
    compared = [(one.held, value) for one, value in moved if one.is_locked and one.held is not None]
    if not compared:
        return None
    asked, found = np.array(compared).T
    size = float(np.abs([*asked, *(value for _, value in moved)]).max()) or 1.0
    return Check(float(np.abs(found - asked).max()) / size, _NO_MOTION, kind="motion")


def _given_forces(forces: InternalForces, check: str) -> Check | None:
    """Forces on scalars of the body against those given, over the largest of both; collective.

    The one compared follows from the displacement and the scalar.

    Args:
        forces: Of the answer.
        check: Of which of the body's scalars; those that are locked do not count.
    """
    solution = forces.solution
    chosen = [row for row in forces.scalar_balances() if row.scalar.check == check]
    compared = [(row.asked, row.found) for row in chosen if not row.scalar.is_locked]
    if not compared:
        return None
    asked, found = np.array(compared).T
    size = float(np.abs([*asked, *found, *(row.size for row in chosen)]).max()) or 1.0
    value = float(np.abs(found - asked).max()) / size
    return Check(value, _NO_FORCE + 2 * solution.imbalance_limit / size)


def stabilisation(forces: InternalForces) -> Check | None:
    """Largest force where motions that nothing resists are held, over all forces applied.

    It vanishes, but for what is left out of balance elsewhere, whose lever is no longer.
    """
    problem = forces.problem
    if not problem.stabilisation:
        return None
    owned = problem.spaces.owned_nodes
    applied = np.abs(forces.load[:owned]).sum() + np.abs(forces.contacts[:owned]).sum()
    size = total(problem.comm, float(applied)) or 1.0
    value = largest(problem.comm, np.abs(forces.at_stabilised())) / size
    return Check(value, _NO_FORCE + 2 * forces.solution.imbalance_limit / size)


def point_supports(forces: InternalForces) -> Check | None:
    """Largest force where a point is held, or an edge in space, over all forces; collective.

    No finite force acts on so little of a body: what gives way there grows without end as cells get
    smaller. None where boundaries hold these dofs, too.
    """
    problem = forces.problem
    if not problem.at_places:
        return None
    applied = problem.applied_supports
    others = [one.dofs for number, one in enumerate(applied) if number not in problem.at_places]
    dofs = np.unique(np.concatenate([applied[number].dofs for number in problem.at_places]))
    dofs = np.setdiff1d(dofs, np.concatenate([dofs[:0], *others]))
    owned = problem.spaces.owned_nodes
    acting = np.abs(forces.load[:owned]).sum() + np.abs(forces.contacts[:owned]).sum()
    reactions = np.where(problem.free, 0.0, forces.unbalanced)[:owned]
    size = total(problem.comm, float(acting + np.abs(reactions).sum())) or 1.0
    own = dofs[dofs < owned * problem.spaces.components]
    value = largest(problem.comm, np.abs(forces.unbalanced.reshape(-1)[own])) / size
    return Check(value, _NO_FORCE + 2 * forces.imbalance / size)


# Boundary stress against reactions: first order in the size h of the cells behind the facets,
# whose stress it is (corners and the stick-slip edge cap the order). Over 320 random scenes, from
# 2 facets up and with cells deeper than wide, the difference was at most 2.1 h/L with degree 1 and
# .58 h/L with degree 2; over the facets' size it came to 4.5 and 1.3.
_STRESS_OVER_SIZE = {1: 5.0, 2: 1.5}
# A limit that a body without any stress would keep is none: half, or this share of what such a
# body has where that is more.
_LARGEST_STRESS_LIMIT = 0.5
_OF_NO_STRESS = 0.8


def boundary_stress(forces: InternalForces) -> Check | None:
    """∫ σ(u) n over each contact against its pressure and friction resultants.

    Relative to ∫ (p + g + mean stress of the body): where the contact carries little,
    the error of the stress is still that of the body's. First order in the cell size.
    The resultants of other contacts on the same surface count with it. Left out are contacts that
    loads act on as well, or others on a part of them, and axes along which supports hold the
    contact: their forces are in σ n, too. None of bodies that move, in which stress varies in time.
    """
    if not forces.rests:
        return None
    problem = forces.problem
    spaces = problem.spaces
    typical = _mean_stress(forces)
    worst: Check | None = None
    for number, contact in enumerate(problem.contacts):
        axes = ~contact.supports.held_axes()
        acting = _on_surface(problem, contact)
        if acting is None or not axes.any():
            continue
        given = np.sum([sign * _resultant(forces, other) for other, sign in acting], axis=0)
        carried = sum(_carried(forces, other) for other, _ in acting)
        limit = _STRESS_OVER_SIZE[spaces.degree] * relative_cell_size(contact.trace.surface)
        if limit > _LARGEST_STRESS_LIMIT and contact.is_one_sided:
            continue  # it may touch in a single point of so coarse a surface
        found = forces.of_stress(number)
        resultant = float(np.linalg.norm(given[axes]))
        without_stress = resultant / (carried or 1.0)
        most = max(_LARGEST_STRESS_LIMIT, _OF_NO_STRESS * without_stress)
        unit = carried + typical * _area(contact) or 1.0
        left = 2 * forces.solution.imbalance_limit / unit  # of a body that has been unloaded, all
        check = Check(
            float(np.linalg.norm((found - given)[axes]) / unit),
            min(limit, most) + left,
            contact.label,
        )
        worst = nearer_to_failing(worst, check)
    return worst


def _on_surface(problem: Problem, contact: ContactSurface) -> list[tuple[int, float]] | None:
    """Numbers of the contacts that act on the slave surface of one, and the signs of their forces.

    None where something else acts there as well, or a contact on a part of it.
    """
    group = contact.sides.group
    if problem.is_loaded(group):
        return None
    tags, found = set(group.tags), []
    for number, other in enumerate(problem.contacts):
        for trace, sign in ((other.trace, 1.0), (other.sides.opposite, -1.0)):
            if trace is None or not tags & set(trace.group.tags):
                continue
            if tags != set(trace.group.tags):
                return None
            found.append((number, sign))
    return found


def _area(contact: ContactSurface) -> float:
    """Return the area of a contact's slave (area)."""
    return float(contact.trace.integral(np.ones(len(contact.trace.weights))))


def _resultant(forces: InternalForces, number: int) -> Array:
    """∫ of the tractions on a contact's slave, (components,) (force)."""
    trace, state = forces.problem.contacts[number].trace, forces.solution.states[number]
    pressure = state.contact_pressure[:, None] * trace.normals
    return np.asarray(trace.integral(state.friction_traction - pressure))


def _carried(forces: InternalForces, number: int) -> float:
    """∫ (p + g) of a contact (force)."""
    contact, state = forces.problem.contacts[number], forces.solution.states[number]
    return float(contact.trace.integral(np.abs(state.contact_pressure) + contact.friction_bound))


def _mean_stress(forces: InternalForces) -> float:
    """Root mean square stress of the body, √(E a(u, u) / volume), E the largest stiffness."""
    problem = forces.problem
    energy = 2 * forces.strain_energy
    volume = problem.discrete.once("volume", lambda: _volume(problem.spaces))
    return float(np.sqrt(max(energy, 0.0) * problem.elastic.reference_modulus / volume))


def _volume(spaces: Spaces) -> float:
    """Return the volume of the body, of all ranks (volume)."""
    found = fem.assemble_scalar(form_cache.form(spaces.weight * spaces.bulk))
    return float(total(spaces.comm, found))
