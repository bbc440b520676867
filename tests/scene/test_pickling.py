"""Scenes go to other processes where their functions do; a sentence names one that does not."""

import copy
import dataclasses
import pickle
import sys
import types

import pytest

from fenics_contact import Contact, Load, MeshSource, Path, Profile, Support
from tests.scenes import slab


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


@pytest.mark.parametrize(
    ("thing", "where"),
    [
        (scene_with(lambda x: x[0]), "Contact.pressure"),
        (scene_with(1.0, path=lambda t: t), "Contact.pressure_path"),
        (Load("right", traction=(lambda x: x[0], 0)), "Load.traction"),
        (Support("left", displacement={"x": lambda x: x[0]}), "Support.displacement"),
    ],
)
def test_a_function_without_a_name_is_refused_in_a_sentence(thing, where):
    words = rf"^{where} is a function that cannot be pickled, .*<lambda>: define it by def at"
    with pytest.raises(pickle.PicklingError, match=words):
        pickle.dumps(thing)


def test_it_is_copied_all_the_same():
    scene = scene_with(lambda x: x[0])
    assert copy.copy(scene) == copy.deepcopy(scene) == scene
    held = Support("left", displacement={"x": 0.0})
    assert copy.deepcopy(held).displacement is not held.displacement


def test_what_pickles_any_function_may(monkeypatch):
    monkeypatch.setitem(sys.modules, "cloudpickle", types.ModuleType("cloudpickle"))
    contact = Contact("top", pressure=lambda x: x[0])
    assert contact.__reduce_ex__(5)
