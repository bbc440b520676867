"""What keys and values of a scene were meant to be."""

import re

import pytest
from mpi4py import MPI

from fenics_contact import load_scene
from fenics_contact.scene import body, contact, obstacle, scene, values
from fenics_contact.scene import settings as of_answer
from fenics_contact.scene.loading import conditions
from fenics_contact.scene.messages import usual_names
from fenics_contact.scene.reference import keys_of
from tests.messages import refused
from tests.scene.test_reading import GOOD, PUNCH, write

COMM = MPI.COMM_WORLD
MODULES = (conditions, contact, body, obstacle, scene, of_answer, values)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("temperature = [20, 20], values = [2e5, 1e5]", "temperatures_of_moduli_stay"),
        ("temprature = [20, 30], values = [2e5, 1e5]", "temperature_of_moduli_misspelt"),
        ("temperature = [20, 30]", "values_of_moduli_missing"),
        ('alon = "x", at = [0, 1], values = [1, 2]', "along_misspelt"),
    ],
)
def test_of_several_tables_the_one_that_is_meant_is_spoken_of(given, said, folder):
    """A modulus may be a table of temperature, or a profile along an axis."""
    text = GOOD.replace("youngs_modulus = 1000", f"youngs_modulus = {{ {given} }}")
    assert text != GOOD
    with refused(said):
        load_scene(write(folder, text))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("youngs_modulus", "E", "unknown_key_e"),
        ("poissons_ratio", "nu", "unknown_key_nu"),
        ("friction_coefficient", "mu", "unknown_key_mu"),
        ("friction_coefficient", "friction", "unknown_key_friction"),
        ("displacement = { x = 0 }", "x = 0.5", "unknown_key_x"),
        ("displacement = { x = 0 }", "u_y = 0", "unknown_key_u_y"),
        ("traction", "torque", "unknown_key_torque"),
        ("traction", "gravity", "unknown_key_gravity"),
        ("x = 0", "ux = 0", "unknown_key_ux"),
        ("[material]", "[Materials]", "unknown_table_materials_in_capitals"),
        # a key that stands in the wrong table
        ("on = ", "symmetry = ['left']\non = ", "symmetry_in_the_wrong_table"),
        ("pressure = 300", "radius = 3", "radius_in_the_wrong_table"),
        ("[[support]]", "[obstacle]\n[[support]]", "obstacle_in_the_wrong_table"),
        # values of enumerations
        ('"plane stress"', '"Plane-Stress"', "kinematics_in_capitals"),
        ("pressure = 300", 'contact = "tied"', "contact_is_tied"),
        ("pressure = 300", 'law = "coulomb"', "law_is_coulomb"),
        ("pressure = 300", 'law = "Incremental"', "law_in_capitals"),
        # values of another type
        ("1000", '".3"', "number_in_quotes"),
        ("1000", '"0,3"', "number_with_a_comma"),
        ("[mesh]", '[steps]\nautomatic = "yes"\n[mesh]', "true_as_a_word"),
        ("kinematics", 'symmetry = "left"\nkinematics', "list_of_one_text"),
        ("[-300, 0]", "300", "list_of_one_number"),
        # tables of one, and of several
        ("[-300, 0]", '{ along = "y", at = [0, 1], values = [0, -300] }', "list_of_a_profile"),
        ("[[load]]", "[load]", "load_is_no_list"),
        ("[[load]]", "[[solver]]\n[[load]]", "solver_is_a_list"),
    ],
)
def test_a_near_or_usual_name_has_a_hint(folder, old, new, said):
    assert old in GOOD
    path = write(folder, GOOD.replace(old, new, 1))
    with refused(said):
        load_scene(path)


@pytest.mark.parametrize(
    ("shape", "meant"), [("ball", "sphere"), ("Cilinder", "cylinder"), ("flat-punch", "flat punch")]
)
def test_shapes_by_their_usual_names(folder, shape, meant):
    path = write(folder, PUNCH.replace('"cylinder"', f'"{shape}"'))
    with refused("no_such_shape", shape=shape, meant=meant):
        load_scene(path)


def test_what_resembles_nothing_has_no_hint(folder):
    for right, said in (
        ("poissons_ratio", "unknown_key_qqqq"),
        ('"plane stress"', "kinematics_qqqq"),
    ):
        path = write(folder, GOOD.replace(right, right.replace(right.strip('"'), "qqqq")))
        with refused(said):
            load_scene(path)


def test_what_a_setting_breaks_is_said_of_the_setting(folder):
    path = write(folder, GOOD)
    for settings, said in (
        (["contact.0.mu=.5", "title=x"], "setting_of_unknown_key_mu"),
        (["contact.0.friction_coefficient=0,5"], "setting_with_a_comma"),
        (["contact[0].pressure=5"], "setting_in_brackets"),
    ):
        with refused(said):
            load_scene(path, settings)
    pointed = load_scene(path, ["contact.0.friction_coefficient=.5"])  # as no file may write it
    assert pointed.contact[0].friction_coefficient == 0.5
    broken = write(folder, GOOD.replace("1000", "-1"))
    with refused("youngs_modulus_is_negative_in_file"):
        load_scene(broken, ["title=x"])


def test_files_by_near_names(folder):
    write(folder, GOOD)
    with refused("scene_misspelt"):
        load_scene(folder / "sceen.toml")


def test_encodings_of_windows(folder):
    path = folder / "scene.toml"

    def save(content):
        if COMM.rank == 0:
            path.write_bytes(content)
        COMM.barrier()

    save(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    assert load_scene(path).kinematics == "plane stress"
    COMM.barrier()
    save(GOOD.encode("utf-16"))
    with refused("scene_in_utf_16"):
        load_scene(path)
    COMM.barrier()
    save(b"# one\n" + "# Stütze\n".encode("cp1252") + GOOD.encode())
    with refused("scene_in_another_encoding"):
        load_scene(path)


def test_usual_names_lead_to_keys_that_there_are():
    classes = {
        name: made
        for module in MODULES
        for name, made in vars(module).items()
        if name in usual_names._KEYS
    }
    for name, names in usual_names._KEYS.items():
        known = {key.name for key in keys_of(classes[name])}
        assert set(names.values()) <= known, name
        assert not known & set(names), f"{name}: a key needs no other name"
        assert all(usual == usual.casefold() for usual in names if usual.isascii())
    words = set(re.findall(r'`"([^"]+)"`', " ".join(_accepted(made) for made in classes.values())))
    assert set(usual_names._VALUES.values()) - set("xyz") <= words


def _accepted(made):
    return " ".join(key.accepts for key in keys_of(made))
