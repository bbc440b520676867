"""A contact surface cut into flat pieces between its nodes, for areas inside the elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fenics_contact import compat
from fenics_contact.mesh import Group
from fenics_contact.spaces import Spaces

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

    def __init__(self, spaces: Spaces, group: Group, contact_nodes: NDArray[np.int32]) -> None:
        nodes = _facet_pieces(spaces, spaces.facets(group))
        point_of = np.full(len(spaces.coordinates), -1)
        point_of[contact_nodes] = np.arange(len(contact_nodes))
        points = point_of[nodes]
        self.points = np.where(points < 0, points.max(axis=1, initial=0)[:, None], points)
        self.corners = spaces.coordinates[nodes]
        edges = self.corners[:, 1:] - self.corners[:, :1]
        if edges.shape[1] == 1:
            self.areas = np.linalg.norm(edges[:, 0], axis=1)
        else:
            self.areas = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
        radii = self.corners[:, :, 0]
        axisymmetric = spaces.kinematics == "axisymmetric"
        self.weights = 2 * np.pi * radii if axisymmetric else np.ones_like(radii)


def _facet_pieces(spaces: Spaces, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Nodes of the segments or triangles of facets, (pieces, corners)."""
    from scipy.spatial import Delaunay

    layout = spaces.displacement_space.dofmap.dof_layout
    reference = compat.interpolation_points(spaces.scalar_space.element)
    dimension = spaces.body.dimension
    found = [np.zeros((0, dimension), dtype=np.int32)]
    for facet in np.unique(facets[:, 1]):
        dofs = np.array(layout.entity_closure_dofs(dimension - 1, int(facet)))
        points = reference[dofs] - reference[dofs].mean(axis=0)
        # Coordinates within the facet: its principal directions.
        inside = points @ np.linalg.svd(points)[2][: dimension - 1].T
        if dimension == 2:
            order = np.argsort(inside[:, 0])
            pieces = np.stack([order[:-1], order[1:]], axis=1)
        else:
            pieces = Delaunay(inside).simplices
        cells = facets[facets[:, 1] == facet, 0]
        nodes = spaces.displacement_space.dofmap.list[cells][:, dofs]
        found.append(nodes[:, pieces].reshape(-1, dimension))
    return np.concatenate(found)
