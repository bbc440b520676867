"""Areas in contact and sticking, with the edge of the zone found inside the elements.

The surface is cut into segments or triangles between contact points. Where one end of
a segment is inside the zone and the other outside, the edge lies in between. On soft
foundations it is where the depth, which is linear there, vanishes; on stiff ones the
asymptotic fields of a smooth edge tell (K. L. Johnson, Contact Mechanics, Cambridge 1985,
chapters 4, 7 and appendix 1): at distance δ from it the pressure is C √δ inside and the gap
4C/(3E*) δ^(3/2) outside; likewise what friction could carry more, g − |σ_T|, where it sticks,
and the slip where it slips.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact import OPEN, STICK, ContactState, ContactSurface
from fenics_contact.parallel import total

Array = NDArray[np.float64]

# Foundations softer than this × E*/h let the depth be linear across the edge.
_SOFT = 10.0


@dataclass(frozen=True, eq=False)
class _Zone:
    """Points inside a zone, and what tells how far its edge is from them.

    Attributes:
        inside: Which points.
        stress: C √δ of each point inside (stress).
        distance: 4C/(3E*) δ^(3/2) of each outside; infinite where that is not known (length).
        depth: Of points inside that is linear across the edge, in place of the stress (length);
            0 where there is none.
    """

    inside: NDArray[np.bool_]
    stress: Array
    distance: Array
    depth: Array


def contact_area(contact: ContactSurface, state: ContactState) -> float:
    """Area in contact (full revolution, per thickness, … like all areas); collective."""
    closed = state.status != OPEN
    if contact.contact.kind in ("prescribed", "bonded") or contact.normal is None:
        return float(contact.trace.integral(closed * 1.0))
    depth = np.where(closed, -state.gap, 0.0)
    return _area(contact, _Zone(closed, state.contact_pressure, state.gap, depth))


def stick_area(contact: ContactSurface, state: ContactState) -> float:
    """Area that sticks; collective."""
    sticks = state.status == STICK
    if contact.friction is None or contact.contact.kind == "prescribed":
        return float(contact.trace.integral(sticks * 1.0))
    carried = np.linalg.norm(state.friction_traction, axis=1)
    slip = np.linalg.norm(contact.friction.counted(state.slip), axis=1)
    beyond = np.maximum(slip - contact.regularisation_parameter, 0.0)
    beyond = np.where(state.status == OPEN, np.inf, beyond)
    spare = np.maximum(contact.friction_bound - carried, 0.0)
    return _area(contact, _Zone(sticks, spare, beyond, np.zeros_like(slip)))


def _area(contact: ContactSurface, zone: _Zone) -> float:
    trace = contact.trace
    pieces = trace.pieces
    inside = zone.inside[pieces.points]
    areas = pieces.areas * pieces.weights.mean(axis=1)
    counted = np.where(inside.all(axis=1), areas, 0.0)
    edge = np.flatnonzero(inside.any(axis=1) & ~inside.all(axis=1))
    for piece in edge.tolist():
        counted[piece] = _part_inside(contact, zone, piece)
    # Relative to what the pieces have in all: these are flat, and the surface may not be.
    found, every = total(trace.spaces.comm, np.array([counted.sum(), areas.sum()]))
    return float(trace.integral(np.ones(len(zone.inside)))) * float(found / every)


def _part_inside(contact: ContactSurface, zone: _Zone, piece: int) -> float:
    """Weighted area of the part of a segment or triangle that lies in the zone."""
    pieces = contact.trace.pieces
    points, corners = pieces.points[piece], pieces.corners[piece]
    weights, inside = pieces.weights[piece], zone.inside[points]
    alone = inside.sum() == 1  # one corner is inside, else one is outside
    corner = int(np.flatnonzero(inside if alone else ~inside)[0])
    share, density = 1.0, weights[corner]
    for other in range(len(points)):
        if other == corner:
            continue
        inner, outer = (corner, other) if alone else (other, corner)
        reach = _edge(contact, zone, points[inner], points[outer], corners[[inner, outer]])
        reach = reach if alone else 1.0 - reach
        share *= reach
        density += (weights[other] - weights[corner]) * reach / len(points)
    cut = float(pieces.areas[piece] * share * density)
    return cut if alone else float(pieces.areas[piece] * weights.mean()) - cut


def _edge(contact: ContactSurface, zone: _Zone, inner: int, outer: int, ends: Array) -> float:
    """Where the edge lies between a point inside and one outside, 0 … 1 of the way out."""
    assert contact.normal is not None
    distance, depth = zone.distance[outer], zone.depth[inner]
    length = float(np.linalg.norm(ends[1] - ends[0]))
    modulus = contact.plane_strain_modulus
    if not np.isfinite(distance):
        return contact.kinematics.end_of_obstacle(inner, ends[1])
    if distance <= 0:  # nothing pushes there, a foundation that ends
        return 0.5
    if depth > 0 and contact.normal.stiffness[inner] * length < _SOFT * modulus:
        return float(depth / (depth + distance))
    return _asymptotic_edge(zone.stress[inner], distance, modulus, length)


def _asymptotic_edge(stress: float, distance: float, modulus: float, length: float) -> float:
    """Solve stress² = C² δ and (3 E* distance / 4C)^(2/3) = L − δ for δ/L, by bisection."""
    low, high = 0.0, length
    for _ in range(60):
        inside = 0.5 * (low + high)
        slope = stress / np.sqrt(inside)
        outside = (0.75 * modulus * distance / slope) ** (2 / 3) if slope > 0 else np.inf
        low, high = (low, inside) if inside + outside > length else (inside, high)
    return float(0.5 * (low + high) / length)
