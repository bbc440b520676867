"""A pin's pressure on a hole: its resultant, its largest value, symmetry, derivatives, refusals."""

import dataclasses

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Point, Scene, Study, Support, run
from fenics_contact.common import form_cache
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from tests.messages import refused
from tests.problem.rings import ring
from tests.problem.test_resultants import resultants
from tests.scenes import box_body

RADIUS, LENGTH, FORCE = 10.0, 20.0, 1000.0


def plate(force, kinematics="plane strain", **more):
    """A plate with a hole that is loaded, held at its rim."""
    axes = {"x": 0, "y": 0} if len(force) == 2 else {"x": 0, "y": 0, "z": 0}
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support("ring.y1", axes),),
        load=(Load("ring.y0", force=force, distribution="bearing"),),
        **more,
    )


def tube(**more):
    return ring(24, inner=RADIUS, length=LENGTH, **more)


@pytest.mark.parametrize("angle", [0.0, 0.2, 1.0])
@pytest.mark.parametrize(
    "body",
    [
        lambda: tube(),
        lambda: tube(order=1, cell="tetrahedron"),
        lambda: tube(order=2, cell="tetrahedron"),
    ],
)
def test_its_resultant_is_the_force(angle, body):
    force = (FORCE * np.cos(angle), FORCE * np.sin(angle), 0.0)
    found = resultants(plate(force, "3D"), body(), (0, 0, 0))
    assert found[:3] == pytest.approx(force, abs=1e-12 * FORCE)


@pytest.mark.parametrize("order", [1, 2])
def test_in_the_plane_its_resultant_is_the_force_per_thickness(order):
    found = resultants(plate((30.0, -50.0)), ring(23, order=order), (0, 0))
    assert found[:2] == pytest.approx((30, -50), abs=1e-11)


def largest_pressure(scene, body):
    """Root of ∫ p⁴ over ∫ p², of p = p₀ cos θ: ¾ p₀²."""
    (load,) = Problem.on_mesh(scene, body).loads
    squared = ufl.dot(load.acting.force, load.acting.force)
    sums = [
        total(body.mesh.comm, form_value(part * load.acting.measure))
        for part in (squared, squared**2)
    ]
    return np.sqrt(4 / 3 * sums[1] / sums[0])


def form_value(form):
    from dolfinx import fem

    return fem.assemble_scalar(form_cache.form(form))


def test_its_largest_value_is_that_of_a_cosine():
    """p₀ = 2 F/(π r L) = 3.18310."""
    found = largest_pressure(plate((FORCE, 0.0, 0.0), "3D"), tube())
    assert found == pytest.approx(3.18310, rel=1e-3)


def test_the_loaded_half_is_that_which_the_force_points_to():
    problem = Problem.on_mesh(plate((FORCE, 0.0)), ring(24))
    nodal = problem.loads[0].acting.nodal()
    x = problem.spaces.coordinates
    behind = nodal[x[:, 0] < -0.2 * RADIUS]
    assert np.abs(behind).max(initial=0.0) < 1e-12 * FORCE
    ahead = nodal[(x[:, 0] > 0.9 * RADIUS) & (np.hypot(x[:, 0], x[:, 1]) < 1.01 * RADIUS)]
    assert (ahead[:, 0] > 0).all()


def test_half_of_a_symmetric_model_is_half_of_it():
    point = (Point("at", (RADIUS, 0)),)
    whole = Study(plate((FORCE, 0.0), point=point), body=ring(24)).solve()
    scene = plate((FORCE / 2, 0.0), point=point, symmetry=("cut",))
    body = ring(12, turn=0.5)
    ends = (*body.groups["ring.x0"].tags, *body.groups["ring.x1"].tags)
    cut = dataclasses.replace(body.groups["ring.x0"], tags=ends)
    body = dataclasses.replace(body, groups={**body.groups, "cut": cut})
    half = Study(scene, body=body).solve()
    found, expected = (one.quantities["displacement_at"] for one in (half, whole))
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-10)
    with refused("bearing_across_a_plane_of_symmetry"):
        Problem.on_mesh(plate((FORCE, 1.0), symmetry=("cut",)), body)


def test_derivatives_are_those_of_differences():
    keys = ["load.0.force.0", "load.0.force.1"]
    names = ["displacement_at_x", "displacement_at_y"]
    scene = plate((30.0, -50.0), point=(Point("at", (0, -RADIUS)),))
    study = Study(scene, body=ring(23))
    found = study.derivatives(names, keys)
    for place, key in enumerate(keys):
        ends = [
            study.solve({key: scene.load[0].force[place] + change}).quantities["displacement_at"]
            for change in (-1e-2, 1e-2)
        ]
        for number, name in enumerate(names):
            slope = (ends[1][number] - ends[0][number]) / 2e-2
            assert found[name][key] == pytest.approx(slope, rel=1e-3, abs=1e-7)


def test_no_force_is_no_load():
    assert Problem.on_mesh(plate((0.0, 0.0)), ring(8)).loads == []


def test_what_is_no_hole_is_refused():
    with refused("bearing_has_no_moment", SceneError):
        Load("x1", force=(1, 0), moment=2, distribution="bearing")
    with refused("bearing_has_no_moment", SceneError):
        Load("x1", moment=2, distribution="bearing")
    with refused("bearing_along_the_hole"):
        Problem.on_mesh(plate((1.0, 0.0, 0.1), "3D"), tube())
    flat = dataclasses.replace(
        plate((1.0, 0.0)),
        support=(Support("x0", {"x": 0, "y": 0}),),
        load=(Load("x1", force=(1, 0), distribution="bearing"),),
    )
    with refused("bearing_on_a_flat_side"):
        run(flat, MPI.COMM_SELF, box_body((2, 2), comm=MPI.COMM_SELF))


@pytest.mark.errors
def test_what_straight_cells_miss_of_it_is_estimated():
    """Of a coarse polygon in place of a circle; the resultant is no part of that."""
    scene = dataclasses.replace(
        plate((FORCE, 0.0)), support=(), contact=(Contact("ring.y1", contact="bonded"),)
    )
    true = run(scene, body=ring(96, layers=8)).quantities["strain_energy"]
    found = run(scene, body=ring(16, layers=2, order=1))
    error = abs(found.quantities["strain_energy"] - true)
    assert error < found.errors["strain_energy"]["total"] < 20 * error
