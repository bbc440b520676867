"""What ranks get to know of each other grows with surfaces, not with bodies."""

import ast
import dataclasses

import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Material,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.common import parallel
from fenics_contact.simulation.output import run_folder
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import ROOT, box_body
from tests.traffic import counted

COMM = MPI.COMM_WORLD
WIDE = 6  # cells along each side of the contact
CLAMPED = {"x": 0, "y": 0, "z": 0}
ON_OBSTACLE = Scene(
    kinematics="3D",
    material=Material(1000, 0.3),
    discretisation=Discretisation(1),
    support=(Support("z1", CLAMPED),),
    contact=(Contact("z0", obstacle=Obstacle(indentation=0.01), friction_coefficient=0.3),),
    solver=SolverSettings(solver="iterative"),
)
PAIR = dataclasses.replace(
    ON_OBSTACLE,
    support=(Support("lower.z0", CLAMPED), Support("upper.z1", {"x": 0.004, "y": 0.0, "z": -0.02})),
    contact=(Contact("upper.z0", against="lower.z1", friction_coefficient=0.3),),
)


def cube(depth):
    return box_body((WIDE, WIDE, depth), cell=CellType.hexahedron)


def cubes(depth):
    lower = Box("lower", (0, 0, -1), (1, 1, 0), (WIDE + 1, WIDE + 1, depth))
    upper = Box("upper", (0, 0, 0), (1, 1, 1), (WIDE, WIDE, depth))
    return boxes((lower, upper), "hexahedron")


def gathered_in_a_run(scene, body, folder):
    """The most bytes that a gathering left on a rank, those of a field, and all by caller."""
    run = Run(scene, COMM, body)
    with counted() as traffic:
        run_folder.solve_and_write(run, folder)
    nodes = run.problem.spaces.displacement_space.dofmap.index_map.size_global
    return COMM.allreduce(traffic.peak, op=MPI.MAX), 24 * nodes, traffic.largest


@pytest.mark.parametrize("name", ["obstacle", "pair"])
def test_gatherings_grow_with_the_contact_and_not_with_the_bodies(name, folder):
    """Bodies of six times the depth on the same contact surface; the files included."""
    scene, make = {"obstacle": (ON_OBSTACLE, cube), "pair": (PAIR, cubes)}[name]
    shallow, _, _ = gathered_in_a_run(scene, make(4), folder / "shallow")
    deep, field, largest = gathered_in_a_run(scene, make(24), folder / "deep")
    assert deep < 1.1 * shallow, dict(largest)
    assert deep < field / 2, dict(largest)


def test_what_grows_with_a_body_would_be_noticed():
    """The same bytes with a field of all nodes gathered."""
    peaks = []
    for depth in (4, 24):
        body = cube(depth)
        run = Run(ON_OBSTACLE, COMM, body)
        with counted() as traffic:
            parallel.gather_rows(COMM, run.problem.load)
        peaks.append(traffic.peak)
    assert peaks[1] > 3 * peaks[0]


@pytest.mark.serial
def test_all_gatherings_go_through_one_module():
    """Else they would not be counted."""
    asked = {"gather", "allgather", "bcast", "scatter", "alltoall", "recv", "sendrecv"}
    asked |= {name.capitalize() for name in asked} | {"Allgatherv", "Gatherv", "Alltoallv"}
    found = []
    for path in sorted((ROOT / "fenics_contact").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if not any(name in text for name in asked):
            continue
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Attribute) and node.attr in asked:
                of = node.value
                name = of.attr if isinstance(of, ast.Attribute) else getattr(of, "id", "")
                if name.strip("_") == "comm" or name == "COMM_WORLD":
                    found.append(path.name)
    assert set(found) == {"parallel.py"}
