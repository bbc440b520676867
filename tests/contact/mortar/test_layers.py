"""Of several layers of the master before a slave's facet, the nearest alone is joined."""

import dataclasses

import numpy as np
import pytest

from fenics_contact.contact.mortar.projection import integrate
from tests.contact.mortar.facet_meshes import flat


def together(*meshes):
    """Surfaces as one, whose nodes keep their order."""
    firsts = np.cumsum([0, *(mesh.node_count for mesh in meshes)])
    nodes = [first + mesh.nodes for first, mesh in zip(firsts[:-1], meshes, strict=True)]
    return dataclasses.replace(
        meshes[0],
        geometry=np.concatenate([mesh.geometry for mesh in meshes]),
        nodes=np.concatenate(nodes),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
    )


@pytest.mark.parametrize("shape", ["interval", "triangle", "quadrilateral"])
@pytest.mark.parametrize("degree", [1, 2])
def test_a_plate_behind_another_one_is_not_joined(shape, degree):
    """Both are as near as a facet is long: which is nearest is asked of each point."""
    slave = flat(shape, 1, 1, degree)
    near, far = (flat(shape, 2, -1, degree, height=height) for height in (0.1, 0.3))
    back = flat(shape, 2, 1, degree, height=0.2)
    alone = integrate(slave, near, slave.normals, False)
    both = integrate(slave, together(near, back, far), slave.normals, False)
    assert abs(both.mass - alone.mass).max() < 1e-14
    count = near.node_count
    assert abs(both.coupling[:, :count] - alone.coupling).max() < 1e-14
    assert both.coupling[:, count:].sum() == 0
    assert both.coverage == pytest.approx(1)


@pytest.mark.parametrize("shape", ["interval", "quadrilateral"])
def test_beside_a_plate_the_one_behind_is_joined(shape):
    slave = flat(shape, 1, 1)
    near, far = flat(shape, 1, -1, height=0.1, size=0.5), flat(shape, 2, -1, height=0.3)
    both = integrate(slave, together(near, far), slave.normals, False)
    assert both.coverage == pytest.approx(1)
    areas = np.asarray(both.coupling.sum(axis=0)).ravel()
    share = 0.5 if shape == "interval" else 0.25
    assert areas[: near.node_count].sum() == pytest.approx(share)
    assert areas[near.node_count :].sum() == pytest.approx(1 - share)
