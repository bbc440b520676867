import dataclasses
import re

import pytest
from mpi4py import MPI

from fenics_contact import (
    InputError,
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
        ("pressure", "presure", r"unknown key 'contact\[0\].presure' \(did you mean 'pressure'"),
        ("[material]", "[materials]", r"unknown key 'materials' \(did you mean 'material'"),
        ("x = 0", "q = 0", r"support\[0\].displacement.q"),
        ("x = 0", "z = 0", r"support\[0\].displacement.z: a plane stress model has only"),
        ("1000", "-1", r"material: youngs_modulus = -1 must be greater than 0"),
        ("1000", "0", r"material: youngs_modulus = 0 must be greater than 0"),
        ("1000", '"stiff"', r"material.youngs_modulus = 'stiff': must be a number"),
        ("1000", "true", r"material.youngs_modulus = True: must be a number"),
        (
            "ratio = 0.3",
            "ratio = 0.5",
            r"poissons_ratio = 0.5 must lie between -1 and 0.5",
        ),
        ("ratio = 0.3", "ratio = -1", r"material: poissons_ratio = -1 must lie between"),
        ("ratio = 0.3", "ratio = nan", r"material.poissons_ratio = nan: must be a finite"),
        ("coefficient = 0.3", "coefficient = -0.3", r"friction_coefficient = -0.3 must be ≥ 0"),
        ("pressure = 300", "pressure = inf", r"contact\[0\].pressure = inf: must be a finite"),
        ("pressure = 300", 'pressure = "p"', r"contact\[0\].pressure = 'p': must be a number"),
        ("pressure = 300\n", 'contact = "prescribed"\n', r"prescribed contact needs it"),
        ("pressure = 300", 'pressure = {along="x", at=[0,1], valus=[1,2]}', r"'values'"),
        ("pressure = 300", 'pressure = {along="x", at=[0,1], values=[1,2,3]}', r"at has 2"),
        ("pressure = 300", 'pressure = {along="x", at=[1,0], values=[1,2]}', r"must increase"),
        ("[-300, 0]", "[1, 2, 3]", r"load\[0\].traction has 3 entries; .* needs 2"),
        ("traction", "pressure = 3\ntraction", r"exactly one of traction, pressure"),
        ("[[load]]", "[load]", r"load = .*: must be a list"),
        ('"plane stress"', '"plane"', r"kinematics = 'plane': must be 'plane strain', "),
        ("[-300, 0]", "[-300, 0", r"not valid TOML"),
        ('file = "slab.geo"', "", r"the key 'mesh.file' is missing"),
        ("pressure = 300", 'pressure = {along="z", at=[0,1], values=[1,2]}', r"profile along z"),
        ("[-300, 0]", "[-300]", r"load\[0\].traction = \[-300\]: must be of at least 2 entries"),
        ("{ x = 0 }", "{}", r"support\[0\].displacement = {}: must be of at least 1 entries"),
        ("= 1000", "= 1" + "0" * 5000, r"cannot be read|finite"),
        ("[[load]]", "[solver]\nmax_iterations = 10000000000\n[[load]]", r"less than or equal"),
        ('[mesh]\nfile = "slab.geo"', "", r"\[mesh\] is missing"),
    ],
)
def test_bad_scene_gives_one_sentence_with_file_and_key(folder, old, new, message):
    assert old in GOOD
    path = write(folder, GOOD.replace(old, new, 1))
    with pytest.raises(InputError, match=message) as error:
        load_scene(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_missing_and_binary_files(folder):
    with pytest.raises(InputError, match="No such file"):
        load_scene(folder / "nowhere.toml")
    if COMM.rank == 0:
        (folder / "b.toml").write_bytes(b"\xff\xfe\x00\x80")
    COMM.barrier()
    with pytest.raises(InputError, match="UTF-8"):
        load_scene(folder / "b.toml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (".".join(["a"] * 5000) + " = 1", r"a\.a\.a.*tables within tables, too many"),
        ("[" + ".".join(["a"] * 5000) + "]", "tables within tables, too many"),
        ("a = " + "[" * 5000 + "]" * 5000, "cannot be read"),
        ("a = 0x1" + "F" * 5000, "a = 0x1fffffffffffffffff: must be a finite"),
        ("a = 1" + "0" * 5000, "cannot be read"),
        ("support = [" + "{ on = 'a', displacement.x = 0 }," * 1001 + "]", "at most 1000 entries"),
        ("load = [" + "{ on = 'a', pressure = 1 }," * 1001 + "]", "at most 1000 entries"),
        ("contact = [" + "{ on = 'left' }," * 1001 + "]", "at most 1000 entries"),
    ],
    ids=["keys", "table", "lists", "hex", "digits", "supports", "loads", "contacts"],
)
def test_scenes_beyond_all_measure_are_refused_in_one_sentence(folder, text, message):
    tables = GOOD.partition("[[support]]")[0]
    path = write(folder, f"{tables}\n{text}" if text.startswith("[") else f"{text}\n{tables}")
    with pytest.raises(InputError, match=message) as caught:
        load_scene(path)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 500


