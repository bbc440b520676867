"""Corners of a body, up to which a rigid obstacle presses it, and at which stress has no bound.

In plane and axisymmetric models, of isotropic bodies. Where friction points away from the corner
into the contact, already a right angle has such a stress; without it an obtuse one.

Whether stress has a bound at the tip of a wedge, one face of which a rigid obstacle presses. Near
the tip displacements go like r^λ, and stress like r^(λ−1): it grows without end where some λ lies
below 1 (M. L. Williams, J. Appl. Mech. 19 (1952) 526-528; with friction J. Dundurs, M. S. Lee, J.
Elasticity 2 (1972) 109-112, and E. E. Gdoutos, P. S. Theocaris, J. Appl. Mech. 42 (1975) 688-692).
The other face is free.
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

# λ from which growth is too slow for any mesh to show it: 1 % from one to the next half its size.
_BOUNDED = 0.985
# Where λ is looked for beside that, and how finely.
_LEAST, _HEIGHT, _POINTS = 0.2, 1.0, 400


def is_singular(angle: float, friction: float | None, kolosov: float) -> bool:
    """Whether stress has no bound at the tip.

    Args:
        angle: Between the faces, through the wedge (radian).
        friction: Friction traction on the wedge along the pressed face, away from the tip, over the
            pressure; None where the face sticks.
        kolosov: 3 − 4ν in plane strain and beside an axis, (3 − ν)/(1 + ν) in plane stress.
    """
    return _zeros(angle, friction, kolosov) > 0


def _zeros(angle: float, friction: float | None, kolosov: float) -> int:
    """How many λ lie left of the bound: as often the determinant goes round zero about them."""
    along = np.linspace(0.0, 1.0, _POINTS, endpoint=False)
    corners = [
        complex(x, y)
        for x, y in (
            (_LEAST, -_HEIGHT),
            (_BOUNDED, -_HEIGHT),
            (_BOUNDED, _HEIGHT),
            (_LEAST, _HEIGHT),
        )
    ]
    sides = zip(corners, corners[1:] + corners[:1], strict=True)
    path = np.concatenate([begin + (end - begin) * along for begin, end in sides])
    values = np.linalg.det(_conditions(path, angle, friction, kolosov))
    turned = np.angle(np.roll(values, -1) / values)
    return round(float(turned.sum()) / (2 * np.pi))


def _conditions(powers: Array, angle: float, friction: float | None, kolosov: float) -> Array:
    """Return both faces' conditions on the four coefficients of each power, (powers, 4, 4).

    Of Airy's function r^(λ+1) F(θ) with F of cosines and sines of (λ ± 1) θ.
    """
    hoop, shear, outward, across = _fields(powers, 0.0, kolosov)
    along = outward if friction is None else shear - friction * hoop
    free_hoop, free_shear, _, _ = _fields(powers, angle, kolosov)
    return np.stack([across, along, free_hoop, free_shear], axis=1)


def _fields(powers: Array, at: float, kolosov: float) -> tuple[Array, Array, Array, Array]:
    """Hoop and shear stress and displacements along and across a ray, but for their powers of r.

    Each as rows of the four coefficients, (powers, 4).
    """
    more, less = powers + 1, powers - 1
    c, s, d, t = np.cos(more * at), np.sin(more * at), np.cos(less * at), np.sin(less * at)
    hoop = np.stack([c, s, d, t], axis=1) * more[:, None]
    shear = -np.stack([-more * s, more * c, -less * t, less * d], axis=1)
    give, turn = kolosov - powers, kolosov + powers
    outward = np.stack([-more * c, -more * s, give * d, give * t], axis=1)
    across = np.stack([more * s, -more * c, turn * t, -turn * d], axis=1)
    return hoop, shear, outward, across


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
