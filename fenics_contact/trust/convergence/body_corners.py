"""Corners of a body, up to which a rigid obstacle presses it, and at which stress has no bound.

In plane and axisymmetric models, of isotropic bodies. Where friction points away from the corner
into the contact, already a right angle has such a stress; without it an obtuse one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx.mesh import compute_midpoints

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.common.parallel import gather_rows, largest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, STICK, ContactState
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.convergence.wedge import is_singular

# Of the extent: as near are places the same.
_SAME = 1e-8
# Of the largest pressure, below which a corner is not pressed.
_PRESSED = 1e-6
# Facets that neither this contact has nor are free.
_OTHER, _FREE = -2.0, -1.0


@dataclass(frozen=True)
class Corner:
    """One at which stress has no bound.

    Attributes:
        contact: Number of the contact that reaches up to it, in scene order.
        place: Undeformed, (length).
        angle: Of the body there (degrees).
        rubs: Whether friction acts there.
    """

    contact: int
    place: tuple[float, ...]
    angle: float
    rubs: bool


def singular_corners(problem: Problem, states: Sequence[ContactState]) -> list[Corner]:
    """Return the corners of a solution where stress has no bound; collective.

    Args:
        problem: Its model.
        states: Of its contacts, in scene order.
    """
    kolosov = _kolosov(problem)
    chosen = [
        number
        for number, contact in enumerate(problem.contacts)
        if contact.has_penalty and not contact.kinematics.faces_body
    ]
    if problem.spaces.components != 2 or not kolosov or not chosen:
        return []
    facets = _boundary(problem)
    found = []
    for number in chosen:
        points = _pressed_points(problem.contacts[number], states[number])
        for place, along, angle in _corners(facets, number):
            near = np.linalg.norm(points[:, :2] - place, axis=1) <= _SAME * _extent(facets)
            for _, _, pressure, *traction, sticks in points[near][:1]:
                ratio = float(np.array(traction) @ along) / pressure
                friction = None if sticks else ratio
                if any(is_singular(angle, friction, one) for one in kolosov):
                    found.append(
                        Corner(
                            number,
                            (float(place[0]), float(place[1])),
                            float(np.degrees(angle)),
                            bool(sticks) or abs(ratio) > 0,
                        )
                    )
    return found


def _kolosov(problem: Problem) -> list[float]:
    """3 − 4ν of its materials, in plane stress (3 − ν)/(1 + ν); nothing where one is not known."""
    found = []
    for material in problem.scene.material:
        ratio = material.poissons_ratio
        if not isinstance(ratio, float | int):
            return []
        plane_stress = problem.spaces.kinematics == "plane stress"
        found.append((3 - ratio) / (1 + ratio) if plane_stress else 3 - 4 * ratio)
    return found


def _boundary(problem: Problem) -> Array:
    """Facets of all ranks: both ends, the middle of the cell behind, and whose they are, (…, 7).

    The last is the number of a contact, or whether a facet is free.
    """
    body = problem.spaces.body
    topology = body.mesh.topology
    for kind, other in ((1, 0), (1, 2), (0, 2)):
        topology.create_connectivity(kind, other)
    facets = compat.exterior_facets(body.mesh)
    ends = np.array([topology.connectivity(1, 0).links(f) for f in facets], dtype=np.int32)
    cells = np.array([topology.connectivity(1, 2).links(f)[0] for f in facets], dtype=np.int32)
    places = compute_midpoints(body.mesh, 0, ends.reshape(-1)).reshape(-1, 2, 3)[:, :, :2]
    behind = compute_midpoints(body.mesh, 2, cells).reshape(-1, 3)[:, :2]
    whose = np.full(len(facets), _FREE)
    if problem.spaces.kinematics == "axisymmetric":
        farthest = largest(problem.comm, np.abs(places[:, :, 0]).ravel())
        whose[(np.abs(places[:, :, 0]) <= _SAME * farthest).all(axis=1)] = _OTHER
    for support in problem.applied_supports:
        whose[_of_group(problem, support.on, facets)] = _OTHER
    for number, contact in enumerate(problem.contacts):
        for name in (contact.contact.on, contact.contact.against):
            if name is not None:
                mine = _of_group(problem, name, facets)
                whose[mine] = np.where(whose[mine] == _FREE, number, _OTHER)
    rows = np.column_stack([places.reshape(-1, 4), behind, whose])
    return np.asarray(gather_rows(problem.comm, rows))


def _of_group(problem: Problem, name: str, facets: AnyIntegers) -> Flags:
    """Return for each facet whether it is of a group; none is of a group of cells."""
    group = problem.spaces.body.find(name)
    if group is None or group.dimension != 1:
        return np.zeros(len(facets), dtype=bool)
    return np.isin(facets, problem.spaces.body.entities(group))


def _pressed_points(contact: ContactSurface, state: ContactState) -> Array:
    """Return place, pressure, friction traction and sticking of all ranks' points, (points, 6)."""
    pressure = state.contact_pressure
    least = _PRESSED * largest(contact.spaces.comm, pressure)
    mine = contact.trace.owned & (state.status != OPEN) & (pressure > least)
    rows = [
        contact.trace.coordinates[:, :2],
        pressure[:, None],
        state.friction_traction,
        (state.status == STICK)[:, None],
    ]
    return np.asarray(gather_rows(contact.spaces.comm, np.column_stack(rows)[mine]))


def _extent(facets: Array) -> float:
    return float(np.ptp(facets[:, :4].reshape(-1, 2), axis=0).max())


def _corners(facets: Array, number: int) -> list[tuple[Array, Array, float]]:
    """Where a contact ends and a free side begins: place, direction along the contact, angle."""
    found = []
    ends = np.concatenate([facets[:, :2], facets[:, 2:4]])
    of_facet = np.tile(np.arange(len(facets)), 2)
    keys = np.round(ends / (_SAME * _extent(facets))).astype(np.int64)
    _, vertex = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(vertex.reshape(-1), kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(vertex.reshape(-1)[order])) + 1)
    for group in groups:
        whose = facets[of_facet[group], 6]
        if len(group) != 2 or set(whose) != {float(number), _FREE}:
            continue
        pressed, free = (of_facet[group[whose == one][0]] for one in (number, _FREE))
        place = ends[group[0]]
        along, away = (_direction(facets[one], place) for one in (pressed, free))
        angle = float(np.arccos(np.clip(along @ away, -1.0, 1.0)))
        middle = facets[pressed, :4].reshape(2, 2).mean(axis=0)
        is_reentrant = (facets[pressed, 4:6] - middle) @ away < -1e-9 * _extent(facets)
        found.append((place, along, 2 * np.pi - angle if is_reentrant else angle))
    return found


def _direction(facet: Array, place: Array) -> Array:
    """Along a facet, away from one of its ends."""
    ends = facet[:4].reshape(2, 2)
    other = ends[np.linalg.norm(ends - place, axis=1).argmax()]
    return np.asarray((other - place) / np.linalg.norm(other - place))
