"""Quantities that do not converge: where displacements jump; and what they are not taken for."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Material,
    MeshSource,
    Point,
    Run,
    Scene,
    Support,
    load_scene,
    run,
)
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import Profile
from fenics_contact.trust.convergence.displacement_jumps import displacement_jumps
from fenics_contact.trust.convergence.unbounded import LevelHistory
from tests.scenes import ROOT, box_body, with_solver

pytestmark = pytest.mark.errors
COMM = MPI.COMM_WORLD

# A wall pressed against the whole side of a block clamped at its base.
WALL = Scene(
    kinematics="plane strain",
    material=Material(1000, 0.3),
    support=(Support("y0", {"x": 0, "y": 0}),),
    contact=(Contact("x0", obstacle=Obstacle(indentation=0.01)),),
)
PATCHES = {"below": ("x0", lambda x: x[1] < 0.5), "above": ("x0", lambda x: x[1] > 0.5)}


def square(cells=4):
    return box_body((cells, cells), (1, 1), patches=PATCHES)


def changed(scene=WALL, **parts):
    return dataclasses.replace(scene, **parts)


def glued(on, **obstacle):
    return Contact(on, contact="bonded", obstacle=Obstacle(**obstacle))


def base(lifted):
    return Support("y0", {"x": 0, "y": lifted})


def jumps(scene, body=None):
    prepared = Run(with_solver(scene, errors="none"), COMM, body or square())
    assert prepared.solve().converged
    displacement = prepared.solution.displacement
    return displacement_jumps(prepared.problem, displacement, scene.steps.last)


def test_force_on_the_wall_grows_like_the_logarithm_and_has_no_bar():
    """Half the cells' size adds as much each time: stress goes like δ/r from the corner."""
    results = [run(WALL, COMM, square(cells)) for cells in (4, 8, 16)]
    forces = [result.quantities["normal_force"] for result in results]
    added = np.diff(forces)
    assert added[1] == pytest.approx(added[0], rel=0.05)
    for result in results:
        rows = {**result.errors, **result.contacts[0]["errors"]}
        for name in ("normal_force", "reaction", "strain_energy", "external_work"):
            assert rows[name]["mesh"] is None and rows[name]["total"] is None
        assert rows["contact_area"]["total"] > 0  # where the body leaves the wall, higher up
        (note,) = (note for note in result.error_notes if "not converge" in note)
        assert "at (0, 0) the contact 'x0' and the support 'y0'" in note
        assert "differ by 0.01" in note and "strain energy" in note


@pytest.mark.parametrize(
    ("parts", "size"),
    [
        ({"contact": (glued("x0", displacement=(0, 0.01)),)}, 0.01),
        ({"support": (Support("y0", {"x": -0.004, "y": 0}),)}, 0.014),
        # Two obstacles that hold the node they share, each of them glued on.
        (
            {
                "support": (Support("x1", {"x": 0, "y": 0}),),
                "contact": (
                    glued("below", indentation=0.01),
                    glued("above"),
                ),
            },
            0.01,
        ),
        ({"support": (base(lambda x: 0.003 * (x[0] > 0.4)),), "contact": ()}, 0.003),
    ],
    ids=["glued", "towards the wall", "two obstacles", "step"],
)
def test_jumps_are_found_with_their_size(parts, size):
    (found,) = jumps(changed(**parts))
    assert found.size == pytest.approx(size, rel=1e-6)


PUSHED = Obstacle(indentation=0.01)
BALL = Obstacle("parabola", radius=3, position=(0, 0.6), indentation=0.01)
HELD_AND_DRIVEN = (Support("x1", {"x": 0, "y": 0}), Support("y0", {"y": 0}))


@pytest.mark.parametrize(
    "parts",
    [
        {"support": HELD_AND_DRIVEN},  # the corner may go along with the wall
        {"support": (Support("y0", {"x": 0.02, "y": 0}),)},  # the support leaves the wall
        {"contact": (Contact("above", obstacle=Obstacle(indentation=0.01)),)},
        {"contact": (Contact("x0", obstacle=BALL),)},
        # Springs give way, and so does a body beside the edge of an obstacle that goes in farther.
        {"contact": (Contact("x0", foundation_stiffness=100, obstacle=PUSHED),)},
        {
            "support": HELD_AND_DRIVEN,
            "contact": (
                Contact("above", obstacle=Obstacle(indentation=0.02)),
                Contact("below", obstacle=Obstacle(indentation=0.01)),
            ),
        },
        {"support": (base(lambda x: 0.01 * np.sqrt(x[0])),), "contact": ()},
        {"support": (base(Profile("x", (0.4, 0.41), (0, 0.01))),), "contact": ()},
    ],
    ids=["roller", "away", "above", "parabola", "springs", "two obstacles", "root", "ramp"],
)
def test_what_fits_together_is_no_jump(parts):
    assert jumps(changed(**parts)) == []


