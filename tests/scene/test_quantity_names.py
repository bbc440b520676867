"""Quantities by their names: what an accuracy may ask for, and what it is over."""

import dataclasses
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Material,
    Obstacle,
    Point,
    Run,
    Scene,
    Support,
    run,
)
from fenics_contact.scene.quantity_names import QuantityName
from fenics_contact.scene.reading import scene_of_text
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.adaptive.targets import asked_of, relative_errors
from tests.messages import refused
from tests.records import made_result
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FILE = Path("named.toml")
TEXT = """
kinematics = "plane strain"
mesh = { file = "own.geo" }
material = { youngs_modulus = 1000, poissons_ratio = 0.3 }
symmetry = ["bottom"]
support = [
    { on = "left", displacement = { x = 0, y = 0 } },
    { on = "front", name = "upper.lid", displacement = { x = 0 } },
    { on = "back", name = "left", displacement = { x = 0 } },
]
point = [{ name = "a", at = [0, 0] }, { name = "a_x", at = [0, 1] }, { name = "b", at = [1, 1] }]
contact = [
    { on = "top", name = "upper.contact", obstacle = { shape = "plane" } },
    { on = "left", obstacle = { shape = "plane" } },
]
"""


def asked(table):
    return scene_of_text(f"{TEXT}[accuracy]\n{table}\n", FILE).accuracy.asked([])


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ('"left.reaction" = 1e-2', {"left.reaction": 0.01}),
        ("left.reaction = 1e-2", {"left.reaction": 0.01}),
        ('"upper.contact".normal_force = 0.1', {"upper.contact.normal_force": 0.1}),
        ("upper.contact.friction_force_x = 0.1", {"upper.contact.friction_force_x": 0.1}),
        ('upper."lid.reaction_y" = 0.1', {"upper.lid.reaction_y": 0.1}),
        ("bottom.reaction = 0.1", {"bottom.reaction": 0.1}),  # of a plane of symmetry
        ("left.normal_force = 0.1", {"left.normal_force": 0.1}),  # the contact of that name
        ("displacement_b = 0.1", {"displacement_b": 0.1}),
        ("displacement_a_y = 0.1", {"displacement_a_y": 0.1}),
        ("reaction_x = 0.1", {"reaction_x": 0.1}),
        ('main = 0.2\nof = { "left.reaction" = 0.1 }', {"left.reaction": 0.1}),
        ("normal_force = 0.2\nleft.reaction = 0.1", {"normal_force": 0.2, "left.reaction": 0.1}),
    ],
)
def test_quotes_dots_and_of_mean_the_same(table, expected):
    assert asked(table) == expected
    scene = scene_of_text(f"{TEXT}[accuracy]\n{table}\n", FILE)
    assert scene_of_text(scene_text(scene), FILE).accuracy == scene.accuracy


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("left.reaction_z = 0.1", "accuracy_of_reaction_z"),
        ("lft.reaction = 0.1", "accuracy_of_lft"),
        ("upper.lid.reactoin = 0.1", "accuracy_of_reactoin"),
        ("upper.lid.normal_force = 0.1", "accuracy_of_force_of_a_support"),
        ("upper.contact.reaction = 0.1", "accuracy_of_reaction_of_a_contact"),
        ("displacement_c = 0.1", "accuracy_of_displacement_c"),
        ("displacement_a_x = 0.1", "accuracy_of_two_points"),
        ("left.reaction = 2", "accuracy_is_2"),
        ("left.reaction = true", "accuracy_is_true"),
        ('left.reaction = 0.1\n"left.reaction" = 0.1', "accuracy_given_twice"),
        ("left = {}", "accuracy_table_is_empty"),
        ("of.normal_force = 0.1", "accuracy_key_in_of"),
        ("of = 1", "accuracy_of_is_no_table"),
        ('".reaction" = 0.1', "accuracy_of_an_empty_name"),
        ("normal_forc = 0.1", "unknown_key_normal_forc"),
        ("max_level = 3", "unknown_key_max_level"),
        ("max_dofs = 300", "max_dofs_without_accuracy"),
    ],
)
def test_what_is_not_there_is_refused_in_one_sentence(table, message):
    with refused(message):
        asked(table)


def test_names_that_cannot_be_read_are_refused():
    for name in (" a", "a\n", "\x1b[2J"):
        with refused("name_not_printable", ValueError, written=repr(name)):
            Support("left", {"x": 0}, name=name)
    for name, said in (("", "name_is_empty"), (3, "name_is_a_number")):
        with refused(said, ValueError):
            Support("left", {"x": 0}, name=name)
    assert Support("left", {"x": 0}, name="upper wall é").label == "upper wall é"
    assert Support("left", {"x": 0}).label == "left"


