"""Values with a unit: what they are in the units of the scene, and what is refused."""

import dataclasses
import re
import subprocess
import sys
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import InputError, Load, Material, MeshSource, Obstacle, Scene, Units
from fenics_contact.scene.given_keys import key_of
from fenics_contact.scene.reading import load_scene, scene_of_text
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.units.dimensions import LENGTH, PLACE, dimension_of
from fenics_contact.scene.units.table import factor
from fenics_contact.scene.writing import scene_text
from tests.messages import refused
from tests.scene.test_schema import errors
from tests.scenes import ROOT

pytestmark = pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="of texts; one rank will do")

TABLE = '[units]\nlength = "mm"\nforce = "N"\n'
WRITTEN = """
kinematics = "3D"
[mesh]
file = "a.geo"
size = "0.8 cm"
parameters = { wide = "1 in", cells = 4 }
[material]
youngs_modulus = "210 GPa"
poissons_ratio = 0.3
[[support]]
on = "left"
displacement = { x = "-5 µm", y = { along = "x", at = ["0 m", 2], values = ["0 mm", "1 mm"] } }
[[load]]
on = "right"
traction = ["1 kN/cm^2", 0, "-2e6 Pa"]
[[load]]
on = "a"
pressure = { along = "x", at = ["0 mm", 2], values = ["1 MPa", 2] }
[[load]]
on = "b"
body_force = [0, 0, "-78.5 kN/m³"]
[[contact]]
on = "foot"
penalty_parameter = "1e-5 mm/MPa"
friction_coefficient = 0.2
regularisation_parameter = "1e-2 um"
[contact.obstacle]
shape = "sphere"
radius = "8mm"
position = [0, "1 m", 2]
force = "1.5 kN"
[[contact]]
on = "side"
foundation_stiffness = "3 GPa/m"
[[contact]]
on = "back"
normal_law = { kind = "normal compliance", coefficient = "2 N/mm^3.5", exponent = 1.5 }
[[preload]]
on = "bolt"
axis = [0, 0, 1]
force = "20 kN"
[[point]]
name = "tip"
at = [1, "2 mm", "3 cm"]
"""
PLAIN = {
    '"0.8 cm"': "8", '"1 in"': "25.4", '"210 GPa"': "210e3", '"-5 µm"': "-0.005", '"0 m"': "0",
    '"0 mm"': "0", '"1 mm"': "1", '"1 kN/cm^2"': "10", '"-2e6 Pa"': "-2", '"1 MPa"': "1",
    '"-78.5 kN/m³"': "-7.85e-5", '"1e-5 mm/MPa"': "1e-5", '"1e-2 um"': "1e-5", '"8mm"': "8",
    '"1 m"': "1000", '"1.5 kN"': "1500", '"3 GPa/m"': "3", '"2 N/mm^3.5"': "2", '"20 kN"': "20e3",
    '"2 mm"': "2", '"3 cm"': "30",
}  # fmt: skip


def read(text):
    return scene_of_text(text, ROOT / "scene.toml")


def without_units(scene):
    return dataclasses.replace(scene, units=None)


def refusal(text):
    with pytest.raises(InputError) as caught:
        read(text)
    return str(caught.value).partition(": ")[2]


def test_all_keys_take_units_and_mean_the_same_as_numbers():
    text = WRITTEN
    for with_unit, number in PLAIN.items():
        assert with_unit in text
        text = text.replace(with_unit, number)
    assert '"1 ' not in text
    found = read(WRITTEN + TABLE)
    assert without_units(found) == read(text)  # to the last digit
    assert read(scene_text(found)) == found
    assert errors(tomllib.loads(WRITTEN + TABLE)) == []  # nor has the schema anything against it


@pytest.mark.parametrize(
    ("unit", "length", "force", "powers", "value"),
    [  # the inch is 25.4 mm and the pound 0.45359237 kg, by definition; standard gravity 9.80665
        ("in", "mm", "N", (1, 0), "25.4"),
        ("lbf", "mm", "N", (0, 1), "4.4482216152605"),
        ("kgf", "mm", "N", (0, 1), "9.80665"),
        ("GPa", "m", "kN", (-2, 1), "1e6"),
        ("mm/MPa", "m", "N", (3, -1), "1e-9"),
        ("MPa/mm", "m", "N", (-3, 1), "1e9"),
    ],
)
def test_factors_are_those_of_definitions(unit, length, force, powers, value):
    assert factor(unit, length, force, powers) == Decimal(value)


