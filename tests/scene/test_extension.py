"""A key that is added to a table of scenes is a key like all others, and can be taken out again."""

import pickle
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import pytest
from pydantic import Field

from fenics_contact.common.errors import SceneError
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.reference import add_key, remove_key, render
from fenics_contact.scene.schema import scene_schema
from fenics_contact.scene.units.dimensions import LENGTH
from fenics_contact.scene.values import Positive
from fenics_contact.scene.writing import scene_text
from tests.messages import refused

TEXT = """
kinematics = "plane strain"
[mesh]
file = "slab.geo"
[units]
length = "mm"
force = "N"
[material]
youngs_modulus = "1 GPa"
poissons_ratio = 0.3
[[support]]
on = "bottom"
displacement = {{ y = 0 }}
{more}
"""
HELD = {"on": "bottom", "displacement": {"y": 0}}


def read(more):
    return scene_of_text(TEXT.format(more=more), Path("slab.toml"))


@pytest.fixture
def added():
    add_key(
        Support, "clearance", Annotated[Positive | None, LENGTH, Field(description="of the hole")]
    )
    yield
    remove_key(Support, "clearance")


@pytest.mark.usefixtures("added")
def test_files_and_python_have_it_with_its_unit():
    scene = read('clearance = "2 µm"')
    assert scene.support == (Support(**HELD, clearance=2e-3),)
    assert "clearance = 0.002" in scene_text(scene)
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert read("").support[0].clearance is None


@pytest.mark.usefixtures("added")
def test_tables_that_differ_in_it_alone_are_not_equal():
    one, other = (Support("bottom", {"y": 0}, clearance=size) for size in (1, 2))
    assert one != other and replace(other, clearance=1) == one and "clearance=1" in repr(one)


@pytest.mark.usefixtures("added")
def test_what_is_no_value_of_it_is_refused_by_name():
    with refused("clearance_is_negative", SceneError):
        Support(**HELD, clearance=-1)
    with refused("unknown_key_clearence"):
        read("clearence = 1")
    with refused("support_key_is_there_already", ValueError):
        add_key(Support, "clearance", Positive | None)


def test_reference_and_schema_have_it_until_it_is_taken_out():
    before = render(), scene_schema()
    add_key(Support, "clearance", Annotated[Positive | None, LENGTH, Field(description="a gap")])
    try:
        assert "| `clearance` | number > 0 | none | a gap (length) |" in render()
        found = scene_schema()["$defs"]["Support"]["properties"]["clearance"]
        assert found["description"] == "A gap (length)."
    finally:
        remove_key(Support, "clearance")
    assert (render(), scene_schema()) == before
    with refused("support_has_no_key_clearance", SceneError):
        Support(**HELD, clearance=1)
    with refused("unknown_key_clearance"):
        read("clearance = 1")
