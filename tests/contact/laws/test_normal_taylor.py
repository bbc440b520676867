"""Taylor's test of each law across a contact: all its derivatives, by central differences.

The difference quotients are of the law's own energies and pressures: a derivative with a factor, a
sign or a term missing is far outside of the tolerances.
"""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Scene, Study, UserContactEnergy, allow_laws
from fenics_contact.contact.laws.normal.spring import positive
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from tests.contact.laws.test_by_points import both, displaced, matrix_of, use_friction
from tests.contact.laws.test_friction_rules import sheared
from tests.contact.laws.test_friction_taylor import along, quotient, random_like
from tests.scenes import box_body

COMM = MPI.COMM_WORLD


class Leaning(UserContactEnergy):
    """Springs that are stiffer where the surfaces have moved: pressure and shear are coupled."""

    @staticmethod
    def density(depth, jump, k, a):
        return 0.5 * k * positive(depth) ** 2 * (1 + a * sum(part**2 for part in jump))


LAWS = {
    "unilateral": {"contact": "unilateral", "penalty_parameter": 1e-3},
    "bonded": {"contact": "bonded", "penalty_parameter": 1e-3},
    "winkler": {"foundation_stiffness": lambda x: 1e3 * (1 + x[0])},
    "compliance": {
        "normal_law": {"kind": "normal compliance", "coefficient": 4e3, "exponent": 1.5}
    },
    "formula": {
        "normal_law": {
            "kind": "formula",
            "pressure": "p0 * (exp(d / h) - 1)",
            "parameters": {"p0": 2.0, "h": 0.02},
        }
    },
    "user's": {"normal_law": {"kind": f"{__name__}:Leaning", "parameters": {"k": 1e3, "a": 50.0}}},
}
every_law = pytest.mark.parametrize("name", LAWS)


def pressed(name, dimension=3):
    """A contact, most of whose points touch, at a jump of its own at each."""
    allow_laws(__name__)
    scene = Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        contact=(Contact("xyz"[dimension - 1] + "0", **LAWS[name]),),
    )
    (contact,) = Problem.on_mesh(scene, box_body((3, 2, 2)[:dimension])).contacts
    displaced(contact, np.random.default_rng(5))
    closed = contact.normal.is_closed(contact.pressure())
    assert COMM.allreduce(int(closed.sum())) > 3
    return contact


def jump_of(contact):
    return contact.kinematics.jump_at_points().copy()


def close(found, expected):
    scale = np.abs(expected).max(initial=1e-300)
    assert scale > 0.1
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6 * scale)


@every_law
@pytest.mark.parametrize("dimension", [2, 3])
def test_tractions_are_derivatives_of_the_energy(name, dimension):
    contact = pressed(name, dimension)
    law, jump = contact.normal, jump_of(contact)
    way = random_like(jump, 1)
    traction = law.traction(jump) - law.pressure(jump)[:, None] * contact.trace.normals
    expected = quotient(lambda step: law.stored(jump + step * way))
    close(-np.einsum("ij,ij->i", traction, way), expected)


@every_law
def test_tangents_are_derivatives_of_tractions(name):
    contact = pressed(name)
    law, jump, kinematics = contact.normal, jump_of(contact), contact.kinematics
    begin = (
        kinematics.jump.x.array.reshape(-1, kinematics.direction.size) + kinematics.motion_at_nodes
    )
    place = contact.trace.surface.of_owners(random_like(begin, 3))
    way = contact.trace.at_points(place)

    def traction(step):
        kinematics.move(begin + step * place)
        return law.at_points()

    expected = quotient(traction)
    close(-np.einsum("pij,pj->pi", law.tangent_at_points(), way), expected)
    expected = quotient(lambda step: law.pressure(jump + step * way))
    close(np.einsum("ij,ij->i", law.pressure_slope(jump), way), expected)


@every_law
def test_the_stiffness_is_the_derivative_of_the_pressure_in_the_depth(name):
    contact = pressed(name)
    law, normals = contact.normal, contact.trace.normals
    depth = 0.01 + 0.01 * contact.trace.coordinates[:, 0]

    def pressure(step):
        if name == "user's":  # of an energy that depends on the jump, the part without it
            return 1e3 * (depth + step)
        return law.pressure((depth + step)[:, None] * normals)

    expected = quotient(pressure)
    close(law.stiffness(depth), expected)


