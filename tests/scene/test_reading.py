import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import (
    Load,
    Obstacle,
    Profile,
    Scene,
    SolverSettings,
    Steps,
    Support,
    load_scene,
)
from fenics_contact.scene import reference as scene_reference
from fenics_contact.scene.reading import value_of
from tests.messages import refused
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD

GOOD = """
kinematics = "plane stress"
[mesh]
file = "slab.geo"
[material]
youngs_modulus = 1000
poissons_ratio = 0.3
[[support]]
on = "left"
displacement = { x = 0 }
[[load]]
on = "right"
traction = [-300, 0]
[[contact]]
on = "top"
pressure = 300
friction_coefficient = 0.3
"""


def write(folder, text):
    path = folder / "scene.toml"
    COMM.barrier()  # the other rank may still read what was there
    if COMM.rank == 0:  # on all at once, one rank would read what another is still writing
        path.write_text(text)
    COMM.barrier()
    return path


def test_scene_file_becomes_the_same_dataclasses(folder):
    scene = load_scene(write(folder, GOOD))
    assert isinstance(scene, Scene)
    assert scene.mesh[0].file == str(folder / "slab.geo")
    assert scene.contact[0].label == "top"
    assert scene.load[0].traction == (-300, 0)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("pressure", "presure", "unknown_key_presure"),
        ("[material]", "[materials]", "unknown_table_materials"),
        ("x = 0", "q = 0", "unknown_axis_q_in_file"),
        ("x = 0", "z = 0", "no_axis_z"),
        ("1000", "-1", "youngs_modulus_is_negative_in_file"),
        ("1000", "0", "youngs_modulus_is_zero"),
        ("1000", '"stiff"', "youngs_modulus_is_a_word"),
        ("1000", "true", "youngs_modulus_is_true"),
        ("ratio = 0.3", "ratio = 0.5", "poissons_ratio_is_a_half_in_file"),
        ("ratio = 0.3", "ratio = -1", "poissons_ratio_is_minus_1"),
        ("ratio = 0.3", "ratio = nan", "poissons_ratio_is_nan"),
        ("coefficient = 0.3", "coefficient = -0.3", "friction_coefficient_is_negative"),
        ("pressure = 300", "pressure = inf", "pressure_is_infinite"),
        ("pressure = 300", 'pressure = "p"', "pressure_is_a_letter"),
        ("pressure = 300\n", 'contact = "prescribed"\n', "pressure_is_missing_in_file"),
        ("pressure = 300", 'pressure = {along="x", at=[0,1], valus=[1,2]}', "unknown_key_valus"),
        (
            "pressure = 300",
            'pressure = {along="x", at=[0,1], values=[1,2,3]}',
            "profile_of_2_and_3",
        ),
        ("pressure = 300", 'pressure = {along="x", at=[1,0], values=[1,2]}', "profile_turns_back"),
        ("[-300, 0]", "[1, 2, 3]", "traction_has_3_entries"),
        ("traction", "pressure = 3\ntraction", "load_gives_two"),
        ("[[load]]", "[load]", "load_is_no_list"),
        ('"plane stress"', '"plane"', "kinematics_unknown"),
        ("[-300, 0]", "[-300, 0", "toml_list_has_no_end"),
        ('file = "slab.geo"', "", "mesh_file_key_is_missing"),
        ("pressure = 300", 'pressure = {along="z", at=[0,1], values=[1,2]}', "profile_along_z"),
        ("[-300, 0]", "[-300]", "traction_has_1_entry"),
        ("{ x = 0 }", "{}", "displacement_has_no_entry"),
        ("= 1000", "= 1" + "0" * 5000, "number_of_5000_digits"),
        ("[[load]]", "[solver]\nmax_iterations = 10000000000\n[[load]]", "too_many_iterations"),
        ('[mesh]\nfile = "slab.geo"', "", "mesh_table_is_missing"),
    ],
)
def test_bad_scene_gives_one_sentence_with_file_and_key(folder, old, new, message):
    assert old in GOOD
    path = write(folder, GOOD.replace(old, new, 1))
    with refused(message):
        load_scene(path)


