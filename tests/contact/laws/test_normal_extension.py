"""A law across a contact that a file registers has all that the program's own have."""

import json

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import Motion, Path, Run, Steps, Study, run
from fenics_contact.common.errors import SceneError
from fenics_contact.contact.laws import normal
from fenics_contact.scene.reference import render
from fenics_contact.scene.schema import scene_schema
from tests.contact.laws import hardening_springs
from tests.contact.laws import test_normal_taylor as taylor
from tests.contact.laws.hardening_springs import KIND
from tests.contact.laws.test_formula_law import BALL, law
from tests.contact.laws.test_friction_rules import sheared
from tests.contact.laws.test_normal_compliance import block, pressed
from tests.messages import refused
from tests.report.page.pages import page_of
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after

pytestmark = pytest.mark.serial
STIFFNESS, DEPTH = 2e3, 4e-3
TABLE = {"kind": KIND, "stiffness": STIFFNESS, "depth": DEPTH}
BY = tuple(f"contact.0.normal_law.{key}" for key in ("stiffness", "depth"))
COMM = MPI.COMM_WORLD


@pytest.fixture(autouse=True)
def registered():
    hardening_springs.register()
    yield
    hardening_springs.unregister()


def depth_at(pressure, stiffness=STIFFNESS, depth=DEPTH):
    return brentq(lambda d: stiffness * d * (1 + (d / depth) ** 2) - pressure, 0, 1)


def test_a_uniform_pressure_sinks_in_as_its_formula_says():
    found = run(block(normal_law=TABLE), COMM, box_body((4, 4)))
    assert found.passed, found.verdict
    depth = depth_at(10)
    assert -found.points.gap == pytest.approx(depth, rel=1e-8)
    energy = STIFFNESS * depth**2 / 2 * (1 + (depth / DEPTH) ** 2 / 2)
    assert found.quantities["penalty_energy"] == pytest.approx(energy, rel=1e-8)
    assert found.contacts[0].parameters.items() >= {"stiffness": STIFFNESS, "depth": DEPTH}.items()
    assert KIND in page_of(found.as_dict())


def test_it_passes_taylors_test(monkeypatch):
    monkeypatch.setitem(taylor.LAWS, KIND, {"normal_law": TABLE})
    for dimension in (2, 3):
        taylor.test_tractions_are_derivatives_of_the_energy(KIND, dimension)
    taylor.test_tangents_are_derivatives_of_tractions(KIND)
    taylor.test_the_stiffness_is_the_derivative_of_the_pressure_in_the_depth(KIND)
    taylor.test_the_transposed_derivatives(KIND)


def test_depths_have_derivatives_by_its_numbers():
    """Of the indentation of a block under a uniform pressure: of the root of its formula."""
    scene = block(normal_law=TABLE)
    found = Study(scene, body=box_body((4, 4))).derivatives(["penalty_energy"], BY)

    def energy(stiffness, depth):
        root = depth_at(10, stiffness, depth)
        return stiffness * root**2 / 2 * (1 + (root / depth) ** 2 / 2)

    slopes = found["penalty_energy"]
    by_stiffness = (energy(STIFFNESS + 1e-2, DEPTH) - energy(STIFFNESS - 1e-2, DEPTH)) / 2e-2
    by_depth = (energy(STIFFNESS, DEPTH + 1e-8) - energy(STIFFNESS, DEPTH - 1e-8)) / 2e-8
    assert slopes[BY[0]] == pytest.approx(by_stiffness, rel=1e-5)
    assert slopes[BY[1]] == pytest.approx(by_depth, rel=1e-5)


@pytest.mark.errors
def test_a_formula_of_the_same_pressure_has_the_same_answer_and_bars():
    formula = law("k * d * (1 + d^2 / h^2)", k=STIFFNESS, h=DEPTH)
    one, other = (
        run(
            pressed(BALL, {"normal_law": table, "friction_coefficient": 0.3}),
            COMM,
            box_body((8, 4)),
        )
        for table in (TABLE, formula)
    )
    assert one.passed, one.verdict
    for name in ("normal_force", "contact_area", "max_contact_pressure", "strain_energy"):
        assert one.quantities[name] == pytest.approx(other.quantities[name], rel=1e-6), name
        assert one.errors[name]["total"] == pytest.approx(other.errors[name]["total"], rel=1e-3)


def test_runs_go_on_with_it(tmp_path):
    scene = pressed(BALL, {"normal_law": TABLE}, steps=Steps(number=3))
    whole = Run(scene, COMM, box_body((8, 4))).solve()
    stopped_after(scene, box_body((8, 4)), tmp_path, 1)
    found = resumed(scene, box_body((8, 4)), tmp_path)
    force, expected = (one.quantities["strain_energy"] for one in (found, whole))
    assert force == pytest.approx(expected, rel=1e-8) and len(found.steps) == 3


def test_the_documentation_editors_and_messages_have_it():
    assert f'`[contact.normal_law]`, kind = `"{KIND}"`' in render()
    assert KIND in json.dumps(scene_schema())
    with refused("no_normal_law_hard_springs", SceneError):
        block(normal_law={"kind": "hard springs"})
    with refused("depth_is_zero", SceneError):
        block(normal_law=TABLE | {"depth": 0})
    with refused("normal_kind_is_there_already", ValueError):
        normal.register(hardening_springs.Hardening, hardening_springs.HardeningSprings)


def test_a_parameter_that_is_called_like_a_key_of_the_contact_is_another_number():
    formula = law("k * d * (1 + d^2 / interference^2)", k=STIFFNESS, interference=DEPTH)
    friction = {"kind": "formula", "bound": "min(mu * p, force)", "parameters": {"force": 9.0}}
    keys = {"normal_law": formula, "friction_law": friction, "friction_coefficient": 0.3}
    (contact,) = Run(block(**keys), COMM, box_body((4, 4))).problem.contacts
    assert contact.normal.field_slopes("interference", 1.0) == {}
    assert contact.friction.field_slopes("force", 1.0) == {}
    ((name, slope),) = contact.friction.field_slopes("friction_law.parameters.force", 1.0).items()
    assert name == "force" and np.all(slope == 1)


def test_a_law_says_whether_bodies_in_motion_may_have_it(monkeypatch):
    moving = {"motion": Motion(step=0.1, end=1)}
    with refused("motion_of_formula", SceneError):
        sheared({"normal_law": TABLE}, density=1.0, path=Path((0.0,), (1.0,)), **moving)
    monkeypatch.setattr(hardening_springs.HardeningSprings, "fits_motion", True)
    scene = sheared({"normal_law": TABLE}, density=1.0, path=Path((0.0,), (1.0,)), **moving)
    found = run(scene, COMM, box_body((4, 2)))
    assert found.quantities["max_penetration"] > 0
    formula = sheared(
        {"normal_law": {"kind": "normal compliance", "coefficient": STIFFNESS, "exponent": 1}},
        density=1.0,
        path=Path((0.0,), (1.0,)),
        **moving,
    )
    softer = run(formula, COMM, box_body((4, 2)))
    assert softer.quantities["max_penetration"] > found.quantities["max_penetration"]
