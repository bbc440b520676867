"""The bulk's quadrature on distorted quadrilaterals and hexahedra, whose integrands are rational.

Degree 2k (k + 1 points along each axis) is what undistorted cells of degree k need. On
distorted ones it must cost less than the discretisation does, and a point less must cost more.
"""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Discretisation, Material, Run, Scene, Support
from fenics_contact.body.spaces import Spaces
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
SIDES = {2: ("x0", "x1", "y0", "y1"), 3: ("x0", "x1", "y0", "y1", "z0", "z1")}
CELLS = [(1, (8, 8)), (1, (16, 16)), (2, (4, 4)), (2, (8, 8)), (1, (4, 4, 4)), (2, (3, 3, 3))]


def distorted(cells, share=0.2):
    """A unit box; inner vertices are moved by up to this share of a cell along each axis.

    The share is the same on every mesh: cells do not turn into parallelograms as they shrink.
    The Jacobian's determinant goes down to a fifth or less of its mean at their corners.
    """
    dimension = len(cells)
    body = box_body(cells, (1,) * dimension)
    points = body.mesh.geometry.x
    before = points[:, :dimension].copy()
    inside = ((before > 1e-9) & (before < 1 - 1e-9)).all(axis=1)
    numbers = np.rint(before * cells) @ [1, 37, 1009][:dimension]
    for axis in range(dimension):
        noise = np.sin(12.9898 * numbers + 78.233 * axis) * 43758.5453
        moved = share / cells[axis] * np.sign(np.mod(noise, 2) - 1)
        points[:, axis] += np.where(inside, moved, 0.0)
    return body


def held_all_around(body, degree, exact):
    """Solved with given displacements on the whole boundary."""
    dimension = body.dimension
    displacement = {
        axis: (lambda x, i=i: exact(x[:dimension], np)[i])
        for i, axis in enumerate("xyz"[:dimension])
    }
    scene = Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=tuple(Support(side, displacement) for side in SIDES[dimension]),
    )
    run = Run(scene, COMM, body)
    assert run.solve().passed
    return run


def linear(x, library):
    """Strain, rotation and translation."""
    values = [0.1 + 0.02 * x[0] - 0.03 * x[1], 0.04 * x[0] + 0.05 * x[1]]
    return values if len(x) == 2 else [values[0] + 0.01 * x[2], values[1], 0.06 * x[2]]


def curl_free(x, library):
    """The gradient of a small harmonic function: in equilibrium for any ν."""
    grows, cos, sin = 1e-3 * library.exp(x[0]), library.cos, library.sin
    if len(x) == 2:
        return [grows * cos(x[1]), -grows * sin(x[1])]
    y, z = 0.6 * x[1], 0.8 * x[2]
    return [
        grows * cos(y) * cos(z),
        -0.6 * grows * sin(y) * cos(z),
        -0.8 * grows * cos(y) * sin(z),
    ]


def norm(field, mesh):
    """Root of ∫ |field|², by a rule that nothing here asks more of."""
    measure = ufl.dx(domain=mesh, metadata={"quadrature_degree": 8})
    square = fem.assemble_scalar(fem.form(ufl.inner(field, field) * measure))
    return np.sqrt(COMM.allreduce(square))


def of_quadrature(degree, cells):
    """Change of the solution by the rule alone, over its discretisation error (gradients).

    Of the rule in use, and of one with a point less along each axis.
    """
    body = distorted(cells)
    found = [held_all_around(body, degree, curl_free).problem.displacement]
    with pytest.MonkeyPatch.context() as patch:
        for rule in (2 * degree - 2, 2 * degree + 8):
            patch.setattr(Spaces, "bulk_degree", rule)
            found.append(held_all_around(body, degree, curl_free).problem.displacement)
    *rules, best = found
    position = ufl.SpatialCoordinate(body.mesh)
    error = norm(ufl.grad(best - ufl.as_vector(curl_free(position, ufl))), body.mesh)
    return [norm(ufl.grad(rule - best), body.mesh) / error for rule in rules]


@pytest.mark.parametrize(("degree", "cells"), CELLS)
def test_patch_test(degree, cells):
    """A linear displacement on the boundary is linear inside."""
    run = held_all_around(distorted(cells), degree, linear)
    points = run.problem.spaces.coordinates[:, : len(cells)]
    expected = np.stack(linear(points.T, np), axis=1)
    worst = np.abs(run.solution.displacement - expected).max(initial=0.0)
    assert COMM.allreduce(worst, op=MPI.MAX) < 1e-14


@pytest.mark.parametrize(("degree", "cells"), CELLS)
def test_quadrature_costs_far_less_than_the_discretisation(degree, cells):
    """And a point less along each axis as much as that."""
    used, less = of_quadrature(degree, cells)
    assert used < 0.02
    assert less > 0.25
