"""Example 1 of the paper: the slab with prescribed contact pressure.

Reference numbers: the specification of the paper's example (a prototype of its own,
checked against the paper). The signs of the resultants are those of equilibrium: the
load of −300 along x is carried by friction and by the left support, both along +x.
"""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Material, run
from tests.scenes import slab

COMM = MPI.COMM_WORLD


def stick_end(result):
    points = result.points
    return points.coordinates[points.status == "STICK", 0].max()


@pytest.mark.parametrize(
    ("end_load", "end"),
    [(100, 8.0), (200, 7.75), (300, 6.25), (400, 5.25), (600, 3.0), (700, 1.75)],
)
def test_last_sticking_point_of_the_paper_mesh(end_load, end):
    """16 nine-node elements: the table of end loads."""
    result = run(slab(end_load), COMM)
    assert result.passed
    assert stick_end(result) == pytest.approx(end, abs=1e-6)


def test_resultants_at_end_load_300():
    result = run(slab(300), COMM)
    assert result.quantities["friction_force"] == pytest.approx([209.98, 0], abs=0.1)
    reactions = {support["on"]: support["reaction"] for support in result.supports}
    assert reactions["left"] == pytest.approx([90.02, 0], abs=0.1)
    assert reactions["bottom"] == pytest.approx([0, 2400], abs=1e-6)
    assert result.quantities["normal_force"] == pytest.approx(2400)
    total = np.add(result.quantities["friction_force"], result.quantities["reaction"])
    assert total == pytest.approx([300, 2400], abs=1e-6)


def test_left_reaction_at_end_load_600():
    result = run(slab(600), COMM)
    assert result.quantities["reaction"][0] == pytest.approx(92.8, abs=0.1)


def test_stick_zone_on_a_fine_mesh():
    result = run(slab(300, cells=(128, 16)), COMM)
    assert result.passed
    assert stick_end(result) == pytest.approx(6.41, abs=0.07)
    assert result.quantities["friction_force"][0] == pytest.approx(209.98, abs=0.1)


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("order", [1, 2])
def test_every_element_agrees_on_the_resultant(cell, degree, order):
    result = run(slab(300, cells=(64, 8), cell=cell, degree=degree, order=order), COMM)
    assert result.passed
    assert result.quantities["friction_force"][0] == pytest.approx(209.98, abs=0.1)
    assert stick_end(result) == pytest.approx(6.41, abs=0.13)


def test_friction_works_as_much_as_the_loads_lose():
    """Virtual work with u itself: f(u) + reactions = a(u, u) + ∫ σ_T·u_T."""
    quantities = run(slab(600), COMM).quantities
    assert quantities["external_work"] == pytest.approx(
        2 * quantities["strain_energy"] + quantities["friction_work"], rel=1e-9
    )


def test_mirrored_load_mirrors_the_answer():
    """Pulling instead of pushing, without the Poisson push of the pressure (ν = 0)."""
    results = []
    for sign in (1, -1):
        scene = slab(sign * 300, coefficient=0.3)
        scene = dataclasses.replace(scene, material=Material(1000, 0.0))
        results.append(run(scene, COMM))
    pushed, pulled = results
    assert pushed.points.friction_traction == pytest.approx(
        -pulled.points.friction_traction, abs=1e-6
    )
    assert (pushed.points.status == pulled.points.status).all()
