"""What keys and values of a scene were meant to be."""

import re

import pytest
from mpi4py import MPI

from fenics_contact import InputError, load_scene
from fenics_contact.scene import body, contact, obstacle, scene, steps, values
from fenics_contact.scene.loading import conditions
from fenics_contact.scene.messages import usual_names
from fenics_contact.scene.reference import keys_of
from tests.scene.test_reading import GOOD, PUNCH, write

COMM = MPI.COMM_WORLD
MODULES = (conditions, contact, body, obstacle, scene, steps, values)


def refusal(path, *settings):
    with pytest.raises(InputError) as caught:
        load_scene(path, settings)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("youngs_modulus", "E", "'material.E' (did you mean 'youngs_modulus'?)"),
        ("poissons_ratio", "nu", "'material.nu' (did you mean 'poissons_ratio'?)"),
        ("friction_coefficient", "mu", "(did you mean 'friction_coefficient'?)"),
        ("friction_coefficient", "friction", "(did you mean 'friction_coefficient'?)"),
        ("displacement = { x = 0 }", "x = 0.5", "(did you mean 'displacement = { x = 0.5 }'?)"),
        ("displacement = { x = 0 }", "u_y = 0", "(did you mean 'displacement = { y = 0 }'?)"),
        ("traction", "force", "(did you mean 'traction', force per area?)"),
        ("x = 0", "ux = 0", "must be 'x', 'y' or 'z' (did you mean 'x'?)"),
        ("[material]", "[Materials]", "'Materials' (did you mean 'material'?)"),
        # a key that stands in the wrong table
        ("on = ", "symmetry = ['left']\non = ", "(it is a key of the scene itself, so it stands "),
        ("pressure = 300", "radius = 3", "(it is a key of [contact.obstacle])"),
        ("[[support]]", "[obstacle]\n[[support]]", "'obstacle' (write [contact.obstacle])"),
        # values of enumerations
        ('"plane stress"', '"Plane-Stress"', "(did you mean 'plane stress'?)"),
        ("pressure = 300", 'contact = "tied"', "or 'bonded' (did you mean 'bonded'?)"),
        ("pressure = 300", 'law = "coulomb"', "(did you mean 'incremental'?)"),
        ("pressure = 300", 'law = "Incremental"', "(did you mean 'incremental'?)"),
        # values of another type
        ("1000", '".3"', "must be a number or a table (did you mean the number 0.3?)"),
        ("1000", '"0,3"', "must be a number or a table (did you mean the number 0.3?)"),
        (
            "[mesh]",
            '[steps]\nautomatic = "yes"\n[mesh]',
            "must be true or false (did you mean true, without quotes?)",
        ),
        ("kinematics", 'symmetry = "left"\nkinematics', 'a list (did you mean ["left"]?)'),
        ("[-300, 0]", "300", "must be a list (in brackets, as in [1, 2])"),
        # tables of one, and of several
        (
            "[-300, 0]",
            '{ along = "y", at = [0, 1], values = [0, -300] }',
            "must be a list (an entry for each axis; a table may be one of them, as in [{ … }, 0])",
        ),
        ("[[load]]", "[load]", "must be a list (write [[load]], also where there is one)"),
        (
            "[[load]]",
            "[[solver]]\n[[load]]",
            "must be a table (there is one at most: write [solver], not [[solver]])",
        ),
    ],
)
def test_a_near_or_usual_name_has_a_hint(folder, old, new, said):
    assert old in GOOD
    found = refusal(write(folder, GOOD.replace(old, new, 1)))
    assert said in found and found.startswith(str(folder))


@pytest.mark.parametrize(
    ("shape", "meant"), [("ball", "sphere"), ("Cilinder", "cylinder"), ("flat-punch", "flat punch")]
)
def test_shapes_by_their_usual_names(folder, shape, meant):
    found = refusal(write(folder, PUNCH.replace('"cylinder"', f'"{shape}"')))
    assert found.endswith(f"(did you mean '{meant}'?)")


def test_what_resembles_nothing_has_no_hint(folder):
    found = refusal(write(folder, GOOD.replace("poissons_ratio", "qqqq")))
    assert "unknown key 'material.qqqq'; accepted here: youngs_modulus, " in found
    found = refusal(write(folder, GOOD.replace('"plane stress"', '"qqqq"')))
    assert found.endswith("'axisymmetric' or '3D'")


def test_what_a_setting_breaks_is_said_of_the_setting(folder):
    path = write(folder, GOOD)
    found = refusal(path, "contact.0.mu=.5", "title=x")
    assert found.startswith(f"{path} with --set contact.0.mu=.5 --set title=x: unknown key ")
    assert "(did you mean 'friction_coefficient'?)" in found
    assert "(did you mean the number 0.5?)" in refusal(path, "contact.0.friction_coefficient=0,5")
    pointed = load_scene(path, ["contact.0.friction_coefficient=.5"])  # as no file may write it
    assert pointed.contact[0].friction_coefficient == 0.5
    assert refusal(path, "contact[0].pressure=5").endswith(" a dot, as in contact.0.pressure")
    broken = write(folder, GOOD.replace("1000", "-1"))
    assert refusal(broken, "title=x").startswith(f"{broken}: material: youngs_modulus = -1")


def test_files_by_near_names(folder):
    write(folder, GOOD)
    assert "(did you mean 'scene.toml'?)" in refusal(folder / "sceen.toml")


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
    assert "not a text file in UTF-8, but in UTF-16; save it as UTF-8" in refusal(path)
    COMM.barrier()
    save(b"# one\n" + "# Stütze\n".encode("cp1252") + GOOD.encode())
    assert "line 2 has a character of another encoding ('ü' in that of Windows)" in refusal(path)


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
