"""A body in cells of half the size: new corners of a round side lie on the circle, others stay."""

import numpy as np
import pytest

from fenics_contact import Material, Run, Scene
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.parallel import largest
from fenics_contact.problem.curved_sides import halved_body
from fenics_contact.verification.boxes import Box, quarter_rings

CASES = [
    *[((4, 6), cell) for cell in ("triangle", "quadrilateral")],
    *[((3, 6, 2), cell) for cell in ("tetrahedron", "hexahedron")],
]


def ring(cells, cell):
    """Between radii of 1 and 2, as high as 1."""
    high = (2.0, 1.0, 1.0)[: len(cells)]
    return quarter_rings(
        [Box("ring", (1.0, 0.0, 0.0)[: len(cells)], high, cells)], order=1, cell=cell
    )


def off_circle(body, name, radius):
    """How far the nodes of a side are from a circle, at the most."""
    dimension = body.dimension
    sides = body.entities(body.groups[name])
    nodes = compat.nodes_of_entities(body.mesh, dimension - 1, sides).ravel()
    radii = np.linalg.norm(body.mesh.geometry.x[nodes, :2], axis=1)
    return largest(body.mesh.comm, np.abs(radii - radius))


@pytest.mark.parametrize(("cells", "cell"), CASES)
def test_new_corners_lie_on_the_circle_and_flat_sides_stay_flat(cells, cell):
    body = ring(cells, cell)
    scene = Scene(
        kinematics="3D" if len(cells) == 3 else "plane strain",
        material=(Material(1.0, 0.3, density=1.0),),
        motion={"step": 1, "end": 1},
    )
    spaces = Run(scene, body=body).problem.spaces
    finer = halved_body(spaces)
    for name, radius in (("ring.x0", 1.0), ("ring.x1", 2.0)):
        chord = radius * (1 - np.cos(np.pi / 4 / cells[1]))
        assert off_circle(finer, name, radius) < 0.1 * chord
    sides = finer.entities(finer.groups["ring.y0"])
    nodes = compat.nodes_of_entities(finer.mesh, body.dimension - 1, sides).ravel()
    assert largest(body.mesh.comm, np.abs(finer.mesh.geometry.x[nodes, 1])) < 1e-12
