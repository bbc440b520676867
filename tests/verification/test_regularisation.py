"""The error that ε brings, against the paper's bound and against ε → 0."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Profile, Run, Scene, Support, run
from fenics_contact.common.parallel import total
from tests.scenes import box_body, slab

COMM = MPI.COMM_WORLD


def solve(epsilon):
    prepared = Run(slab(300, cells=(64, 8), epsilon=epsilon), COMM)
    prepared.solve()
    return prepared


def test_energy_error_is_first_order_and_below_the_papers_bound():
    """√a(e, e) against ε: 1.20e-1, 1.19e-2, 1.21e-3, below √(ε ∫g / 2) (Theorem 2.4)."""
    reference = solve(1e-9)
    owned = slice(0, reference.problem.spaces.owned_nodes)
    for epsilon, expected in ((1e-2, 1.20e-1), (1e-3, 1.19e-2), (1e-4, 1.21e-3)):
        found = solve(epsilon)
        error = found.solution.displacement - reference.solution.displacement
        force = found.solution.internal_force - reference.solution.internal_force
        energy = np.sqrt(total(COMM, np.sum(error[owned] * force[owned])))
        assert energy == pytest.approx(expected, rel=0.05)
        assert energy < np.sqrt(epsilon * 90 * 8 / 2)


AUTOMATIC = {
    "paper": slab(),
    "little slip": slab(200),
    "all stick": slab(100),
    "much slip": slab(700),
    "near the limit": slab(719.99, held=False),
    "fine": slab(cells=(64, 8)),
    "triangles of degree 1": slab(cell="triangle", degree=1, cells=(32, 4)),
    "little friction": slab(coefficient=1e-4),
    "much friction": slab(coefficient=50.0),
    "varying pressure": slab(pressure=Profile("x", (0, 8), (30, 300))),
}


@pytest.mark.parametrize("name", AUTOMATIC)
def test_automatic_parameter_has_little_bias(name):
    """A tenfold reduction changes force and peak traction by less than .1 %."""
    scene = AUTOMATIC[name]
    automatic = run(scene, COMM)
    used = automatic.contacts[0]["parameters"]["regularisation_parameter"]
    contact = dataclasses.replace(scene.contact[0], regularisation_parameter=used / 10)
    reduced = run(dataclasses.replace(scene, contact=(contact,)), COMM)
    force = [r.quantities["friction_force"][0] for r in (automatic, reduced)]
    peak = [np.abs(r.points.friction_traction).max() for r in (automatic, reduced)]
    assert force[0] == pytest.approx(force[1], rel=1e-3)
    assert peak[0] == pytest.approx(peak[1], rel=1e-3)
    assert reduced.contacts[0]["parameters"]["regularisation_parameter"] == used / 10


@pytest.mark.parametrize("height", [1e-2, 1e-4])
def test_automatic_parameter_on_flat_cells(height):
    """A layer far thinner than its facets are long is stiff: ε has to follow its height."""
    young, poisson, pressure, coefficient = 1000.0, 0.25, 20.0, 0.4
    threshold = coefficient * pressure * height / (young / 2.5)
    scene = Scene(
        kinematics="plane strain",
        material=Material(young, poisson),
        support=(Support("body", {"y": 0}), Support("y0", {"x": 0.9 * threshold})),
        contact=(Contact("y1", pressure=pressure, friction_coefficient=coefficient),),
    )
    result = run(scene, COMM, box_body((4, 2), (4, height)))
    # stuck: all of the shear strain's force arrives
    force = result.quantities["friction_force"][0]
    assert force == pytest.approx(-0.9 * coefficient * pressure * 4, rel=1e-3)


@pytest.mark.parametrize("epsilon", [1e-3, 1e-6, 1e-9, 1e-12])
def test_newton_from_the_adhesive_start_does_not_mind_small_parameters(epsilon):
    result = run(slab(600, cells=(64, 8), epsilon=epsilon), COMM)
    assert result.passed
    assert result.steps[0]["newton_iterations"] <= 15
