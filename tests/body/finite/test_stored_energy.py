"""Stored energies: derivatives by Taylor's test, Hooke's law in small strains, no work by turns."""

import numpy as np
import pytest
import ufl

from fenics_contact import Material, Scene, Support
from fenics_contact.body.description import BodyDescription
from fenics_contact.body.elasticity import Isotropic
from fenics_contact.body.finite.stored_energy import ENERGIES, stored_energy
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.scene.laws import energies
from fenics_contact.solve.systems.rank_stiffness import LocalStiffness
from fenics_contact.verification.finite.rubber import rubber as material_of
from tests.scenes import box_body

E, NU = 1.0, 0.3
LAWS = energies.names()


@pytest.fixture(scope="module", params=LAWS)
def rubber(request):
    return discrete(request.param)


def discrete(law):
    finite = {} if law is None else {"strains": "finite"}
    scene = Scene(
        kinematics="plane strain",
        material=Material(1.0, NU) if law is None else material_of(law),
        support=(Support("y0", {"x": 0, "y": 0}),),
        **finite,
    )
    return DiscreteBody(BodyDescription.of(scene), box_body((2, 1)))


def some_fields(body):
    """A displacement with strains of some ten per cent, and another one."""
    x, y, _ = body.spaces.coordinates.T
    return (
        np.stack([0.3 * np.sin(x + y), 0.2 * x * y - 0.1 * y], axis=1),
        np.stack([np.cos(2 * y), np.sin(3 * x) - x], axis=1),
    )


def orders(errors):
    return np.log2(np.array(errors[:-1]) / errors[1:])


def test_every_name_of_a_scene_has_its_energy():
    assert set(ENERGIES) == set(LAWS) == set(energies.FORMULAS)


def test_forces_are_slopes_of_the_energy(rubber):
    u, v = some_fields(rubber)
    elastic, own = rubber.elastic, slice(rubber.spaces.owned_nodes)
    comm = rubber.spaces.comm
    slope = comm.allreduce(float(np.sum((elastic.forces_at(u) * v)[own])))
    energy = elastic.energy_at(u)
    errors = [abs(elastic.energy_at(u + h * v) - energy - h * slope) for h in (0.02, 0.01, 0.005)]
    assert np.all(np.abs(orders(errors) - 2) < 0.1)


def test_the_stiffness_is_the_slope_of_forces(rubber):
    u, v = some_fields(rubber)
    elastic, own = rubber.elastic, slice(rubber.spaces.owned_nodes)
    before = elastic.forces_at(u)
    stiffness = LocalStiffness(rubber)
    change = stiffness.forces(stiffness.at_unknowns(v))

    def missed(h):
        left = (elastic.forces_at(u + h * v) - before - h * change)[own]
        return np.sqrt(rubber.spaces.comm.allreduce(float(np.sum(left**2))))

    assert np.all(np.abs(orders([missed(h) for h in (0.02, 0.01, 0.005)]) - 2) < 0.1)


def test_small_strains_have_hookes_law(rubber):
    rubber.displacement.x.array[:] = 0.0
    _, v = some_fields(rubber)
    finite, linear = LocalStiffness(rubber), LocalStiffness(discrete(None))
    found, expected = (one.forces(one.at_unknowns(v)) for one in (finite, linear))
    assert np.allclose(found, expected, atol=1e-12)


def test_a_turn_by_a_right_angle_does_no_work(rubber):
    x, y, _ = rubber.spaces.coordinates.T
    turned = np.stack([-y - x, x - y], axis=1)
    assert abs(rubber.elastic.energy_at(turned)) < 1e-13
    assert np.abs(rubber.elastic.forces_at(turned)).max() < 1e-13
    found = rubber.elastic.stretches_at(turned)
    assert np.allclose([found.volume_ratio, found.most, found.least], 1.0)


def test_cells_that_are_not_a_number_count_as_turned_inside_out(rubber):
    u, _ = some_fields(rubber)
    u[0] = np.nan
    assert rubber.elastic.stretches_at(u).volume_ratio <= 0


@pytest.mark.parametrize("stretch", [1.0, 1.0 + 1e-9, 1.01, 1.10, 1.1055, 1.11, 2.0])
def test_henckys_energy_is_that_of_logarithms_also_at_equal_stretches(stretch):
    """Its series and its formula meet where the stretches are as 1 to 1.1055."""
    gradient = ufl.as_matrix([[stretch, 0, 0], [0, 1 / stretch, 0], [0, 0, 1]])
    energy = stored_energy(energies.HENCKY, gradient, Isotropic(E, NU), {})
    expected = E / (2 * (1 + NU)) * 2 * np.log(stretch) ** 2
    assert abs(float(energy) - expected) <= 1e-14 + 1e-13 * expected