def test_a_file_without_an_end_is_no_scene():
    with pytest.raises(InputError, match="has more than 64 MB"):
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
    "setting",
    [
        "nonsense",
        "=3",
        "material.1.youngs_modulus=7",
        "discretisation.0.degree=1",
        "contact.7.pressure=1",
        "contact.x.pressure=1",
        "contact.².pressure=1",
        "title.a.b=1",
        'accuracy."top.normal_force=1e-2',
    ],
)
def test_bad_overrides_are_named(folder, setting):
    path = write(folder, 'title = "t"\n' + GOOD)
    with pytest.raises(InputError, match=re.escape(setting)):
        load_scene(path, [setting])


def test_two_contacts_of_one_name_are_refused(folder):
    path = write(folder, GOOD + '[[contact]]\non = "top"\npressure = 1\n')
    with pytest.raises(InputError, match="two contacts are called 'top'"):
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
        ("radius = 8", "radus = 8", r"contact\[0\].obstacle.radus' \(did you mean 'radius'"),
        ('"cylinder"', '"ball"', r"contact\[0\].obstacle.shape = 'ball': must be 'plane', "),
        ("radius = 8", "", r"contact\[0\].obstacle: radius is missing for the shape 'cylinder'"),
        ("radius = 8", "radius = -8", r"contact\[0\].obstacle.radius = -8: must be greater than 0"),
        ("[4, 1]", "[4, 1, 0]", r"contact\[0\].obstacle.position has 3 entries; it needs 2"),
        ("[4, 1]", "4", r"contact\[0\].obstacle.position = 4: must be a list"),
        ("indentation", "force = 3\nindentation", r"either an indentation or a force"),
        ("1e-8", '"soft"', r"contact\[0\].penalty_parameter = 'soft': must be .*number or 'auto'"),
        ("1e-8", "0", r"contact\[0\].penalty_parameter = 0: must be greater than 0"),
        ("[contact.obstacle]", "[contact.obstacles]", r"did you mean 'obstacle'"),
        ("[mesh]", '[half_space]\non = ["bottom"]\n[mesh]', r"half_space: only the contacts'"),
    ],
)
def test_bad_obstacle_gives_one_sentence(folder, old, new, message):
    assert old in PUNCH
    path = write(folder, PUNCH.replace(old, new, 1))
    with pytest.raises(InputError, match=message) as error:
        load_scene(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


LOAD = Load("top", pressure=1)
NUMBER = ": must be a number or a Profile or a function"


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Load("top", lambda x: (0, 1)), "Load: traction = a function: must be a list"),
        (lambda: Load("top", (1, "2")), "Load: traction[1] = '2'" + NUMBER),
        (lambda: Load("top"), "Load: give exactly one of traction, pressure and body_force"),
        (lambda: Load("top", (1, 2), None, None, abs, 5), "Load: too many values: it has 5 keys"),
        (lambda: Load("top", on="top"), "Load: on is given twice"),
        (lambda: Support("top", {"q": 0}), "Support: unknown key 'displacement.q': must be 'x', "),
        (lambda: Support("top", {"x": 0}, 3), "Support: path = 3: must be a Path or a function"),
        (lambda: Steps(number=2.5), "Steps: number = 2.5: must be a whole number"),
        (lambda: Steps(automatic=1), "Steps: automatic = 1: must be True or False"),
        (lambda: SolverSettings(stratgy="auto"), "SolverSettings: unknown key 'stratgy' (did "),
        (lambda: Scene(kinematics="3D"), "Scene: the key 'material' is missing"),
        (lambda: Obstacle("plane", normal=(0, 0)), "Obstacle: normal must not be a zero vector"),
        (lambda: dataclasses.replace(LOAD, pressure="2"), "Load: pressure = '2'" + NUMBER),
    ],
)
def test_what_python_gives_is_refused_in_one_sentence(make, said):
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(said)
    assert "\n" not in str(caught.value) and "pydantic" not in str(caught.value)
    assert isinstance(caught.value, ValueError)  # as Python's own are
    assert caught.value.__suppress_context__
