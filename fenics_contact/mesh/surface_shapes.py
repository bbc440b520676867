"""Kind of the surface of points and normals: plane, cylinder, cone, sphere or torus.

All are found from linear equations. The normal lines of a surface of revolution meet its axis: with
direction a and moment m of the axis, a·(p × n) + m·n = 0 for all points p and normals n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array

_FLAT = {"plane": "straight line", "cylinder": "circle", "free form": "curve"}


@dataclass(frozen=True)
class SurfaceShape:
    """A surface, or a curve in the plane.

    Attributes:
        kind: ``plane``, ``cylinder``, ``cone``, ``sphere``, ``torus`` or ``free form``; in the
            plane ``straight line``, ``circle`` or ``curve``.
        centre: A point on the axis, or the centre; of a plane and a free form the mean of its
            points (length).
        axis: Direction of the axis, or the normal of a plane; none of spheres and free forms.
        radius: Of cylinders and spheres, and of the tube of a torus (length).
        ring: Radius of the circle through the middle of a torus's tube (length).
        angle: Half of that at a cone's apex, in degrees; ``centre`` is the apex.
    """

    kind: str
    centre: tuple[float, ...]
    axis: tuple[float, ...] = ()
    radius: float | None = None
    ring: float | None = None
    angle: float | None = None


def shape_of(
    points: Array, normals: Array, tolerance: float, in_plane: bool = False
) -> SurfaceShape:
    """The simplest shape that the points lie on with these normals.

    Args:
        points: (points, 3) (length).
        normals: Unit normals there, all to one side of the surface, (points, 3).
        tolerance: Of distances, over the extent of the points; of normals, as it is.
        in_plane: Whether they are of a curve in the plane, with normals in it.
    """
    middle = points.mean(axis=0)
    size = float(np.ptp(points, axis=0).max()) or 1.0
    scaled = (points - middle) / size
    found = None
    for fit in (_plane, _cylinder, _sphere, _cone, _torus)[: 2 if in_plane else 5]:
        found = fit(scaled, normals, tolerance)
        if found is not None:
            break
    found = found or SurfaceShape("free form", (0.0, 0.0, 0.0))
    kind = _FLAT.get(found.kind, found.kind) if in_plane else found.kind
    return SurfaceShape(
        kind,
        tuple((middle + size * np.array(found.centre)).tolist()),
        () if in_plane and kind == "circle" else found.axis,
        None if found.radius is None else size * found.radius,
        None if found.ring is None else size * found.ring,
        found.angle,
    )


def _plane(points: Array, normals: Array, tolerance: float) -> SurfaceShape | None:
    normal = normals.mean(axis=0)
    normal /= np.linalg.norm(normal) or 1.0
    if np.abs(normals - normal).max() > tolerance or np.abs(points @ normal).max() > tolerance:
        return None
    return SurfaceShape("plane", (0.0, 0.0, 0.0), tuple(normal.tolist()))


def _cylinder(points: Array, normals: Array, tolerance: float) -> SurfaceShape | None:
    axis = _least_direction(normals)
    if np.abs(normals @ axis).max() > tolerance:
        return None
    across = points - np.outer(points @ axis, axis)
    found = _round(across, normals, tolerance)
    return found and SurfaceShape("cylinder", tuple(found[0].tolist()), _up(axis), found[1])


def _sphere(points: Array, normals: Array, tolerance: float) -> SurfaceShape | None:
    found = _round(points, normals, tolerance)
    return found and SurfaceShape("sphere", tuple(found[0].tolist()), (), found[1])


def _cone(points: Array, normals: Array, tolerance: float) -> SurfaceShape | None:
    """Normals have one angle with the axis, and tangent planes go through the apex."""
    axis = _least_direction(normals - normals.mean(axis=0))
    sines = normals @ axis
    if np.ptp(sines) > tolerance or abs(sines.mean()) > 1 - tolerance:
        return None
    apex = np.linalg.lstsq(normals, (normals * points).sum(axis=1), rcond=None)[0]
    if np.abs(((points - apex) * normals).sum(axis=1)).max() > tolerance:
        return None
    angle = float(np.degrees(np.arcsin(min(abs(sines.mean()), 1.0))))
    return SurfaceShape("cone", tuple(apex.tolist()), _up(axis), angle=angle)


def _torus(points: Array, normals: Array, tolerance: float) -> SurfaceShape | None:
    rows = np.concatenate([np.cross(points, normals), normals], axis=1)
    direction, moment = np.split(_least_direction(rows), 2)
    length = np.linalg.norm(direction)
    if length < 1e-3:
        return None
    axis, moment = direction / length, moment / length
    foot = np.cross(axis, moment)
    arms = points - foot
    along = arms @ axis
    out = arms - np.outer(along, axis)
    radii = np.linalg.norm(out, axis=1)
    if radii.min() < 1e-9:
        return None
    radial = out / radii[:, None]
    meridian = np.column_stack([radii, along])
    directions = np.column_stack([(normals * radial).sum(axis=1), normals @ axis])
    sideways = normals - directions[:, :1] * radial - np.outer(directions[:, 1], axis)
    found = _round(meridian, directions, tolerance)
    if found is None or np.abs(sideways).max() > tolerance or found[0][0] <= 0:
        return None
    (ring, level), radius = found
    return SurfaceShape(
        "torus", tuple((foot + level * axis).tolist()), _up(axis), radius, float(ring)
    )


def _round(points: Array, normals: Array, tolerance: float) -> tuple[Array, float] | None:
    """Centre and radius with p = c + r n for all points, if there are such."""
    count, dimension = points.shape
    rows = np.zeros((count, dimension, dimension + 1))
    rows[:, np.arange(dimension), np.arange(dimension)] = 1
    rows[:, :, dimension] = normals
    rows, right = rows.reshape(-1, dimension + 1), points.reshape(-1)
    *centre, radius = np.linalg.lstsq(rows, right, rcond=None)[0]
    misfit = np.abs(rows @ np.array([*centre, radius]) - right).max()
    if misfit > tolerance * max(1.0, abs(radius)) or abs(radius) > 1e3:
        return None
    return np.array(centre), float(abs(radius))


def _least_direction(rows: Array) -> Array:
    """The unit vector with which all rows have the least product."""
    return np.asarray(np.linalg.svd(rows, full_matrices=True)[2][-1])


def _up(axis: Array) -> tuple[float, ...]:
    """An axis in the one of its two directions whose largest component is positive."""
    return tuple((axis * np.sign(axis[np.argmax(np.abs(axis))])).tolist())
