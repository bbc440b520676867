"""Meshes with all their edges halved: the same body and groups, in cells of half the size."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact.common.parallel import largest
from fenics_contact.mesh.gathered_mesh import is_of_order_1
from fenics_contact.mesh.refinement import halved
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
    """Volume of each group of cells; ∫ (1 + x²) of each group of sides and the means of n."""
    mesh, found = body.mesh, {}
    x, normal = ufl.SpatialCoordinate(mesh), ufl.FacetNormal(mesh)
    for name, group in body.groups.items():
        whole = group.dimension == body.dimension
        kind, tags = ("dx", body.cell_tags) if whole else ("ds", body.facet_tags)
        measure = ufl.Measure(kind, domain=mesh, subdomain_data=tags)(group.tags)
        terms = [1 * measure] if whole else [(1 + x[0] ** 2) * measure]
        terms += [] if whole else [n * measure for n in normal]
        found[name] = [COMM.allreduce(fem.assemble_scalar(fem.form(term))) for term in terms]
    return found


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
