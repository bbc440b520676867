"""Areas in contact and sticking, and their radii, with the edge found inside the elements.

The surface is cut into segments or triangles between contact points. Where one end of
a segment is inside the zone and the other outside, the edge lies in between. On soft
foundations it is where the depth, which is linear there, vanishes; on stiff ones the
asymptotic fields of a smooth edge tell (K. L. Johnson, Contact Mechanics, Cambridge 1985,
chapters 4, 7 and appendix 1): at distance δ from it the pressure is C √δ inside and the gap
4C/(3E*) δ^(3/2) outside; likewise what friction could carry more, g − |σ_T|, where it sticks,
and the slip where it slips.

Radii are about the axis of revolution, of the disc at the axis: a ring that touches farther out
does not count.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, largest, smallest, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, STICK, ContactState
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.quantities.names import CONTACT_RADIUS, STICK_RADIUS

# Foundations softer than this × E*/h let the depth be linear across the edge.
_SOFT = 10.0

# A surface reaches the axis whose smallest radius is this share of its size.
_ON_AXIS = 1e-9


@dataclass(frozen=True, eq=False)
class Zone:
    """Points inside a zone, and what tells how far its edge is from them.

    Attributes:
        inside: Which points.
        stress: C √δ of each point inside (stress).
        distance: 4C/(3E*) δ^(3/2) of each outside; infinite where that is not known (length).
        depth: Of points inside that is linear across the edge, in place of the stress (length);
            0 where there is none.
    """

    inside: Flags
    stress: Array
    distance: Array
    depth: Array


@dataclass(frozen=True, eq=False)
class Zones:
    """Where a contact touches and where it sticks, for all that is measured of it in a state.

    Attributes:
        contact: The contact.
        state: What happens at its points.
    """

    contact: ContactSurface
    state: ContactState

    @cached_property
    def closed(self) -> Flags:
        """Whether each point touches."""
        return np.asarray(self.state.status != OPEN)

    @cached_property
    def sticks(self) -> Flags:
        """Whether each point sticks."""
        return np.asarray(self.state.status == STICK)

    @cached_property
    def touching(self) -> Zone | None:
        """Where it touches; None where the edge of that is not found inside the elements."""
        if not _may_open(self.contact):
            return None
        depth = np.where(self.closed, -self.state.gap, 0.0)
        return Zone(self.closed, self.state.contact_pressure, self.state.gap, depth)

    @cached_property
    def sticking(self) -> Zone | None:
        """Where it sticks, at the same places."""
        contact, state = self.contact, self.state
        if not contact.is_coulomb:
            return None
        carried = contact.friction.rule.metric.carried(state.friction_traction)
        slip = np.linalg.norm(contact.friction.scaled_slip(state.slip), axis=1)
        beyond = np.maximum(slip - contact.regularisation_parameter, 0.0)
        beyond = np.where(self.closed, beyond, np.inf)
        spare = np.maximum(contact.friction_bound - carried, 0.0)
        return Zone(self.sticks, spare, beyond, np.zeros_like(slip))


def contact_area(zones: Zones) -> float:
    """Area in contact (full revolution, per thickness, … like all areas); collective."""
    return _area(zones.contact, zones.closed, zones.touching)


def _may_open(contact: ContactSurface) -> bool:
    return contact.is_one_sided


def cut_areas(contact: ContactSurface, state: ContactState) -> tuple[float, float]:
    """Areas of the pieces that the edges of contact and of stick pass through; collective."""
    measures = contact.trace.pieces.measures
    cut = [measures[found].sum() for found in _cut_pieces(contact, state)]
    touching, sticking = _once(contact) * total(contact.trace.spaces.comm, np.array(cut))
    return float(touching), float(sticking)


def areas_inside(contact: ContactSurface, state: ContactState) -> tuple[Array, Array]:
    """Area of each piece of this rank in contact, and that sticks, (pieces,); collective."""
    zones = Zones(contact, state)
    nothing = np.zeros(len(contact.trace.pieces.areas))
    touching, sticking = (
        nothing if zone is None else _counted(contact, zone)
        for zone in (zones.touching, zones.sticking)
    )
    once = _once(contact)
    return once * touching, once * sticking


def edges(contact: ContactSurface, state: ContactState) -> list[Array]:
    """Where this rank's edges of contact and of stick are, and how large facets are there.

    Returns:
        Of either, rows of x, y, z and the length of a facet's side (length).
    """
    rows = facet_sizes(contact.trace)
    return [rows[found] for found in _cut_pieces(contact, state)]


def facet_sizes(trace: Trace) -> Array:
    """Rows of x, y, z and the length of a facet's side at each piece of this rank (length)."""
    pieces, dimension = trace.pieces, trace.spaces.components
    sides = (pieces.areas * (1 if dimension == 2 else 2)) ** (1 / (dimension - 1))
    return np.column_stack([pieces.corners.mean(axis=1), sides * trace.spaces.degree])


