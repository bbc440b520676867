"""Radii of the zones of contact and of stick about the axis of revolution.

The edge of a zone lies inside an element where ``contact_area`` finds it. A ring that touches
farther out does not count: the radius is that of the disc at the axis.
"""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Flags
from fenics_contact.common.parallel import gather_rows, largest, smallest
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.evaluate.contact_areas import Zone, Zones, edge_places

# A surface reaches the axis whose smallest radius is this share of its size.
_ON_AXIS = 1e-9


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
        "contact_radius": _radius(contact, zones.closed, zones.touching),
        "stick_radius": _radius(contact, zones.sticks, zones.sticking),
    }


def _radius(contact: ContactSurface, inside: Flags, zone: Zone | None) -> float | None:
    """Of the edge nearest to the axis, if what it encloses is inside; collective."""
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
