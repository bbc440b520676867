"""Scenes go to other processes where their functions do."""

import dataclasses
import pickle

import pytest

from fenics_contact import Contact, MeshSource, Path, Profile
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


def test_a_function_without_a_name_is_named():
    with pytest.raises((pickle.PicklingError, AttributeError), match="<lambda>"):
        pickle.dumps(scene_with(lambda x: x[0]))
