"""What of a scene a saved state depends on: what is given, and not what has its default."""

import dataclasses
import functools
from typing import Annotated

import numpy as np
import pytest
from pydantic import Field

from fenics_contact import (
    Contact,
    Cycles,
    Load,
    Material,
    Motion,
    Obstacle,
    Path,
    Profile,
    Scene,
    SlipDependentFriction,
    SolverSettings,
    Steps,
    Support,
    Wear,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.scene.given_keys import FREE_AT_RESUME
from fenics_contact.scene.values import Number, scene_class
from fenics_contact.simulation import fingerprint
from tests.scenes import box_body

WEAKENING = SlipDependentFriction("slip dependent", slips=(0, 1), shares=(1, 0.5))
SCENE = Scene(
    kinematics="plane strain",
    material=Material(1, 0.3),
    support=(Support("y0", {"x": 0}, path=Path((0, 1), (1, 1))),),
    load=(Load("y1", pressure=1, path=Path((0, 0.5, 1, 1.5, 2), (0, 1, 1, 0, 1))),),
    contact=(
        Contact(
            "x1",
            obstacle=Obstacle("plane", position=(1, 0)),
            friction_coefficient=Profile("y", (0, 1), (0.1, 0.2)),
            friction_law=WEAKENING,
            law="incremental",
            wear=Wear(1e-6),
        ),
    ),
    cycles=Cycles(end=2, begin=1, increments=4, until="end"),
    steps=Steps(end=1),
)


@pytest.fixture(scope="module")
def of_scene():
    return functools.partial(fingerprint.of_scene, body=box_body((1, 1)))


def with_more_keys(kind):
    """A class of scenes with keys more, as a later version of the program might have it."""

    class Later(kind):
        __module__ = kind.__module__  # where pydantic 2.10 looks for what annotations name
        new_number: Annotated[Number, Field(description="of later")] = 1.5
        new_numbers: Annotated[tuple[Number, ...], Field(description="of later")] = ()
        new_names: Annotated[dict[str, Number], Field(description="of later")] = Field(
            default_factory=dict
        )
        new_path: Annotated[Path, Field(description="of later")] = Path((0, 1), (0, 1))
        new_asked: Annotated[Number, FREE_AT_RESUME, Field(description="of later")] = 1.0

    Later.__name__ = kind.__name__
    return scene_class(Later)


MORE = {
    "new_number": 2.0,
    "new_numbers": (1.5,),
    "new_names": {"a": 1.0},
    "new_path": Path((0, 2), (0, 1)),
}


def remade(table, **changes):
    """The same table, of a class with more keys."""
    given = {key.name: getattr(table, key.name) for key in dataclasses.fields(table)}
    return with_more_keys(type(table))(**given | changes)


def scene_with(place, **changes):
    """The scene, with a table at a place of a class with more keys."""

    def changed(part, way):
        if isinstance(part, tuple):
            return (changed(part[0], way), *part[1:])
        if not way:
            return remade(part, **changes)
        return dataclasses.replace(part, **{way[0]: changed(getattr(part, way[0]), way[1:])})

    return changed(SCENE, place.split(".") if place else [])


PLACES = {
    "": None,
    "material": "material",
    "support": "support",
    "cycles": "cycles",
    "contact": "contact",
    "contact.obstacle": "contact",
    "contact.wear": "contact",
    "contact.friction_law": "contact",
    "contact.friction_coefficient": "contact",
    "support.path": "support",
}


@pytest.mark.parametrize(("place", "key"), PLACES.items())
def test_a_new_key_counts_where_it_is_given(place, key, of_scene):
    """Also inside lists of tables and tables of tables; and in the description of the body."""
    before = of_scene(SCENE)
    assert of_scene(scene_with(place)) == before
    assert of_scene(scene_with(place, new_asked=3.0)) == before
    for name, value in MORE.items():
        found = of_scene(scene_with(place, **{name: value}))
        assert fingerprint.differences(before, found) == [key or name]
        assert fingerprint.differences(found, before) == [key or name]


def test_a_new_key_of_materials_is_one_of_the_body():
    body = box_body((1, 1))
    before, after, given = (
        fingerprint.of_body(BodyDescription.of(scene), body)
        for scene in (SCENE, scene_with("material"), scene_with("material", new_number=2.0))
    )
    assert before == after
    assert fingerprint.differences(before, given) == ["material"]


def test_a_default_that_is_given_is_none_that_counts(of_scene):
    (contact,) = SCENE.contact
    said = dataclasses.replace(contact, slave="auto", interference=0.0, penalty_parameter="auto")
    assert of_scene(dataclasses.replace(SCENE, contact=(said,), thickness=None)) == of_scene(SCENE)


def test_keys_that_are_free(of_scene):
    """How an answer is computed and what is asked of it, at the top and inside tables."""
    (contact,) = SCENE.contact
    cycles = dataclasses.replace(SCENE.cycles, number=7, increments=8, tolerance=1e-2)
    changed = dataclasses.replace(
        SCENE,
        title="x",
        steps=Steps(number=3, end=1),
        cycles=cycles,
        solver=SolverSettings("lagged"),
    )
    assert of_scene(changed) == of_scene(SCENE)
    later = dataclasses.replace(SCENE.cycles, begin=0.5)
    assert fingerprint.differences(
        of_scene(dataclasses.replace(SCENE, cycles=later)), of_scene(SCENE)
    ) == ["cycles"]
    motion = Motion(step=0.1, end=1)
    assert fingerprint.keys_of_state(motion) == {"step": 0.1}
    assert set(fingerprint.keys_of_state(contact.wear)) == {"coefficient"}
    assert fingerprint.keys_of_state(dataclasses.replace(contact.wear, share=0.5)) == {
        "coefficient": 1e-6
    }


@dataclasses.dataclass(frozen=True)
class Growing:
    """A function of a user's, with a value that has a default."""

    rate: float = 2.0

    def __call__(self, time):
        return self.rate * time


@dataclasses.dataclass(frozen=True)
class Shrinking(Growing):
    """Another one of the same values."""

    def __call__(self, time):
        return self.rate * (1 - time)


def test_functions_are_told_apart_by_what_they_do(of_scene):
    def with_path(path):
        load = (Load("y1", pressure=1, path=path),)
        return of_scene(dataclasses.replace(SCENE, load=load, cycles=None))["load"]

    assert with_path(lambda t: 2 * t) == with_path(lambda t: 2 * t)
    assert with_path(lambda t: 2 * t) != with_path(lambda t: 3 * t)
    assert with_path(lambda t: 2 * t) != with_path(lambda t: t - 2)
    assert with_path(scaled(2)) != with_path(scaled(3))
    assert with_path(lambda t, c=3.0: c * t) != with_path(lambda t, c=4.0: c * t)
    table = np.array([0.0, 1.0, 0.5])
    first, second = (
        functools.partial(np.interp, xp=[0, 1, 2], fp=values) for values in (table, 2 * table)
    )
    assert with_path(first) != with_path(second)
    assert with_path(folded) == with_path(folded)  # which calls itself
    assert with_path(Growing()) == with_path(Growing(2.0)) == with_path(lambda t: 2 * t)
    assert with_path(Growing()) != with_path(Growing(3.0))
    assert with_path(Growing()) != with_path(Shrinking())


def folded(t):
    return t if t <= 1 else folded(t - 1)


def scaled(factor):
    return lambda t: factor * t
