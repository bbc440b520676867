"""Facets of a contact surface: their sizes, normals at their nodes, and pieces of them."""

from __future__ import annotations

import numpy as np
import ufl
from numpy.typing import NDArray

from fenics_contact.body.cyclic.cut_faces import CutFaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array, Integers
from fenics_contact.common.parallel import gather_rows, largest, smallest, total
from fenics_contact.contact.surface.point_rule import nodal_rule, node_integrals
from fenics_contact.contact.surface.space import SurfaceSpace
from fenics_contact.mesh.tagged_mesh import Group


def relative_facet_size(surface: SurfaceSpace) -> float:
    """Largest facet over the extent of the surface; collective."""
    mesh = surface.mesh
    facets = np.arange(len(surface.facet_nodes), dtype=np.int32)
    return largest(surface.comm, mesh.h(mesh.topology.dim, facets)) / surface.extent()


def relative_cell_size(surface: SurfaceSpace) -> float:
    """Largest of the cells behind the facets over the extent of the surface; collective."""
    mesh = surface.spaces.body.mesh
    cells = np.unique(surface.parents[:, 0]).astype(np.int32)
    return largest(surface.comm, mesh.h(mesh.topology.dim, cells)) / surface.extent()


def smallest_edge(surface: SurfaceSpace) -> float:
    """Shortest edge of the cells at the surface (length): flat ones are stiff; collective."""
    mesh = surface.spaces.body.mesh
    topology = mesh.topology
    topology.create_entities(1)
    topology.create_connectivity(topology.dim, 1)
    topology.create_connectivity(1, topology.dim)  # which `h` asks for
    cells = np.unique(surface.parents[:, 0])
    links = topology.connectivity(topology.dim, 1)
    edges = [np.zeros(0, dtype=np.int32), *(links.links(cell) for cell in cells)]
    return smallest(surface.comm, mesh.h(1, np.unique(np.concatenate(edges))))


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
        cut: The cut faces of a sector, beyond which it goes on turned.
    """

    def __init__(self, surface: SurfaceSpace, group: Group, cut: CutFaces | None = None) -> None:
        spaces, self._surface = surface.spaces, surface
        bare = node_integrals(surface, 1.0, surface.measure(nodal_rule(spaces)))
        test = ufl.TestFunction(spaces.displacement_space)
        outward = ufl.dot(ufl.FacetNormal(spaces.body.mesh), test)
        boundary = spaces.boundary(group, nodal_rule(spaces))
        averaged = spaces.assemble(form_cache.form(outward * boundary))[surface.body_nodes]
        self.mean = self._mean(averaged, bare)
        if cut is not None:
            known = np.column_stack([averaged, bare])
            known = known + cut.exchanged(surface.on_body(known))[surface.body_nodes]
            averaged, bare = known[:, :-1], known[:, -1]
        lengths = np.linalg.norm(averaged, axis=1)
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

    Args:
        surface: The surface.
        contact_nodes: Nodes that are contact points.
        coordinates: Where all nodes are, (nodes, 3) (length).
    """

    def __init__(self, surface: SurfaceSpace, contact_nodes: Integers, coordinates: Array) -> None:
        nodes = self.nodes = _facet_pieces(surface)
        point_of = np.full(len(surface.coordinates), -1)
        point_of[contact_nodes] = np.arange(len(contact_nodes))
        points = point_of[nodes]
        self.points = np.where(points < 0, points.max(axis=1, initial=0)[:, None], points)
        self.corners = coordinates[nodes]
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
