"""Which numbers of a scene are moved on a page, and between what."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Load,
    NormalCompliance,
    Obstacle,
    Path,
    Preload,
    Profile,
    Spring,
    Steps,
    Study,
    Support,
    SupportAxes,
    Units,
    load_scene,
)
from fenics_contact.explore.keys import moved_keys, numbers_of
from fenics_contact.simulation.sensitivities.scene_values import with_changes
from tests.messages import refused
from tests.scenes import ROOT, box_body, slab


def study(scene):
    return Study(scene, MPI.COMM_SELF)


def ranges(scene, asked=()):
    return {one.key: (one.low, one.high) for one in moved_keys(study(scene), asked)}


def test_ranges_follow_from_what_the_numbers_are():
    """Half to one and a half of what has a unit; a pure number from 0 to 1, or to twice itself."""
    scene = load_scene(ROOT / "demos" / "sphere.toml")
    assert ranges(scene) == {
        "contact.0.obstacle.radius": (4, 12),
        "contact.0.obstacle.indentation": (0.5, 1.5),
        "contact.0.friction_coefficient": (0, pytest.approx(1.2)),
    }
    assert ranges(slab()) == {
        "contact.0.pressure": (150, 450),
        "contact.0.friction_coefficient": (0, 1),
        "load.0.traction.0": (-450, -150),
    }


def test_directions_places_paths_functions_and_zeros_are_not_chosen():
    obstacle = Obstacle(
        shape="parabola", radius=2, position=(1, 3), normal=(0.1, -1), displacement=(0.2, 0)
    )
    law = NormalCompliance(kind="normal compliance", coefficient=4e4, exponent=2)
    scene = dataclasses.replace(
        slab(),
        load=(Load("right", pressure=Profile("y", (0, 1), (1, 2)), path=Path((0, 2), (0, 1))),),
        support=(Support("left", {"x": 0.5, "y": lambda x: x[0]}),),
        contact=(Contact("top", obstacle=obstacle, normal_law=law, interference=0.5),),
        steps=Steps(number=2),
    )
    assert ranges(scene) == {
        "contact.0.obstacle.radius": (1, 3),
        "contact.0.obstacle.displacement.0": (pytest.approx(0.1), pytest.approx(0.3)),
        "contact.0.normal_law.coefficient": (2e4, 6e4),
        "contact.0.normal_law.exponent": (1, 4),
        "contact.0.interference": (0.25, 0.75),
        "contact.0.friction_coefficient": (0, 1),
        "load.0.pressure.values.0": (0.5, 1.5),
        "load.0.pressure.values.1": (1, 3),
        "support.0.displacement.x": (0.25, 0.75),
    }


def test_what_makes_another_body_is_moved_only_when_asked_for():
    scene = load_scene(ROOT / "demos" / "joint.toml")
    chosen = {one.key: one for one in moved_keys(study(scene))}
    assert "preload.0.force" in chosen
    assert not [key for key in chosen if "between" in key or "locked_from" in key]
    asked = moved_keys(study(scene), ["material.2.youngs_modulus=1e5:3e5", "preload.0.force=1:2e4"])
    assert [one.makes_anew for one in asked] == [True, False]
    assert asked[0].number.of == "material 'bolt_M8'"


def test_labels_and_units_are_those_of_the_scene():
    scene = dataclasses.replace(slab(), units=Units("mm", "N"))
    found = {one.key: one.number for one in moved_keys(study(scene))}
    traction = found["load.0.traction.0"]
    assert (traction.label, traction.of) == ("traction x", "load 'right'")
    assert (traction.unit(scene), traction.unit(slab())) == ("MPa", "stress")
    assert found["contact.0.friction_coefficient"].unit(scene) == ""
    assert "Coulomb's coefficient" in found["contact.0.friction_coefficient"].meaning


def test_one_material_and_one_mesh_are_named_with_and_without_their_number():
    for key in ("material.youngs_modulus", "material.0.youngs_modulus"):
        assert ranges(slab(), [f"{key}=500:2000"]) == {"material.0.youngs_modulus": (500, 2000)}
    (one,) = moved_keys(study(slab()), {"mesh.parameters.cells_along": (8, 32)})
    assert one.makes_anew and one.number.of == "mesh 0"


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ("contact.0.friction=0:1", "vary_friction"),
        ("contact.7.friction_coefficient=0:1", "vary_contact_7"),
        ("contact.0.on=0:1", "vary_a_group"),
        ("contact.0.penalty_parameter=1:2", "vary_an_automatic_number"),
        ("contact.0=0:1", "vary_a_table"),
        ("contact.0.obstacle=0:1", "vary_an_empty_table"),
        ("contact.0.friction_coefficient=1:0", "vary_from_1_to_0"),
        ("contact.0.friction_coefficient=1:1", "vary_from_1_to_1"),
        ("contact.0.friction_coefficient=0:nan", "vary_to_nan"),
        ("contact.0.friction_coefficient=-1:1", "vary_from_a_negative_coefficient"),
        ("contact.0.friction_coefficient=a:1", "vary_from_a_letter"),
        ("contact.0.friction_coefficient=0,1", "vary_two_values"),
        ("contact.0.friction_coefficient", "vary_without_range"),
        ("discretisation.degree=1:1.5", "vary_degree_to_a_fraction"),
    ],
)
def test_a_key_or_range_that_is_none_is_refused(asked, said):
    with refused(said):
        moved_keys(study(dataclasses.replace(slab(), load=(Load("right", pressure=1),))), [asked])


def test_a_key_given_twice_and_python_s_ranges():
    twice = ["load.0.traction.0=-2:-1"] * 2
    with refused("vary_a_key_twice"):
        moved_keys(study(slab()), twice)
    assert ranges(slab(), {"load.0.traction.0": (-2, -1)}) == {"load.0.traction.0": (-2, -1)}
    with refused("range_is_no_pair"):
        moved_keys(study(slab()), {"load.0.traction.0": 3})


def test_a_scene_without_such_numbers_says_so():
    scene = dataclasses.replace(slab(), load=(), contact=())
    with refused("nothing_to_vary"):
        moved_keys(Study(scene, MPI.COMM_SELF, box_body((1, 1), (1, 1))))


def test_values_of_a_request_are_in_their_range():
    (one,) = moved_keys(study(slab()), ["contact.0.friction_coefficient=0:0.2"])
    assert one.start == 0.2  # the scene's .3 is beyond
    assert one.taken(0.1) == 0.1
    for wrong in (0.21, -1, float("nan"), float("inf"), 10**400):
        with refused("number_beyond_its_range", ValueError):
            one.taken(wrong)
    for wrong in (True, "0.1", None, [0.1]):
        with refused("number_is_none", ValueError):
            one.taken(wrong)
    (degree,) = moved_keys(study(slab()), ["discretisation.degree=1:2"])
    assert isinstance(degree.taken(2.0), int)
    with refused("degree_is_no_whole_number", ValueError):
        degree.taken(1.5)


def test_every_number_of_every_demo_can_be_found_by_its_key():
    """What is written of a number's key is what a study changes."""
    for path in sorted((ROOT / "demos").glob("*.toml")):
        scene = load_scene(path)
        for key, number in numbers_of(scene).items():
            assert numbers_of(with_changes(scene, {key: number.value}))[key].value == number.value


