"""What friction holds of torques and pushes together, against the formulas of rigid bodies."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Discretisation,
    Group,
    Load,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
SILENT = SolverSettings(errors="none")
RADIUS, FRICTION, FORCE = 2.0, 0.3, 100.0


def cylinder(radius, length, cells):
    """A square bar that is mapped to a round one: cells across and along it."""
    across, along = cells
    box = Box("bar", (-1.0, -1.0, 0.0), (1.0, 1.0, length), (across, across, along))
    body = boxes([box], "hexahedron", order=2)
    x = body.mesh.geometry.x
    u, v = x[:, 0].copy(), x[:, 1].copy()
    x[:, 0] = radius * u * np.sqrt(1 - v**2 / 2)
    x[:, 1] = radius * v * np.sqrt(1 - u**2 / 2)
    sides = [body.groups[f"bar.{side}"].tags for side in ("x0", "x1", "y0", "y1")]
    groups = body.groups | {"side": Group(2, tuple(tag for tags in sides for tag in tags))}
    return dataclasses.replace(body, groups=groups)


def uniform(x):
    return np.full(x.shape[1], FORCE / (np.pi * RADIUS**2))


def of_hertz(x):
    square = (x[0] ** 2 + x[1] ** 2) / RADIUS**2
    return 1.5 * FORCE / (np.pi * RADIUS**2) * np.sqrt(np.maximum(1 - square, 0))


@pytest.mark.parametrize(
    ("pressure", "push", "turn"),
    [
        # Over μ P and μ P a. A disc turns about its middle at 2/3, and beside a push about its rim,
        # or about a point at .6 a; under Hertz's pressure it turns at 3π/16.
        (uniform, 0.0, 2 / 3),
        (uniform, 0.848826, 0.282942),
        (uniform, 0.57162, 0.49951),
        (of_hertz, 0.0, 3 * np.pi / 16),
    ],
)
def test_a_disc_that_is_turned_and_pushed(pressure, push, turn):
    share = 0.7
    scale = share * FRICTION * FORCE
    load = Load("bar.z1", force=(0, push * scale, 0), moment=(0, 0, turn * scale * RADIUS))
    if not push:
        load = dataclasses.replace(load, force=None)
    scene = Scene(
        kinematics="3D",
        material=Material(1e5, 0.0),
        discretisation=Discretisation(2),
        support=(Support("bar.z1", {"z": 0}),),
        load=(load,),
        contact=(Contact("bar.z0", pressure=pressure, friction_coefficient=FRICTION),),
        solver=SILENT,
    )
    result = run(scene, COMM, body=cylinder(RADIUS, 1.0, (6 if pressure is uniform else 10, 1)))
    assert result.passed, result.verdict
    (found,) = result.slip_limit.parts.values()
    assert found == pytest.approx(share, rel=1.2e-2)


@pytest.mark.parametrize(("share", "code"), [(0.98, 0), (1.02, 3)])
def test_a_bar_in_a_groove_is_pushed_along_it(share, code):
    """Two sides at 45° under W = 100: N = W/√2 each, so that it slides at 2 μ N = 28.2843.

    Below, friction across the groove takes a part of the weight.
    """
    body = box_body((2, 4, 2), (1, 2, 1))
    x = body.mesh.geometry.x
    x[:, 0], x[:, 2] = (x[:, 0] - x[:, 2]) / np.sqrt(2), (x[:, 0] + x[:, 2]) / np.sqrt(2)
    sides = {"x0": (1, 0, 1), "z0": (-1, 0, 1)}
    scene = Scene(
        kinematics="3D",
        material=Material(1e5, 0.0),
        load=(Load("body", body_force=(0, share * 28.2843 / 2, -50.0)),),
        contact=tuple(
            Contact(side, obstacle=Obstacle("plane", normal=normal), friction_coefficient=0.2)
            for side, normal in sides.items()
        ),
        solver=SILENT,
    )
    result = run(scene, COMM, body=body)
    assert result.exit_code == code
    if code == 0:
        (found,) = result.slip_limit.parts.values()
        assert share - 1e-3 < found < 1


def test_a_shaft_in_a_rigid_hub_slips_over_a_part_of_its_length():
    """T falls by μ p 2π r² a length, from .6 of what the hub can hold: θ = T l/(2 G J), l = .6 L.

    In one dimension; without lateral contraction the pressure moves no point along the hub.
    """
    radius, length, pressure, friction, shear = 10.0, 40.0, 50.0, 0.15, 80769.0
    torque = 0.6 * friction * pressure * 2 * np.pi * radius**2 * length
    end = Coupling("bar.z1", kind="distributing", name="end", moment=(0, 0, torque))
    side = Contact("side", pressure=pressure, friction_coefficient=friction)
    scene = Scene(
        kinematics="3D",
        material=Material(2 * shear, 0.0),
        discretisation=Discretisation(2),
        support=(Support("bar.z0", {"z": 0}),),
        coupling=(end,),
        contact=(side,),
        solver=SILENT,
    )
    result = run(scene, COMM, body=cylinder(radius, length, (2, 20)))
    assert result.passed, result.verdict
    (found,) = result.couplings
    assert found.rotation[2] == pytest.approx(1.06971e-3, rel=2e-2)
    # Where all sticks, friction falls off over r/3.83, the first zero of the Bessel function J₁.
    assert 24 - radius / 3.83 < result.quantities["slip_area"] / (2 * np.pi * radius) < 24
