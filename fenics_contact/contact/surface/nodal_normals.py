"""Outward normals at the nodes of a surface, averaged over the facets around each."""

from __future__ import annotations

import numpy as np
import ufl

from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.surface.point_rule import nodal_rule, node_integrals
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.mesh.tagged_mesh import Group

# Cosine of half the largest angle between neighbouring facets of one surface.
_SHARP = float(np.cos(np.pi / 8))


class NodalNormals:
    """Normals at all nodes of a surface, from integrals of their shape functions; collective.

    Attributes:
        normals: Outward unit normals, (nodes, components).
        mean: Mean of the outward unit normal over the surface, of a full revolution where
            axisymmetric, (components,); shorter the more the surface wraps around.
        turn: Angle between facets and these normals at the nodes, root of the mean square: 0 where
            facets go on smoothly (radians).

    Args:
        surface: The surface.
        group: Its facets on the boundary of the body.
    """

    def __init__(self, surface: SurfaceSpace, group: Group) -> None:
        spaces, self._surface = surface.spaces, surface
        bare = node_integrals(surface, 1.0, surface.measure(nodal_rule(spaces)))
        test = ufl.TestFunction(spaces.displacement_space)
        outward = ufl.dot(ufl.FacetNormal(spaces.body.mesh), test)
        boundary = spaces.boundary(group, nodal_rule(spaces))
        averaged = spaces.assemble(form_cache.form(outward * boundary))[surface.body_nodes]
        lengths = np.linalg.norm(averaged, axis=1)
        self.mean = self._mean(averaged, bare)
        # 1 on a flat surface; the cosine of half the angle at an edge between two facets.
        self._flatness = lengths / np.where(bare > 0, bare, 1.0)
        self.normals = averaged / np.where(lengths > 0, lengths, 1.0)[:, None]
        owned = slice(0, surface.owned_nodes)
        sums = np.column_stack([bare - lengths, bare])[owned].sum(axis=0)
        missing, every = total(surface.comm, sums)
        self.turn = float(np.sqrt(2 * max(missing, 0.0) / every))  # 1 − cos is half the square

    def _mean(self, normals: Array, areas: Array) -> Array:
        """∫ n over ∫ 1, from their integrals with the nodes' shape functions; collective."""
        surface, owned = self._surface, slice(0, self._surface.owned_nodes)
        rows = np.column_stack([normals, areas])[owned]
        axisymmetric = surface.spaces.kinematics == "axisymmetric"
        if axisymmetric:  # the radius is linear on a straight facet, and so is what it weighs
            rows = rows * surface.coordinates[owned, :1]
        summed: Array = total(surface.comm, rows.sum(axis=0))
        if axisymmetric:  # over a revolution radial ones cancel
            summed[0] = 0.0
        return np.asarray(summed[:-1] / summed[-1])

    def sharp_corner(self) -> Array | None:
        """A point where facets meet at more than 45°, the same on every rank; or None."""
        sharp = (self._flatness < _SHARP) & (self._flatness > 0)
        rows = gather_rows(self._surface.comm, self._surface.coordinates[sharp])
        order = np.lexsort(np.round(rows / (np.abs(rows).max(initial=0.0) or 1.0), 9).T)
        return rows[order[0]] if len(rows) else None
