"""Derivatives that a scene asks for: of the continuous problem, and of the discrete answer."""

import dataclasses
import json
from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    HalfSpace,
    Material,
    Obstacle,
    Scene,
    Steps,
    Study,
    Support,
    load_scene,
    main,
    run,
)
from fenics_contact.analyses.derivatives.means import Mean
from fenics_contact.analyses.derivatives.table import DerivativeRequest
from fenics_contact.analyses.derivatives.task import _derivative
from fenics_contact.analyses.derivatives.windows import Window
from fenics_contact.analyses.derivatives.words import notes_on_derivatives
from fenics_contact.problem.problem import Problem
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.scene_run import Run
from fenics_contact.simulation.studies.solved_derivatives import has_kink
from tests.messages import refused
from tests.scenes import ROOT, box_body
from tests.simulation.sensitivities.test_derivatives import (
    DELTA,
    HEIGHT,
    NU,
    PENALTY,
    WIDTH,
    E,
    uniform_block,
)
from tests.simulation.studies.cases import BALL, DEPTH, MU, ON_A_FLOOR, square
from tests.solve.load_steps.histories import DRAGGED, PRESSED

RADIUS = "contact.0.obstacle.radius"


def asking(scene, of, by=None):
    solver = dataclasses.replace(scene.solver, errors="none")
    return dataclasses.replace(scene, derivatives=DerivativeRequest(of, by), solver=solver)


def test_of_a_sphere_without_friction_they_are_those_of_hertz():
    """F = (4/3) E* √R d^(3/2), p₀ = (2 E*/π) √(d/R), a = √(R d); the mesh has 14 cells in a."""
    scene = load_scene(ROOT / "demos" / "sphere.toml", [f"{MU}=0"])
    of = ("normal_force", "max_contact_pressure", "contact_radius")
    found = run(asking(scene, of)).derivatives
    young, ratio, radius, depth = 1000.0, 0.3, 8.0, 1.0
    modulus = young / (1 - ratio**2)
    force = 4 / 3 * modulus * np.sqrt(radius) * depth**1.5
    expected = {
        E: force / young,
        NU: force * 2 * ratio / (1 - ratio**2),
        DEPTH: 1.5 * force / depth,
        RADIUS: force / (2 * radius),
    }
    assert {*found["normal_force"]} == {*expected}
    for key, slope in expected.items():
        assert found["normal_force"][key].value == pytest.approx(slope, rel=3e-3), key
    peak = 2 * modulus / np.pi * np.sqrt(depth / radius)
    peaks = found["max_contact_pressure"]
    assert peaks[DEPTH].value == pytest.approx(peak / 2 / depth, rel=5e-3)
    assert peaks[RADIUS].value == pytest.approx(-peak / 2 / radius, rel=1e-2)
    assert peaks[E].value == pytest.approx(peak / young, rel=3e-3)
    radii = found["contact_radius"]
    assert radii[DEPTH].value == pytest.approx(np.sqrt(radius / depth) / 2, rel=0.04)
    assert radii[DEPTH].discrete is None
    # From cell to cell the discrete ones jump by more than their means are off.
    discrete = found["normal_force"][RADIUS]
    assert abs(discrete.discrete / expected[RADIUS] - 1) > 0.01
    assert abs(discrete.value - discrete.discrete) <= discrete.spread