def _cut_pieces(contact: ContactSurface, state: ContactState) -> list[Flags]:
    """Whether the edges of contact and of stick pass through each piece of this rank."""
    zones = [state.status != OPEN, state.status == STICK]
    zones[0] = zones[0] if _may_open(contact) else np.ones_like(zones[0])
    zones[1] = zones[1] if contact.friction.has_friction else np.ones_like(zones[1])
    inside = [zone[contact.trace.pieces.points] for zone in zones]
    return [found.any(axis=1) & ~found.all(axis=1) for found in inside]


def stick_area(zones: Zones) -> float:
    """Area that sticks; collective."""
    return _area(zones.contact, zones.sticks, zones.sticking)


def _area(contact: ContactSurface, inside: Flags, zone: Zone | None) -> float:
    """Area of a zone; without one, the area that the points inside represent."""
    trace = contact.trace
    if zone is None:
        return float(trace.integral(np.where(inside, 1.0, 0.0)))
    # Pieces are flat, and the surface may not be.
    return _once(contact) * float(total(trace.spaces.comm, _counted(contact, zone).sum()))


def _once(contact: ContactSurface) -> float:
    """Over what its pieces have in all, the area of a surface; collective.

    Those of quadrilaterals in space cover them twice.
    """
    trace = contact.trace
    return trace.area / float(total(trace.spaces.comm, trace.pieces.measures.sum()))


def _counted(contact: ContactSurface, zone: Zone) -> Array:
    """Weighted area of each piece that lies in a zone, (pieces,)."""
    pieces = contact.trace.pieces
    inside = zone.inside[pieces.points]
    whole = inside.all(axis=1)
    counted = np.where(whole, pieces.measures, 0.0)
    edge = np.flatnonzero(inside.any(axis=1) & ~whole)
    counted[edge] = _parts_inside(contact, zone, edge)
    return counted


def _parts_inside(contact: ContactSurface, zone: Zone, chosen: Integers) -> Array:
    """Weighted areas of the parts of segments or triangles that lie in the zone."""
    pieces = contact.trace.pieces
    points = pieces.points[chosen]
    corners, weights = pieces.corners[chosen], pieces.weights[chosen]
    inside, rows, count = zone.inside[points], np.arange(len(chosen)), points.shape[1]
    alone = inside.sum(axis=1) == 1  # one corner is inside, else one is outside
    corner = np.where(alone[:, None], inside, ~inside).argmax(axis=1)
    share, density = np.ones(len(chosen)), weights[rows, corner]
    for step in range(1, count):
        other = (corner + step) % count
        inner, outer = np.where(alone, corner, other), np.where(alone, other, corner)
        ends = corners[rows, inner], corners[rows, outer]
        reach = edge_places(contact, zone, points[rows, inner], points[rows, outer], ends)
        reach = np.where(alone, reach, 1.0 - reach)
        share *= reach
        density += (weights[rows, other] - weights[rows, corner]) * reach / count
    cut = pieces.areas[chosen] * share * density
    return np.asarray(np.where(alone, cut, pieces.measures[chosen] - cut))


