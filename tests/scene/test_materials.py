"""Materials by name: their values in the scene's units, and what stands beside the name."""

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Load, Material, Scene, Support, Units, main, run
from fenics_contact.common.errors import SceneError
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.schema import scene_schema
from fenics_contact.scene.units import materials
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.messages import refused
from tests.scenes import ROOT, box_body

TEXT = """
kinematics = "3D"
{units}
[mesh]
file = "slab.geo"
[material]
{material}
"""
NAMES = ", ".join(f"'{name}'" for name in materials.names()[:-1])  # before "or"
MM = 'units = { length = "mm", force = "N" }'


def read(material, units=MM):
    return scene_of_text(TEXT.format(material=material, units=units), Path("slab.toml"))


@pytest.mark.parametrize(
    ("units", "expected"),
    [
        (MM, (210e3, 7.85e-9)),
        ('units = { length = "m", force = "N" }', (210e9, 7850)),
        ('units = { length = "m", force = "kN" }', (210e6, 7.85)),
    ],
)
def test_values_are_in_the_units_of_the_scene(units, expected):
    (found,) = read('name = "steel S355"', units).material
    assert (found.youngs_modulus, found.density) == pytest.approx(expected)
    assert found.poissons_ratio == 0.3


def test_what_stands_beside_a_name_holds():
    (found,) = read('name = "steel S355"\npoissons_ratio = 0.28\ndensity = "8 g/cm³"').material
    assert (found.youngs_modulus, found.poissons_ratio) == (210e3, 0.28)
    assert found.density == pytest.approx(8e-9)
    row = "[3, 1, 1, 0, 0, 0], [1, 3, 1, 0, 0, 0], [1, 1, 3, 0, 0, 0], [0, 0, 0, 1, 0, 0]"
    tensor = f"stiffness = [{row}, [0, 0, 0, 0, 1, 0], [0, 0, 0, 0, 0, 1]]"
    (found,) = read(f'name = "steel S355"\n{tensor}').material
    assert found.youngs_modulus is None and found.density == pytest.approx(7.85e-9)


def test_a_scene_that_is_written_is_the_same():
    scene = read('name = "titanium Ti-6Al-4V"')
    assert scene_of_text(scene_text(scene), Path("slab.toml")) == scene


def test_a_run_is_that_of_the_values():
    """A bar that hangs: its weight is that of the table."""
    scene = Scene(
        kinematics="3D",
        material=Material(name="aluminium 6061"),
        support=(Support("z1", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("body", acceleration=(0, 0, -10.0)),),
        units=Units("m", "N"),
    )
    found = run(scene, body=box_body((1, 1, 1), (1, 1, 2))).quantities["reaction"]
    assert found[2] == pytest.approx(2 * 2700 * 10, rel=1e-9)


def test_names_need_units_and_are_of_the_table():
    with refused("material_by_name_without_units"):
        read('name = "steel S355"', "")
    assert read('name = "glass"\nyoungs_modulus = 1\npoissons_ratio = 0\ndensity = 1', "")
    with refused("material_without_values"):
        read("")
    with refused("material_of_another_name", names=NAMES):
        read('name = "steel"')


def test_a_name_cannot_be_changed_behind_its_values():
    scene = read('name = "steel S355"')
    for key in ("material.name", "material.0.name"):
        with refused("material_renamed", key=key):
            with_changes(scene, {key: "glass"})
    assert with_changes(scene, {"material.youngs_modulus": 200e3}).material[0].density > 0


def test_settings_of_the_command_line_name_another(tmp_path):
    from fenics_contact import load_scene

    path = tmp_path / "slab.toml"
    path.write_text(TEXT.format(material='name = "steel S355"', units=MM), encoding="utf-8")
    (found,) = load_scene(path, ["material.name=glass"]).material
    assert found.youngs_modulus == 70e3


def test_every_row_is_a_sound_material_with_a_source():
    """Of the bulk and shear moduli, and of metals the square of the velocity of sound."""
    assert len(materials.MATERIALS) >= 20
    for one in materials.MATERIALS.values():
        assert 0 < one.poissons_ratio < 0.5 and len(one.source) > 10
        velocity = np.sqrt(one.youngs_modulus * 1e9 / one.density)
        assert 1e3 < velocity < 12e3 and 1 < one.thermal_expansion < 200


@pytest.mark.skipif(MPI.COMM_WORLD.rank > 0, reason="rank 0 prints")
def test_the_command_and_the_page_list_them(capsys):
    assert main(["materials"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(materials.MATERIALS) + 1
    (row,) = [line for line in lines if line.startswith("steel S355")]
    assert row.split()[2:6] == ["210", "0.3", "7850", "12"] and "EN 1993-1-1" in row
    page = (ROOT / "docs" / "material_table.md").read_text(encoding="utf-8")
    assert page == materials.as_page(), "run: python docs/make_materials.py"


def test_editors_know_the_names():
    said = scene_schema()["$defs"]["Material"]["properties"]["name"]
    assert "steel S355" in str(said)


def test_python_says_what_is_missing():
    assert Material(name="glass").youngs_modulus is None  # until a scene has units
    with refused("material_name_is_unknown", SceneError, names=NAMES):
        Material(name="Glas")
