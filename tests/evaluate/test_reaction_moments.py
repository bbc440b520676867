"""Moments of the reactions of supports: from equilibrium, with bars and derivatives."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Discretisation,
    FaceRotation,
    Load,
    Material,
    Scene,
    SolverSettings,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import InputError, SceneError
from fenics_contact.evaluate.nodal_forces import BulkForces
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FORCE, LENGTH = 3.0, 5.0
SIZES = {2: (LENGTH, 1.2), 3: (LENGTH, 1.2, 0.8)}


def cantilever(dimension, errors="none", **more):
    """A beam held at x = 0, with a force across it at its other end."""
    force = (0.0, -FORCE, 0.0)[:dimension]
    held = dict.fromkeys("xyz"[:dimension], 0)
    return Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(Support("x0", held, **more),),
        load=(Load("x1", force=force),),
        solver=SolverSettings(errors=errors),
    )


def beam(dimension, comm=COMM):
    return box_body((5, 3, 2)[:dimension], SIZES[dimension], comm=comm)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_held_end_bears_force_times_length_about_its_centroid(dimension):
    found = run(cantilever(dimension), COMM, beam(dimension)).supports[0]
    expected = np.array([0.0, 0.0, FORCE * LENGTH])[-1 if dimension == 2 else slice(None)]
    assert found.reaction_moment == pytest.approx(expected, abs=1e-9 * FORCE * LENGTH)
    assert found.moment_about == pytest.approx([0, 0.6, 0.4][:dimension], abs=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_point_that_is_given_moves_the_moment_by_the_resultant(dimension):
    about = (1.0, -2.0, 0.5)[:dimension]
    found = run(cantilever(dimension, moment_about=about), COMM, beam(dimension)).reactions["x0"]
    arm = np.array([LENGTH, 0.6, 0.4]) - np.array([1.0, -2.0, 0.5 if dimension == 3 else 0.4])
    expected = -np.cross(arm, [0, -FORCE, 0])
    expected = expected[2] if dimension == 2 else expected
    assert found.reaction_moment == pytest.approx(expected, abs=1e-9 * FORCE * LENGTH)


def test_supports_of_a_name_add_up_about_the_centroid_of_all():
    """Both ends of a block with a force in the middle of its top."""
    held = {"x": 0, "y": 0}
    scene = dataclasses.replace(
        cantilever(2),
        support=(Support("x0", held, name="ends"), Support("x1", held, name="ends")),
        load=(Load("y1", force=(0, -FORCE), at=(1.0, 1.2)),),
    )
    found = run(scene, COMM, beam(2))
    expected = FORCE * (1.0 - LENGTH / 2)
    assert found.reactions["ends"].reaction_moment == pytest.approx(expected, abs=1e-9 * FORCE)
    assert [one.moment_about for one in found.supports] == [pytest.approx([LENGTH / 2, 0.6])] * 2


def test_supports_that_meet_share_moments_as_they_share_forces():
    """Under a uniform stress the moments of the walls about the floor's middle cancel."""
    about = (1.0, 0.0)
    sides = {"x0": {"x": 0}, "y0": {"x": 0, "y": 0}, "x1": {"x": 0}}
    scene = dataclasses.replace(
        cantilever(2),
        support=tuple(Support(on, held, moment_about=about) for on, held in sides.items()),
        load=(Load("y1", pressure=10),),
    )
    left, floor, right = run(scene, COMM, box_body((3, 2), (2, 1))).supports
    sideways = 0.3 / 0.7 * 10
    assert left.reaction_moment == pytest.approx(-sideways / 2, abs=1e-9)
    assert floor.reaction_moment == pytest.approx(0, abs=1e-9)
    assert right.reaction_moment == pytest.approx(sideways / 2, abs=1e-9)


def test_a_turned_end_of_a_bar_is_in_balance_with_the_other():
    """Torsion with warping held: without ν about the axis nothing else is held back."""
    turn = FaceRotation(angle=1e-2, axis=(2, 0, 0), at=(0, 0.6, 0.4))
    supports = (
        Support("x0", {"x": 0, "y": 0, "z": 0}),
        Support("x1", rotation=turn, moment_about=(LENGTH, 0.6, 0.4)),
    )
    scene = dataclasses.replace(
        cantilever(3), material=Material(1000, 0.0), support=supports, load=()
    )
    held, turned = run(scene, COMM, beam(3)).supports
    moments = np.array([held.reaction_moment, turned.reaction_moment])
    size = np.abs(moments).max()
    assert moments.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-9 * size)
    # Between GJ φ/L of free warping, and of an elastic core.
    width, height, shear = 1.2, 0.8, 500.0
    polar = width * height * (width**2 + height**2) / 12
    free = 0.196 * width * height**3  # h/b = 1.5
    twist = shear * 1e-2 / LENGTH
    assert free * twist < turned.reaction_moment[0] < polar * twist
    assert held.reaction_moment[1:] == pytest.approx([0, 0], abs=1e-9 * size)


