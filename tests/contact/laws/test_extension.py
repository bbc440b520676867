"""A friction law that a file registers has all that the program's own have."""

import json

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Run, Study, load_scene, run
from fenics_contact.contact.laws.friction import rules
from fenics_contact.mesh.loading import load_body
from fenics_contact.scene.reference import render
from fenics_contact.scene.schema import scene_schema
from tests.contact.laws import shear_limit
from tests.contact.laws import test_friction_taylor as taylor
from tests.contact.laws.shear_limit import KIND
from tests.messages import refused
from tests.report.page.pages import page_of
from tests.scenes import ROOT
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.simulation.sweeps.inline import inline, rows_of, swept

assert inline  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.errors]
COEFFICIENT, STRENGTH = 0.3, 12.0
TABLE = f'kind = "{KIND}", strength = {STRENGTH}'
FORMULA = f'kind = "formula", bound = "min(mu * p, tau)", parameters = {{ tau = {STRENGTH} }}'
MU, TAU = "contact.0.friction_coefficient", "contact.0.friction_law.strength"
QUIET = '[solver]\nerrors = "none"'
SCENE = """
kinematics = "plane strain"
[mesh]
file = "{mesh}"
parameters = {{ length = 1, height = 1, cells_along = {cells}, cells_across = {cells} }}
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ x = 0, y = 0 }}
[[contact]]
on = "top"
friction_coefficient = {coefficient}
friction_law = {{ {table} }}
law = "{law}"
[contact.obstacle]
shape = "parabola"
radius = 2
position = [0.5, 1.0]
indentation = 0.02
displacement = [0.02, 0]
[steps]
number = {steps}
{more}
"""


@pytest.fixture(autouse=True)
def registered():
    shear_limit.register()
    yield
    shear_limit.unregister()


@pytest.fixture
def scene(tmp_path):
    def written(more=QUIET, *, table=TABLE, law="static", cells=16, steps=1):
        path = tmp_path / "rubbed.toml"
        numbers = {"cells": cells, "steps": steps, "coefficient": COEFFICIENT}
        text = SCENE.format(
            mesh=ROOT / "meshes" / "slab.geo", table=table, law=law, more=more, **numbers
        )
        path.write_text(text)
        return path

    return written


@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
@pytest.mark.parametrize("law", ["static", "incremental"])
def test_points_that_slip_carry_the_smaller_of_both(scene, strategy, law):
    asked = f'[solver]\nerrors = "none"\nstrategy = "{strategy}"'
    found = run(load_scene(scene(asked, law=law)))
    assert found.passed, found.verdict
    pressure = found.points.contact_pressure[:]
    bound = np.minimum(COEFFICIENT * pressure, STRENGTH)
    slips = found.points.status == "SLIP"
    assert (bound[slips] < STRENGTH).any() and (bound[slips] == STRENGTH).any()
    traction = np.linalg.norm(found.points.friction_traction, axis=1)
    assert traction[slips] == pytest.approx(bound[slips], rel=1e-6)
    assert (traction <= bound * (1 + 1e-9) + 1e-9).all()
    assert found.contacts[0].parameters["friction_law"] == f"{KIND}: strength 12"


@pytest.mark.parametrize("law", ["static", "incremental"])
def test_it_passes_taylors_test(law, monkeypatch):
    """At pressures below and above those at which the strength is reached."""
    coulomb = taylor.rubbing("coulomb", law).friction.bound
    strength = 1.01 * float(np.median(coulomb[coulomb > 0]))
    table = {"kind": KIND, "strength": strength}
    rule = {**taylor.RULES["coulomb"], "friction_law": table}
    monkeypatch.setitem(taylor.RULES, KIND, rule)
    bound = taylor.rubbing(KIND, law).friction.bound
    assert (bound == strength).sum() > 5 and ((bound > 0) & (bound < strength)).sum() > 5
    for mode in ("law", "coupled"):
        taylor.test_the_true_tangent_is_the_derivative_of_the_traction(KIND, law, mode)
    taylor.test_the_transposed_derivative_of_the_traction(KIND, law)


def force(path, **changes):
    keys = [f"{MU if key == 'mu' else TAU}={value!r}" for key, value in changes.items()]
    return run(load_scene(path, keys)).quantities["friction_force"][0]


@pytest.mark.parametrize("law", ["static", "incremental"])
def test_forces_have_derivatives_by_its_numbers(scene, law):
    """Those of the mesh itself are difference quotients of whole runs."""
    path = scene(law=law, steps=2)
    asked = Study(load_scene(path)).derivatives(["friction_force_x"], [MU, TAU])
    found = asked["friction_force_x"]
    by_mu = force(path, mu=COEFFICIENT + 1e-5) - force(path, mu=COEFFICIENT - 1e-5)
    by_tau = force(path, tau=STRENGTH + 1e-3) - force(path, tau=STRENGTH - 1e-3)
    assert found[MU] == pytest.approx(by_mu / 2e-5, rel=1e-3)
    assert found[TAU] == pytest.approx(by_tau / 2e-3, rel=1e-3)
    assert found[MU] > 0 and found[TAU] > 0


