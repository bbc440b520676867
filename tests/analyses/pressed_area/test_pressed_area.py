"""An analysis that a folder registers has all that those of the program have."""

import csv
import dataclasses
import json

import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps, load_scene, main, run
from fenics_contact.analyses import registry
from fenics_contact.common.errors import SceneError
from fenics_contact.mesh.loading import load_body
from fenics_contact.results.result import read_result
from fenics_contact.scene import reference
from fenics_contact.scene.schema import scene_schema
from fenics_contact.scene.writing import scene_text
from tests.analyses import pressed_area
from tests.analyses.pressed_area.table import PressedArea
from tests.messages import refused
from tests.report.page.pages import page_of
from tests.scenes import ROOT
from tests.simulation.restart.test_state_file import resumed, stopped_after

pytestmark = pytest.mark.serial
# The pressure grows along the top, 8 long, to 300 at its end.
SCENE = """
kinematics = "plane strain"
{table}
[units]
length = "mm"
force = "N"
[mesh]
file = "{mesh}"
cell = "quadrilateral"
parameters = {{ length = 8, height = 1, cells_along = 16, cells_across = 1 }}
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ x = 0, y = 0 }}
[[contact]]
on = "top"
pressure = {{ along = "x", at = [0, 8], values = [0, 300] }}
pressure_path = {{ time = [0, 1], factor = [0, 1] }}
[steps]
number = 4
[solver]
errors = "none"
"""
ASKED = 'pressed_area = { above = "75 MPa" }'


@pytest.fixture(autouse=True)
def registered():
    pressed_area.register()
    yield
    pressed_area.unregister()


@pytest.fixture
def scene(tmp_path):
    def written(table=ASKED):
        path = tmp_path / "pressed.toml"
        text = SCENE.format(mesh=ROOT / "meshes" / "slab.geo", table=table)
        path.write_text(text, encoding="utf-8")
        return path

    return written


def areas(result):
    return dict(result.further["pressed_area"]["steps"])


def test_it_is_the_part_along_which_the_pressure_is_above(scene):
    """Of 300 t x/8 that is x > 2/t, up to what is between two nodes, a quarter apart."""
    found = run(load_scene(scene()))
    measured = areas(found)
    assert found.exit_code == 0 and list(measured) == [0.25, 0.5, 0.75, 1.0]
    for time, area in measured.items():
        assert abs(area - (8 - 2 / time)) < 0.25
    assert f" {measured[1.0]:g} of area is pressed hard." in found.verdict
    less = run(load_scene(scene(), ["pressed_area.above=225"]))
    assert abs(areas(less)[1.0] - 2) < 0.25


def test_what_does_not_ask_for_it_has_nothing_of_it(scene):
    found = run(load_scene(scene("")))
    assert not found.further and "further" not in found.as_dict()
    assert registry.asked_by(load_scene(scene(""))) == []


def test_a_run_writes_and_says_it(scene, tmp_path, capsys):
    out = tmp_path / "out"
    assert main(["run", str(scene()), "--out", str(out)]) == 0
    assert "pressed area" in capsys.readouterr().out
    record = read_result(out)
    assert abs(areas(record)[1.0] - 6) < 0.25
    assert json.loads((out / "result.json").read_text())["further"] == record.further
    with (out / "pressed_area.csv").open(newline="") as file:
        head, *rows = csv.reader(file)
    assert head == ["time", "area"] and [float(area) for _, area in rows] == [
        *areas(record).values()
    ]
    assert main(["run", str(scene("")), "--out", str(out), "--quiet"]) == 0
    assert not (out / "pressed_area.csv").exists()
    assert main(["check", str(scene())]) == 0
    assert "Pressed area: where pressures are above 75 MPa" in capsys.readouterr().out


def test_a_run_goes_on_with_it_and_with_another_pressure(scene, tmp_path):
    asked = load_scene(scene())
    body = load_body(asked.mesh, 2, MPI.COMM_SELF)
    whole = Run(asked, body.mesh.comm, body).solve()
    stopped_after(asked, body, tmp_path / "state", 2)
    found = resumed(asked, body, tmp_path / "state")
    later = {time: area for time, area in areas(whole).items() if time > 0.5}
    assert areas(found) == pytest.approx(later, abs=1e-9)
    assert whole.further["pressed_area"]["is_whole"]
    assert not found.further["pressed_area"]["is_whole"]
    other = resumed(
        dataclasses.replace(asked, pressed_area=PressedArea(225)), body, tmp_path / "state"
    )
    assert abs(areas(other)[1.0] - 2) < 0.25
    with refused("resume_with_another_contact"):
        contact = dataclasses.replace(asked.contact[0], pressure=1.0)
        resumed(dataclasses.replace(asked, contact=(contact,)), body, tmp_path / "state")


def test_the_page_has_its_section_where_it_is_known(scene):
    found = run(load_scene(scene())).as_dict()
    page = page_of(found)
    assert 'id="pressed_area"' in page and "Where pressures are high." in page
    assert "Where pressures are high." not in page_of(found | {"further": {}})


def test_editors_the_reference_and_files_know_it(scene):
    said = scene_schema()
    assert said["properties"]["pressed_area"]["description"].startswith("The area that carries")
    assert said["$defs"]["PressedArea"]["properties"]["above"]["description"] == (
        "The pressure (stress)."
    )
    text = reference.render()
    assert "## `[pressed_area]` (a table)" in text and "| `above` | number > 0 |" in text
    asked = load_scene(scene())
    assert "[pressed_area]\nabove = 75" in scene_text(asked)


def test_what_it_does_not_take_is_refused_in_a_sentence(scene):
    with refused("pressed_area_above_is_negative"):
        load_scene(scene("pressed_area = { above = -1 }"))
    with refused("unknown_key_of_pressed_area"):
        load_scene(scene("pressed_area = { over = 1 }"))
    asked = load_scene(scene())
    with refused("pressed_area_without_contact", SceneError):
        dataclasses.replace(asked, contact=(), steps=Steps())


def test_it_is_unknown_once_it_is_taken_out(scene):
    pressed_area.unregister()
    try:
        with refused("pressed_area_is_unknown"):
            load_scene(scene())
    finally:
        pressed_area.register()