@pytest.mark.serial
@every_law
def test_the_transposed_derivatives(name):
    """In the jump, in the gap, and in each parameter; those of a softened penalty as well."""
    contact = pressed(name)
    law, jump, kinematics = contact.normal, jump_of(contact), contact.kinematics
    of_slopes, of_energy = random_like(jump, 1), random_like(jump[:, 0], 2)
    by_jump, by_gap = random_like(jump, 3), random_like(jump[:, 0], 4)
    gap = kinematics.gap

    def quantity(jump):
        minus = law.pressure(jump)[:, None] * contact.trace.normals - law.traction(jump)
        return np.sum(of_slopes * minus) + np.sum(of_energy * law.stored(jump))

    def at_gap(step):
        kinematics.set_gap(gap + step * by_gap)
        return quantity(jump)

    def with_another(step, name, values):
        law._fields[name] = values * (1 + step)
        law._known = None
        return quantity(jump)

    for factor in (1.0, 3.0) if law.penalty.exists else (1.0,):
        law.penalty.soften(factor)
        found = law.vjp(jump, of_slopes, of_energy)
        expected = quotient(lambda step: quantity(jump + step * by_jump))
        assert abs(expected) > 0.1
        assert along(found.jump, by_jump) == pytest.approx(expected, rel=1e-6)
        expected = quotient(at_gap)
        assert (name == "bonded") == (expected == 0)
        assert along(found.gap, by_gap) == pytest.approx(expected, rel=1e-6)
        for field, values in dict(law._fields).items():
            expected = quotient(lambda step, of=field, v=values: with_another(step, of, v), 1e-5)
            assert abs(expected) > 1e-4
            assert along(found.fields[field], values) == pytest.approx(expected, rel=1e-6)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("unilateral", ["penalty_parameter"]),
        ("bonded", ["penalty_parameter"]),
        ("compliance", ["normal_law.coefficient"]),
        ("formula", ["normal_law.parameters.p0", "normal_law.parameters.h"]),
        ("user's", ["normal_law.parameters.k", "normal_law.parameters.a"]),
    ],
)
def test_parameters_follow_the_keys_of_the_scene(name, keys):
    contact = pressed(name)
    for key in keys:
        ((field, slopes),) = contact.normal.field_slopes(key, 1.0).items()
        table = LAWS[name].get("normal_law", LAWS[name])
        table = table.get("parameters", table)
        given = table[key.rpartition(".")[2]]
        parameter = contact.normal._fields[field]
        expected = -parameter / given if key == "penalty_parameter" else parameter / given
        assert slopes == pytest.approx(expected, rel=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize("coefficient", [0.0, 0.3])
def test_pressure_and_shear_of_a_law_are_coupled_in_answers(coefficient):
    """Forces of contact, supports and loads balance; derivatives are difference quotients."""
    allow_laws(__name__)
    table = {"kind": f"{__name__}:Leaning", "parameters": {"k": 1e3, "a": 200.0}}
    keys = {"normal_law": table, "friction_coefficient": coefficient}
    scene = sheared(keys, solver={"errors": "none", "tolerance": 1e-12})
    study = Study(scene, body=box_body((6, 3)))
    found = study.solve().quantities
    balance = np.add(found["contact_force"], found["reaction"]) + np.array([3.0, -10.0])
    assert balance == pytest.approx([0, 0], abs=1e-8)
    asked = [f"contact.0.normal_law.parameters.{name}" for name in "ka"]
    asked += ["contact.0.friction_coefficient"] * (coefficient > 0)
    slopes = study.derivatives(["friction_force_x", "strain_energy"], asked)
    for key in asked:
        given = table["parameters"].get(key[-1], coefficient)
        ends = [study.solve({key: given * (1 + step)}).quantities for step in (1e-4, -1e-4)]
        values = np.array([[end["friction_force"][0], end["strain_energy"]] for end in ends])
        of_force, of_energy = (values[0] - values[1]) / (2e-4 * given)
        assert slopes["friction_force_x"][key] == pytest.approx(of_force, rel=1e-4)
        assert slopes["strain_energy"][key] == pytest.approx(of_energy, rel=1e-3)


@pytest.mark.parametrize("dimension", [2, 3])
def test_forms_and_points_couple_friction_to_all_of_the_pressure(dimension):
    """Of an energy that depends on slip, the pressure has a part that does not follow the depth."""
    allow_laws(__name__)
    keys = {"normal_law": LAWS["user's"]["normal_law"], "friction_coefficient": 0.3}
    body = box_body((3, 2, 2)[:dimension])
    (contact,) = Problem.on_mesh(sheared(keys, dimension), body).contacts
    contact.friction.regularisation.set(0.005)
    surface, slip = SurfaceMatrix(contact), displaced(contact, np.random.default_rng(3))
    contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
    matrices = []
    for mode in ("law", "coupled"):
        use_friction(contact, mode, slip)
        expected, found = both(contact, lambda: matrix_of(surface))
        scale = np.abs(expected).max(initial=1e-300)
        assert scale > 1
        assert np.abs(found - expected).max(initial=0) <= 1e-12 * scale
        matrices.append(found)
    assert np.abs(matrices[1] - matrices[0]).max(initial=0) > 0
