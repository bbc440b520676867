"""A rigid obstacle whose surface is of triangles: of a file, such as a tool from CAD.

Rays from the contact points meet its triangles. What these miss of a curved surface is taken from
polynomials through the nodes around each, so that the gap is smooth where the surface is, and has
the corners of edges.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from fenics_contact.analytic.obstacle_shapes import ObstacleShape, Sizes
from fenics_contact.common.arrays import Array
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.ray_projection import hits
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.mesh.rigid_surface import RigidSurface


class FacetObstacle(ObstacleShape):
    """The shape of a surface from a file.

    Attributes:
        middle: Of the box around it, in the file's coordinates, (3,) (length).
        radius: Of a sphere about the middle that holds it (length).

    Args:
        surface: Its triangles.
    """

    name, has_radius = "file", False
    models: ClassVar[tuple[str, ...]] = ("3D",)

    def __init__(self, surface: RigidSurface) -> None:
        self._facets = _facet_mesh(surface)
        self._smooth = SmoothSurface(self._facets)
        used = surface.points[np.unique(surface.triangles)]
        self.middle = (used.min(axis=0) + used.max(axis=0)) / 2
        self.radius = float(np.linalg.norm(used - self.middle, axis=1).max())

    def gaps(self, offsets: Array, rays: Array, sizes: Sizes) -> Array:
        """To the nearest triangle that faces a point, less what it misses of the surface.

        Complex offsets or rays give the slope of the gap as its imaginary part: the distance along
        a ray to the plane of the triangle changes by n·δ/cos with the point, and with the ray.
        """
        mesh = self._facets
        found = hits(mesh, np.real(offsets), np.real(rays))
        gap = np.full(len(rays), np.inf, np.result_type(offsets, rays))
        hit = np.flatnonzero(found.facet >= 0)
        facet, place = found.facet[hit], found.reference[hit]
        normals = normalised(mesh.area_normals(facet, place))
        cosines = -np.einsum("ij,ij->i", normals, np.real(rays[hit]))
        missed = self._smooth.offsets(facet, place) / cosines
        gap[hit] = found.distance[hit] - missed
        if np.iscomplexobj(gap):
            moved = np.imag(offsets[hit]) + np.real(gap[hit])[:, None] * np.imag(rays[hit])
            gap[hit] += 1j * np.einsum("ij,ij->i", normals, moved) / cosines
        return gap

    def is_before(self, places: Array, radii: Array, rays: Array) -> Array:
        """Whether rays out of spheres may meet it, (spheres,).

        Args:
            places: Middles of the spheres, from the obstacle's position, (spheres, 3) (length).
            radii: Of the spheres (length).
            rays: Unit vectors, (spheres, 3).
        """
        away = places - self.middle
        aside = away - np.einsum("ij,ij->i", away, rays)[:, None] * rays
        return np.asarray(np.linalg.norm(aside, axis=1) <= self.radius + 2 * radii)


def _facet_mesh(surface: RigidSurface) -> FacetMesh:
    """The triangles, none of which shares a node: a mean normal would tell nothing at an edge."""
    geometry = surface.points[surface.triangles]
    count, nodes = surface.triangles.shape
    outward = np.cross(geometry[:, 1] - geometry[:, 0], geometry[:, 2] - geometry[:, 0])
    return FacetMesh(
        shape="triangle",
        order=surface.order,
        degree=surface.order,
        geometry=geometry,
        nodes=np.arange(count * nodes).reshape(count, nodes),
        normals=np.repeat(normalised(outward), nodes, axis=0),
    )
