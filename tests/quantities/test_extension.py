"""A quantity that a file registers has all that the program's own have."""

import math

import pytest
from mpi4py import MPI

from fenics_contact import Run, load_scene, run
from fenics_contact.evaluate import contact_quantities
from fenics_contact.mesh.loading import load_body
from fenics_contact.quantities import table
from fenics_contact.quantities.quantity import Quantity, Together
from fenics_contact.results.reference import quantity_tables
from tests.messages import refused
from tests.quantities import mean_pressure
from tests.quantities.mean_pressure import NAME
from tests.report.page.pages import page_of
from tests.scenes import ROOT
from tests.simulation.restart.test_state_file import resumed, stopped_after
from tests.simulation.sweeps.inline import inline, rows_of, swept

assert inline  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.errors]
E_STAR = 1000 / (1 - 0.3**2)
RADIUS, DEPTH = 2.0, "contact.0.obstacle.indentation"
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
[contact.obstacle]
shape = "parabola"
radius = {radius}
position = [0.5, 1.0]
indentation = 0.02
[steps]
number = {steps}
{more}
"""


@pytest.fixture(autouse=True)
def registered():
    mean_pressure.register()
    yield
    mean_pressure.unregister()


@pytest.fixture
def scene(tmp_path):
    def written(more="", cells=16, steps=1):
        path = tmp_path / "pressed.toml"
        mesh = ROOT / "meshes" / "slab.geo"
        text = SCENE.format(mesh=mesh, cells=cells, steps=steps, more=more, radius=RADIUS)
        path.write_text(text)
        return path

    return written


def hertz(force):
    """Mean pressure of a parabolic cylinder on a half-space, ¼ √(π P E*/R).

    K. L. Johnson, Contact Mechanics, Cambridge 1985, equations 4.43 and 4.45.
    """
    return 0.25 * math.sqrt(math.pi * force * E_STAR / RADIUS)


def test_it_has_a_bar_that_holds(scene):
    found = run(load_scene(scene()))
    fine = run(load_scene(scene('[solver]\nerrors = "none"', cells=64))).quantities
    bar = found.errors[NAME]["total"]
    assert abs(found.quantities[NAME] - fine[NAME]) < bar < 0.1 * fine[NAME]
    assert fine[NAME] == pytest.approx(hertz(fine["normal_force"]), rel=0.06)  # a block is stiffer


def test_an_accuracy_asks_for_it(scene):
    found = run(load_scene(scene(f"[accuracy]\n{NAME} = 0.05", cells=8)))
    value = found.quantities[NAME]
    assert found.exit_code == 0 and len(found.levels) > 1
    assert found.errors[NAME]["total"] <= 0.05 * value
    assert value == pytest.approx(hertz(found.quantities["normal_force"]), rel=0.05)


def test_it_has_a_derivative(scene):
    """Mean pressures go with the root of the force, which goes with the depth, about linearly."""
    asked = f'[derivatives]\nof = ["{NAME}", "normal_force"]\nby = ["{DEPTH}"]'
    found = run(load_scene(scene(asked, cells=40))).derivatives
    by_force = found["normal_force"][DEPTH].normalised
    mean = found[NAME][DEPTH]
    assert mean.value > 0
    assert abs(mean.normalised - by_force / 2) < 0.2 * by_force


def test_sweeps_have_its_column(scene, tmp_path, inline):
    swept(scene('[solver]\nerrors = "none"'), [f"{DEPTH}=0.01,0.02"], tmp_path / "out")
    for row in rows_of(tmp_path / "out"):
        expected = float(row["pressure_integral"]) / float(row["contact_area"])
        assert float(row[NAME]) == pytest.approx(expected, rel=1e-12)


def test_runs_go_on_with_it_and_pages_show_it(scene, tmp_path):
    asked = load_scene(scene('[solver]\nerrors = "none"', steps=3))
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    whole = Run(asked, body.mesh.comm, body).solve()
    stopped_after(asked, body, tmp_path, 1)
    found = resumed(asked, body, tmp_path)
    values = [[step.quantities[NAME] for step in result.steps] for result in (whole, found)]
    assert values[1] == pytest.approx(values[0], rel=1e-6) and len(values[0]) == 3
    assert "mean contact pressure" in page_of(whole.as_dict())


def test_the_documentation_has_its_row():
    assert mean_pressure.ROW.meaning in quantity_tables()["contact quantities"]


def test_a_name_is_given_once():
    with refused("quantity_is_there_already", ValueError):
        contact_quantities.register(Quantity(NAME, "", "", Together.SUM), lambda answer: 0.0)
    assert table.find(NAME) is mean_pressure.ROW


def test_what_it_lacks_is_refused_in_one_sentence(scene):
    """Without an edge it would be asked for its gradient, which nothing gives."""
    mean_pressure.unregister()
    bare = Quantity(NAME, "stress", "mean", Together.OF_THE_ONLY, is_asked_for=True)
    contact_quantities.register(bare, mean_pressure.value)
    asked = f'[derivatives]\nof = ["{NAME}"]\nby = ["{DEPTH}"]'
    with refused("mean_pressure_has_no_derivatives"):
        run(load_scene(scene(asked)))