@pytest.mark.errors
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_bar_of_what_equilibrium_decides_is_none(dimension):
    found = run(cantilever(dimension, errors="all"), COMM, beam(dimension))
    row = found.supports[0].errors["reaction_moment"]
    assert row["total"] is not None and row["total"] < 1e-6 * FORCE * LENGTH
    assert found.reactions["x0"].errors["reaction_moment"] == row


def pushed_block():
    """A block between a floor and a wall beside it, which both bear a part of the load."""
    return dataclasses.replace(
        cantilever(3),
        support=(
            Support("z0", {"x": 0, "y": 0, "z": 0}),
            Support("z1", {"z": 0.01, "x": 0.002}, name="top", moment_about=(0.3, 0.2, 1.0)),
        ),
        load=(Load("x1", force=(-1.0, 2.0, 0.5)),),
    )


def test_derivatives_are_those_of_differences():
    study = Study(pushed_block(), body=box_body((3, 3, 2), (1, 1, 1)))
    names = [f"top.reaction_moment_{axis}" for axis in "xyz"]
    keys = {
        "load.0.force.1": 2.0,
        "support.1.displacement.z": 0.01,
        "material.0.youngs_modulus": 1e3,
    }
    found = study.derivatives(names, list(keys))
    for key, value in keys.items():
        low, high = (
            study.solve({key: value * (1 + sign * 1e-3)}).supports[1].reaction_moment
            for sign in (-1, 1)
        )
        slopes = np.subtract(high, low) / (2e-3 * value)
        given = [found[name][key] for name in names]
        assert given == pytest.approx(slopes, rel=1e-5, abs=1e-6 * np.abs(slopes).max())


def test_in_the_plane_the_derivative_is_of_a_number():
    """Of F L in F: L."""
    study = Study(cantilever(2), body=beam(2))
    found = study.derivatives(["x0.reaction_moment"], ["load.0.force.1"])
    assert found["x0.reaction_moment"]["load.0.force.1"] == pytest.approx(-LENGTH, rel=1e-9)


def test_ranks_have_the_same():
    found, expected = (
        run(pushed_block(), comm, box_body((3, 3, 2), (1, 1, 1), comm=comm)).supports[1]
        for comm in (COMM, MPI.COMM_SELF)
    )
    assert found.reaction_moment == pytest.approx(expected.reaction_moment, rel=1e-9)


def test_axisymmetric_models_have_none():
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(Load("y1", pressure=1.0),),
        solver=SolverSettings(errors="none"),
    )
    found = run(scene, COMM, box_body((2, 2)))
    assert "reaction_moment" not in found.supports[0]
    assert "reaction_moment" not in found.reactions["y0"]
    with refused("reaction_moment_of_a_whole_turn_asked", InputError):
        Study(scene, body=box_body((2, 2))).derivatives(["y0.reaction_moment"], ["load.0.pressure"])


def test_points_that_do_not_fit_are_refused():
    held = {"x": 0, "y": 0}
    with refused("reaction_moment_about_three_entries", SceneError):
        cantilever(2, moment_about=(0, 1, 2))
    with refused("reaction_moment_of_a_whole_turn", SceneError):
        dataclasses.replace(cantilever(2, moment_about=(0, 1)), kinematics="axisymmetric")
    two = (
        Support("x0", held, name="ends", moment_about=(0, 0)),
        Support("x1", held, name="ends", moment_about=(0, 1)),
    )
    with refused("reaction_moments_do_not_add_up", SceneError):
        dataclasses.replace(cantilever(2), support=two)


def test_a_body_that_is_kept_tells_moments_by_rows():
    """As the fields of the body do, at supports that share points."""
    scene = dataclasses.replace(
        pushed_block(),
        support=(
            Support("z0", {"x": 0, "y": 0, "z": 0}),
            Support("x0", {"x": 0, "z": 0}, moment_about=(0.1, 0.2, 0.3)),
        ),
    )
    study = Study(scene, body=box_body((3, 3, 2), (1, 1, 1)))
    answer = study.solve({"load.0.force.0": -2.0})
    theirs = BulkForces(study.run.problem, study.run.solution).moments_of_supports
    ours = [one.reaction_moment for one in answer.supports]
    assert np.abs(theirs).max() > 0.1
    assert ours == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())
