"""Elastic supports: bars and blocks on springs against formulas of springs in series."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    DerivativeRequest,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    Obstacle,
    Path,
    Point,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.analyses.vibration.table import Modes
from fenics_contact.common.errors import InputError, NoEquilibriumError
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
E, LENGTH, HEIGHT, FORCE, K = 1000.0, 4.0, 0.5, 3.0, 70.0
AXES = "xyz"
GIVE = 1e-7  # of the penalty: one more spring in series


def bar(size=2, by_area=False, **more):
    """A bar along x whose end x0 is on springs and whose end x1 is pulled."""
    area = HEIGHT ** (size - 1)
    spring = {"foundation_stiffness": {"x": K / area}} if by_area else {"stiffness": {"x": K}}
    given = {
        "kinematics": "3D" if size == 3 else "plane strain",
        "material": Material(E, 0.0),
        "support": (
            Support("x0", **spring),
            *(Support(f"{axis}0", {axis: 0}) for axis in AXES[1:size]),
        ),
        "load": (Load("x1", force=(FORCE, 0, 0)[:size]),),
        "point": (Point("tip", (LENGTH, 0, 0)[:size]),),
    }
    return Scene(**given | more), area


def body(size=2, cells=4):
    return box_body((cells, 1, 1)[:size], (LENGTH, HEIGHT, HEIGHT)[:size])


@pytest.mark.parametrize(
    ("size", "solver"),
    [(2, "full"), (2, "condensed"), (3, "full"), (3, "condensed"), (3, "iterative")],
)
@pytest.mark.parametrize("by_area", [False, True])
def test_a_pulled_bar_on_springs_moves_as_springs_in_series(size, solver, by_area):
    """Its tip moves F/k + F L/(E A), and its support carries −F."""
    scene, area = bar(size, by_area, solver=SolverSettings(solver=solver))
    found = run(scene, COMM, body(size))
    assert found.passed, found.verdict
    series = 1 / K + LENGTH / (E * area)
    tip = found.quantities["displacement_tip"][0]
    assert tip == pytest.approx(FORCE * series, rel=1e-10)
    held = next(row for row in found.supports if row.name == "x0")
    assert held.reaction[0] == pytest.approx(-FORCE, rel=1e-10)
    assert held.displacement[0] == pytest.approx(FORCE / K, rel=1e-10)
    assert found.quantities["strain_energy"] == pytest.approx(
        FORCE**2 * LENGTH / (2 * E * area), rel=1e-9
    )
    assert found.quantities["spring_energy"] == pytest.approx(FORCE**2 / (2 * K), rel=1e-9)
    assert found.quantities["external_work"] == pytest.approx(FORCE**2 * series, rel=1e-9)
    assert found.checks["equilibrium"].passed


@pytest.mark.parametrize("solver", ["full", "condensed"])
def test_a_foot_that_moves_pulls_a_bar_that_is_held(solver):
    """The far end is held: springs in series between the foot and it, over a path to and fro."""
    scene, area = bar(solver=SolverSettings(solver=solver), load=())
    support = (
        replace(scene.support[0], displacement={"x": 0.02}, path=Path((0, 1, 2), (0, 1, -0.5))),
        *scene.support[1:],
        Support("x1", {"x": 0}),
    )
    found = run(replace(scene, support=support, steps=Steps(times=(1.0, 2.0))), COMM, body())
    assert found.passed, found.verdict
    series = 1 / (1 / K + LENGTH / (E * area))
    for step, moved in zip(found.steps, (0.02, -0.01), strict=True):
        rows = {row.name: row.reaction[0] for row in step.supports}
        assert rows["x0"] == pytest.approx(series * moved, rel=1e-10)
        assert rows["x1"] == pytest.approx(-series * moved, rel=1e-10)
    whole = 0.5 * series * 0.01**2
    stored = found.quantities["strain_energy"] + found.quantities["spring_energy"]
    assert stored == pytest.approx(whole, rel=1e-9)
    # By the trapezoidal rule the work along straight parts of the path is exact.
    assert found.quantities["external_work"] == pytest.approx(whole, rel=1e-8)
    assert abs(found.quantities["energy_defect"]) < 1e-9 * whole


@pytest.mark.parametrize("solver", ["full", "condensed"])
@pytest.mark.parametrize("degree", [1, 2])
def test_a_block_on_springs_that_is_pressed_on_a_rigid_plane(solver, degree):
    """Springs above, a gap below: what is beyond the gap is shared by body and springs."""
    gap, moved = 0.01, -0.05
    scene = Scene(
        kinematics="plane strain",
        material=Material(E, 0.0),
        discretisation=Discretisation(degree),
        support=(Support("y1", {"y": moved}, stiffness={"y": K}), Support("x0", {"x": 0})),
        contact=(Contact("y0", obstacle=Obstacle(gap=gap), penalty_parameter=GIVE),),
        solver=SolverSettings(solver=solver),
    )
    found = run(scene, COMM, body())
    assert found.passed, found.verdict
    series = 1 / (1 / K + HEIGHT / (E * LENGTH) + GIVE / LENGTH)
    force = series * (abs(moved) - gap)
    assert found.contacts[0].quantities["normal_force"] == pytest.approx(force, rel=1e-9)
    assert found.reactions["y1"].reaction[1] == pytest.approx(-force, rel=1e-9)


FLOATING = Scene(
    kinematics="3D",
    material=Material(E, 0.3),
    support=(Support("y0", stiffness=K),),
    load=(Load("y1", force=(1.0, -2.0, 0.5)),),
    point=(Point("corner", (2, 1, 1)),),
)


@pytest.mark.parametrize("solver", ["full", "condensed", "iterative"])
def test_a_body_on_springs_alone_is_held(solver):
    """All solvers give the same, and the springs carry what is put on."""
    scene = replace(FLOATING, solver=SolverSettings(solver=solver))
    found = run(scene, COMM, box_body((4, 2, 2), (2, 1, 1)))
    assert found.passed, found.verdict
    assert found.reactions["y0"].reaction == pytest.approx([-1.0, 2.0, -0.5], rel=1e-9)
    reference = run(
        replace(FLOATING, solver=SolverSettings(solver="full")),
        COMM,
        box_body((4, 2, 2), (2, 1, 1)),
    )
    moved = found.quantities["displacement_corner"]
    assert moved == pytest.approx(reference.quantities["displacement_corner"], rel=1e-8)


def test_a_component_that_no_spring_holds_is_free():
    scene = replace(FLOATING, support=(Support("y0", stiffness={"y": K}),))
    with pytest.raises(NoEquilibriumError, match="translation along x"):
        run(scene, COMM, box_body((2, 2, 2), (2, 1, 1)))


def test_the_thickness_and_the_whole_ring_share_the_stiffness():
    """A total stiffness is of the area: over the thickness, over the whole turn."""
    sheet, _ = bar(kinematics="plane stress", thickness=0.2)
    found = run(sheet, COMM, body())
    tip = FORCE / K + FORCE * LENGTH / (E * HEIGHT * 0.2)
    assert found.quantities["displacement_tip"][0] == pytest.approx(tip, rel=1e-9)
    disc = Scene(
        kinematics="axisymmetric",
        material=Material(E, 0.0),
        support=(Support("y0", stiffness={"y": K}),),
        load=(Load("y1", force=(0, -FORCE)),),
        point=(Point("top", (1, 1)),),
    )
    found = run(disc, COMM, box_body((4, 2), (2, 1)))
    down = -FORCE / K - FORCE / (E * np.pi * 2**2)
    assert found.quantities["displacement_top"][1] == pytest.approx(down, rel=1e-9)
    assert found.reactions["y0"].reaction[1] == pytest.approx(FORCE, rel=1e-9)


def test_a_nearly_incompressible_block_on_springs_is_in_balance():
    scene = replace(FLOATING, material=Material(E, 0.4999), solver=SolverSettings(solver="full"))
    found = run(scene, COMM, box_body((4, 2, 2), (2, 1, 1)))
    assert found.passed, found.verdict
    assert found.reactions["y0"].reaction == pytest.approx([-1.0, 2.0, -0.5], rel=1e-9)


# A cantilever whose end is clamped by springs.
BENT = Scene(
    kinematics="plane strain",
    material=Material(E, 0.3),
    support=(Support("x0", stiffness=1e4),),
    load=(Load("x1", traction=(0, -0.2)),),
    point=(Point("tip", (LENGTH, 0)),),
    solver=SolverSettings(errors="all"),
)


@pytest.mark.errors
@pytest.mark.parametrize("degree", [1, 2])
@pytest.mark.parametrize("stiffness", [K, 1e4, 1e8])
def test_error_bars_of_a_bent_bar_on_springs_hold(degree, stiffness):
    """Against 128 × 16 cells; the reaction, which balance gives, has none to speak of."""
    scene = replace(BENT, support=(Support("x0", stiffness=stiffness),))
    fine = run(replace(scene, solver=SolverSettings(errors="none")), COMM, body_of(128, 16))
    scene = replace(scene, discretisation=Discretisation(degree))
    found = run(scene, COMM, body_of(16, 2))
    assert found.passed, found.verdict
    for name in ("strain_energy", "spring_energy", "displacement_tip", "external_work"):
        off = np.linalg.norm(np.subtract(found.quantities[name], fine.quantities[name]))
        bar = found.errors[name]["total"]
        assert off <= bar <= max(12 * off, 1e-2 * np.linalg.norm(fine.quantities[name])), name
    assert found.errors["reaction"]["total"] < 1e-9


def body_of(along, across):
    return box_body((along, across), (LENGTH, HEIGHT))


def rubbed(foot=(0.003, -0.02), stiffness=(K, 2 * K)):
    """A block on two sets of springs, which a foot that moves presses on a rough plane."""
    spring = dict(zip("xy", stiffness, strict=True))
    return Scene(
        kinematics="plane strain",
        material=Material(E, 0.3),
        support=(
            Support("y1", dict(zip("xy", foot, strict=True)), stiffness=spring),
            Support("x0", stiffness=50.0),
        ),
        load=(Load("x1", traction=(0.1, 0.2)),),
        contact=(
            Contact(
                "y0",
                obstacle=Obstacle(gap=0.0),
                friction_coefficient=0.3,
                penalty_parameter=1e-7,
            ),
        ),
        solver=SolverSettings(solver="condensed", errors="none"),
    )


def numbers(found):
    quantities = found.quantities
    return {
        "y1.reaction_x": found.reactions["y1"].reaction[0],
        "y1.reaction_y": found.reactions["y1"].reaction[1],
        "y1.reaction_moment": found.reactions["y1"].reaction_moment,
        "x0.reaction_x": found.reactions["x0"].reaction[0],
        "reaction_y": quantities["reaction"][1],
        "strain_energy": quantities["strain_energy"],
        "normal_force": quantities["normal_force"],
    }


def test_derivatives_by_foot_and_stiffness_are_those_of_finite_differences():
    solid, of = body_of(8, 2), tuple(numbers(run(rubbed(), COMM, body_of(8, 2))))
    ways = {
        "support.0.displacement.y": (1e-6, lambda h: rubbed(foot=(0.003, -0.02 + h))),
        "support.0.displacement.x": (1e-6, lambda h: rubbed(foot=(0.003 + h, -0.02))),
        "support.0.stiffness.y": (1e-3, lambda h: rubbed(stiffness=(K, 2 * K + h))),
        "support.0.stiffness.x": (1e-3, lambda h: rubbed(stiffness=(K + h, 2 * K))),
    }
    asked = DerivativeRequest(of=of, by=tuple(ways))
    found = run(replace(rubbed(), derivatives=asked), COMM, solid).derivatives
    for key, (step, scene) in ways.items():
        after, before = (numbers(run(scene(h), COMM, solid)) for h in (step, -step))
        for name in of:
            slope = (after[name] - before[name]) / (2 * step)
            size = max(abs(slope), 1e-4 * abs(after[name]))
            assert found[name][key].value == pytest.approx(slope, abs=2e-3 * size), (key, name)


def test_energies_balance_along_a_path_with_friction():
    """The foot presses the block on and drags it: work becomes strain, springs and friction."""
    there = Path((0, 1, 2), (0, 1, 0.5))
    scene = rubbed(foot=(0.04, -0.05))
    support = (replace(scene.support[0], path=there), scene.support[1])
    contact = (replace(scene.contact[0], law="incremental"),)
    scene = replace(
        scene, support=support, contact=contact, load=(), steps=Steps(number=16, end=2.0)
    )
    found = run(scene, COMM, body_of(8, 2))
    assert found.passed, found.verdict
    assert found.checks["energy_balance"].passed
    quantities = found.quantities
    parts = ("strain_energy", "spring_energy", "penalty_energy", "friction_work")
    stored = sum(quantities[name] for name in parts)
    assert quantities["spring_energy"] > 0.1 * stored
    assert quantities["external_work"] == pytest.approx(stored, rel=2e-2)


def test_a_stiff_block_on_springs_swings_as_a_mass_does():
    scene = Scene(
        kinematics="plane strain",
        material=Material(1e9, 0.3, density=2.0),
        support=(Support("y0", stiffness={"x": 5.0, "y": 7.0}),),
        modes=Modes(2),
        solver=SolverSettings(errors="none"),
    )
    found = run(scene, COMM, box_body((8, 1), (1, 0.02)))
    frequencies = [mode.natural_frequency for mode in found.modes]
    assert frequencies == pytest.approx(
        np.sqrt(np.array([5.0, 7.0]) / 0.04) / (2 * np.pi), rel=2e-3
    )


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"stiffness": -1.0}, "greater than 0"),
        ({"stiffness": 1.0, "foundation_stiffness": 1.0}, "not both"),
        ({"stiffness": {"x": 1.0}, "displacement": {"y": 0}}, "displacement.y: no spring acts"),
        ({"stiffness": 1.0, "rotation": {"angle": 0.1}}, "rotation: not beside stiffness"),
    ],
)
def test_springs_that_contradict_themselves_are_refused(keys, said):
    with pytest.raises(InputError, match=said):
        Support("x0", **keys)


def test_models_that_springs_do_not_fit_are_refused():
    scene, _ = bar()
    deep = replace(scene.support[0], stiffness={"z": 1.0})
    with pytest.raises(
        InputError, match=r"support\[0\].stiffness.z: a plane strain model has only"
    ):
        run(replace(scene, support=(deep, *scene.support[1:])), COMM, body())
    with pytest.raises(InputError, match="shares boundary with the support on 'x0'"):
        run(replace(scene, contact=(Contact("x0", obstacle=Obstacle(gap=0.0)),)), COMM, body())
    with pytest.raises(
        InputError, match=r"half_space: its boundary holds it, so leave out support"
    ):
        replace(scene, load=(), half_space=HalfSpace(on=("x1",)))


def test_a_study_follows_foot_and_stiffness():
    """Its quick answers, and those of other springs, are those of runs."""
    solid, study = body_of(8, 2), Study(rubbed(), body=body_of(8, 2))
    for other in (rubbed(), rubbed(foot=(0.002, -0.03)), rubbed(stiffness=(K, 5.0))):
        expected = numbers(run(other, COMM, solid))
        quick, whole = study.quantities(other), study.solve(other)
        assert numbers(whole) == pytest.approx(expected, rel=1e-7)
        for name in ("spring_energy", "strain_energy", "normal_force", "external_work"):
            assert quick.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-7), name