def cylinder(shift, cells):
    """A parabola of radius 1 pressed on a half-plane by a force and moved; its cells."""
    young, ratio, half_width = 1000.0, 0.49, 0.16
    force = np.pi * young / (1 - ratio**2) * half_width**2 / 4
    obstacle = Obstacle(
        "parabola",
        radius=1,
        position=(0, 0),
        force=force,
        displacement=(shift, 0),
        path=PRESSED,
        displacement_path=DRAGGED,
    )
    scene = Scene(
        kinematics="plane strain",
        material=Material(young, ratio),
        half_space=HalfSpace(("x0", "x1", "y0")),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.3, law="incremental"),),
        steps=Steps(times=(0.5, 1.0)),
    )
    body = box_body((cells, cells // 2), (2, 1))
    points = body.mesh.geometry.x
    across, down = points[:, 0] - 1, points[:, 1] - 1
    points[:, 0], points[:, 1] = (np.sinh(4 * x) / np.sinh(4) for x in (across, down))
    return scene, body, half_width, force


@pytest.mark.parametrize("intervals", [8, 16])
def test_slopes_in_a_window_are_those_of_a_curved_function(intervals):
    """Exact of cubics, whose mean slope is off by h²/12 times its second derivative, with h half
    the width; of what repeats over a cell a fifth is left."""
    window = Window.of_boxes(0.3, 0.2, 0.2, intervals)
    places = window.places
    slope, spread = window.slope(places**3)
    assert slope == pytest.approx(3 * 0.3**2, rel=1e-12) and spread < 1e-12
    mean, _ = window.mean(places**3)
    assert mean == pytest.approx(3 * 0.3**2 + 6 * 0.2**2 / 12, rel=1e-2)
    waves = [window.slope(np.sin(2 * np.pi * places / 0.2 + phase))[0] for phase in range(6)]
    assert np.abs(waves).max() < 0.25 * 2 * np.pi / 0.2


@cache
def asked_of_cylinder(cells):
    scene, body, *_ = cylinder(0.008, cells)
    return run(asking(scene, ("friction_force_x", "stick_area"), (MU,)), body=body)


def test_friction_under_a_given_shift_follows_the_coefficient():
    """Against differences of runs on a finer mesh, to order 4 in their steps."""
    result = asked_of_cylinder(60)
    scene, body, *_ = cylinder(0.008, 120)
    finer, step = Study(scene, body=body), 0.03
    nearest, next_ones = (
        np.diff([finer.quantities({MU: 0.3 + d}).quantities["friction_force"][0] for d in (-w, w)])
        for w in (step, 2 * step)
    )
    expected = float((8 * nearest - next_ones)[0]) / (12 * step)
    found = result.derivatives["friction_force_x"][MU]
    assert found.value == pytest.approx(expected, rel=0.02) and not found.of_single_answers


def test_single_answers_that_differ_have_a_spread():
    """In a window narrower than a cell a small spread says nothing, a large one that they jump."""
    jumps = _derivative(Mean(1.79, 0.4, True), 3.76, 1.0, False)
    assert jumps.of_single_answers and jumps.spread == pytest.approx(3.76 - 1.79)
    assert _derivative(Mean(1.79, 0.4, True), 1.8, 1.0, False).spread == 0.4
    assert _derivative(Mean(1.79, 0.01, True), 1.8, 1.0, False).spread is None
    assert _derivative(Mean(1.79, 0.01, False), 1.8, 1.0, False).spread == pytest.approx(0.01)


def test_where_no_window_is_wide_enough_it_is_said():
    """Of cells so large that a quarter of the coefficient moves the edge of stick by less."""
    result, finer = asked_of_cylinder(20), asked_of_cylinder(60)
    found = result.derivatives["friction_force_x"][MU]
    assert found.of_single_answers and found.spread is None
    assert found.value == pytest.approx(found.discrete, rel=1e-3)
    assert abs(found.value / finer.derivatives["friction_force_x"][MU].value - 1) > 0.2
    assert result.derivatives["stick_area"][MU].value is None
    (said,) = notes_on_derivatives(result)
    assert f"Cells are too large for means by {MU}" in said


def test_the_half_width_that_sticks_follows_the_coefficient_as_cattaneo_has_it():
    """c = a √(1 − q), q = Q/(μP); of a shift that is given, Q follows the coefficient, too."""
    scene, body, half_width, force = cylinder(0.008, 60)
    result = run(
        asking(scene, ("stick_area", "friction_force_x", "contact_area"), (MU,)), body=body
    )
    friction = result.quantities["friction_force"][0]
    found = {name: slopes[MU].value for name, slopes in result.derivatives.items()}
    part = friction / (0.3 * force)
    of_part = found["friction_force_x"] / (0.3 * force) - part / 0.3
    expected = -half_width / 2 / np.sqrt(1 - part) * of_part
    assert 0.45 < part < 0.6
    assert found["stick_area"] / 2 == pytest.approx(expected, rel=0.03)
    # The edge of contact does not move by a cell: nothing is said of it.
    assert found["contact_area"] is None


def test_where_no_edge_moves_both_are_those_of_the_formula():
    """Force W δ / c with c = h (1 − ν²)/E + ε₁ of a block that touches everywhere."""
    c = HEIGHT * (1 - 0.3**2) / 1000 + PENALTY
    force, down = WIDTH * DELTA / c, "support.0.displacement.y"
    slopes = {
        E: force / c * HEIGHT * (1 - 0.3**2) / 1000**2,
        "contact.0.penalty_parameter": -force / c,
        down: -WIDTH / c,
    }
    scene = asking(uniform_block(), ("normal_force",), tuple(slopes))
    found = run(scene, body=box_body((3, 2), (WIDTH, HEIGHT))).derivatives["normal_force"]
    assert list(found) == list(slopes)
    for key, slope in slopes.items():
        assert found[key].discrete == pytest.approx(slope, rel=1e-8)
        assert found[key].value == pytest.approx(slope, rel=1e-4)
        assert found[key].spread < 1e-3 * abs(slope)
        assert not found[key].one_sided


def test_tolerances_add_up_as_independent_errors():
    """Of the block that touches everywhere, F = W δ / c."""
    c = HEIGHT * (1 - 0.3**2) / 1000 + PENALTY
    force, down = WIDTH * DELTA / c, "support.0.displacement.y"
    scene = asking(uniform_block(), ("normal_force",), ())
    scene = dataclasses.replace(scene, tolerances={E: 50.0, down: 1e-5})
    result = run(scene, body=box_body((3, 2), (WIDTH, HEIGHT)))
    parts = [force / c * HEIGHT * (1 - 0.3**2) / 1000**2 * 50, WIDTH / c * 1e-5]
    found = result.uncertainty["normal_force"]
    assert list(found.by.values()) == pytest.approx(parts, rel=1e-4)
    assert found.data == pytest.approx(np.hypot(*parts), rel=1e-4)
    assert found.data_at_most == pytest.approx(sum(parts), rel=1e-4)
    assert found.numerical is None and found.larger is None  # no bars were asked for


@pytest.mark.parametrize(
    ("tolerances", "said"),
    [
        ({"solver.tolerance": 1e-3}, "tolerance_of_solver_has_no_derivative"),
        ({"contact.0.nothing": 1.0}, "tolerance_of_unknown_key"),
    ],
)
def test_tolerances_of_what_has_no_derivative_are_refused(tolerances, said):
    scene = dataclasses.replace(asking(ON_A_FLOOR, ("normal_force",)), tolerances=tolerances)
    with refused(said):
        Run(scene, body=square())


def test_tolerances_are_of_quantities_that_are_named():
    with refused("tolerances_without_quantities"):
        dataclasses.replace(ON_A_FLOOR, tolerances={MU: 0.1})
    with refused("tolerance_is_zero"):
        dataclasses.replace(asking(ON_A_FLOOR, ("normal_force",)), tolerances={MU: 0.0})


def test_discrete_ones_are_those_of_a_study():
    scene = asking(BALL, ("normal_force", "friction_work"), (MU, DEPTH))
    found = run(scene, body=box_body((8, 8), (1, 1))).derivatives
    study = Study(BALL, body=box_body((8, 8), (1, 1)))
    expected = study.derivatives(["normal_force", "friction_work"], [MU, DEPTH])
    for name, slopes in expected.items():
        for key, slope in slopes.items():
            assert found[name][key].discrete == pytest.approx(slope, rel=1e-7)


def test_friction_at_a_fixed_motion_follows_its_coefficient_while_all_slips():
    """A block dragged far: friction is μ times the force that presses it, whatever the cells."""
    changed = dataclasses.replace(ON_A_FLOOR.support[0], displacement={"x": 0.02, "y": -0.002})
    scene = dataclasses.replace(ON_A_FLOOR, support=(changed,), load=())
    found = run(asking(scene, ("friction_force_x",), (MU,)), body=square())
    slope = found.derivatives["friction_force_x"][MU]
    # The sides of the block lift a little, so that the force itself follows μ: differences tell.
    ends = [
        run(dataclasses.replace(scene, contact=(c,)), body=square()).quantities["friction_force"][0]
        for c in (
            dataclasses.replace(scene.contact[0], friction_coefficient=mu) for mu in (0.27, 0.33)
        )
    ]
    assert slope.value == pytest.approx((ends[1] - ends[0]) / 0.06, rel=0.02)


def test_points_that_just_touch_make_it_one_sided():
    prepared = Run(BALL, body=box_body((6, 6), (1, 1)))
    prepared.solve()
    problem, solution = prepared.problem, prepared.solution
    assert isinstance(problem, Problem) and not has_kink(problem, solution)
    (state,) = solution.states
    touching = dataclasses.replace(state, gap=np.where(state.gap > 0, 0.0, state.gap))
    assert has_kink(problem, dataclasses.replace(solution, states=[touching]))
    (contact,) = problem.contacts
    longest = contact.regularisation_parameter
    slip = np.zeros_like(state.slip)
    slip[:, 0] = longest * (1 + 1e-10)
    assert has_kink(problem, dataclasses.replace(solution, states=[_with(state, slip)]))
    assert not has_kink(problem, dataclasses.replace(solution, states=[_with(state, 1.1 * slip)]))


def _with(state, slip):
    return dataclasses.replace(state, slip=slip)


@pytest.mark.parametrize(
    ("of", "by", "said"),
    [
        ("max_penetration", None, "max_penetration_is_now_indentation"),
        ("friction_force", None, "derivative_of_a_vector"),
        ("normal_force", "solver.tolerance", "derivative_by_solver_tolerance"),
        ("normal_force", "contact.7.radius", "derivative_by_unknown_key"),
    ],
)
def test_what_has_none_is_refused_before_anything_is_solved(of, by, said):
    with refused(said):
        Run(asking(ON_A_FLOOR, (of,), by and (by,)), body=square())


def test_quantities_are_named_once():
    with refused("derivatives_of_nothing"):
        DerivativeRequest(())
    with refused("derivatives_of_one_twice"):
        DerivativeRequest(("normal_force", "normal_force"))


@pytest.mark.serial
def test_a_scene_file_asks_and_the_files_tell(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "own", "--quiet"]) == 0
    text = (tmp_path / "own.toml").read_text()
    asked = """
[derivatives]
of = ["friction_force_x"]
by = ["load.1.traction.0"]

[tolerances]
load.1.traction.0 = 0.3
"load.0.pressure" = 1
"""
    (tmp_path / "own.toml").write_text(text + asked)
    assert main(["run", "own.toml", "--out", "out"]) == 0
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    slope = result["derivatives"]["friction_force_x"]["load.1.traction.0"]
    names = {"value", "spread", "discrete", "normalised", "one_sided", "of_single_answers"}
    assert set(slope) == names
    assert slope["of_single_answers"]  # the edge of stick moves by less than a cell
    assert slope["normalised"] == pytest.approx(1.0, rel=1e-6)
    unsure = result["uncertainty"]["friction_force_x"]
    assert unsure["data"] == pytest.approx(0.3, rel=1e-6)  # the pressure has no part in it
    assert unsure["by"]["load.0.pressure"] == pytest.approx(0.0, abs=1e-6)
    assert unsure["numerical"] is unsure["larger"] is None  # histories have no bars by themselves
    assert slope["value"] == pytest.approx(-1.0, rel=1e-6)  # equilibrium
    assert slope["discrete"] == pytest.approx(-1.0, rel=1e-8)
    printed = capsys.readouterr().out
    assert "derivative of" in printed and "by tolerances" in printed
    assert "  load.1.traction.0 " in printed  # in full, however narrow the terminal
    assert main(["report", "out", "--quiet"]) == 0
    page = (tmp_path / "out" / "report.html").read_text()
    assert "friction_force_x: which number moves it most" in page
    assert "The data or the mesh" in page


def test_of_a_block_under_a_rough_plane_by_what_moves_no_edge(tmp_path):
    """The force is E times a function of ν, times what the plane is pushed in by."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                on="y1",
                friction_coefficient=0.3,
                obstacle=Obstacle(
                    shape="plane", position=(0.5, 1), normal=(0, -1), indentation=0.01
                ),
            ),
        ),
    )
    scene = asking(scene, ("normal_force",), (E, "contact.0.obstacle.indentation"))
    body = box_body((4, 4), comm=MPI.COMM_SELF)
    files.solve_and_write(Run(scene, MPI.COMM_SELF, body), tmp_path)
    written = json.loads((tmp_path / "result.json").read_text())
    force, found = written["quantities"]["normal_force"], written["derivatives"]["normal_force"]
    assert found[E]["value"] == pytest.approx(force / 1000, rel=2e-4)
    assert found["contact.0.obstacle.indentation"]["value"] == pytest.approx(force / 0.01, rel=2e-4)


def test_keys_of_a_table_that_there_is_once_may_leave_its_number_out():
    """As in files and for ``--set``; results have the key as it was asked for."""
    pairs = {"material.youngs_modulus": E, "support.displacement.y": "support.0.displacement.y"}
    scene = asking(uniform_block(), ("normal_force",), (*pairs, *pairs.values()))
    found = run(scene, body=box_body((2, 2), (WIDTH, HEIGHT))).derivatives
    for short, counted in pairs.items():
        one, other = found["normal_force"][short], found["normal_force"][counted]
        for name in ("value", "discrete"):
            assert one[name] and one[name] == pytest.approx(other[name], rel=1e-9), name
