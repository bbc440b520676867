"""Surfaces near a contact, from their points: how they curve, and whether points cover a zone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.fields import flat_sides
from fenics_contact.results.contact_points import ContactTable

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_ROUND = 0.02  # of how far a surface recedes: what it may be apart from a parabola


@dataclass(frozen=True)
class Curvature:
    """Two surfaces that touch at their apexes.

    Attributes:
        radius: 1/R = 1/R₁ + 1/R₂ (length).
        smallest_radius: The least of |R₁| and |R₂| (length).
        smallest_body: The least extent of the two bodies (length).
        centre: The apex, (3,) (length).
        other: Places along x of the points of the other surface (length).
    """

    radius: float
    smallest_radius: float
    smallest_body: float
    centre: Array
    other: Array


def relative_curvature(
    rows: ContactTable, body: UnstructuredGrid, middle: float | None = None
) -> Curvature | None:
    """Fit a parabola about a common apex to either surface; None where one is none.

    Args:
        rows: Points of the contact, all of one surface, which runs along x.
        body: A pyvista grid of both bodies.
        middle: Where along x a plane of symmetry or an axis is, so that the apex must be there.
    """
    x, y = rows.numbers["x"], rows.numbers["y"]
    body = body.connectivity()  # its points are in another order
    regions = np.asarray(body.point_data["RegionId"])
    if len(np.unique(regions)) != 2 or np.ptp(x) < 2 * np.ptp(y):
        return None
    points = np.asarray(body.points)
    surface = np.stack([x, y], axis=1)
    far = [KDTree(points[regions == number, :2]).query(surface)[0].max() for number in (0, 1)]
    own = int(np.argmin(far))  # some points are nodes of both
    extents = [np.ptp(points[regions == number, :2], axis=0).min() for number in (0, 1)]
    sides, outer = flat_sides(body)
    sides = sides[outer & (regions[sides[:, 0]] != own)]
    ends = points[sides[:, [0, -1]]][:, :, :2]
    along = np.abs(np.diff(ends, axis=1))[:, 0]
    near = (ends[:, 0, 0] >= x.min()) & (ends[:, 0, 0] <= x.max()) & (along[:, 1] < along[:, 0])
    height = np.abs(ends[:, 0, 1] - np.interp(ends[:, 0, 0], x[np.argsort(x)], y[np.argsort(x)]))
    near &= height < 0.5 * np.ptp(x)
    if near.sum() < 5 or len(x) < 5:
        return None
    other_x, other_y = ends[near, 0].T
    slave, master = _parabola(x, y, middle), _parabola(other_x, other_y, middle)
    if slave is None or master is None:
        return None
    up = np.sign(rows.numbers["ny"].mean())
    relative = up * (master[0] - slave[0])
    apexes = [fit[1] for fit in (slave, master) if fit[0]]
    if relative <= 0 or not apexes or np.ptp(apexes) > _ROUND * np.ptp(x):
        return None
    sharpest = max(abs(slave[0]), abs(master[0]))
    centre = np.array([float(np.mean(apexes)), float(y.mean()), 0.0])
    other = ends[near][:, :, 0].ravel()
    return Curvature(1 / relative, 1 / sharpest, float(min(extents)), centre, other)


def _parabola(x: Array, y: Array, middle: float | None) -> tuple[float, float] | None:
    """Curvature and apex of a parabola through points, both 0 of a straight line.

    With a middle the points are one side of a surface: the apex of a parabola through them alone
    is a little off it where that is no parabola but a circle.

    Returns:
        None where they lie on none, or its apex is not in the middle.
    """
    size, start = np.ptp(x), x.mean()
    curve, slope, _ = fit = np.polyfit(x - start, y, 2)
    off = np.abs(np.polyval(fit, x - start) - y).max()
    if off > _ROUND * np.ptp(y) + 1e-9 * size:
        return None
    if abs(curve) < 1e-9 / size:
        return 0.0, 0.0
    apex = float(start - slope / (2 * curve))
    if middle is None:
        return 2 * float(curve), apex
    if abs(apex - middle) > _ROUND * size:
        return None
    curve, _ = np.polyfit((x - middle) ** 2, y, 1)
    return 2 * float(curve), middle


_ENDS = 1e-2  # of the zone's radius, that points may end before it
_HOLE = 1.5  # times the distances between points: how far from all of them nothing may be
_DIRECTIONS, _RINGS = 32, 100


def covers(offsets: Array, radius: float, mirrors: list[int]) -> bool:
    """Whether a surface reaches all around a zone, without a hole wider than a few spacings.

    Args:
        offsets: Of its points from the middle of the zone, (points, 1) or (points, 2) (length).
        radius: Of the zone, or its half-width (length).
        mirrors: Axes of the offsets across which planes of symmetry stand, through the middle.
    """
    for axis in mirrors:
        offsets = np.concatenate(
            [offsets, offsets * np.where(np.arange(offsets.shape[1]) == axis, -1, 1)]
        )
    _, once = np.unique(np.round(offsets / radius, 6), axis=0, return_index=True)
    offsets = offsets[once]
    line = offsets.shape[1] == 1
    turns = np.linspace(0, 2 * np.pi, _DIRECTIONS, endpoint=False)
    around = np.array([[1.0], [-1.0]]) if line else np.stack([np.cos(turns), np.sin(turns)], axis=1)
    neighbours = 1 if line else 4  # so that long cells are no holes
    if len(offsets) <= neighbours or (offsets @ around.T).max(axis=0).min() < (1 - _ENDS) * radius:
        return False
    tree = KDTree(offsets)
    spacing = tree.query(offsets, [neighbours + 1])[0][:, 0]
    zone = np.linspace(0, 1 - _ENDS, _RINGS)[:, None, None] * radius * around
    distance, nearest = tree.query(zone.reshape(-1, offsets.shape[1]))
    return bool((distance <= _HOLE * spacing[nearest]).all())