def test_missing_and_binary_files(folder):
    with refused("scene_cannot_be_read"):
        load_scene(folder / "nowhere.toml")
    if COMM.rank == 0:
        (folder / "b.toml").write_bytes(b"\xff\xfe\x00\x80")
    COMM.barrier()
    with refused("scene_not_in_utf_8"):
        load_scene(folder / "b.toml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (".".join(["a"] * 5000) + " = 1", "too_many_tables_within_tables"),
        ("[" + ".".join(["a"] * 5000) + "]", "too_many_tables_within_tables"),
        ("a = " + "[" * 5000 + "]" * 5000, "lists_too_deep"),
        ("a = 0x1" + "F" * 5000, "number_in_hex_too_large"),
        ("a = 1" + "0" * 5000, "number_of_5000_digits"),
        ("support = [" + "{ on = 'a', displacement.x = 0 }," * 1001 + "]", "too_many_supports"),
        ("load = [" + "{ on = 'a', pressure = 1 }," * 1001 + "]", "too_many_loads"),
        ("contact = [" + "{ on = 'left' }," * 1001 + "]", "too_many_contacts"),
    ],
    ids=["keys", "table", "lists", "hex", "digits", "supports", "loads", "contacts"],
)
def test_scenes_beyond_all_measure_are_refused_in_one_sentence(folder, text, message):
    tables = GOOD.partition("[[support]]")[0]
    path = write(folder, f"{tables}\n{text}" if text.startswith("[") else f"{text}\n{tables}")
    with refused(message):
        load_scene(path)


def test_a_file_without_an_end_is_no_scene():
    with refused("scene_too_large"):
        load_scene("/dev/zero")


def test_overrides_replace_and_add_values(folder):
    path = write(folder, GOOD)
    settings = [
        "contact.0.friction_coefficient=0.5",
        "solver.tolerance=1e-8",
        "title=A title",
        'contact.0.pressure={along="x", at=[0, 8], values=[100, 300]}',
    ]
    scene = load_scene(path, settings)
    assert scene.contact[0].friction_coefficient == 0.5
    assert scene.solver.tolerance == 1e-8
    assert scene.title == "A title"
    assert isinstance(scene.contact[0].pressure, Profile)
    for key in ("accuracy.top.normal_force", 'accuracy."top.normal_force"'):
        assert load_scene(path, [f"{key}=1e-2"]).accuracy.of == {"top.normal_force": 0.01}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        (".4", 0.4),
        ("-.4", -0.4),
        ("+.4e-1", 0.04),
        ("5.", 5.0),
        ("2.e3", 2000.0),
        ("[-.5, 1., .25]", [-0.5, 1.0, 0.25]),
        ('{ along = "x.5", at = [.0, 8], values=[-.1,3.] }', "x.5"),
    ],
)
def test_numbers_may_begin_or_end_with_their_point(text, value):
    found = value_of(text)
    if isinstance(found, dict):
        assert found == {"along": value, "at": [0.0, 8], "values": [-0.1, 3.0]}
    else:
        assert found == value and type(found) is type(value)


@pytest.mark.parametrize("text", [".", "../a.geo", "a.5", "v1.", ".geo", "1.2.3", '".5"', "..5"])
def test_points_of_words_are_their_own(text):
    assert value_of(text) == text.strip('"')


@pytest.mark.parametrize("key", ["material.youngs_modulus", "material.0.youngs_modulus"])
def test_a_table_that_stands_alone_may_be_counted(folder, key):
    """As results write it, which name keys of tables that may be several by number."""
    assert load_scene(write(folder, GOOD), [f"{key}=7"]).material[0].youngs_modulus == 7


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("nonsense", "setting_is_nonsense"),
        ("=3", "setting_without_key"),
        ("material.1.youngs_modulus=7", "setting_of_material_1"),
        ("discretisation.0.degree=1", "setting_of_discretisation_0"),
        ("contact.7.pressure=1", "setting_of_contact_7"),
        ("contact.x.pressure=1", "setting_of_contact_x"),
        ("contact.².pressure=1", "setting_of_contact_squared"),
        ("title.a.b=1", "setting_of_a_text"),
        ('accuracy."top.normal_force=1e-2', "setting_with_open_quote"),
    ],
)
def test_bad_overrides_are_named(folder, setting, said):
    path = write(folder, 'title = "t"\n' + GOOD)
    with refused(said):
        load_scene(path, [setting])


