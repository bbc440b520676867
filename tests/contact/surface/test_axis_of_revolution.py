"""A point on the axis of revolution stands for no area, and exerts exactly nothing."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Obstacle, Run, Scene, Support
from fenics_contact.verification.boxes import Box, boxes

COMM = MPI.COMM_WORLD


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
@pytest.mark.parametrize("order", [1, 2])
def test_what_touches_nothing_is_at_rest(cell, order):
    """An obstacle that comes nearer, but not near enough: round-off of the radius is no area."""
    body = boxes((Box("body", (0.0, -1.0), (1.0, 0.0), (8, 4)),), cell, COMM, order)
    points = body.mesh.geometry.x
    points[:, 1] -= 0.2566 * points[:, 0] ** 2 * (1 + points[:, 1])
    points[:, 1] -= 1e-3
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.45),
        discretisation=Discretisation(2),
        support=(Support("body.y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "body.y1",
                obstacle=Obstacle("plane", position=(0, 0), normal=(0, -1), indentation=6e-4),
                friction_coefficient=0.5,
            ),
        ),
    )
    run = Run(scene, COMM, body)
    result = run.solve()
    assert result.passed, result.verdict
    assert COMM.allreduce(np.abs(run.solution.displacement).max(initial=0), op=MPI.MAX) == 0
    assert result.quantities["strain_energy"] == 0
    assert "does not touch" in result.verdict
