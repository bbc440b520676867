"""Bodies of several boxes with meshes of their own, for tests of contact between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem, mesh
from mpi4py import MPI

from fenics_contact import Body, Group
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.contact.mortar.projection import Projection

COMM = MPI.COMM_WORLD


@dataclass(frozen=True)
class Box:
    """A box, named, from one corner to the opposite one, with cells along each axis."""

    name: str
    low: tuple[float, ...]
    high: tuple[float, ...]
    cells: tuple[int, ...]


def boxes(
    parts: Sequence[Box], cell: str = "quadrilateral", comm: MPI.Comm = COMM, order: int = 1
) -> Body:
    """Boxes as one mesh of unconnected parts; groups such as ``upper`` and ``upper.y0``."""
    dimension = len(parts[0].cells)
    points, cells, owner = [], [], []
    for number, box in enumerate(parts):
        make = mesh.create_rectangle if dimension == 2 else mesh.create_box
        ends = [np.array(box.low), np.array(box.high)]
        made = make(MPI.COMM_SELF, ends, list(box.cells), getattr(mesh.CellType, cell))
        nodes, places = compat.geometry_nodes(made), made.geometry.x
        if order == 2:  # the nodes of such cells are numbered as those of elements are
            space = fem.functionspace(made, ("Lagrange", 2))
            nodes, places = space.dofmap.list, space.tabulate_dof_coordinates()
        cells.append(nodes + sum(len(p) for p in points))
        points.append(places[:, :dimension])
        owner.append(np.full(len(cells[-1]), number + 1, dtype=np.int32))
    joined = [np.concatenate(arrays) for arrays in (points, cells, owner)]
    if comm.rank:
        joined = [array[:0] for array in joined]
    whole = compat.create_mesh(comm, cell, order, joined[0], joined[1].astype(np.int64))
    cell_tags = compat.distributed_tags(whole, dimension, joined[1].astype(np.int64), joined[2])
    facet_tags, groups = _sides(whole, cell_tags, parts)
    for number, box in enumerate(parts):
        groups[box.name] = Group(dimension, (number + 1,))
    return Body(whole, cell_tags, facet_tags, groups, "boxes")


def _sides(whole, cell_tags, parts):
    """Tags of the boundary facets by box and side, and the groups of these."""
    dimension = whole.topology.dim
    whole.topology.create_entities(dimension - 1)
    whole.topology.create_connectivity(dimension - 1, dimension)
    links = whole.topology.connectivity(dimension - 1, dimension)
    facets = compat.exterior_facets(whole)
    behind = np.array([links.links(facet)[0] for facet in facets], dtype=np.int32)
    owner = np.zeros(cell_tags.indices.max(initial=-1) + 1, dtype=np.int32)
    owner[cell_tags.indices] = cell_tags.values
    centres = mesh.compute_midpoints(whole, dimension - 1, facets)
    tags, groups = np.zeros(len(facets), dtype=np.int32), {}
    for number, box in enumerate(parts):
        mine = owner[behind] == number + 1 if len(behind) else np.zeros(0, dtype=bool)
        for axis in range(dimension):
            for end, at in enumerate((box.low[axis], box.high[axis])):
                tag = 1 + 10 * number + 2 * axis + end
                tags[mine & np.isclose(centres[:, axis], at)] = tag
                groups[f"{box.name}.{'xyz'[axis]}{end}"] = Group(dimension - 1, (tag,))
    order = np.argsort(facets)
    return mesh.meshtags(whole, dimension - 1, facets[order], tags[order]), groups


class Shuffled:
    """A projection whose columns are shuffled: resultants balance, moments do not.

    Args:
        pairing: Whose projection it is.
    """

    def __init__(self, pairing) -> None:
        self._straight, self._comm = pairing.projection, pairing.master.comm
        count = pairing.master.space.dofmap.index_map.size_global
        self._order = np.random.default_rng(7).permutation(count)
        self._mine = pairing.master.numbers[: pairing.master.owned_nodes]

    def apply(self, values):
        return self._straight.apply(self._whole(values)[self._order][self._mine])

    def transposed(self, forces):
        whole = self._whole(self._straight.transposed(forces))
        found = np.empty_like(whole)
        found[self._order] = whole
        return found[self._mine]

    def whole(self, projection):
        """The same of the projection of the whole surfaces."""
        parts = []
        for part in projection.components:
            rows, back = np.arange(part.shape[0]), np.argsort(self._order)
            parts.append(part.restricted(rows, back))
        return Projection(parts)

    def _whole(self, own):
        return np.concatenate(self._comm.allgather(own))