@pytest.mark.parametrize("demo", ["annulus", "winkler", "slab", "cylinders"])
def test_demos_have_no_jumps(demo):
    scene = load_scene(ROOT / "demos" / f"{demo}.toml")
    prepared = Run(changed(scene, steps=dataclasses.replace(scene.steps, times=(1.0,))), COMM)
    nodes = np.zeros_like(prepared.problem.load)
    nodes.reshape(-1)[prepared.problem.constrained] = prepared.problem.prescribed
    prepared.problem.set_time(1.0)
    assert displacement_jumps(prepared.problem, nodes, 1.0) == []


def test_in_3d_a_common_edge_tears_the_body_but_a_common_corner_does_not():
    solid = changed(kinematics="3D", support=(Support("z0", {"x": 0, "y": 0, "z": 0}),))
    corner = {"corner": ("z0", lambda x: (x[0] > 0.6) & (x[1] > 0.6))}
    body = box_body((2, 2, 2), (1, 1, 1), patches=corner)
    (found,) = jumps(solid, body)
    assert found.place[0] == pytest.approx(0, abs=1e-12)
    held = (*HELD_AND_DRIVEN, Support("corner", {"x": 0, "y": 0, "z": 0}))
    assert jumps(changed(solid, support=held), body) == []


def test_bodies_that_supports_press_into_each_other():
    """Two blocks side by side on one floor, of which one is pushed; and on a floor for each."""
    meshes = tuple(
        MeshSource(
            str(ROOT / "meshes" / "block.geo"),
            name=name,
            cell="quadrilateral",
            parameters={"left": left, "cells_across": cells},
        )
        for name, left, cells in (("first", -1, 3), ("second", 0, 4))
    )
    pushed = (
        Support("first.bottom", {"x": 0.01, "y": 0}),
        Support("second.bottom", {"x": 0, "y": 0}),
    )
    scene = changed(
        WALL,
        mesh=meshes,
        support=pushed,
        contact=(Contact("first.right", against="second.left"),),
    )
    prepared = Run(scene, COMM)
    result = prepared.solve()
    (found,) = displacement_jumps(prepared.problem, prepared.solution.displacement, 1.0)
    assert found.size == pytest.approx(0.01) and set(found.supports) == {0, 1}
    assert result.contacts[0]["errors"]["normal_force"]["total"] is None
    assert result.errors["reaction"]["total"] is not None  # what they press is not in the sum
    apart = (pushed[0], Support("second.right", {"x": 0, "y": 0}))
    prepared = Run(with_solver(changed(scene, support=apart), errors="none"), COMM)
    prepared.solve()
    assert displacement_jumps(prepared.problem, prepared.solution.displacement, 1.0) == []


def test_obstacle_that_a_force_presses_on_a_corner_that_is_held():
    """The force is given; how far the obstacle goes depends on the mesh without end."""
    pressed = changed(
        contact=(Contact("x0", obstacle=Obstacle(force=5), friction_coefficient=0.2),)
    )
    result = run(pressed, COMM, square())
    rows = result.contacts[0]["errors"]
    assert rows["normal_force"]["total"] < 1e-6
    for name in ("indentation", "friction_force", "max_slip"):
        assert rows[name]["total"] is None
    assert any(note.startswith("Only what loads alone decide") for note in result.error_notes)


@pytest.mark.serial
def test_accuracy_is_never_reached_by_what_does_not_converge():
    mesh = MeshSource(str(ROOT / "meshes" / "block.geo"), cell="quadrilateral")
    wall = changed(
        mesh=(mesh,),
        support=(Support("bottom", {"x": 0, "y": 0}),),
        contact=(Contact("left", obstacle=Obstacle(indentation=0.01)),),
        accuracy=Accuracy(normal_force=0.05),
    )
    found = run(wall, COMM)
    assert found.exit_code == 3 and len(found.levels) == 1
    assert "not converge: at (0, 0)" in found.verdict
    # So steep that cells see a step, though there is none: it shows from mesh to mesh.
    ramp = Profile("x", (0.4, 0.4000001), (0, 0.01))
    found = run(
        changed(
            wall,
            support=(Support("bottom", {"x": 0, "y": ramp}),),
            contact=(),
            accuracy=Accuracy(strain_energy=0.1),
        ),
        COMM,
    )
    assert found.exit_code == 3 and 2 < len(found.levels) < 6
    assert "strain energy does not converge" in found.accuracy["reason"]
    assert found.errors["strain_energy"]["total"] is None
    assert any("strain energy" in note for note in found.error_notes)


