"""Curved sides and functions between nodes, which a mesh misses; a body in cells of half the size.

Facets of a body that stand for a curve, and how far the curve lies outside of them. Straight cells
have the nodes of a curved side on the curve, and chords between them.

Functions of the place that a scene gives, as they are between nodes too. Loads act with values
that are interpolated between the nodes of the body's own element. What functions are besides is
seen by elements of a higher degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import basix
import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, largest, of_every_rank
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised, reference_nodes
from fenics_contact.contact.mortar.smooth_surface import SmoothSurface
from fenics_contact.mesh.refinement import halved
from fenics_contact.mesh.tagged_mesh import Body, Group
from fenics_contact.scene.values import Value

# Of the elements, by dimension: a step within a cell is then found to a tenth of the cell.
_DEGREES = {2: 6, 3: 4}
# Of reference coordinates: what lies on a side of the reference cell.
_ON_SIDE = 1e-9


def sampled(spaces: Spaces, values: Sequence[Value], group: Group, key: str) -> Expr:
    """Values on a group, a dolfinx function of one or all components; collective.

    Args:
        spaces: Those of the body.
        values: One of each component.
        group: Cells or facets; the function means something there alone.
        key: For messages.
    """
    mesh, dimension = spaces.body.mesh, spaces.body.dimension
    shape = (len(values),) if len(values) > 1 else ()
    space = fem.functionspace(mesh, ("DG", _DEGREES[dimension], shape))
    places = compat.interpolation_points(space.element)
    if group.dimension == dimension:
        dofs = [space.dofmap.list[spaces.body.entities(group)].ravel()]
    else:
        pairs = spaces.facets(group)
        cell = getattr(basix.CellType, mesh.topology.cell_name())
        dofs = [
            space.dofmap.list[pairs[pairs[:, 1] == side, 0]][:, on_side(cell, side, places)[0]]
            for side in np.unique(pairs[:, 1]).tolist()
        ]
    chosen = np.unique(np.concatenate([np.zeros(0, dtype=np.int32), *map(np.ravel, dofs)]))
    points = space.tabulate_dof_coordinates()[chosen].T
    function = fem.Function(space)
    array = function.x.array.reshape(-1, len(values))
    for axis, value in enumerate(values):
        array[chosen, axis] = spaces.evaluate_at(value, points, key)
    return function


def on_side(cell: Any, side: int, places: Array) -> tuple[AnyIntegers, Array]:
    """Places of the reference cell that are on a side of it, and where on that."""
    dimension = places.shape[1]
    corners = basix.geometry(cell)[basix.topology(cell)[dimension - 1][side]]
    axes = (corners[1:dimension] - corners[0]).T
    reference = (places - corners[0]) @ np.linalg.pinv(axes).T
    apart = np.linalg.norm(places - corners[0] - reference @ axes.T, axis=1)
    on = np.flatnonzero(apart < _ON_SIDE)
    return on, reference[on]


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


# Of the body's extent: places that are the same but for round-off.
_SAME = 1e-9
# Square of the sine of an angle between two sides, below which they are of one curve.
_TURN = 0.1


def halved_body(spaces: Spaces) -> Body:
    """All edges of its cells halved; collective.

    Without the curves it would be the same polygon, and a ball would never get its weight.

    Args:
        spaces: Those of a body of cells of order 1.
    """
    from scipy.spatial import cKDTree  # slow to load; few bodies need it

    finer = halved(spaces.body)
    places, moves = _onto_curves(spaces)
    nodes = finer.mesh.geometry.x
    size = spaces.components
    distance, nearest = cKDTree(places).query(nodes[:, :size])
    known = distance <= _SAME * np.ptp(places, axis=0).max()
    nodes[known, :size] += moves[nearest[known]]
    return finer


def _onto_curves(spaces: Spaces) -> tuple[Array, Array]:
    """Middles of all sides and of their edges, and the way from there to the curve; collective."""
    facets, _ = gathered_facets(spaces, exterior_pairs(spaces))
    corners = len(reference_nodes(facets.shape, 1))
    middles = reference_nodes(facets.shape, 2)[corners:]
    number = np.repeat(np.arange(len(facets.geometry)), len(middles))
    reference = np.tile(middles, (len(facets.geometry), 1))
    places = facets.positions(number, reference)
    offsets = SmoothSurface(facets).offsets(number, reference)
    normals = normalised(facets.normals_at_centres())[number]
    rounded = np.round(places / (_SAME * np.ptp(places, axis=0).max()))
    _, first, same = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return places[first], _common(same.reshape(-1), normals, offsets)


def _common(same: Integers, normals: Array, offsets: Array) -> Array:
    """Ways that lead onto all curves of which places are known from several sides.

    Args:
        same: Number of each place, (sides,).
        normals: There, (sides, components).
        offsets: Along them, (sides,).

    Returns:
        m by least squares of n · m − d, (places, components).
    """
    count, size = same.max() + 1, normals.shape[1]
    squares, right = np.zeros((count, size, size)), np.zeros((count, size))
    np.add.at(squares, same, normals[:, :, None] * normals[:, None, :])
    np.add.at(right, same, normals * offsets[:, None])
    return np.asarray(np.einsum("pij,pj->pi", np.linalg.pinv(squares, rcond=_TURN), right))
