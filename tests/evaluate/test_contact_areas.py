"""Areas of the pieces of a surface that an edge passes through."""

import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Contact, Discretisation, Material, Obstacle, Scene, Support
from fenics_contact.body.description import BodyDescription
from fenics_contact.evaluate.contact_areas import cut_areas
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_stepper import stepping
from tests.scenes import box_body


@pytest.mark.parametrize(
    ("kind", "share"), [(CellType.hexahedron, 0.75), (CellType.tetrahedron, None)]
)
def test_pieces_that_an_edge_passes_through_count_once(kind, share, comm=MPI.COMM_WORLD):
    """A tip over the middle of four facets: of their triangles, cut both ways, 3 of 4 do so."""
    tip = Obstacle("paraboloid", radius=0.01, position=(1, 1, 1), indentation=0.001)
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        contact=(Contact("z1", obstacle=tip, friction_coefficient=0.0),),
    )
    problem = Problem(
        scene, DiscreteBody(BodyDescription.of(scene), box_body((2, 2, 1), (2, 2, 1), kind, comm))
    )
    with stepping(problem) as load_steps:
        (state,) = load_steps.solve().states
        (touching, _) = cut_areas(problem.contacts[0], state)
    if share is None:
        assert 2 <= touching <= 4  # as its diagonals run
    else:
        assert touching == pytest.approx(share * 4)