def history(values, bars):
    found = LevelHistory()
    found.values = [{"f": np.atleast_1d(np.asarray(value, dtype=float))} for value in values]
    found.bars = [{"f": bar} for bar in bars]
    return found


@pytest.mark.parametrize(
    ("values", "bars", "away"),
    [
        ([10, 13.5, 17, 20.5], [0.6] * 4, True),
        ([10, 13.5, 17, 20.5], [8.0, 7.5, 7.2, 7.1], True),  # the bars cover it, and do not fall
        ([10, 13.5, 17, 20.5], [8.0, 5.0, 3.0, 2.0], False),  # they fall, and have yet to be tried
        ([10, 11, 11.4, 11.56], [0.1] * 4, False),  # bars are too short, but it comes to rest
        ([10, 11, 10, 11], [0.1] * 4, False),  # to and fro: what an edge within cells does
        ([10, 10.3, 10.5, 10.6], [0.8, 0.4, 0.2, 0.1], False),
        ([10, 13.5, 17, 20.5], [0.6, 0.6, None, 0.6], False),  # not known
    ],
)
def test_what_runs_away_from_mesh_to_mesh(values, bars, away):
    assert history(values, bars).runs_away("f") == away


def test_bars_that_the_next_mesh_does_not_bear_out():
    assert history([10, 12], [0.5, 0.5]).is_beyond("f")
    assert not history([10, 10.9], [0.5, 0.5]).is_beyond("f")
    assert not history([10], [0.5]).is_beyond("f")
    assert not history([10, 12], [None, 0.5]).is_beyond("f")


@pytest.mark.serial
def test_singular_problems_that_converge_keep_their_bars():
    """A flat punch on a clamped block: pressures have no bound at its edges, its force has."""
    punch = Obstacle("flat punch", position=(0.5, 1), radius=0.25, indentation=0.01)
    scene = changed(contact=(Contact("y1", obstacle=punch),))
    fine = run(with_solver(scene, errors="none"), COMM, square(64)).quantities
    result = run(scene, COMM, square(16))
    for name in ("normal_force", "strain_energy"):
        error = abs(result.quantities[name] - fine[name])
        assert 0.3 * error < result.errors[name]["total"] < 10 * error
    mesh = MeshSource(str(ROOT / "meshes" / "block.geo"), cell="triangle")
    found = run(
        changed(
            scene,
            mesh=(mesh,),
            support=(Support("bottom", {"x": 0, "y": 0}),),
            contact=(Contact("top", obstacle=punch),),
            discretisation=Discretisation(2),
            accuracy=Accuracy(normal_force=0.02),
        ),
        COMM,
    )
    assert found.accuracy["reached"]
    assert abs(found.quantities["normal_force"] / fine["normal_force"] - 1) < 0.02


TORN = {
    "wall": changed(support=(WALL.support[0], Support("x1", {"x": 0}))),
    "step": changed(
        support=(
            Support("y0", {"x": 0, "y": 0}),
            Support("y1", {"y": lambda x: -0.01 * (x[0] > 0.5)}),
        ),
        contact=(),
    ),
}


@pytest.mark.parametrize("scene", TORN.values(), ids=TORN)
def test_displacements_beside_a_jump_are_of_first_order_and_their_bars_know(scene):
    """Half the cells' size halves what they are off by, whatever the degree."""
    scene = changed(
        scene,
        discretisation=Discretisation(2),
        point=(Point("inside", (0.5, 0.6)),),
        solver=dataclasses.replace(scene.solver, errors="all"),
    )
    found = [run(scene, COMM, square(cells)) for cells in (4, 16)]
    coarse, fine = (np.asarray(result.quantities["displacement_inside"]) for result in found)
    error = np.linalg.norm(fine - coarse) / (1 - 4 / 16)
    assert error > 0.01 * np.linalg.norm(fine)
    assert error < found[0].errors["displacement_inside"]["total"] < 4 * error
    coarse, fine = (result.quantities["max_slip"] for result in found)
    assert abs(fine - coarse) <= 0.8 * found[0].errors["max_slip"]["total"]
