"""What is done with gives back MPI's communicators, of which MPICH has some 2,000."""

import gc

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Obstacle, Scene, Support
from fenics_contact.problem.problem import Problem
from fenics_contact.verification.boxes import Box, boxes
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
HELD = dict.fromkeys("xyz", 0)


def against_a_shape():
    """UFL takes derivatives of the gap."""
    gap = Obstacle(gap=lambda x: 0.1 * x[0])
    contact = Contact("z1", contact="unilateral", obstacle=gap)
    scene = Scene("3D", Material(100, 0.3), support=(Support("z0", HELD),), contact=(contact,))
    Problem.on_mesh(scene, box_body((2, 2, 2)))


def against_a_body():
    """The mortar projection is in matrices of PETSc."""
    lower = Box("lower", (0, 0, -1), (1, 1, 0), (2, 2, 2))
    upper = Box("upper", (0, 0, 0), (1, 1, 1), (3, 3, 2))
    scene = Scene(
        "3D",
        Material(100, 0.3),
        support=(Support("lower.z0", HELD), Support("upper.z1", HELD)),
        contact=(Contact("upper.z0", against="lower.z1"),),
    )
    Problem.on_mesh(scene, boxes((lower, upper), "hexahedron"))


def free_communicators():
    gc.collect()
    found = []
    try:
        while True:
            found.append(MPI.COMM_SELF.Dup())
    except MPI.Exception:
        count = len(found)
    for one in found:
        one.Free()
    return count


@pytest.mark.skipif("MPICH" not in MPI.Get_library_version(), reason="others have many more")
@pytest.mark.parametrize("make", [against_a_shape, against_a_body])
def test_problems_that_are_dropped_keep_none(make):
    make()
    make()
    free = free_communicators()
    for _ in range(3):
        make()
    assert COMM.allgather(free_communicators()) == COMM.allgather(free)
