"""A body that is made ready once serves any conditions, one after the other."""

import dataclasses

import numpy as np
import pytest

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    Obstacle,
    Path,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.body.description import BodyDescription
from fenics_contact.problem.discrete_body import DiscreteBody
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.load_steps.load_stepper import solve
from tests.messages import refused
from tests.solve.load_steps.histories import block, dragged, shoved, two_blocks

ONE = dragged(Steps(number=2))
TWO = shoved(Steps(times=(0.5, 0.7, 0.9)))


def with_contact(scene, **changes):
    return dataclasses.replace(scene, contact=(dataclasses.replace(scene.contact[0], **changes),))


def other_obstacle(scene, **changes):
    obstacle = dataclasses.replace(scene.contact[0].obstacle, **changes)
    return with_contact(scene, obstacle=obstacle)


def pushed(scene):
    supports = (Support("y0", {"x": 1e-4, "y": lambda x: -1e-4 * x[0]}, path=Path((0, 1), (1, 1))),)
    return dataclasses.replace(scene, support=supports, load=(Load("x0", traction=(3, 0)),))


CONDITIONS = {
    "coefficient": (ONE, with_contact(ONE, friction_coefficient=0.7)),
    "law": (ONE, with_contact(ONE, law="static", penalty_parameter=1e-7)),
    "foundation": (ONE, with_contact(ONE, contact="winkler", foundation_stiffness=1e4)),
    "obstacle": (ONE, other_obstacle(ONE, radius=2, position=(0.4, 1), shape="cylinder")),
    "force": (ONE, other_obstacle(ONE, indentation=None, force=5)),
    "values and loads": (ONE, pushed(ONE)),
    "solver": (
        ONE,
        dataclasses.replace(ONE, steps=Steps(), solver=SolverSettings(strategy="monolithic")),
    ),
    "two bodies": (TWO, with_contact(TWO, friction_coefficient=0.05)),
}


def answer(problem):
    found = solve(problem).displacement
    assert np.array_equal(found.ravel(), problem.displacement.x.array)
    return found


@pytest.mark.parametrize("name", CONDITIONS)
def test_other_conditions_on_a_body_that_was_used_give_the_answer_of_a_new_one(name):
    scene, other = CONDITIONS[name]
    body = two_blocks() if name == "two bodies" else block()
    assert BodyDescription.of(scene) == BodyDescription.of(other)
    discrete = DiscreteBody(BodyDescription.of(scene), body)
    first = answer(Problem(scene, discrete))
    second = answer(Problem(other, discrete))
    expected = answer(Problem.on_mesh(other, body))
    assert np.abs(second - expected).max() <= 1e-9 * np.abs(expected).max()
    assert name == "solver" or np.abs(first - second).max() > 1e-4 * np.abs(second).max()


def test_mean_stress_of_a_nearly_incompressible_body_is_found_anew():
    scene = dragged(Steps(), solid=0.4999)
    other = other_obstacle(scene, indentation=0.01)
    body = block()
    discrete = DiscreteBody(BodyDescription.of(scene), body)
    answer(Problem(scene, discrete))
    used, new = Problem(other, discrete), Problem.on_mesh(other, body)
    assert answer(used) == pytest.approx(answer(new), abs=1e-10)
    ours, expected = (each.elastic.mixed.mean_stress.x.array for each in (used, new))
    assert np.abs(ours - expected).max() <= 1e-8 * np.abs(expected).max()


OTHER_BODIES = {
    "material": dataclasses.replace(ONE, material=Material(1000, 0.25)),
    "degree": dataclasses.replace(ONE, discretisation=Discretisation(1)),
    "held": dataclasses.replace(ONE, support=(Support("y0", {"y": 0}), *ONE.support)),
    "symmetry": dataclasses.replace(ONE, symmetry=("x0",)),
    "outer": dataclasses.replace(ONE, half_space=HalfSpace(("x0",))),
    "contacts": dataclasses.replace(ONE, contact=(Contact("x1", obstacle=Obstacle("plane")),)),
    "kinematics": dataclasses.replace(ONE, kinematics="plane stress"),
}


@pytest.mark.parametrize("name", OTHER_BODIES)
def test_a_scene_of_another_body_is_refused_by_what_is_other(name):
    discrete = DiscreteBody(BodyDescription.of(ONE), block())
    with refused("body_is_another", part=name):
        Problem(OTHER_BODIES[name], discrete)


def test_a_name_is_no_part_of_the_body():
    named = with_contact(ONE, name="wheel")
    assert BodyDescription.of(named) == BodyDescription.of(ONE)
