"""The area in contact, with the edge of the contact found inside the elements.

The surface is cut into segments or triangles between contact points. Where one end of
a segment is closed and the other open, the edge lies in between: on soft foundations
where the depth, which is linear there, vanishes; on stiff ones by the asymptotic fields
of a smooth frictionless edge (K. L. Johnson, Contact Mechanics, Cambridge 1985, ch. 4 and
appendix 1): at distance δ from it the pressure is C √δ inside, the gap 4C/(3E*) δ^(3/2)
outside.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact import OPEN, ContactState, ContactSurface
from fenics_contact.parallel import total

Array = NDArray[np.float64]


def contact_area(contact: ContactSurface, state: ContactState) -> float:
    """Area in contact (full revolution, per thickness, … like all areas); collective."""
    trace = contact.trace
    closed = state.status != OPEN
    whole = float(trace.integral(np.ones(len(closed))))
    pieces = trace.pieces
    if contact.contact.kind in ("prescribed", "bonded") or contact.normal is None:
        return float(trace.integral(closed * 1.0))
    is_closed = closed[pieces.points]
    areas = pieces.areas * pieces.weights.mean(axis=1)
    counted = np.where(is_closed.all(axis=1), areas, 0.0)
    edge = np.flatnonzero(is_closed.any(axis=1) & ~is_closed.all(axis=1))
    for piece in edge.tolist():
        counted[piece] = _closed_part(contact, state, pieces, piece, is_closed[piece])
    # Relative to what the pieces have in all: these are flat, and the surface may not be.
    found, every = total(trace.spaces.comm, np.array([counted.sum(), areas.sum()]))
    return whole * float(found / every)


def _closed_part(
    contact: ContactSurface, state: ContactState, pieces: Any, piece: int, closed: NDArray[np.bool_]
) -> float:
    """Weighted area of the closed part of a segment or triangle that the edge crosses."""
    points, corners = pieces.points[piece], pieces.corners[piece]
    weights = pieces.weights[piece]
    alone = closed.sum() == 1  # one corner is closed, else one is open
    corner = int(np.flatnonzero(closed if alone else ~closed)[0])
    share, density = 1.0, weights[corner]
    for other in range(len(points)):
        if other == corner:
            continue
        length = float(np.linalg.norm(corners[other] - corners[corner]))
        inner, outer = (corner, other) if alone else (other, corner)
        if np.isfinite(state.gap[points[outer]]):
            reach = _edge_position(contact, state, points[inner], points[outer], length)
        else:
            reach = contact.kinematics.end_of_obstacle(points[inner], corners[outer])
        reach = reach if alone else 1.0 - reach
        share *= reach
        density += (weights[other] - weights[corner]) * reach / len(points)
    cut = pieces.areas[piece] * share * density
    return cut if alone else pieces.areas[piece] * weights.mean() - cut


def _edge_position(
    contact: ContactSurface, state: ContactState, inner: int, outer: int, length: float
) -> float:
    """Where the edge lies between a closed and an open point, 0 … 1 of the way out."""
    assert contact.normal is not None
    pressure, gap = state.contact_pressure[inner], state.gap[outer]
    if gap <= 0:  # nothing pushes there, a foundation that ends
        return 0.5
    stiffness = contact.normal.stiffness[inner]
    modulus = contact.plane_strain_modulus
    if stiffness * length < 10 * modulus:
        depth = -state.gap[inner]
        return float(depth / (depth + gap))
    # p² = C² δ and (3 E* gap / 4C)^(2/3) = L − δ: one equation for δ, solved by bisection.
    low, high = 0.0, length
    for _ in range(60):
        inside = 0.5 * (low + high)
        slope = pressure / np.sqrt(inside)
        outside = (0.75 * modulus * gap / slope) ** (2 / 3)
        low, high = (low, inside) if inside + outside > length else (inside, high)
    return float(0.5 * (low + high) / length)
