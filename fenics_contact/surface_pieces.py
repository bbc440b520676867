"""A contact surface cut into flat pieces between its nodes, for areas inside the elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fenics_contact import compat
from fenics_contact.surface_space import SurfaceSpace

Array = NDArray[np.float64]


class SurfacePieces:
    """Facets cut into flat segments (2D) or triangles (3D) between nodes.

    Attributes:
        points: Contact points at the corners, (pieces, corners); a node on the axis of
            revolution, which is none, is given its neighbour.
        corners: Coordinates, (pieces, corners, 3) (length).
        areas: Length or area of each, (pieces,).
        weights: Factor of the integral at the corners (2πr where axisymmetric), (pieces, corners).
    """

    def __init__(self, surface: SurfaceSpace, contact_nodes: NDArray[np.int64]) -> None:
        nodes = _facet_pieces(surface)
        point_of = np.full(len(surface.coordinates), -1)
        point_of[contact_nodes] = np.arange(len(contact_nodes))
        points = point_of[nodes]
        self.points = np.where(points < 0, points.max(axis=1, initial=0)[:, None], points)
        self.corners = surface.coordinates[nodes]
        edges = self.corners[:, 1:] - self.corners[:, :1]
        if edges.shape[1] == 1:
            self.areas = np.linalg.norm(edges[:, 0], axis=1)
        else:
            self.areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        radii = self.corners[:, :, 0]
        axisymmetric = surface.spaces.kinematics == "axisymmetric"
        self.weights = 2 * np.pi * radii if axisymmetric else np.ones_like(radii)


def _facet_pieces(surface: SurfaceSpace) -> NDArray[np.int32]:
    """Nodes of the segments or triangles of all facets, (pieces, corners)."""
    points = compat.interpolation_points(surface.scalar_space.element)
    dimension = points.shape[1]
    if dimension == 1:
        order = np.argsort(points[:, 0])
        pieces = np.stack([order[:-1], order[1:]], axis=1)
    else:
        from scipy.spatial import Delaunay

        pieces = Delaunay(points).simplices
    return np.asarray(surface.facet_nodes[:, pieces].reshape(-1, dimension + 1))
