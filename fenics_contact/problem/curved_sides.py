"""Facets of a body that stand for a curve, and how far the curve lies outside of them.

Straight cells have the nodes of a curved side on the curve, and chords between them.
"""

from __future__ import annotations

import basix
import numpy as np
import ufl
from dolfinx import fem

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Flags
from fenics_contact.common.parallel import gather_rows, largest, of_every_rank
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.sampled_values import on_side

# Of the body's extent: what is missed is round-off of the nodes.
_NONE = 1e-12


class CurvedSides:
    """All sides of a body on which facets miss something; collective.

    Attributes:
        facets: (cell, local facet) of this rank's own, (facets, 2).
        offset: How far the curve lies outside, a dolfinx function with a meaning on these facets
            alone; None where no rank has any (length).

    Args:
        spaces: Those of the body.
        left_out: Groups of facets that stand for no curve.
    """

    def __init__(self, spaces: Spaces, left_out: list[Group]) -> None:
        self._spaces = spaces
        mesh = spaces.body.mesh
        pairs = exterior_pairs(spaces)
        whole, first = gathered_facets(spaces, pairs)
        space = fem.functionspace(mesh, ("DG", 2 * spaces.geometry_order))
        offset = fem.Function(space)
        missed = self._fill(offset, SmoothSurface(whole), pairs, first)
        extent = largest(spaces.comm, np.abs(mesh.geometry.x).ravel())
        curved = missed > _NONE * extent
        for group in left_out:
            curved &= ~_among(pairs, spaces.facets(group))
        self.facets = pairs[curved]
        self.offset = offset if largest(spaces.comm, missed[curved]) > 0 else None

    @property
    def slope(self) -> Expr:
        """Gradient of the offset along the sides, in UFL."""
        normal, gradient = self.normal, ufl.grad(self.offset)
        return gradient - ufl.dot(gradient, normal) * normal

    @property
    def normal(self) -> Expr:
        """Outward, of the facets, in UFL."""
        return ufl.FacetNormal(self._spaces.body.mesh)

    @property
    def widened(self) -> Expr:
        """Share by which circles about the axis of revolution are longer on the curve, in UFL."""
        if self._spaces.kinematics != "axisymmetric":
            return ufl.as_ufl(0.0)
        return self.offset * self.normal[0] / self._spaces.position[0]

    @property
    def stretch(self) -> Expr:
        """Share by which the curve is longer (in 3D larger) than its facets, in UFL."""
        return ufl.dot(self.slope, self.slope) / 2 + self.widened

    def further_motion(self, displacement: Expr) -> Expr:
        """Return how much more the curve moves than its facets, in UFL (length)."""
        return self.offset * ufl.dot(ufl.grad(displacement), self.normal)

    def measure(self, chosen: Flags) -> ufl.Measure:
        """Measure of some of ``facets``."""
        entities = self.facets[chosen].astype(np.int32).reshape(-1)
        return ufl.Measure("ds", self._spaces.body.mesh, subdomain_data=[(1, entities)])(1)

    def within(self, group: Group) -> Flags:
        """Return for each of the facets whether it is a group's, or a side of its cells."""
        if group.dimension == self._spaces.body.dimension:
            return np.isin(self.facets[:, 0], self._spaces.body.entities(group))
        return _among(self.facets, self._spaces.facets(group))

    def held(self, free: Flags) -> Flags:
        """Return for each of the facets whether all its nodes are held in all directions.

        Args:
            free: Which components of which nodes nothing holds, (nodes, components).
        """
        dofmap = self._spaces.displacement_space.dofmap
        dimension = self._spaces.body.dimension - 1
        closures = [
            dofmap.list[cell, dofmap.dof_layout.entity_closure_dofs(dimension, side)]
            for cell, side in self.facets.tolist()
        ]
        return np.array([not free[nodes].any() for nodes in closures], dtype=bool)

    def _fill(
        self, offset: fem.Function, smooth: SmoothSurface, pairs: AnyIntegers, first: int
    ) -> Array:
        """Set the offsets of all facets; the largest of each, (facets,) (length)."""
        space = offset.function_space
        places = compat.interpolation_points(space.element)
        cell = getattr(basix.CellType, self._spaces.body.mesh.topology.cell_name())
        missed = np.zeros(len(pairs))
        for side in np.unique(pairs[:, 1]):
            rows = np.flatnonzero(pairs[:, 1] == side)
            on, reference = on_side(cell, int(side), places)
            facet = np.repeat(first + rows, len(on))
            found = smooth.offsets(facet, np.tile(reference, (len(rows), 1)))
            found = found.reshape(len(rows), len(on))
            missed[rows] = np.abs(found).max(axis=1, initial=0.0)
            dofs = space.dofmap.list[pairs[rows, 0]][:, on]
            known = offset.x.array[dofs]  # at the edge of another side of the same cell
            offset.x.array[dofs] = np.where(np.abs(found) > np.abs(known), found, known)
        return missed


def exterior_pairs(spaces: Spaces) -> AnyIntegers:
    """(cell, local facet) of this rank's own sides of the body, (facets, 2)."""
    mesh = spaces.body.mesh
    exterior = compat.exterior_facets(mesh)
    return np.asarray(compat.boundary_entities(mesh.topology, exterior)).reshape(-1, 2)


def gathered_facets(spaces: Spaces, pairs: AnyIntegers) -> tuple[FacetMesh, int]:
    """All facets of all ranks, and the number of this rank's first; collective.

    Args:
        spaces: Those of the body.
        pairs: This rank's, as of ``exterior_pairs``.
    """
    mesh, size = spaces.body.mesh, spaces.components
    dimension = spaces.body.dimension - 1
    layout = compat.geometry_layout(mesh)
    corners = mesh.geometry.x[compat.geometry_nodes(mesh)][..., :size]
    geometry = [
        corners[cell, layout.entity_closure_dofs(dimension, side)] for cell, side in pairs.tolist()
    ]
    cell = getattr(basix.CellType, mesh.topology.cell_name())
    shape = basix.cell.subentity_types(cell)[dimension][0].name
    count = len(basix.topology(cell)[dimension][0])
    nodes = len(layout.entity_closure_dofs(dimension, 0))
    mine = np.array(geometry).reshape(-1, nodes, size)
    outward = mine[:, :count].mean(axis=1) - corners[pairs[:, 0]].mean(axis=1)
    whole = gather_rows(spaces.comm, mine)
    normals = normalised(gather_rows(spaces.comm, outward))
    numbers = np.arange(count * len(whole)).reshape(-1, count)
    surface = FacetMesh(
        shape, spaces.geometry_order, 1, whole, numbers, np.repeat(normals, count, axis=0)
    )
    return surface, sum(of_every_rank(spaces.comm, len(mine))[: spaces.comm.rank])


def _among(pairs: AnyIntegers, others: AnyIntegers) -> Flags:
    """Return for each (cell, local facet) whether it is among others."""
    wanted = set(map(tuple, others.tolist()))
    return np.array([tuple(pair) in wanted for pair in pairs.tolist()], dtype=bool)