def pressed(**accuracy):
    """Two parabolas on a block, one to each side of its middle, the right one deeper."""
    heights = {"left": (0.25, 0.01), "right": (0.75, 0.02)}
    patches = {"left": ("y1", lambda x: x[0] < 0.5), "right": ("y1", lambda x: x[0] > 0.5)}
    contacts = tuple(
        Contact(on, obstacle=Obstacle("parabola", radius=1, position=(x, 1), indentation=depth))
        for on, (x, depth) in heights.items()
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}, name="floor"),),
        point=(Point("middle", (0.5, 1.0)),),
        contact=contacts,
        accuracy=Accuracy(**accuracy) if accuracy else None,
    )
    return scene, box_body((8, 4), (1, 1), patches=patches)


def test_a_force_is_asked_of_each_contact():
    prepared = Run(*pressed_with(COMM, normal_force=0.1, of={"right.normal_force": 0.02}))
    assert asked_of(prepared) == {"left.normal_force": 0.1, "right.normal_force": 0.02}
    prepared = Run(*pressed_with(COMM, main=0.1))
    assert asked_of(prepared) == {
        "left.normal_force": 0.1,
        "right.normal_force": 0.1,
        "max_contact_pressure": 0.1,
        "contact_area": 0.1,
    }
    prepared = Run(*pressed_with(COMM, of={"friction_force_x": 0.1}))
    assert set(asked_of(prepared)) == {"left.friction_force_x", "right.friction_force_x"}


def pressed_with(comm, **accuracy):
    scene, body = pressed(**accuracy)
    return scene, comm, body


def test_what_a_scene_has_not_is_refused():
    with refused("contact_radius_needs_an_axis"):
        asked_of(Run(*pressed_with(COMM, contact_radius=0.1)))
    scene, body = pressed()
    bare = dataclasses.replace(
        scene,
        contact=(),
        support=(*scene.support, Support("y1", {"y": -0.01})),
        accuracy=Accuracy(normal_force=0.1),
    )
    with refused("normal_force_needs_a_contact"):
        asked_of(Run(bare, COMM, body))
    bare = dataclasses.replace(scene, contact=(Contact("left", pressure=1),))
    bare = dataclasses.replace(bare, accuracy=Accuracy(indentation=0.1))
    with refused("indentation_needs_an_obstacle"):
        asked_of(Run(bare, COMM, body))


def found(**changed):
    """A result with made-up numbers: a contact carries 100, supports a and b 99 and 0."""
    row = {"mesh": 0.1, "total": 0.1}
    contact = {
        "name": "top",
        "quantities": {"normal_force": None, "pressure_integral": 100.0, "friction_force": [3, 4]},
        "errors": {"pressure_integral": row, "friction_force": row},
    }
    quantities = {"strain_energy": 5.0, "displacement_tip": [0.0, 0.0], "reaction": [60.0, 80.0]}
    reactions = {
        "a": {"reaction": [0.0, 99.0], "errors": {"reaction": row}},
        "b": {"reaction": [0.0, 0.0], "errors": {"reaction": row}},
        "c": {"reaction": [1.0, 0.0]},
    }
    filled = {
        "title": "", "converged": True, "verdict": "", "model": {}, "steps": [], "checks": {},
        "contacts": [contact], "quantities": quantities, "reactions": reactions,
        "errors": {"displacement_tip": row, "reaction": row},
    }  # fmt: skip
    return made_result(**filled | changed)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a.reaction", 0.1 / 99),
        ("a.reaction_x", 0.1 / 99),  # a component that is zero: over its vector
        ("b.reaction", 0.1),  # nothing: over a hundredth of the largest force
        ("c.reaction", None),
        ("reaction_x", 0.1 / 100),
        ("top.normal_force", 0.1 / 100),  # there is no axis: that of the integral
        ("top.friction_force", 0.1 / 100),  # over the normal force
        ("top.friction_force_y", 0.1 / 100),
        ("displacement_tip", 0.1 / (0.01 * 2 * 5.0 / 100)),  # 2 W / F goes with the largest force
        ("top.max_slip", None),
    ],
)
def test_errors_are_over_what_measures_them(name, expected):
    names = dataclasses.replace(
        pressed()[0].names, contacts=("top",), supports=("a", "b", "c"), points=("tip",)
    )
    errors = relative_errors(found(), {name: 0.1}, names)[name]
    assert errors["total"] == (expected if expected is None else pytest.approx(expected))


@pytest.mark.errors
def test_what_an_answer_has_not_is_said():
    """A plane that presses a ring: there is no contact at the axis."""
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("ring", obstacle=Obstacle("plane", indentation=0.01)),),
        accuracy=Accuracy(of={"ring.contact_radius": 0.1}),
    )
    body = box_body((4, 4), (1, 1), patches={"ring": ("y1", lambda x: x[0] > 0.5)})
    found = run(scene, COMM, body)
    assert found.exit_code == 3
    assert found.accuracy["reason"] == "the answer has no contact radius of ring"


def test_a_name_is_what_follows_the_last_dot():
    names = dataclasses.replace(pressed()[0].names, supports=("a.b", "a"))
    assert names.find("a.b.reaction_y") == QuantityName("a.b", "reaction", 1)
    assert names.find("a.reaction") == QuantityName("a", "reaction")
