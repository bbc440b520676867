"""How the nodes of a cut face of a sector follow from those of the other, whose mesh is another.

The mortar method, as between bodies that touch, with a space of multipliers that has no functions
of its own at the rim (C. Bernardi, Y. Maday, A. T. Patera 1994): there nodes follow from the other
rim, point by point, so that a contact that ends in the cut has no nodes in it but those of its
rim. The shape function of a node of the rim counts with those of nodes inside beside it. So their
sum is 1 everywhere, and a uniform traction crosses the cut exactly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csr_matrix, hstack, identity
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from fenics_contact.body.cyclic.matching import NodeShares, parts_in_order
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import on_root
from fenics_contact.contact.mortar.facet_mesh import FacetMesh
from fenics_contact.contact.mortar.pairing import gathered
from fenics_contact.contact.mortar.projection import integrate
from fenics_contact.contact.mortar.ray_projection import hits
from fenics_contact.contact.mortar.rim_of_facets import places_on_rim, rim_of
from fenics_contact.contact.surface.trace import Trace

# Shares of which a node has less in another: round-off of the mortar projection.
_NONE = 1e-13
# Facets at a curved rim need not cover each other: shares of them that are to, and of the distance
# of nodes how far rims may be apart along the face.
_COVERED, _ALONG = 0.8, 0.1


class CutProjection:
    """The two faces of a cut; collective.

    Args:
        spaces: Those of the body.
        on: Name of the face that follows.
        against: That of the other one.
    """

    def __init__(self, spaces: Spaces, on: str, against: str) -> None:
        self._spaces, self._names = spaces, (on, against)

    def shares(self, turn: Array, centre: Array) -> NodeShares:
        """Shares by which nodes of one face follow from those of the other, turned; collective.

        Args:
            turn: R, (3, 3).
            centre: A point of the axis, (3,) (length).
        """
        spaces, size = self._spaces, self._spaces.components
        meshes: list[FacetMesh] = []
        numbers: list[Integers] = []
        parts: list[Integers] = []
        for name in self._names:
            trace = Trace(spaces, spaces.body.boundary(name, "cyclic_symmetry"))
            surface = trace.surface
            meshes.append(gathered(trace))
            numbers.append(surface.dofs[::size] // size)
            parts.append(surface.gathered(spaces.parts.of_node[surface.body_nodes]))
        rotation, at = turn[:size, :size], centre[:size]
        meshes[1] = replace(
            meshes[1],
            geometry=at + (meshes[1].geometry - at) @ rotation.T,
            normals=meshes[1].normals @ rotation.T,
        )
        found, off = on_root(spaces.comm, lambda: _shares(meshes, parts))
        return NodeShares(numbers[0], numbers[1], found, off)


def _shares(meshes: list[FacetMesh], parts: list[Integers]) -> tuple[csr_matrix, float]:
    """Shares of all nodes, and how far the faces are apart, by parts of the body.

    A part goes on in itself or, where the cut parts a body twice, in another one.
    """
    weights, off = np.zeros([mesh.node_count for mesh in meshes]), 0.0
    for part in np.unique(parts[0]):
        one = _of_part(meshes[0], parts[0] == part)
        tries = []
        for beyond in parts_in_order(part, parts[1]):
            other = _of_part(meshes[1], parts[1] == beyond)
            tries.append(_shares_of_part(one, other))
            if tries[-1][2] == 0:  # no farther than facets miss of curved faces
                break
        rows, found, apart = min(tries, key=lambda each: each[2])
        weights[rows] = found
        off = max(off, apart)
    weights[np.abs(weights) < _NONE] = 0.0
    return csr_matrix(weights), off


def _of_part(mesh: FacetMesh, inside: Flags) -> FacetMesh:
    """The facets whose nodes are inside a part; nodes keep their numbers."""
    kept = inside[mesh.nodes].all(axis=1)
    return replace(mesh, geometry=mesh.geometry[kept], nodes=mesh.nodes[kept])


def _shares_of_part(slave: FacetMesh, master: FacetMesh) -> tuple[Integers, Array, float]:
    """Rows of the shares of the nodes of one part's face.

    Returns:
        The nodes, their shares of all nodes of the master, and how far the faces are apart beyond
        what facets miss of a curved one, infinite where one does not cover the other (length).
    """
    nodes = np.unique(slave.nodes)
    places = np.full((slave.node_count, slave.dimension), np.nan)
    places[nodes] = slave.node_positions()[nodes]
    rim: Integers = np.unique(rim_of(slave).nodes)
    at_rim, others = places_on_rim(places[rim], rim_of(master), master.node_count)
    apart = np.linalg.norm(places[rim] - others, axis=1)
    inside: Integers = np.setdiff1d(nodes, rim).astype(np.int64)
    integrals = integrate(slave, master, slave.normals, False)
    across = np.abs(np.einsum("nd,nd->n", places[rim] - others, slave.normals[rim]))
    off = max(_gap(slave, master, inside, places), _beyond(float(across.max()), slave, master))
    if min(integrals.coverage.min(), _coverage(master, slave)) < _COVERED:
        off = np.inf
    if float(apart.max()) > _ALONG * float(min(slave.spacing.min(), master.spacing.min())):
        off = max(off, float(apart.max()))
    if len(inside) == 0 or not np.isfinite(off):
        return rim, at_rim, off
    test = _test_functions(slave, inside, rim, places)
    every = np.concatenate([inside, rim])
    mass = test @ integrals.mass[every][:, every]
    right = test @ integrals.coupling[every] - mass[:, len(inside) :] @ csr_matrix(at_rim)
    found = splu(mass[:, : len(inside)].tocsc()).solve(right.toarray())
    return every, np.concatenate([found, at_rim]), off


def _gap(slave: FacetMesh, master: FacetMesh, inside: Integers, places: Array) -> float:
    """How far nodes inside a face are from the other, beyond what facets miss (length)."""
    found = hits(master, places[inside], slave.normals[inside]).distance
    return _beyond(float(np.abs(found).max(initial=0.0)), slave, master)


def _beyond(apart: float, slave: FacetMesh, master: FacetMesh) -> float:
    """Return a distance without what facets of curved faces miss (length)."""
    return max(apart - slave.sagitta - master.sagitta, 0.0)


def _coverage(master: FacetMesh, slave: FacetMesh) -> float:
    """The least share of a facet of the other face that faces this one."""
    return float(integrate(master, slave, master.normals, False).coverage.min())


def _test_functions(slave: FacetMesh, inside: Integers, rim: Integers, places: Array) -> csr_matrix:
    """Functions of nodes inside, of which each node of the rim has its own in equal parts.

    Returns:
        (nodes inside, nodes inside and of the rim).
    """
    parts = np.zeros((len(inside), len(rim)))
    number = np.full(slave.node_count, -1)
    number[inside] = np.arange(len(inside))
    _, nearest = cKDTree(places[inside]).query(places[rim])
    for column, node in enumerate(rim):
        beside = number[np.unique(slave.nodes[(slave.nodes == node).any(axis=1)])]
        beside = beside[beside >= 0]
        beside = beside if len(beside) else nearest[column : column + 1]
        parts[beside, column] = 1 / len(beside)
    return csr_matrix(hstack([identity(len(inside)), csr_matrix(parts)]))
