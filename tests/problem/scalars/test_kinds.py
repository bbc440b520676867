"""A scalar unknown that a file registers is solved for by every system, as the program's own."""

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Obstacle, Run, Scene, Support
from tests.problem.scalars import springs
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
MODULUS, PENALTY, DEPTH, HEIGHT = 1000.0, 1e-6, 0.01, 2.0
# A block between two plates, in uniaxial stress.
BLOCK = Scene(
    kinematics="3D",
    material=Material(MODULUS, 0.0),
    discretisation=Discretisation(1),
    support=(Support("z0", {"z": 0}),),
    symmetry=("x0", "y0"),
    contact=(
        Contact(
            "z1",
            friction_coefficient=0.0,
            penalty_parameter=PENALTY,
            obstacle=Obstacle(shape="plane", position=(0, 0, HEIGHT), indentation=DEPTH),
        ),
    ),
)


@pytest.fixture(params=springs.KINDS)
def kind(request):
    springs.register(springs.KINDS[request.param])
    yield request.param
    springs.unregister(springs.KINDS[request.param])


@pytest.mark.parametrize("solver", ["full", "condensed", "iterative"])
def test_a_spring_takes_its_part_of_the_way(kind, solver):
    made = Run(with_solver(BLOCK, solver=solver), COMM, box_body((2, 2, 4), (1, 1, HEIGHT)))
    found = made.solve()
    assert found.passed, found.verdict
    assert found.model["scalar_unknowns"] == [f"{kind} at z1"]
    force = DEPTH / (1 / springs.STIFFNESS + HEIGHT / MODULUS + PENALTY)
    assert found.quantities["pressure_integral"] == pytest.approx(force, rel=1e-8)
    (scalar,) = made.end.last.scalars
    way = force / springs.STIFFNESS
    assert scalar == pytest.approx(DEPTH - way if kind == "seat" else way, rel=1e-8)
