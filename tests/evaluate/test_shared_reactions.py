"""Reactions of supports: where they meet, by their names, and their error bars."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Accuracy,
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Point,
    Scene,
    SolverSettings,
    Support,
    run,
)
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
WALLS = (
    Support("x0", {"x": 0}, name="wall"),
    Support("y0", {"x": 0, "y": 0}, name="floor"),
    Support("x1", {"x": 0}, name="wall"),
)


def confined(*contacts, load=(), degree=2, errors="all", **more):
    """A block between smooth walls on a floor to which it is glued."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=WALLS,
        load=load,
        contact=contacts,
        solver=SolverSettings(errors=errors),
        **more,
    )


def uneven(x):
    """A pressure without a kink."""
    return 30 - 25 * x[0] ** 2


@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("cell", [CellType.triangle, CellType.quadrilateral])
def test_supports_that_meet_have_their_own_parts(cell, degree):
    """A uniform stress: the walls bear ν/(1 − ν) p, the floor nothing sideways, on any mesh."""
    scene = confined(load=(Load("y1", pressure=10),), degree=degree, errors="none")
    found = run(scene, COMM, box_body((3, 2), (2, 1), cell))
    sideways = 0.3 / 0.7 * 10
    left, floor, right = (support["reaction"] for support in found.supports)
    assert left == pytest.approx([sideways, 0], abs=1e-10)
    assert floor == pytest.approx([0, 20], abs=1e-10)
    assert right == pytest.approx([-sideways, 0], abs=1e-10)
    assert [support["name"] for support in found.supports] == ["wall", "floor", "wall"]
    assert found.reactions["wall"]["reaction"] == pytest.approx([0, 0], abs=1e-10)
    assert found.steps[0]["supports"][0]["name"] == "wall"


def test_supports_that_meet_in_space_have_their_own_parts():
    """The same with four walls, of tetrahedra; at corners three supports meet."""
    sides = {"x0": "x", "x1": "x", "y0": "y", "y1": "y"}
    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        support=(
            Support("z0", {"x": 0, "y": 0, "z": 0}),
            *(Support(side, {axis: 0}) for side, axis in sides.items()),
        ),
        load=(Load("z1", pressure=10),),
        solver=SolverSettings(errors="none"),
    )
    found = run(scene, COMM, box_body((2, 3, 2), (1, 1, 0.5), CellType.tetrahedron))
    sideways = 0.3 / 0.7 * 10 * 0.5
    reactions = {support["name"]: support["reaction"] for support in found.supports}
    assert reactions["z0"] == pytest.approx([0, 0, 10], abs=1e-9)
    assert reactions["x0"] == pytest.approx([sideways, 0, 0], abs=1e-9)
    assert reactions["y1"] == pytest.approx([0, -sideways, 0], abs=1e-9)


@pytest.mark.parametrize("on_axis", [{"x": 0}, {"x": 0, "y": lambda x: -0.01 * x[1]}])
def test_supports_that_meet_on_the_axis_of_revolution(on_axis):
    """A cylinder under e_y = −.01: all of y is the floor's, and nothing of it that of the axis."""
    strain, size = 0.01, 1000 * 0.7 / (1.3 * 0.4)
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(
            Support("x0", on_axis, name="axis"),
            Support("y0", {"x": 0, "y": 0}, name="floor"),
            Support("x1", {"x": 0, "y": lambda x: -strain * x[1]}, name="wall"),
            Support("y1", {"x": 0, "y": -strain}, name="lid"),
        ),
        solver=SolverSettings(errors="none"),
    )
    found = run(scene, COMM, box_body((4, 3), (2, 1)))
    reactions = {name: row["reaction"] for name, row in found.reactions.items()}
    assert reactions["floor"] == pytest.approx([0, size * strain * 4 * np.pi])
    assert reactions["lid"] == pytest.approx([0, -size * strain * 4 * np.pi])
    assert reactions["wall"] == pytest.approx([0, 0], abs=1e-9)
    assert reactions["axis"] == pytest.approx([0, 0], abs=1e-9)


def test_dofs_that_one_holds_without_facets_count_to_the_first():
    """All cells are held along x, the floor as well: what the walls bear is the body's then."""
    first = (Support("body", {"x": 0}), Support("y0", {"x": 0, "y": 0}))
    for supports, by_body in ((first, 0.0), (first[::-1], 0.0)):
        scene = dataclasses.replace(
            confined(load=(Load("y1", traction=(1.0, -10)),), errors="none"), support=supports
        )
        found = run(scene, COMM, box_body((3, 2), (2, 1)))
        reactions = {support["name"]: support["reaction"] for support in found.supports}
        assert np.sum(list(reactions.values()), axis=0) == pytest.approx([-2, 20])
        assert reactions["y0"][0] == pytest.approx(by_body, abs=1e-9)