def test_two_contacts_of_one_name_are_refused(folder):
    path = write(folder, GOOD + '[[contact]]\non = "top"\npressure = 1\n')
    with refused("two_contacts_of_one_name"):
        load_scene(path)


def test_scene_reference_is_generated_from_the_code():
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    assert page == scene_reference.render(), "run: python docs/make_scene.py"


def test_scene_reference_describes_every_key():
    for line in scene_reference.render().splitlines():
        if line.startswith("| `"):
            assert all(cell.strip() for cell in line.strip("|").split("|")), line


PUNCH = (
    GOOD[: GOOD.index("pressure")]
    + """
penalty_parameter = 1e-8
[contact.obstacle]
shape = "cylinder"
radius = 8
position = [4, 1]
indentation = 0.1
"""
)


def test_obstacle_is_a_table_of_its_contact(folder):
    scene = load_scene(write(folder, 'symmetry = ["left"]\n' + PUNCH))
    obstacle = scene.contact[0].obstacle
    assert (obstacle.shape, obstacle.radius, obstacle.position) == ("cylinder", 8, (4, 1))
    assert scene.contact[0].kind == "unilateral"
    assert scene.symmetry == ("left",)
    changed = load_scene(folder / "scene.toml", ["contact.0.obstacle.indentation=0.2"])
    assert changed.contact[0].obstacle.indentation == 0.2


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius = 8", "radus = 8", "unknown_key_radus"),
        ("radius = 8", "", "cylinder_without_radius"),
        ("radius = 8", "radius = -8", "radius_is_negative_in_file"),
        ("[4, 1]", "[4, 1, 0]", "position_has_3_entries"),
        ("[4, 1]", "4", "position_is_no_list"),
        ("indentation", "force = 3\nindentation", "indentation_and_force_in_file"),
        ("1e-8", '"soft"', "penalty_is_a_word"),
        ("1e-8", "-1", "penalty_is_negative"),
        ("[contact.obstacle]", "[contact.obstacles]", "unknown_key_obstacles"),
        ("[mesh]", '[half_space]\non = ["bottom"]\n[mesh]', "half_space_with_load_in_file"),
    ],
)
def test_bad_obstacle_gives_one_sentence(folder, old, new, message):
    assert old in PUNCH
    path = write(folder, PUNCH.replace(old, new, 1))
    with refused(message):
        load_scene(path)


LOAD = Load("top", pressure=1)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Load("top", lambda x: (0, 1)), "traction_is_a_function"),
        (lambda: Load("top", (1, "2")), "traction_has_a_text"),
        (lambda: Load("top"), "load_gives_none"),
        (lambda: Load("top", (1, 2), None, None, abs, *[None] * 6, 5), "load_has_too_many_values"),
        (lambda: Load("top", on="top"), "load_on_given_twice"),
        (lambda: Support("top", {"q": 0}), "unknown_axis_q"),
        (lambda: Support("top", {"x": 0}, 3), "path_is_a_number"),
        (lambda: Steps(number=2.5), "number_of_steps_is_no_whole_number"),
        (lambda: Steps(automatic=1), "automatic_is_a_number"),
        (lambda: SolverSettings(stratgy="auto"), "unknown_key_stratgy"),
        (lambda: Scene(kinematics="3D"), "material_is_missing"),
        (lambda: Obstacle("plane", normal=(0, 0)), "normal_is_zero"),
        (lambda: dataclasses.replace(LOAD, pressure="2"), "pressure_is_a_text"),
    ],
)
def test_what_python_gives_is_refused_in_one_sentence(make, said):
    with refused(said) as caught:
        make()
    assert isinstance(caught.value, ValueError)  # as Python's own are
    assert caught.value.__suppress_context__
