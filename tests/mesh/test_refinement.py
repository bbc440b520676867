"""Meshes with all their edges halved: the same body and groups, in cells of half the size."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.parallel import largest
from fenics_contact.mesh.refinement import halved, is_of_order_1
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body

COMM = MPI.COMM_WORLD


def two_bodies(cell, dimension):
    """Two boxes one above the other, sheared, so that no two of their sides are alike."""
    parts = [
        Box(name, (0, 0, low)[-dimension:], (2, 3, low + 1)[-dimension:], (3, 2, 2)[-dimension:])
        for name, low in (("lower", 0), ("upper", 1))
    ]
    body = boxes(parts, cell)
    body.mesh.geometry.x[:, 0] += 0.3 * body.mesh.geometry.x[:, 1] ** 2
    return body


def sizes(body):
    """Volume of each group of cells; of each group of sides the area and where its middle is."""
    mesh, dimension, found = body.mesh, body.dimension, {}
    constants = fem.functionspace(mesh, ("DG", 0))
    volumes = fem.assemble_vector(fem.form(ufl.TestFunction(constants) * ufl.dx)).array
    for name, group in body.groups.items():
        entities = body.entities(group)
        count = mesh.topology.index_map(group.dimension).size_local
        mine = entities[entities < count]
        if group.dimension == dimension:
            found[name] = [COMM.allreduce(volumes[mine].sum())]
            continue
        nodes = compat.nodes_of_entities(mesh, dimension - 1, mine)
        corners = {"triangle": 2, "quadrilateral": 2, "tetrahedron": 3, "hexahedron": 4}
        ends = mesh.geometry.x[nodes.reshape(-1, corners[mesh.topology.cell_name()])]
        areas, middles = areas_of(ends), ends.mean(axis=1)
        moments = [areas.sum(), *(areas @ middles)]
        found[name] = COMM.allreduce(np.array(moments)).tolist()
    return found


def areas_of(ends):
    """Lengths of edges, areas of plane triangles and quadrilaterals, (sides,)."""
    along = ends[:, 1] - ends[:, 0]
    if ends.shape[1] == 2:
        return np.linalg.norm(along, axis=1)
    last = ends[:, 2] - ends[:, 0]
    if ends.shape[1] == 4:
        along, last = ends[:, 3] - ends[:, 0], ends[:, 2] - ends[:, 1]
    return np.linalg.norm(np.cross(along, last), axis=1) / 2


def largest_size(mesh):
    count = mesh.topology.index_map(mesh.topology.dim).size_local
    return largest(COMM, mesh.h(mesh.topology.dim, np.arange(count, dtype=np.int32)))


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_halves_are_the_same_body_with_the_same_groups(cell):
    dimension = 3 if cell.endswith("hedron") else 2
    body = two_bodies(cell, dimension)
    finer = halved(body)
    count, more = (b.mesh.topology.index_map(dimension).size_global for b in (body, finer))
    assert more == 2**dimension * count
    assert largest_size(finer.mesh) < 0.6 * largest_size(body.mesh)
    expected, found = sizes(body), sizes(finer)
    assert set(found) == set(expected) and len(found) == 4 * dimension + 2
    for name, values in expected.items():
        assert found[name] == pytest.approx(values, abs=1e-12), name
        assert abs(values[0]) > 0.5, name


def test_cells_with_curved_sides_are_told():
    assert is_of_order_1(box_body((2, 1)).mesh)
    parts = [Box("block", (0, 0), (1, 1), (2, 2))]
    assert not is_of_order_1(boxes(parts, "quadrilateral", order=2).mesh)