@pytest.mark.errors
def test_bars_of_reactions_hold_and_fall():
    """Against a mesh on which errors are a thousandth; each support, and all of a name."""
    scene = confined(Contact("y1", pressure=uneven))
    fine = run(with_solver(scene, errors="none"), COMM, box_body((24, 24), (1, 1)))
    true, bars = {}, {}
    for cells in (3, 6):
        found = run(scene, COMM, box_body((cells, cells), (1, 1)))
        rows = [
            *zip(found.supports, fine.supports, strict=True),
            *((found.reactions[name], fine.reactions[name]) for name in found.reactions),
        ]
        true[cells] = np.array([distance(row, exact) for row, exact in rows])
        bars[cells] = np.array([row["errors"]["reaction"]["total"] for row, _ in rows])
        assert (true[cells] <= bars[cells]).all()
        assert (bars[cells] < 0.02 * np.linalg.norm(found.reactions["floor"]["reaction"])).all()
    assert (true[3] / true[6] > 8).all()  # with corners that count to one support it was 2
    assert (bars[3] / bars[6] > 4).all()


def distance(row, exact):
    return np.linalg.norm(np.subtract(row["reaction"], exact["reaction"]))


@pytest.mark.errors
def test_the_error_of_a_sum_is_that_of_the_sum():
    """Walls that bear the same: what the mesh does to one it does to the other."""
    punch = Obstacle("parabola", radius=8, position=(0.4, 1), indentation=0.03)
    scene = confined(Contact("y1", obstacle=punch))
    found = run(scene, COMM, box_body((4, 4), (1, 1)))
    fine = run(with_solver(scene, errors="none"), COMM, box_body((24, 24), (1, 1)))
    together = found.reactions["wall"]["errors"]["reaction"]["total"]
    alone = [row["errors"]["reaction"]["total"] for row in found.supports if row["name"] == "wall"]
    # .21 by the load's scatter; .43 since edges are moved as well, which few cells make coarse
    assert together < 0.5 * sum(alone)
    assert distance(found.reactions["wall"], fine.reactions["wall"]) <= together
    summed = np.sum([row["reaction"] for row in found.supports if row["name"] == "wall"], axis=0)
    assert found.reactions["wall"]["reaction"] == pytest.approx(summed)
    every = np.sum([row["reaction"] for row in found.supports], axis=0)
    assert found.quantities["reaction"] == pytest.approx(every)


@pytest.mark.errors
def test_bars_of_reactions_do_not_depend_on_the_number_of_ranks():
    punch = Obstacle("parabola", radius=1, position=(0.4, 1), indentation=0.02)
    scene = confined(Contact("y1", obstacle=punch, friction_coefficient=0.2))
    together = run(scene, COMM, box_body((6, 5), (1, 1)))
    alone = run(scene, MPI.COMM_SELF, box_body((6, 5), (1, 1), comm=MPI.COMM_SELF))
    pairs = [
        *zip(together.supports, alone.supports, strict=True),
        *((together.reactions[name], alone.reactions[name]) for name in alone.reactions),
    ]
    for ours, theirs in pairs:
        assert ours["reaction"] == pytest.approx(theirs["reaction"], abs=1e-8)
        for source, value in ours["errors"]["reaction"].items():
            expected = theirs["errors"]["reaction"][source]
            assert value == pytest.approx(expected, rel=1e-5, abs=1e-7), source


@pytest.mark.errors
@pytest.mark.serial
def test_meshes_are_made_for_reactions_and_points():
    scene = confined(
        Contact("y1", pressure=uneven),
        point=(Point("edge", (0.3, 1.0)),),
        accuracy=Accuracy(
            of={"wall.reaction_x": 2e-3, "floor.reaction": 2e-3, "displacement_edge_y": 2e-3}
        ),
    )
    found = run(scene, COMM, box_body((2, 2), (1, 1), CellType.triangle))
    assert found.accuracy["reached"], found.verdict
    assert len(found.levels) > 1
    assert set(found.levels[-1]["errors"]) == set(scene.accuracy.of)
    plain = dataclasses.replace(with_solver(scene, errors="none"), accuracy=None)
    fine = run(plain, COMM, box_body((24, 24), (1, 1)))
    for name, at in (("wall", 2e-3), ("floor", 2e-3)):
        exact = np.linalg.norm(fine.reactions[name]["reaction"])
        assert distance(found.reactions[name], fine.reactions[name]) <= at * exact
    moved, exact = (np.array(r.quantities["displacement_edge"]) for r in (found, fine))
    assert abs(moved[1] - exact[1]) <= 2e-3 * np.linalg.norm(exact)


@pytest.mark.errors
def test_reactions_that_do_not_converge_have_no_bar():
    """A wall pressed against the whole side of a block that is glued to its floor."""
    floor, back = Support("y0", {"x": 0, "y": 0}, name="floor"), Support("x0", {"x": 0})
    pressed = Contact("x1", obstacle=Obstacle("plane", indentation=0.01))
    scene = dataclasses.replace(confined(pressed), support=(floor, back))
    found = run(scene, COMM, box_body((4, 4), (1, 1)))
    bars = {name: row["errors"]["reaction"]["total"] for name, row in found.reactions.items()}
    assert bars["floor"] is None
    assert bars["x0"] > 0
    assert found.supports[0]["errors"]["reaction"]["total"] is None
    assert any("reaction of 'floor'" in note for note in found.error_notes)
    asked = dataclasses.replace(scene, accuracy=Accuracy(of={"floor.reaction_x": 0.1}))
    refused = run(asked, COMM, box_body((2, 2), (1, 1), CellType.triangle))
    assert "reaction of 'floor'" in refused.accuracy["reason"]
    assert refused.exit_code == 3