def test_a_scene_asks_for_them(scene):
    asked = f'[derivatives]\nof = ["friction_force_x"]\nby = ["{MU}", "{TAU}"]'
    found = run(load_scene(scene(asked + "\n" + QUIET, cells=32))).derivatives["friction_force_x"]
    assert all(slope.value > 0 for slope in found.values())
    share = sum(slope.normalised for slope in found.values())  # both: forces grow with friction
    assert share < run(load_scene(scene())).quantities["friction_force"][0]


def test_it_has_a_bar_that_holds(scene):
    found = run(load_scene(scene("")))
    fine = run(load_scene(scene(cells=64))).quantities["friction_force"][0]
    bar = found.errors["friction_force"]["total"]
    assert abs(found.quantities["friction_force"][0] - fine) < bar < 0.05 * fine


def test_an_accuracy_is_reached_with_it(scene):
    """Of a friction force it is relative to the force of the contact, here 4 times as large."""
    asked = "[accuracy]\nfriction_force = 0.001"
    found = run(load_scene(scene(asked, cells=8)))
    fine = run(load_scene(scene(cells=64))).quantities["friction_force"][0]
    assert found.exit_code == 0 and len(found.levels) > 1
    bar = found.errors["friction_force"]["total"]
    assert bar <= 0.001 * np.hypot(*found.quantities["contact_force"])
    assert abs(found.quantities["friction_force"][0] - fine) < bar


def test_a_formula_of_the_same_bound_has_the_same_answer(scene):
    """Quantities, bars and derivatives: the formula is read, and its rule is another one."""
    found, other = (
        run(load_scene(scene(f'[derivatives]\nof = ["normal_force"]\nby = ["{MU}"]', table=table)))
        for table in (TABLE, FORMULA)
    )
    for name in ("friction_force", "normal_force", "stick_area", "friction_work"):
        assert found.quantities[name] == pytest.approx(other.quantities[name], rel=1e-7), name
        assert found.errors[name]["total"] == pytest.approx(other.errors[name]["total"], rel=1e-4)
    slopes = (one.derivatives["normal_force"][MU].value for one in (found, other))
    assert next(slopes) == pytest.approx(next(slopes), rel=1e-6)


def test_sweeps_vary_its_numbers(scene, tmp_path, inline):
    path = scene()
    swept(path, [f"{TAU}=6,12,1e6"], tmp_path / "out")
    found = [float(row["friction_force_x"]) for row in rows_of(tmp_path / "out")]
    assert found == pytest.approx([force(path, tau=tau) for tau in (6.0, 12.0, 1e6)], rel=1e-6)
    coulomb = scene(table='kind = "coulomb"')
    assert found[0] < found[1] < found[2] == pytest.approx(force(coulomb), rel=1e-6)


def test_runs_go_on_with_it_and_pages_show_it(scene, tmp_path):
    asked = load_scene(scene(law="incremental", steps=3))
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    whole = Run(asked, body.mesh.comm, body).solve()
    stopped_after(asked, body, tmp_path, 1)
    found = resumed(asked, body, tmp_path)
    values = [
        [step.quantities["friction_force"][0] for step in one.steps] for one in (whole, found)
    ]
    assert values[1] == pytest.approx(values[0], rel=1e-6) and len(values[0]) == 3
    assert f"{KIND}: strength 12" in page_of(whole.as_dict())


def test_another_strength_is_another_scene(scene, tmp_path):
    asked = load_scene(scene(law="incremental", steps=3))
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    stopped_after(asked, body, tmp_path, 1)
    other = load_scene(scene(law="incremental", steps=3), [f"{TAU}=11.0"])
    with refused("resume_with_another_contact"):
        resumed(other, body, tmp_path)


def test_its_numbers_may_have_units(scene):
    units = '[units]\nlength = "mm"\nforce = "N"\n' + QUIET
    table = f'kind = "{KIND}", strength = "12e-3 GPa"'
    assert load_scene(scene(units, table=table)).contact[0].friction_law.strength == STRENGTH
    with refused("strength_in_mm"):
        load_scene(scene(units, table=table.replace("GPa", "mm")))


def test_the_documentation_and_editors_have_it():
    page = render()
    assert f'`[contact.friction_law]`, kind = `"{KIND}"`' in page
    assert (
        "| `strength` | number > 0 | required | the largest friction traction τ (stress) |" in page
    )
    assert json.dumps(KIND) in json.dumps(scene_schema())
    shear_limit.unregister()
    assert KIND not in render() and KIND not in json.dumps(scene_schema())
    shear_limit.register()


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ('kind = "shear limits", strength = 12', "no_friction_law_shear_limits"),
        (f'kind = "{KIND}"', "strength_is_missing"),
        (f'kind = "{KIND}", strength = 0', "strength_is_zero"),
        (f'kind = "{KIND}", strengths = 1', "unknown_key_strengths"),
    ],
)
def test_what_is_wrong_with_its_table_is_said(scene, table, words):
    with refused(words):
        load_scene(scene(table=table))


def test_a_kind_is_given_once():
    with refused("friction_kind_is_there_already", ValueError):
        rules.register(shear_limit.ShearLimit, shear_limit.ShearLimitFriction)
