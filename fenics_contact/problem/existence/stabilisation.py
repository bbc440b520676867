"""Motions that supports leave free before contact: their names, and those held for free.

Motions that nothing resists and nothing pushes, held at as few displacements as they are. So held,
a body is determined, and statically so: what holds it carries no force, whichever displacements
are chosen, and strains and contact forces are those of every other choice. That is checked on the
answer: the forces there are reactions, from the bulk.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fenics_contact.body.spaces import Spaces
from fenics_contact.body.supports import AppliedSupport
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import largest, of_every_rank, total
from fenics_contact.problem.existence.friction_cones import contact_cones
from fenics_contact.problem.existence.rigid_slip import allowance
from fenics_contact.problem.problem import Problem
from fenics_contact.problem.rigid_motions import RigidMotions

# Of two displacements that a motion moves equally far, the first by coordinates is taken.
_EQUAL = 1e-6
# Of the work of the loads: what is less is round-off.
_PUSHES = 1e-10


def stabilise(
    problem: Problem, rigid: RigidMotions, motions: Array, among: Flags | None = None
) -> tuple[str, ...]:
    """Hold motions that nothing resists, unless the loads push one of them; collective.

    Args:
        problem: It gets a support for each body held.
        rigid: Its free motions.
        motions: Combinations of them that nothing resists, as columns.
        among: Nodes of this rank that may be held; by default those off the contacts, where
            these are enough.

    Returns:
        The motions held, in words; none where the loads push one.
    """
    pushed = np.abs(rigid.force @ motions).max(initial=0.0) > _PUSHES * rigid.force_size
    if motions.shape[1] == 0 or pushed:
        return ()
    fields = np.stack([rigid.displacement(motion) for motion in motions.T], axis=-1)
    dofs = None
    for nodes in (_off_contacts(problem), None) if among is None else (among,):
        dofs = dofs if dofs is not None else determining_dofs(problem, fields, nodes)
    if dofs is None:  # an obstacle is free, which no support of a body holds
        return ()
    parts = problem.spaces.parts
    owner = parts.of_node[dofs // problem.spaces.components]
    for number, name in enumerate(parts.names):
        mine = dofs[owner == number]
        if total(problem.comm, len(mine)) > 0:
            whose = f" of '{name}'" if parts.count > 1 else ""
            support = AppliedSupport(f"the stabilisation{whose}", mine, np.zeros(len(mine)))
            problem.stabilise(support)
    return tuple(rigid.describe(motion) for motion in motions.T)


def _off_contacts(problem: Problem) -> Flags:
    """Nodes of this rank that no contact surface has; collective."""
    found = np.ones(len(problem.spaces.coordinates), dtype=bool)
    for contact in problem.contacts:
        found &= ~contact.on_body
        if contact.kinematics.pairing is not None:
            found &= ~contact.kinematics.pairing.master_nodes()
    return found


def determining_dofs(problem: Problem, fields: Array, nodes: Flags | None) -> Integers | None:
    """Dofs, as many as there are fields, that let these vanish only together; collective.

    Each is the one that moves farthest in what the earlier ones leave (pivoted QR), so that the
    forces on them are no larger than what is out of balance elsewhere.

    Args:
        problem: The model.
        fields: At the nodes of this rank, (nodes, components, fields).
        nodes: Which of them may be taken; by default all.

    Returns:
        Local numbers of those of this rank, owned and ghost; None where there are too few.
    """
    spaces, comm, cut = problem.spaces, problem.comm, problem.discrete.cut
    components, count = spaces.components, fields.shape[-1]
    rest = fields[: spaces.owned_nodes].reshape(-1, count).copy()
    if nodes is not None:
        rest[~np.repeat(nodes[: spaces.owned_nodes], components)] = 0.0
    if cut is not None:  # what is held there is held on both faces
        rest[np.repeat(cut.nodes[: spaces.owned_nodes], components)] = 0.0
    first = largest(comm, np.linalg.norm(rest, axis=1))
    index_map = spaces.displacement_space.dofmap.index_map
    numbers = index_map.local_to_global(np.arange(len(spaces.coordinates), dtype=np.int32))
    chosen = [np.zeros(0, dtype=np.int64)]
    for _ in range(count):
        sizes = np.linalg.norm(rest, axis=1)
        top = largest(comm, sizes)
        if not top > _EQUAL * first:
            return None
        candidates = np.flatnonzero(sizes >= (1 - _EQUAL) * top)
        best = min((_place(spaces, dof), dof) for dof in candidates) if len(candidates) else None
        mine = None if best is None else (best[0], numbers[best[1] // components], rest[best[1]])
        offers: list[Any] = [offer for offer in of_every_rank(comm, mine) if offer is not None]
        (*_, axis), node, row = min(offers, key=lambda offer: offer[0])
        along = row / np.linalg.norm(row)
        rest -= np.outer(rest @ along, along)
        chosen.append(np.flatnonzero(numbers == node) * components + axis)
    return np.concatenate(chosen)


def _place(spaces: Spaces, dof: int | np.integer[Any]) -> tuple[float, ...]:
    """Where a dof of this rank is, rounded, its part and its axis: for an order of them."""
    node, axis = divmod(int(dof), spaces.components)
    parts = spaces.parts
    part = int(parts.of_node[node])
    return (part, *np.round(parts.arms[node] / parts.sizes[part], 9).tolist(), axis)


# Jump of a motion, over its size, from which a contact resists it.
_RESISTS = 1e-9


def named_motions(problem: Problem, rigid: RigidMotions) -> list[dict[str, Any]]:
    """``model.rigid_motions`` of a result; collective.

    Returns:
        A row a motion: ``motion`` in words, ``bodies`` that take part, and ``resisted_by``: the
        contacts that may stop it once they touch.
    """
    rows = []
    motions = contact_cones(problem, rigid).aligned()[1] if rigid.count else np.zeros((0, 0))
    for motion in motions.T:
        resisted = []
        for contact in problem.contacts:
            if not contact.forces.terms:
                continue
            jumps = rigid.jumps(contact) @ motion
            across = contact.kinematics.normal(jumps)
            along = np.linalg.norm(contact.kinematics.tangential(jumps), axis=1)
            acts = contact.kinematics.reached | contact.normal.pressure_is_known
            size = allowance(contact.kinematics.facet_turn) * largest(problem.comm, along[acts])
            # Facets do not hold what a round surface does not.
            presses = contact.is_one_sided and largest(problem.comm, np.abs(across)[acts]) > size
            for word, sizes in (
                ("contact", np.abs(across) * presses),
                ("friction", along * contact.friction.has_friction),
            ):
                if largest(problem.comm, sizes[acts]) > _RESISTS:
                    resisted.append(f"{word} at '{contact.label}'")
        name, bodies = rigid.describe(motion), rigid.parts_moved(motion)
        rows.append({"motion": name, "bodies": bodies, "resisted_by": resisted})
    return rows
