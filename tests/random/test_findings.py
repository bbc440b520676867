"""What scenes at random have shown, each as a small scene of its own."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.run_checks import run_checks
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
PRESSED = Path(time=(0, 0.5, 1), factor=(0, 1, 1))
DRAGGED = Path(time=(0, 0.5, 1), factor=(0, 0, 1))


def arched(cells, height=0.05, **keys):
    """A unit square or cube whose top is a parabola, highest in the middle."""
    body = box_body(cells, (1,) * len(cells), **keys)
    x = body.mesh.geometry.x
    last = len(cells) - 1
    share = np.prod(4 * x[:, :last] * (1 - x[:, :last]), axis=1)
    x[:, last] += height * share * x[:, last]
    return body


def in_plane(contact, steps=1, **keys):
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(keys.pop("degree", 1)),
        support=keys.pop("support", (Support("y0", {"x": 0, "y": 0}),)),
        contact=(contact,),
        steps=Steps(steps),
        **keys,
    )


def punch_in_space(**keys):
    """A flat punch, pressed down and dragged, on tetrahedra of degree 2."""
    punch = Obstacle(
        "flat punch", 0.4, position=(0.5, 0.5, 0.5), indentation=0.01,
        displacement=(0.004, 0.002, 0), path=PRESSED, displacement_path=DRAGGED,
    )  # fmt: skip
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=punch, friction_coefficient=0.3, law="incremental"),),
        steps=Steps(4),
        **keys,
    )


@pytest.mark.parametrize("cells", [(9, 6), (8, 6)])
def test_a_force_finds_a_surface_that_is_curved_and_rough(cells):
    """No point of it is quite square to the force; friction must not seem to hold that back."""
    obstacle = Obstacle("parabola", 4, position=(0.5, 1.05), normal=(0, -1), force=5)
    contact = Contact("y1", obstacle=obstacle, friction_coefficient=0.3)
    result = run(in_plane(contact), COMM, arched(cells))
    assert result.passed, result.verdict
    assert result.quantities["reaction"][1] == pytest.approx(5, rel=1e-8)


def test_an_overlap_at_the_start_takes_work():
    """Of an elastic body, half the force times the way, overlap included."""
    obstacle = Obstacle(gap=-0.01, indentation=0.02, direction=(0, -1))
    support = (Support("y0", {"y": 0}), Support("x0", {"x": 0}))
    contact = Contact("y1", obstacle=obstacle)
    result = run(in_plane(contact, steps=3, support=support), COMM, box_body((4, 4), (1, 1)))
    assert result.passed, result.verdict
    modulus = 1000 / (1 - 0.3**2)
    assert result.quantities["external_work"] == pytest.approx(0.5 * modulus * 0.03**2, rel=1e-3)
    assert abs(result.quantities["energy_defect"]) < 1e-9 * result.quantities["external_work"]


@pytest.mark.parametrize("steps", [4, 16])
def test_points_that_the_edge_of_a_punch_passes_leave_work_open(steps):
    """What they lose at once is lost, however short the steps."""
    punch = Obstacle(
        "flat punch", 0.36, position=(0.5, 1), indentation=0.02, displacement=(0.05, 0),
        path=PRESSED, displacement_path=DRAGGED,
    )  # fmt: skip
    contact = Contact("y1", obstacle=punch, friction_coefficient=5.0, law="incremental")
    result = run(in_plane(contact, steps), COMM, box_body((17, 8), (1, 1)))
    assert result.passed, result.verdict
    assert result.checks["energy_balance"].value > 0.02


def test_friction_between_nodes_dissipates_by_its_forces():
    """And a slip the other way round fails."""
    body = box_body((3, 3, 2), (1, 1, 0.5), cell=CellType.tetrahedron)
    prepared = Run(punch_in_space(), COMM, body)
    result = prepared.solve()
    assert result.passed, result.verdict
    assert "dissipation" in result.checks
    solution = prepared.solution
    turned = [dataclasses.replace(s, slip=-s.slip) for s in solution.states]
    forces = BulkForces(prepared.problem, dataclasses.replace(solution, states=turned))
    contact = prepared.problem.contacts[0]
    contact.friction.accept(-contact.friction.reference)
    checks = run_checks(forces)
    assert not checks["dissipation"].passed


def test_curved_facets_with_points_between_nodes():
    """There pressures have parts along the nodes' surface, and friction across it."""
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("x1", traction=(3, 2, 0)),),
        contact=(Contact("z1", pressure=10, friction_coefficient=0.3),),
    )
    body = arched((3, 3, 2), cell=CellType.tetrahedron)
    prepared = Run(scene, COMM, body)
    assert prepared.solve().passed
    solution = prepared.solution
    less = [0.99 * force for force in solution.friction_force]
    forces = BulkForces(prepared.problem, dataclasses.replace(solution, friction_force=less))
    checks = run_checks(forces)
    assert not checks["friction_law"].passed


def test_what_is_loose_in_the_iterative_solver_ends_in_words():
    """The paper's passes hold pressures, and then nothing holds an obstacle under a force."""
    plane = Obstacle("plane", position=(0, 0, 1), force=50, displacement=(0.01, 0, 0))
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=plane, friction_coefficient=0.5),),
        solver=SolverSettings(solver="iterative", strategy="campos"),
    )
    result = run(scene, COMM, box_body((4, 4, 4), (1, 1, 1)))
    assert result.exit_code == 3
    assert "singular" in result.verdict