def test_pressures_of_pounds_and_inches():
    psi = 0.45359237 * 9.80665 / 0.0254**2
    assert float(factor("psi", "m", "N", (-2, 1))) == pytest.approx(psi, rel=1e-14)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"210 GPa"', '"210 mm"', "youngs_modulus_in_mm"),
        ('"1.5 kN"', '"1.5 kN/mm"', "force_in_kn_per_mm"),
        ('"210 GPa"', '"210 Gpa"', "unit_is_not_known"),
        ('"210 GPa"', '"2*105 GPa"', "unit_with_a_product"),
        ('"210 GPa"', '"210 GPa + 1 MPa"', "unit_with_a_sum"),
        ('"210 GPa"', '"21e1000 GPa"', "unit_of_a_huge_number"),
        ('"210 GPa"', '"21e300 GPa"', "value_is_huge"),
        ('"210 GPa"', '"-210 GPa"', "youngs_modulus_with_unit_is_negative"),
        ('"8mm"', '"-8 mm"', "radius_with_unit_is_negative"),
        ('"210 GPa"', '"210 °C"', "unit_of_degrees"),
        ('"210 GPa"', '"210 degC"', "unit_of_temperature"),
        ("0.3\n", '"0.3 mm"\n', "poissons_ratio_in_mm"),
        ('length = "mm"', 'length = "kg"', "unit_of_length_is_kg"),
        ('length = "mm"', 'length = "2 mm"', "unit_of_length_is_2_mm"),
        ('force = "N"\n', "", "unit_of_force_is_missing"),
    ],
)  # fmt: skip
def test_what_is_refused_and_what_is_said(old, new, said):
    text = WRITTEN + TABLE
    assert old in text
    with refused(said):
        read(text.replace(old, new, 1))


@pytest.mark.parametrize(
    "text",
    ["9**9**9**9 mm", "1 mm**999999", "1 " + "m" * 100_000, "1" * 100_000 + " mm", "1 __class__",
     "1 mm.__class__", "1 (mm)", "1 mm\\n2 mm", "1 m m m m m m m m m m", "1 mm^9.9999999999"],
)  # fmt: skip
def test_nothing_is_computed_of_a_text(text):
    said = refusal((WRITTEN + TABLE).replace('"0.8 cm"', f'"{text}"'))
    assert said.startswith("mesh.size = ") and len(said) < 400


