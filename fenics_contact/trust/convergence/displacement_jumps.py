"""Places where what is prescribed tears the body: displacements that differ on the two sides.

A displacement that jumps along the boundary is not the trace of one of finite energy (J.-L. Lions,
E. Magenes, Non-homogeneous Boundary Value Problems, 1972, chapter 1: steps are not in H^½). The
stress falls like one over the distance from the jump, so forces and energies grow like the
logarithm of one over the cells' size, without end. What is prescribed comes from supports, from
glued obstacles, and from obstacles that may push only: these leave a node every displacement that
does not enter them, so all that holds at a node is asked together.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.mortar.turned_copies import TurnedCopies
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.convergence.support_steps import support_steps

# Jumps over the largest displacement that are none: their energy is 1e-12 of a whole one's.
_NONE = 1e-6
# Of two surfaces: how near to the point opposite a held node of the other is one, over its extent.
_SAME_PLACE = 1e-6
# Columns of a condition: node, place, whose it is, whether an equation, coefficients, right side.
_NODE, _PLACE, _KIND, _NUMBER, _IS_EQUATION, _OF, _RIGHT = 0, slice(1, 4), 4, 5, 6, slice(7, 10), 10
_WIDTH = 11
_CONTACT, _SUPPORT = 0.0, 1.0


@dataclass(frozen=True)
class Jump:
    """A place where prescribed displacements jump.

    Attributes:
        place: Undeformed, (3,) (length).
        size: By how much they differ, at the least (length).
        contacts: Numbers of the contacts that prescribe them, in scene order.
        supports: Numbers of the supports, in the order of ``Problem.applied_supports``.
    """

    place: tuple[float, ...]
    size: float
    contacts: tuple[int, ...]
    supports: tuple[int, ...]


def displacement_jumps(problem: Problem, displacement: Array, time: float) -> list[Jump]:
    """The largest jump between the same contacts and supports, of all such sets; collective.

    Foundations give way everywhere: they prescribe nothing.

    Args:
        problem: In the state of the answer.
        displacement: Of the answer, at the body's nodes of this rank (length).
        time: Its pseudo-time.
    """
    scale = _scale(problem, displacement)
    if scale == 0:
        return []
    stiff = {
        number: contact for number, contact in enumerate(problem.contacts) if contact.has_penalty
    }
    held = _held(problem, displacement, time)
    found = _at_nodes(problem, stiff, held, _NONE * scale)
    for number, contact in stiff.items():
        if contact.kinematics.faces_body:
            found += _between_bodies(problem, number, held, _NONE * scale)
    found += [
        Jump(place, size, (), (number,)) for number, place, size in support_steps(problem, time)
    ]
    return _largest_of_each(_along_edges(problem, found))


def _scale(problem: Problem, displacement: Array) -> float:
    """The largest displacement there is, of bodies and obstacles; collective."""
    sizes = [np.abs(displacement).ravel()]
    for contact in problem.contacts:
        kinematics = contact.kinematics
        sizes += [np.abs(kinematics.motion_at_points).ravel(), np.abs([kinematics.indentation])]
    return largest(problem.comm, np.concatenate(sizes))


def _held(problem: Problem, displacement: Array, time: float) -> list[tuple[Integers, Array]]:
    """Dofs and their values of each support; none of those that hold what nothing resists."""
    given = {id(support) for support in problem.supports.applied}
    idle = {id(support) for support in problem.stabilisation}
    found = []
    for support in problem.applied_supports:
        dofs, values = support.dofs, displacement.reshape(-1)[support.dofs]
        if id(support) in given and not support.follows:
            values = support.values * support.path(time)
        chosen = slice(0, 0) if id(support) in idle else slice(None)
        found.append((dofs[chosen], values[chosen]))
    return found


def _at_nodes(
    problem: Problem,
    stiff: dict[int, ContactSurface],
    held: list[tuple[Integers, Array]],
    least: float,
) -> list[Jump]:
    """Where supports and obstacles ask a node for what it cannot do; collective."""
    count = len(problem.spaces.coordinates)
    obstacles = {n: c for n, c in stiff.items() if not c.kinematics.faces_body}
    asked = np.zeros(count)
    for contact in obstacles.values():
        asked += contact.on_body
    is_held = np.zeros((count, problem.spaces.components), dtype=bool)
    for dofs, _ in held:
        is_held.reshape(-1)[dofs] = True
    chosen = asked + is_held.any(axis=1) > 1
    rows = [
        *(_rows_of_support(problem, number, *one, chosen) for number, one in enumerate(held)),
        *(_rows_of_obstacle(problem, number, chosen) for number in obstacles),
    ]
    whole = gather_rows(problem.comm, np.concatenate([np.zeros((0, _WIDTH)), *rows]))
    return [jump for part in _by_node(whole) if (jump := _jump(part)).size > least]


def _rows_of_support(
    problem: Problem,
    number: int,
    dofs: Integers,
    values: Array,
    chosen: Flags,
) -> Array:
    components = problem.spaces.components
    nodes = dofs // components
    mine = chosen[nodes] & (nodes < problem.spaces.owned_nodes)
    rows = _rows(problem, nodes[mine], (_SUPPORT, number, True))
    rows[np.arange(len(rows)), _OF.start + dofs[mine] % components] = 1.0
    rows[:, _RIGHT] = values[mine]
    return rows


def _rows_of_obstacle(problem: Problem, number: int, chosen: Flags) -> Array:
    """n·u ≤ s + n·(motion of the obstacle), or u = motion where it is glued on."""
    contact = problem.contacts[number]
    kinematics, nodes = contact.kinematics, contact.nodes
    gap = kinematics.whole_gap()[: len(nodes)]
    mine = chosen[nodes] & contact.owned_nodes & np.isfinite(gap)
    motion = kinematics.motion_at_points[: len(nodes)][mine]
    if not contact.is_one_sided:
        glued = []
        for axis, moved in enumerate(motion.T):
            row = _rows(problem, nodes[mine], (_CONTACT, number, True))
            row[:, _OF.start + axis], row[:, _RIGHT] = 1.0, moved
            glued.append(row)
        return np.concatenate(glued)
    rows = _rows(problem, nodes[mine], (_CONTACT, number, False))
    normals = contact.trace.normals[: len(nodes)][mine]
    rows[:, _OF.start : _OF.start + normals.shape[1]] = normals
    rows[:, _RIGHT] = gap[mine] + np.einsum("ni,ni->n", normals, motion)
    return rows


def _rows(problem: Problem, nodes: AnyIntegers, whose: tuple[float, int, bool]) -> Array:
    index_map = problem.spaces.displacement_space.dofmap.index_map
    rows = np.zeros((len(nodes), _WIDTH))
    rows[:, _NODE] = index_map.local_to_global(nodes.astype(np.int32))
    rows[:, _PLACE] = problem.spaces.coordinates[nodes]
    rows[:, [_KIND, _NUMBER, _IS_EQUATION]] = whose
    return rows


def _by_node(rows: Array) -> Iterator[Array]:
    rows = rows[np.argsort(rows[:, _NODE], kind="stable")]
    _, first = np.unique(rows[:, _NODE], return_index=True)
    return (part for part in np.split(rows, first[1:]) if len(part))


def _jump(rows: Array) -> Jump:
    """Return the least that conditions on one displacement leave unmet, and their owners."""
    left = _unmet(rows[:, _OF], rows[:, _RIGHT], rows[:, _IS_EQUATION] > 0)
    sizes = np.abs(left)
    part = rows[sizes > 1e-3 * sizes.max(initial=0.0)]
    numbers = [
        tuple(sorted({int(row[_NUMBER]) for row in part if row[_KIND] == kind}))
        for kind in (_CONTACT, _SUPPORT)
    ]
    # Of two that disagree by δ the least squares leave half of it to each.
    size = float(np.sqrt(2) * np.linalg.norm(left))
    return Jump(_place(rows[0, _PLACE]), size, numbers[0], numbers[1])


def _place(row: Array) -> tuple[float, ...]:
    return tuple(float(x) for x in row[:3])


def _unmet(matrix: Array, right: Array, equations: Flags) -> Array:
    """Residuals of A u = b where equations, (A u − b)₊ elsewhere, least squares over u.

    Of the few inequalities at a node all sets are tried that may be met as equations.
    """
    optional = np.flatnonzero(~equations)
    found = []
    for count in range(len(optional) + 1):
        for chosen in combinations(optional, count):
            rows = equations.copy()
            rows[list(chosen)] = True
            moved, *_ = np.linalg.lstsq(matrix[rows], right[rows], rcond=None)
            left = matrix @ moved - right
            found.append(np.where(equations, left, np.maximum(left, 0.0)))
    return min(found, key=lambda left: float(left @ left))


def _between_bodies(
    problem: Problem,
    number: int,
    held: list[tuple[Integers, Array]],
    least: float,
) -> list[Jump]:
    """Where supports of both bodies push them into each other at one place; collective.

    A held node that faces a part that is free does no harm: that part gives way.
    """
    contact = problem.contacts[number]
    opposite = contact.sides.opposite
    assert opposite is not None
    components = problem.spaces.components
    own, other = (_held_rows(problem, nodes, held) for nodes in (contact.nodes, opposite.nodes))
    gaps, normals = np.full(len(problem.load), np.inf), np.zeros_like(problem.load)
    gaps[contact.nodes] = contact.kinematics.gap[: len(contact.nodes)]
    normals[contact.nodes] = contact.trace.normals[: len(contact.nodes)]
    local = own[:, -1].astype(np.int64)
    extra = np.column_stack([gaps[local], normals[local]])
    own = gather_rows(problem.comm, np.column_stack([own[:, :_WIDTH], extra]))
    other = gather_rows(problem.comm, other[:, :_WIDTH])
    if contact.kinematics.pairing is not None:
        other = _in_all_copies(other, contact.kinematics.pairing.copies)
    found, reach = [], _SAME_PLACE * contact.trace.extent()
    parts = list(_by_node(other))
    places = np.array([part[0, _PLACE] for part in parts]).reshape(-1, 3)
    for part in _by_node(own):
        gap, normal = part[0, _WIDTH], part[0, _WIDTH + 1 :]
        if not np.isfinite(gap) or len(parts) == 0:
            continue
        faced = part[0, _PLACE].copy()
        faced[:components] += gap * normal
        distances = np.linalg.norm(places - faced, axis=1)
        nearest = int(distances.argmin())
        if distances[nearest] > reach:
            continue
        jump = _pressed_together(part[:, :_WIDTH], parts[nearest], (gap, normal), contact)
        if jump.size > least:
            found.append(Jump(jump.place, jump.size, (number,), jump.supports))
    return found


def _in_all_copies(rows: Array, copies: TurnedCopies) -> Array:
    """Rows of nodes of a master, and of these in the sectors of a ring that a slave may face."""
    size, count = copies.dimension, 1 + rows[:, _NODE].max(initial=0.0)
    found = np.tile(rows, (copies.size, 1, 1))
    found[:, :, _NODE] += count * np.arange(copies.size)[:, None]
    first = _PLACE.start
    found[:, :, first : first + size] = copies.places(rows[:, first : first + size])
    first = _OF.start
    found[:, :, first : first + size] = copies.directions(rows[:, first : first + size])
    return found.reshape(-1, rows.shape[1])


def _pressed_together(
    own: Array, other: Array, opening: tuple[float, Array], contact: ContactSurface
) -> Jump:
    """The jump of two nodes that supports hold, and a contact keeps apart or together."""
    gap, normal = opening
    components = len(normal)
    conditions = np.eye(components) if not contact.is_one_sided else normal[None]
    between = np.zeros((len(conditions), 2 * 3))
    between[:, :components], between[:, 3 : 3 + components] = conditions, -conditions
    held = np.zeros((len(own) + len(other), 2 * 3))
    held[: len(own), :3], held[len(own) :, 3:] = own[:, _OF], other[:, _OF]
    right = np.concatenate([own[:, _RIGHT], other[:, _RIGHT]])
    apart = np.full(len(conditions), gap if contact.is_one_sided else 0.0)
    equations = np.ones(len(right) + len(apart), dtype=bool)
    equations[len(right) :] = not contact.is_one_sided
    left = _unmet(np.vstack([held, between]), np.concatenate([right, apart]), equations)
    size = float(np.sqrt(3) * np.linalg.norm(left))  # of three conditions, each is left a third
    numbers = {int(row[_NUMBER]) for row in np.vstack([own, other])}
    return Jump(_place(own[0, _PLACE]), size, (), tuple(sorted(numbers)))


def _held_rows(
    problem: Problem,
    nodes: AnyIntegers,
    held: list[tuple[Integers, Array]],
) -> Array:
    """Conditions of supports on this rank's own nodes of a surface, with their local numbers."""
    chosen = np.zeros(len(problem.load), dtype=bool)
    chosen[nodes] = True
    components = problem.spaces.components
    parts = [np.zeros((0, _WIDTH + 1))]
    for number, (dofs, values) in enumerate(held):
        rows = _rows_of_support(problem, number, dofs, values, chosen)
        local = dofs // components
        local = local[chosen[local] & (local < problem.spaces.owned_nodes)]
        parts.append(np.column_stack([rows, local]))
    return np.concatenate(parts)


def _along_edges(problem: Problem, found: list[Jump]) -> list[Jump]:
    """Without those in 3D of a single node: a jump there alone costs no energy."""
    if problem.spaces.components == 2:
        return found
    count: dict[tuple[tuple[int, ...], tuple[int, ...]], int] = {}
    for jump in found:
        count[jump.contacts, jump.supports] = count.get((jump.contacts, jump.supports), 0) + 1
    return [jump for jump in found if count[jump.contacts, jump.supports] > 1]


def _largest_of_each(found: list[Jump]) -> list[Jump]:
    """One of each set of contacts and supports: the largest, and of equal ones the first."""
    best: dict[tuple[tuple[int, ...], tuple[int, ...]], Jump] = {}
    least = 1e-9 * max((jump.size for jump in found), default=0.0)  # round-off
    for jump in sorted(found, key=lambda jump: (-round(jump.size / least), jump.place)):
        best.setdefault((jump.contacts, jump.supports), jump)
    return sorted(best.values(), key=lambda jump: (jump.contacts, jump.supports, jump.place))