def edge_places(
    contact: ContactSurface,
    zone: Zone,
    inner: Integers,
    outer: Integers,
    ends: tuple[Array, Array],
) -> Array:
    """Where the edge lies between points inside and points outside, 0 … 1 of the way out.

    Args:
        contact: The contact.
        zone: Inside of which.
        inner: Numbers of the points inside.
        outer: Those of the points outside.
        ends: Coordinates of either, (pairs, 3) (length).
    """
    distance, depth = zone.distance[outer], zone.depth[inner]
    length = np.linalg.norm(ends[1] - ends[0], axis=1)
    modulus = contact.moduli.plane_strain
    found = np.full(len(inner), 0.5)  # where nothing pushes outside, as a foundation that ends
    beyond = ~np.isfinite(distance)
    if beyond.any():
        found[beyond] = contact.kinematics.end_of_obstacle(inner[beyond], outer[beyond])
    pushed = ~beyond & (distance > 0)
    soft = pushed & (depth > 0)
    if soft.any():
        soft &= contact.normal.stiffness(zone.depth)[inner] * length < _SOFT * modulus
    found[soft] = depth[soft] / (depth[soft] + distance[soft])
    stiff = pushed & ~soft
    stress = zone.stress[inner][stiff]
    found[stiff] = _asymptotic_edges(stress, distance[stiff], modulus, length[stiff])
    return found


def _asymptotic_edges(stress: Array, distance: Array, modulus: float, length: Array) -> Array:
    """Solve stress² = C² δ and (3 E* distance / 4C)^(2/3) = L − δ for δ/L.

    A cubic in t = (δ/L)^(1/3), t³ + κ t = 1, with one real root.
    """
    carries = stress > 0
    kappa = (0.75 * modulus * distance / (np.where(carries, stress, 1.0) * length)) ** (2 / 3)
    root = 2 * np.sqrt(kappa / 3) * np.sinh(np.arcsinh(1.5 / kappa * np.sqrt(3 / kappa)) / 3)
    return np.where(carries, root**3, 0.0)


def radii(zones: Zones) -> dict[str, float | None]:
    """``contact_radius`` and ``stick_radius`` of a surface that reaches the axis; collective.

    Returns:
        Nothing where the model has no axis, or the surface does not reach it. A radius is 0 where
        nothing touches, or sticks, and None where that does but not at the axis.
    """
    contact, trace = zones.contact, zones.contact.trace
    if contact.spaces.kinematics != "axisymmetric":
        return {}
    nearest = smallest(contact.spaces.comm, trace.surface.coordinates[:, 0])
    if nearest > _ON_AXIS * trace.extent():
        return {}
    return {
        CONTACT_RADIUS: _radius(contact, zones.closed, zones.touching),
        STICK_RADIUS: _radius(contact, zones.sticks, zones.sticking),
    }


def _radius(contact: ContactSurface, inside: Flags, zone: Zone | None) -> float | None:
    """Radius of the edge nearest to the axis, if what it encloses is in the zone; collective."""
    comm, pieces = contact.spaces.comm, contact.trace.pieces
    flags = inside[pieces.points]
    cut = np.flatnonzero(flags[:, 0] != flags[:, 1])
    first = np.where(flags[cut, 0], 0, 1)  # the end that is inside
    rows = np.arange(len(cut))
    points, corners = pieces.points[cut], pieces.corners[cut]
    inner, outer = points[rows, first], points[rows, 1 - first]
    ends = corners[rows, first], corners[rows, 1 - first]
    reach = np.full(len(cut), 0.5)
    if zone is not None:
        reach = edge_places(contact, zone, inner, outer, ends)
    start, end = ends[0][:, 0], ends[1][:, 0]
    edges = gather_rows(comm, np.column_stack([start + reach * (end - start), end > start]))
    if len(edges) == 0:  # all of the surface, or nothing
        return largest(comm, contact.trace.coordinates[inside, 0])
    radius, encloses = edges[np.argmin(edges[:, 0])]
    return float(radius) if encloses else None
