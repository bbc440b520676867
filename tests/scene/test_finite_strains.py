"""What finite strains need, and what does not go with them yet, is said in one sentence each."""

import dataclasses

import pytest

from fenics_contact import (
    Accuracy,
    Contact,
    HalfSpace,
    Load,
    Material,
    MicroSlipFriction,
    Modes,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    Wear,
    run,
)
from fenics_contact.common.errors import SceneError
from tests.messages import refused
from tests.scenes import box_body

MICRO_SLIP = MicroSlipFriction(kind="micro-slip", elastic_slip=1e-3)
PLANE = Obstacle(shape="plane", position=(0, 0), normal=(0, 1))
FINITE = Scene(
    kinematics="plane strain",
    strains="finite",
    material=Material(1.0, 0.3, law="neo-Hookean"),
    support=(Support("y1", {"x": 0, "y": -0.1}),),
    contact=(Contact("y0", obstacle=PLANE),),
)


def rubber(**changes):
    return dataclasses.replace(Material(1.0, 0.3, law="neo-Hookean"), **changes)


def contact(**changes):
    return {"contact": (Contact("y0", **{"obstacle": PLANE, **changes}),)}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"strains": "small"}, "stored_energy_in_small_strains"),
        ({"kinematics": "plane stress"}, "finite_strains_in_plane_stress"),
        ({"material": rubber(law=None)}, "finite_strains_without_law"),
        ({"material": rubber(poissons_ratio=0.49)}, "finite_strains_incompressible"),
        ({"material": (rubber(on="a"), rubber(on="b", law="Hencky"))}, "two_stored_energies"),
        ({"half_space": HalfSpace(on=("y1",)), "support": ()}, "finite_strains_of_half_space"),
        ({"accuracy": Accuracy(main=0.01)}, "finite_strains_with_accuracy"),
        ({"modes": Modes(2)}, "finite_strains_with_modes"),
        ({"solver": SolverSettings(solver="full")}, "finite_strains_with_full_solver"),
        ({"solver": SolverSettings(errors="all")}, "finite_strains_with_all_errors"),
        ({"support": (Support("y1", stiffness={"y": 1.0}),)}, "finite_strains_on_springs"),
        ({"load": (Load("x1", pressure=1.0),)}, "finite_strains_under_pressure"),
        (contact(against="x1", obstacle=None), "finite_strains_between_bodies"),
        (contact(foundation_stiffness=1.0), "finite_strains_on_foundation"),
        (contact(interference=0.1), "finite_strains_with_interference"),
        (contact(wear=Wear(coefficient=1e-3)), "finite_strains_with_wear"),
        (contact(penalty_parameter=1e-3), "finite_strains_with_penalty"),
        (
            {**contact(friction_coefficient=0.3), "steps": Steps(number=2)},
            "finite_strains_with_static_friction",
        ),
        (contact(obstacle=None), "finite_strains_without_shape"),
        (contact(obstacle=Obstacle("flat punch", radius=1, normal=(0, 1))), "finite_flat_punch"),
        (contact(obstacle=Obstacle("plane")), "finite_strains_without_normal"),
        (
            contact(obstacle=Obstacle("plane", normal=(0, 1), force=1.0)),
            "finite_strains_under_force",
        ),
    ],
)
def test_what_cannot_be_had_is_said(change, words):
    with refused(words, SceneError):
        dataclasses.replace(FINITE, **change)


def test_a_friction_law_of_its_own_is_refused():
    with refused("finite_strains_with_friction_law", SceneError):
        dataclasses.replace(
            FINITE, **contact(friction_coefficient=0.3, friction_law=MICRO_SLIP, law="incremental")
        )


def test_a_body_that_supports_leave_free_is_refused():
    scene = dataclasses.replace(FINITE, support=(Support("y1", {"y": -0.1}),))
    with refused("finite_strains_of_free_body"):
        run(scene, body=box_body((2, 2)))


def test_a_study_is_refused():
    with refused("study_of_finite_strains"):
        Study(FINITE, body=box_body((2, 2)))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"law": "Yeoh"}, "yeoh_without_constants"),
        ({"law": "neo-Hookean", "constants": {"c10": 1.0}}, "constants_of_neo_hookean"),
        (
            {"law": "Mooney-Rivlin", "constants": {"c10": 1.0, "c01": 0.1}},
            "modulus_beside_constants",
        ),
    ],
)
def test_constants_belong_to_their_law(given, words):
    with refused(words, SceneError):
        Material(1.0, 0.3, **given)


def test_constants_give_a_shear_modulus_above_0():
    with refused("constants_of_no_shear", SceneError):
        Material(poissons_ratio=0.3, law="Mooney-Rivlin", constants={"c10": 1.0, "c01": -2.0})


def test_the_modulus_follows_from_constants():
    rubbery = Material(poissons_ratio=0.25, law="Mooney-Rivlin", constants={"c10": 1, "c01": 0.5})
    assert rubbery.modulus == pytest.approx(2 * 1.25 * 3)
