"""Masses of bodies that touch: none across contacts, and nothing lost."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Motion, Obstacle, Scene
from fenics_contact.common.parallel import total
from fenics_contact.problem.problem import Problem
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
CELLS = {
    "plane strain": CellType.triangle,
    "axisymmetric": CellType.quadrilateral,
    "3D": CellType.tetrahedron,
}


def pressed(kinematics: str, degree: int, normal: tuple[float, ...]) -> Scene:
    """A box with ρ = 3 whose lower side an obstacle may press."""
    side = "z0" if kinematics == "3D" else "y0"
    floor = Obstacle("plane", position=(0.0,) * len(normal), normal=normal)
    return Scene(
        kinematics=kinematics,
        material=Material(1000.0, 0.3, density=3.0),
        discretisation=Discretisation(degree),
        contact=(Contact(side, obstacle=floor),),
        motion=Motion(step=0.1, end=1.0),
    )


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kinematics", list(CELLS))
def test_contact_nodes_have_no_mass_across_and_the_whole_is_kept(kinematics, degree):
    dimension = 3 if kinematics == "3D" else 2
    up = np.eye(dimension)[-1]
    body = box_body((3, 3, 3)[:dimension], (2.0, 1.0, 0.5)[:dimension], CELLS[kinematics])
    problem = Problem.on_mesh(pressed(kinematics, degree, tuple(up)), body)
    spaces, mass = problem.spaces, problem.inertia.masses.blocks
    own = slice(spaces.owned_nodes)
    volume = {"plane strain": 2.0, "axisymmetric": np.pi * 4.0, "3D": 1.0}[kinematics]
    whole = total(COMM, mass[own].sum(axis=0))
    assert whole == pytest.approx(3.0 * volume * np.eye(dimension), rel=1e-12, abs=1e-12)
    for contact in problem.contacts:
        across = np.einsum("i,nij,j->n", up, mass[contact.nodes], up)
        assert np.abs(across).max(initial=0.0) < 1e-14
        along = mass[contact.nodes, 0, 0]
        assert (along > 0).all()


def test_cells_that_touch_with_all_nodes_have_none_to_take_their_mass():
    scene = pressed("plane strain", 1, (0.0, 1.0))
    top = Contact("y1", obstacle=Obstacle("plane", position=(0.0, 1.0), normal=(0.0, -1.0)))
    both = dataclasses.replace(scene, contact=(*scene.contact, top))
    body = box_body((3, 1), (2.0, 1.0), CellType.quadrilateral)
    with refused("no_node_takes_the_mass"):
        Problem.on_mesh(both, body)