def test_preloads_are_moved():
    scene = dataclasses.replace(slab(), preload=(Preload("bolt", (1, 0), 40),))
    assert ranges(scene)["preload.0.force"] == (20, 60)


def test_couplings_springs_and_frames_are_moved():
    """Springs, which make another body, when they are asked for; a wall that is at 0, likewise."""
    held = (
        Support("left", normal=0.0),
        Support("bottom", foundation_stiffness={"y": 50.0}, axes=SupportAxes(x=(0.8, 0.6))),
    )
    scene = dataclasses.replace(
        slab(),
        support=held,
        load=(Load("right", force=(3.0, 0.0), at=(4.0, 1.0)),),
        coupling=(Coupling("right", kind="distributing", name="end", moment=2.0),),
        spring=(Spring(("end", "ground"), {"x": 100.0}, gap=0.1),),
    )
    chosen = ranges(scene)
    assert chosen["load.0.force.0"] == (1.5, 4.5) and chosen["coupling.0.moment"] == (1, 3)
    asked = {
        "spring.0.stiffness.x": True,
        "spring.0.gap": True,
        "support.1.foundation_stiffness.y": True,
        "support.0.normal": False,
        "load.0.at.1": False,
    }
    assert not set(asked) & set(chosen)
    found = moved_keys(study(scene), {key: (0.01, 0.2) for key in asked})
    assert {one.key: one.makes_anew for one in found} == asked
