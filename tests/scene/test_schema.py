"""The JSON schema of scenes: what is read passes it, and what has a wrong key or type does not."""

import dataclasses
import json
import tomllib

import jsonschema
import pytest
from mpi4py import MPI

from fenics_contact import Scene, main
from fenics_contact.common.program import templates
from fenics_contact.scene.reference import keys_of
from fenics_contact.scene.schema import scene_schema
from tests.scene.test_reading import GOOD, PUNCH
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
pytestmark = pytest.mark.skipif(COMM.rank > 0, reason="of texts; one rank will do")

SCHEMA = scene_schema()
FILES = [
    *sorted((ROOT / "demos").glob("*.toml")),
    *sorted((ROOT / "docs").rglob("*.toml")),
    *sorted((ROOT / "tests").glob("*/**/*.toml")),
    *templates().values(),
]


def errors(scene):
    """Where a scene, as data or as TOML, is not as the schema says."""
    data = tomllib.loads(scene) if isinstance(scene, str) else scene
    found = jsonschema.Draft7Validator(SCHEMA).iter_errors(data)
    return [error.json_path for error in found]


def test_the_schema_is_one():
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    assert SCHEMA["$schema"] == jsonschema.Draft7Validator.META_SCHEMA["$schema"]


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_scenes_of_demos_and_templates_pass(path):
    assert errors(path.read_text(encoding="utf-8")) == []


def test_all_scenes_are_found():
    assert len(FILES) > 14


@pytest.mark.parametrize(
    "more",
    [
        "accuracy = 1e-3",
        "symmetry = ['left']",
        "[accuracy]\nmain = 1e-2\n'left.reaction' = 1e-2\nleft.reaction_x = 0.1",
        "[accuracy.of]\n'left.reaction' = 1e-2\nleft.reaction_x = 0.1",
        "[accuracy]\ndisplacement_tip_x = 0.1\nreaction_x = 0.1",
        "[half_space]\non = ['bottom']",
        "thickness = { along = 'x', at = [0, 1], values = [1, 2] }",
    ],
)
def test_what_is_accepted_in_several_ways_passes(more):
    head, tables = ("", more) if more.startswith("[") else (more, "")
    assert errors(f"{head}\n{GOOD}\n{tables}") == []


def test_lists_of_one_may_be_tables():
    for name in ("material", "mesh"):
        data = tomllib.loads(GOOD)
        data[name] = [data[name]]
        assert errors(data) == []


def test_a_tensor_may_have_six_rows_or_four_indices():
    data = tomllib.loads(GOOD)
    for stiffness in ([[0.0] * 6] * 6, [[[[0.0] * 3] * 3] * 3] * 3):
        data["material"] = {"stiffness": stiffness}
        assert errors(data) == []
    data["material"] = {"stiffness": [[0.0] * 6] * 5}
    assert errors(data)


@pytest.mark.parametrize(
    ("text", "old", "new"),
    [
        (GOOD, "presure", None),
        (GOOD, "pressure", "presure"),
        (GOOD, "[material]", "[materials]"),
        (GOOD, "x = 0", "q = 0"),
        (GOOD, "1000", '"stiff"'),
        (GOOD, "1000", "true"),
        (GOOD, '"plane stress"', '"plane"'),
        (GOOD, "[[load]]", "[load]"),
        (GOOD, "[-300, 0]", "[-300]"),
        (GOOD, 'file = "slab.geo"', ""),
        (GOOD, '[mesh]\nfile = "slab.geo"', ""),
        (GOOD, "[mesh]", "accuracy = 2\n[mesh]"),
        (GOOD, "[mesh]", "[accuracy]\nmax_level = 3\n[mesh]"),
        (GOOD, "[mesh]", "[accuracy]\n'left.reaction' = 3\n[mesh]"),
        (GOOD, "[mesh]", "[steps]\nnumber = 0\n[mesh]"),
        (GOOD, "[mesh]", "[[solver]]\n[mesh]"),
        (PUNCH, "radius = 8", "radus = 8"),
        (PUNCH, "radius = 8", "radius = -8"),
        (PUNCH, '"cylinder"', '"ball"'),
        (PUNCH, "1e-8", '"soft"'),
    ],
)
def test_what_is_wrong_with_a_scene_is_refused(text, old, new):
    assert errors(text) == []
    if new is not None:
        assert old in text
        assert errors(text.replace(old, new, 1)) != []


def test_every_table_is_closed_and_every_key_is_described():
    def check(table, schema, name):
        assert schema["additionalProperties"] is False or name == "Accuracy"
        assert len(schema["description"]) > 20 and ">>>" not in schema["description"]
        assert list(schema["properties"]) == [key.name for key in keys_of(table)]
        for key in keys_of(table):
            assert len(schema["properties"][key.name]["description"]) > 5, (name, key.name)
            for below in key.tables:
                check(below, SCHEMA["$defs"][below.__name__], below.__name__)

    check(Scene, SCHEMA, "Scene")
    assert SCHEMA["$defs"]["Path"]["additionalProperties"] is False


def test_defaults_are_those_of_the_classes():
    for name in ("Contact", "Steps", "SolverSettings", "MeshSource"):
        (made,) = (
            table for key in keys_of(Scene) for table in key.tables if table.__name__ == name
        )
        for field in dataclasses.fields(made):
            shown = SCHEMA["$defs"][name]["properties"][field.name].get("default")
            if isinstance(field.default, int | float | str) and field.default != "":
                assert shown == field.default, (name, field.name)


def test_the_command_prints_it(capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
