"""A kind of load whose value is a table, and to which the load is not proportional."""

from pathlib import Path

import pytest

from fenics_contact import Load, Material, Scene, Study, Support
from fenics_contact.analyses.derivatives.means import driven
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.reference import render
from fenics_contact.scene.schema import scene_schema
from fenics_contact.scene.writing import scene_text
from tests.messages import refused
from tests.problem import spinning_load
from tests.problem.spinning_load import Spin
from tests.scenes import box_body

WIDTH, HEIGHT = 2.0, 1.0
SPEED, DENSITY, AT = 3.0, 0.5, (0.25, -0.5)
KEYS = [f"load.0.spin.{key}" for key in ("speed", "density", "at.0", "at.1")]
TEXT = """
kinematics = "plane strain"
units = { length = "mm", force = "N" }
[mesh]
file = "slab.geo"
[material]
youngs_modulus = "1 GPa"
poissons_ratio = 0.3
[[load]]
on = "slab"
spin = { speed = "3 s^-1", density = "7850 kg/m³", at = [0, "2 cm"] }
"""


@pytest.fixture(autouse=True)
def registered():
    spinning_load.register()
    yield
    spinning_load.unregister()


def spun():
    """A plate that spins, on a support at its left end."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0, "y": 0}),),
        load=(Load("body", spin=Spin(SPEED, DENSITY, AT)),),
    )


def study():
    return Study(spun(), body=box_body((6, 3), (WIDTH, HEIGHT)))


def arms():
    """From the axis to the middle of the plate."""
    return WIDTH / 2 - AT[0], HEIGHT / 2 - AT[1]


def test_its_support_holds_what_equilibrium_tells():
    mass = DENSITY * WIDTH * HEIGHT
    found = study().solve().quantities["reaction"]
    assert found == pytest.approx([-mass * SPEED**2 * arm for arm in arms()], rel=1e-9)


def test_its_derivatives_are_those_of_the_formula():
    """−ρ V ω² (x − at) by each of its numbers."""
    found = study().derivatives(["x0.reaction_x", "x0.reaction_y"], KEYS)
    volume = WIDTH * HEIGHT
    for number, (axis, arm) in enumerate(zip("xy", arms(), strict=True)):
        slopes = found[f"x0.reaction_{axis}"]
        assert slopes[KEYS[0]] == pytest.approx(-2 * DENSITY * volume * SPEED * arm, rel=1e-8)
        assert slopes[KEYS[1]] == pytest.approx(-volume * SPEED**2 * arm, rel=1e-8)
        assert slopes[KEYS[2 + number]] == pytest.approx(DENSITY * volume * SPEED**2, rel=1e-8)
        assert slopes[KEYS[3 - number]] == pytest.approx(0, abs=1e-8)


def test_a_multiple_is_one_of_the_load():
    body = box_body((6, 3), (WIDTH, HEIGHT))
    scenes = driven(spun(), 0.5), spun()
    found, whole = (Study(scene, body=body).solve().quantities for scene in scenes)
    assert found["reaction"] == pytest.approx([part / 2 for part in whole["reaction"]], rel=1e-9)


def test_its_table_is_read_with_units_and_written():
    scene = scene_of_text(TEXT, Path("slab.toml"))
    assert scene.load[0].spin == Spin(3, 7.85e-9, (0, 20))
    assert scene_of_text(scene_text(scene), Path("slab.toml")) == scene
    assert "## `[load.spin]` (a table of the last [[load]])" in render()
    assert "speed" in scene_schema()["$defs"]["Spin"]["properties"]


def test_a_number_in_its_place_is_refused():
    text = TEXT[: TEXT.index("spin = ")] + "spin = 3\n"
    with refused("spin_is_no_table"):
        scene_of_text(text, Path("slab.toml"))


def test_its_vector_has_an_entry_for_each_axis():
    text = TEXT.replace('[0, "2 cm"]', "[0, 1, 2]")
    with refused("spin_has_3_entries"):
        scene_of_text(text, Path("slab.toml"))
