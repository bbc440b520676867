"""Moments of contacts: what equilibrium asks of them, with bars and derivatives."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, Study, Support, run
from fenics_contact.common.errors import InputError, SceneError
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.torque import turned_fit
from tests.messages import refused
from tests.scenes import box_body

FORCE, MOMENT, AT = (1.0, 2.0, -30.0), (4.0, -5.0, 6.0), (0.7, 0.4, 2.0)


def glued(about=None, axis=None, **more):
    """A block in space that glue alone holds at its lower side, pushed and turned at its upper."""
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        load=(Load("z1", force=FORCE, moment=MOMENT, at=AT),),
        contact=(Contact("z0", contact="bonded", moment_about=about, axis=axis),),
        **more,
    )


def opposite(about):
    """What holds the block, about a point."""
    arm = np.array(AT) - about
    return -np.array(MOMENT) - np.cross(arm, FORCE)


@pytest.mark.parametrize("about", [(0.2, -1.0, 3.0), None])
def test_glue_holds_the_moment_of_the_loads(about):
    found = run(glued(about), body=box_body((3, 3, 3), (1, 1, 2))).quantities
    expected = opposite((0.5, 0.5, 0) if about is None else about)
    assert found["contact_moment"] == pytest.approx(expected, rel=1e-6)
    assert "torque" not in found


@pytest.mark.errors
def test_the_torque_is_that_about_the_axis_with_its_bar():
    axis, about = (1.0, -2.0, 2.0), (0.2, -1.0, 3.0)
    found = run(glued(about, axis), body=box_body((3, 3, 3), (1, 1, 2)))
    expected = opposite(about) @ axis / 3
    assert found.quantities["torque"] == pytest.approx(expected, rel=1e-6)
    assert found.errors["torque"]["total"] is not None


@pytest.mark.parametrize("kinematics", ["plane stress", "3D"])
def test_friction_of_a_turned_fit_has_the_torque_that_turns_it(kinematics):
    """Which acts as shear on the bore: 2π b² L τ."""
    scene, body = turned_fit(kinematics, 0.5)
    contact = dataclasses.replace(
        scene.contact[0],
        **({"axis": (0, 0, 2.0)} if kinematics == "3D" else {"moment_about": (0, 0)}),
    )
    applied = scene.load[0].traction[1].values[1] * 2 * np.pi * 0.5**2
    applied *= 0.5 if kinematics == "3D" else 1.0
    found = run(dataclasses.replace(scene, contact=(contact,)), body=body).quantities
    assert found["torque"] == pytest.approx(-applied, rel=1e-3)


@pytest.mark.parametrize("slave", ["on", "against"])
def test_it_is_that_on_the_body_of_on_whichever_is_the_slave(slave):
    parts = [
        Box("lower", (0, 0, 0), (1, 1, 1), (2, 2, 2)),
        Box("upper", (0, 0, 1), (1, 1, 2), (3, 3, 2)),
    ]
    contact = Contact(
        "upper.z0", against="lower.z1", slave=slave, contact="bonded", moment_about=(0, 0, 1)
    )
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("lower.z0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("upper.z1", force=(1, 2, -30), moment=(0, 0, 3)),),
        contact=(contact,),
    )
    found = run(scene, body=boxes(parts, "hexahedron")).quantities["contact_moment"]
    expected = -np.array((0, 0, 3.0)) - np.cross((0.5, 0.5, 1), (1, 2, -30))
    assert found == pytest.approx(expected, rel=1e-3)


def test_derivatives_are_those_of_differences():
    obstacle = Obstacle("paraboloid", radius=3.0, position=(0.4, 0.3, 1), indentation=0.05)
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("z0", {"x": 0, "y": 0, "z": 0}),),
        load=(Load("x1", force=(0.0, 2.0, 0.0)),),
        contact=(
            Contact(
                "z1",
                obstacle=obstacle,
                friction_coefficient=0.3,
                axis=(0.3, 1.0, 0.2),
                moment_about=(0, 0, 1),
            ),
        ),
    )
    study = Study(scene, body=box_body((4, 4, 2), (1, 1, 1)))
    key = "contact.0.obstacle.indentation"
    found = study.derivatives(["torque"], [key, "load.0.force.1"])["torque"]
    for name, value, change in ((key, 0.05, 1e-5), ("load.0.force.1", 2.0, 1e-2)):
        low, high = (
            study.solve({name: value + sign * change}).quantities["torque"] for sign in (-1, 1)
        )
        assert found[name] == pytest.approx((high - low) / (2 * change), rel=2e-2)


def test_ranks_have_the_same():
    found, expected = (
        run(glued((0, 0, 0), (0, 0, 1)), comm, box_body((3, 3, 3), (1, 1, 2), comm=comm)).quantities
        for comm in (MPI.COMM_WORLD, MPI.COMM_SELF)
    )
    assert found["contact_moment"] == pytest.approx(expected["contact_moment"], rel=1e-6)
    assert found["torque"] == pytest.approx(expected["torque"], rel=1e-6)


def plane(kinematics="plane strain", **keys):
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        load=(Load("y1", force=(0, -2.0)),),
        contact=(Contact("y0", contact="bonded", **keys),),
    )


def test_axes_that_a_model_has_not_are_refused():
    with refused("torque_in_a_plane", SceneError):
        plane(axis=(0, 1))
    with refused("moment_of_a_whole_turn", SceneError):
        plane("axisymmetric", moment_about=(0, 0))
    with refused("axis_of_torque_is_none", SceneError):
        Contact("y0", axis=(0, 0, 0))
    with refused("moment_about_three_entries", SceneError):
        plane(moment_about=(0, 1, 2))
    with refused("torque_without_axis", InputError):
        Study(plane(), body=box_body((2, 2))).derivatives(["torque"], ["load.0.force.1"])


def test_in_the_plane_the_torque_is_about_a_point():
    found = run(plane(moment_about=(3, 1)), body=box_body((2, 2))).quantities
    assert found["torque"] == pytest.approx(-(0.5 - 3) * -2.0, rel=1e-6)
    assert "contact_moment" not in found
