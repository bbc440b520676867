"""Scenes go to other processes where their functions do, and results come back."""

import dataclasses
import pickle

import pytest

from fenics_contact import Contact, MeshSource, Path, Profile, run
from tests.scenes import box_body, slab


def uneven(points):
    return 100 + points[0]


def grows(time):
    return time**2


def scene_with(pressure, path=grows):
    contact = Contact("top", pressure=pressure, friction_coefficient=0.3, pressure_path=path)
    return dataclasses.replace(slab(), mesh=(MeshSource("slab.geo"),), contact=(contact,))


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
@pytest.mark.parametrize("pressure", [300.0, uneven, Profile("x", at=(0, 8), values=(1, 2))])
def test_a_scene_with_functions_of_a_module_comes_back(pressure, protocol):
    for path in (grows, Path(time=(0, 1), factor=(0, 1))):
        scene = scene_with(pressure, path)
        found = pickle.loads(pickle.dumps(scene, protocol))
        assert found == scene and type(found.contact[0]) is Contact


def test_a_function_without_a_name_is_named():
    with pytest.raises((pickle.PicklingError, AttributeError), match="<lambda>"):
        pickle.dumps(scene_with(lambda x: x[0]))


def test_a_result_comes_back():
    """With its checks, errors, load steps and points."""
    scene = dataclasses.replace(slab(), mesh=())
    names = {"bottom": "y0", "top": "y1", "left": "x0", "right": "x1"}
    scene = dataclasses.replace(
        scene,
        support=tuple(dataclasses.replace(one, on=names[one.on]) for one in scene.support),
        load=tuple(dataclasses.replace(one, on=names[one.on]) for one in scene.load),
        contact=tuple(dataclasses.replace(one, on=names[one.on]) for one in scene.contact),
    )
    result = run(scene, body=box_body((8, 2), (8, 1)))
    found = pickle.loads(pickle.dumps(result))
    assert type(found) is type(result) and found.as_dict() == result.as_dict()
    assert repr(found) == repr(result) and found.passed == result.passed
    assert found.points is not None and result.points is not None
    assert (found.points.contact_pressure == result.points.contact_pressure).all()
