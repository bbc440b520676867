"""A contact surface cut into flat pieces between its nodes, for areas inside the elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Integers
from fenics_contact.contact.surface.space import SurfaceSpace

Place = tuple[int, ...]


class SurfacePieces:
    """Facets cut into flat segments (2D) or triangles (3D) between nodes.

    Quadrilaterals are cut along either diagonal, and so covered twice.

    Attributes:
        nodes: Nodes of this rank at the corners, (pieces, corners).
        points: Contact points at the corners, (pieces, corners); a node on the axis of
            revolution, which is none, is given its neighbour.
        corners: Coordinates, (pieces, corners, 3) (length).
        areas: Length or area of each, (pieces,).
        weights: Factor of integrals at the corners (2πr where axisymmetric, else a thickness or 1),
            (pieces, corners).
        measures: Areas times the mean of these, (pieces,).
    """

    def __init__(self, surface: SurfaceSpace, contact_nodes: Integers) -> None:
        nodes = self.nodes = _facet_pieces(surface)
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
        self.weights = surface.factors[nodes]
        self.measures = self.areas * self.weights.mean(axis=1)


def _facet_pieces(surface: SurfaceSpace) -> NDArray[np.int32]:
    """Nodes of the segments or triangles of all facets, (pieces, corners)."""
    points = compat.interpolation_points(surface.scalar_space.element)
    degree, is_square = surface.spaces.degree, compat.is_tensor_cell(surface.mesh)
    places = np.rint(degree * points).astype(int)
    node = {tuple(place): number for number, place in enumerate(places.tolist())}
    dimension = points.shape[1]
    # Whatever the numbering of a facet, its pieces are the same: it may differ between ranks.
    pieces: list[list[Place]]
    if dimension == 1:
        pieces = [[(k,), (k + 1,)] for k in range(degree)]
    else:
        pieces = [
            corners
            for i in range(degree)
            for j in range(degree)
            for corners in _cut((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1), is_square)
        ]
    numbers = [[node[place] for place in piece] for piece in pieces if node.keys() >= {*piece}]
    return np.asarray(surface.facet_nodes[:, numbers].reshape(-1, dimension + 1))


def _cut(a: Place, b: Place, c: Place, d: Place, along_both: bool) -> list[list[Place]]:
    """Triangles of a square between nodes, along one diagonal or along either."""
    first = [[a, b, d], [b, c, d]]
    return [*first, [a, b, c], [a, c, d]] if along_both else first