def test_without_the_table_a_unit_is_refused_and_numbers_are_as_ever():
    with refused("unit_without_units_in_file"):
        read(WRITTEN)
    code = (
        "import sys; from fenics_contact import load_scene\n"
        f"load_scene({str(ROOT / 'demos' / 'slab.toml')!r}); assert 'pint' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, timeout=60).returncode == 0


def test_forces_of_plane_models_are_per_length():
    text = """
        kinematics = "plane strain"
        mesh = { file = "a.geo" }
        material = { youngs_modulus = 1, poissons_ratio = 0.3 }
        [[contact]]
        on = "top"
        obstacle = { shape = "cylinder", radius = 1, force = "3 kN/m" }
    """
    assert read(text + TABLE).contact[0].obstacle.force == 3.0
    with refused("force_of_plane_model_in_kn"):
        read((text + TABLE).replace("kN/m", "kN"))
    stressed = text.replace("strain", "stress") + TABLE
    assert read(stressed).contact[0].obstacle.force == 3.0
    thick = stressed.replace("mesh =", 'thickness = "2 cm"\nmesh =', 1)
    assert read(thick.replace("kN/m", "kN")).contact[0].obstacle.force == 3000.0


def test_step_files_are_in_mm():
    text = WRITTEN.replace("a.geo", "a.STEP")
    assert read(text + TABLE).mesh[0].file == "a.STEP"
    with refused("step_file_in_m"):
        read(text + TABLE.replace('"mm"', '"m"'))


def test_settings_and_python_take_units_too():
    settings = ["units.length=mm", "units.force=N", "material.youngs_modulus=30 Mpsi"]
    found = load_scene(ROOT / "demos" / "slab.toml", settings)
    assert found.material[0].youngs_modulus == pytest.approx(206842.719, rel=1e-8)
    parts = {
        "kinematics": "3D",
        "material": Material("210 GPa", 0.3),
        "mesh": MeshSource("a.geo", size="8 mm"),
        "load": (Load("top", traction=("1 kPa", 0, 0)),),
    }
    made = Scene(**parts, units=Units("m", "N"))
    assert made.material[0].youngs_modulus == 210e9 and made.mesh[0].size == 0.008
    assert made.load[0].traction == (1000.0, 0.0, 0.0)
    with refused("unit_without_units"):
        Scene(**parts)
    with refused("youngs_modulus_is_negative"):
        Scene(**parts | {"material": Material("-1 Pa", 0.3)}, units=Units("m", "N"))


def test_checks_of_a_part_wait_until_its_values_are_numbers():
    ring = Obstacle(shape="annular punch", radius="1 cm", inner_radius="2 mm")
    assert ring.shape == "annular punch"
    with refused("sphere_without_radius"):
        Obstacle(shape="sphere")


def tables(table=Scene, seen=()):
    """All classes of a scene."""
    yield table
    for key in keys_of(table):
        for inner in key.tables:
            if inner not in seen:
                yield from tables(inner, (*seen, inner))


@pytest.mark.parametrize("table", dict.fromkeys(tables()), ids=lambda table: table.__name__)
def test_what_a_key_measures_is_said_by_its_mark_alone(table):
    for name, field in table.__pydantic_fields__.items():
        by_hand = re.search(r"\((length|stress|force|energy|area)\b[^)]*\)", field.description)
        assert not by_hand, f"{table.__name__}.{name}: mark it, as in Annotated[Number, LENGTH, …]"
        mark = dimension_of(field)
        said = next(key.description for key in keys_of(table) if key.name == key_of(table, name))
        assert mark is None or not mark.is_said or f"({mark.words})" in said


def test_a_mark_inside_lists_and_tables_is_found():
    fields = Obstacle.__pydantic_fields__
    assert dimension_of(fields["position"]) is PLACE
    assert dimension_of(fields["displacement"]) is LENGTH
    assert dimension_of(fields["normal"]) is None


def test_densities_in_any_unit_are_masses_by_force_length_and_seconds():
    """1 kg is 1 N·s²/m, so that 7850 kg/m³ are 7.85e-9 N·s²/mm⁴."""
    parts = {"kinematics": "3D", "material": Material(1.0, 0.3, density="7850 kg/m³")}
    made = Scene(**parts, units=Units("mm", "N"))
    assert made.material[0].density == pytest.approx(7.85e-9, rel=1e-14)
    with refused("density_in_kg"):
        Scene(
            kinematics="3D",
            material=Material(1.0, 0.3, density="7850 kg"),
            units=Units("m", "N"),
        )


def test_damping_in_units_of_time_and_of_its_inverse():
    """Of steady sliding as of motions; less than 0 is refused after it is a number, too."""
    text = (
        'kinematics = "plane strain"\n[mesh]\nfile = "a.geo"\n'
        "[material]\nyoungs_modulus = 1\npoissons_ratio = 0.3\ndensity = 1\n"
        '[[contact]]\non = "a"\nfriction_coefficient = 0.1\nlaw = "incremental"\n'
        '[stability]\nrayleigh = { stiffness = "0.2 ms", mass = "3 Hz" }\n'
    )
    rayleigh = scene_of_text(text + TABLE, Path("own.toml")).stability.rayleigh
    assert (rayleigh.stiffness, rayleigh.mass) == (pytest.approx(2e-4), pytest.approx(3.0))
    with refused("rayleigh_stiffness_is_negative"):
        scene_of_text(text.replace("0.2 ms", "-0.2 ms") + TABLE, Path("own.toml"))
