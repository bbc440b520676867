"""Density and masses: those of bodies whose volume and density are known, for every kinematics."""

import dataclasses

import numpy as np
import pytest
from dolfinx.fem import Function
from dolfinx.fem.petsc import assemble_matrix
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import Discretisation, Material, Scene
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.mass import Mass
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import total
from tests.body.test_materials import bimaterial
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
CELLS = {
    "plane strain": CellType.quadrilateral,
    "plane stress": CellType.triangle,
    "axisymmetric": CellType.quadrilateral,
    "3D": CellType.tetrahedron,
}
SIZE = (2.0, 1.0, 0.5)


def spaces_of(kinematics, degree, **more):
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000.0, 0.3),
        discretisation=Discretisation(degree),
        **more,
    )
    dimension = 3 if kinematics == "3D" else 2
    body = box_body((3, 2, 2)[:dimension], SIZE[:dimension], CELLS[kinematics])
    return Spaces(BodyDescription.of(scene), body)


def work(mass, spaces, u, v):
    """u · M v of two polynomials that the space has."""
    matrix = assemble_matrix(mass.consistent)
    matrix.assemble()
    vectors = matrix.createVecs()  # of its communicator: one of a function may be gone on one rank
    for vector, values in zip(vectors, (u, v), strict=True):
        function = Function(spaces.displacement_space)
        function.interpolate(values)
        vector.array = function.x.array[: vector.local_size]
    left, right = vectors
    return left.dot(matrix * right)


def lumped_sum(mass, spaces, values):
    """Σ m f over the nodes, each once."""
    own = slice(spaces.owned_nodes)
    masses = mass.lumped()
    assert masses.min() > 0
    return total(COMM, masses[own] @ values(spaces.coordinates[own]))


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("kinematics", list(CELLS))
def test_mass_and_moment_of_inertia_of_a_box(kinematics, degree):
    """∫ ρ and ∫ ρ x² with ρ = 3; of a full revolution with 2πr, and with a thickness of .5."""
    more = {"thickness": 0.5} if kinematics == "plane stress" else {}
    spaces = spaces_of(kinematics, degree, **more)
    mass = Mass((Material(1.0, 0.0, density=3.0),), spaces)
    a, b, c = SIZE
    across = {"plane strain": b, "plane stress": 0.5 * b, "3D": b * c, "axisymmetric": b}
    exact, second = 3.0 * a * across[kinematics], 3.0 * a**3 / 3 * across[kinematics]
    if kinematics == "axisymmetric":
        exact, second = 3.0 * np.pi * a**2 * b, 3.0 * 2 * np.pi * a**4 / 4 * b

    def along(x):
        return np.stack([np.ones(x.shape[1])] + [np.zeros(x.shape[1])] * (spaces.components - 1))

    def linear(x):
        return x[0] * along(x)

    assert work(mass, spaces, along, along) == pytest.approx(exact, rel=1e-12)
    assert work(mass, spaces, linear, linear) == pytest.approx(second, rel=1e-12)
    assert lumped_sum(mass, spaces, lambda x: np.ones(len(x))) == pytest.approx(exact, rel=1e-12)


def test_lumping_of_squares_of_degree_2_is_simpsons_rule():
    """It integrates cubic functions exactly: ∫ ρ x³."""
    spaces = spaces_of("plane strain", 2)
    mass = Mass((Material(1.0, 0.0, density=3.0),), spaces)
    found = lumped_sum(mass, spaces, lambda x: x[:, 0] ** 3)
    assert found == pytest.approx(3.0 * 2.0**4 / 4, rel=1e-12)


def test_density_may_vary_in_space():
    """ρ = 1 + x: ∫ ρ x² = a³/3 + a⁴/4, of height 1."""
    spaces = spaces_of("plane strain", 1)
    mass = Mass((Material(1.0, 0.0, density=lambda x: 1 + x[0]),), spaces)

    def linear(x):
        return np.stack([x[0], 0 * x[0]])

    assert work(mass, spaces, linear, linear) == pytest.approx(8 / 3 + 16 / 4, rel=1e-12)
    assert lumped_sum(mass, spaces, lambda x: np.ones(len(x))) == pytest.approx(4.0, rel=1e-12)


def test_each_material_has_its_own():
    body = bimaterial()
    halves = (Material(1.0, 0.0, on="left", density=2.0), Material(1.0, 0.0, on="right"))
    spaces = Spaces(BodyDescription.of(Scene(kinematics="plane strain", material=halves)), body)
    with refused("second_density_is_missing"):
        Mass(halves, spaces)
    both = (halves[0], dataclasses.replace(halves[1], density=5.0))
    found = lumped_sum(Mass(both, spaces), spaces, lambda x: np.ones(len(x)))
    assert found == pytest.approx(2.0 + 5.0, rel=1e-12)


def test_densities_must_be_greater_than_0():
    with refused("density_is_zero", SceneError):
        Material(1.0, 0.0, density=0)
    spaces = spaces_of("plane strain", 1)
    with refused("density_is_negative_somewhere"):
        Mass((Material(1.0, 0.0, density=lambda x: x[0] - 1),), spaces)


def test_a_density_is_no_part_of_what_a_stiffness_is_of():
    """A body is kept where only it changes."""
    light, heavy = (
        BodyDescription.of(
            Scene(kinematics="plane strain", material=Material(1.0, 0.0, density=rho))
        )
        for rho in (None, 3.0)
    )
    assert not light.differences(heavy)
