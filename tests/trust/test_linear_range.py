"""Strains, rotations and indentations beyond linear theory are said; what is inside out fails."""

import dataclasses
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    Obstacle,
    Path,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Support,
    load_scene,
)
from fenics_contact.cli.summary import print_result
from fenics_contact.report.page.tables import checks_table
from fenics_contact.results.check_messages import failure
from fenics_contact.solve.load_steps.load_stepper import solve
from fenics_contact.trust.linear_range import TURNED, LinearRange, exceeded, linear_range
from fenics_contact.trust.strain_zones import Zone
from tests.scenes import ROOT, box_body, slab
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
BEYOND = "Outside the range of linear theory"


def block(pressed, cells=(8, 8), path=None, steps=None, kinematics="plane strain", **changes):
    """A block of height 1 whose top is moved down, between smooth sides: strained evenly."""
    sides = {f"{axis}0": {axis: 0} for axis in "xyz"[: len(cells)]}
    top = f"{'xyz'[len(cells) - 1]}1"
    supports = [Support(side, held) for side, held in sides.items()]
    down = {top[0]: -pressed}
    supports.append(Support(top, down) if path is None else Support(top, down, path=path))
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=tuple(supports),
        **({} if steps is None else {"steps": steps}),
        **changes,
    )
    return Run(scene, COMM, box_body(cells, (1,) * len(cells)))


@pytest.mark.parametrize("cells", [(4, 4), (24, 24)])
def test_a_block_pressed_together(cells):
    """By .09 of its height without a word, by .15 with one, by 1.5 it is no answer."""
    for pressed, code, said in [(0.09, 0, False), (0.15, 0, True), (1.5, 4, True)]:
        result = block(pressed, cells).solve()
        assert result.exit_code == code
        assert (BEYOND in result.verdict) == said
        assert result.checks["linear_range"].passed == (code == 0)
        found = result.steps[-1]["linear_range"]["strain"]["value"]
        assert found == pytest.approx(pressed, rel=1e-9)
    assert "strains of 150 % in 'body'" in result.verdict
    assert "100 % of the volume is turned inside out" in result.verdict


def test_no_table_says_that_linear_theory_holds_where_the_verdict_says_that_it_does_not(tmp_path):
    """The check that passes looks for what is impossible, and is called so where people read."""
    result = block(0.15, (4, 4)).solve()
    assert BEYOND in result.verdict and result.checks["linear_range"].passed
    if COMM.rank == 0:
        printed = StringIO()
        with redirect_stdout(printed):
            print_result(result, tmp_path)
        for table in (printed.getvalue().replace(result.verdict, ""), checks_table(result)):
            rows = [line for line in str(table).splitlines() if "inside out or overlapping" in line]
            assert len(rows) == 1
            assert "linear range" not in table
    said = failure("linear_range", dataclasses.replace(result.checks["linear_range"], value=0.5))
    assert said.startswith("inside out or overlapping: 50 % of the volume is turned inside out")


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
@pytest.mark.parametrize("degree", [1, 2])
def test_an_even_gradient(cell, degree):
    """The largest principal strain and the angle of any H, exactly."""
    size = 2 if cell in ("triangle", "quadrilateral") else 3
    kind = getattr(mesh.CellType, cell)
    scene = Scene(
        kinematics="3D" if size == 3 else "plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(Support("x0", dict.fromkeys("xyz"[:size], 0)),),
        load=(Load("x1", traction=(1, *[0] * (size - 1))),),
    )
    prepared = Run(scene, COMM, box_body((3,) * size, (1, 1, 1), kind))
    solution = solve(prepared.problem)
    gradient = np.random.default_rng(3).normal(size=(size, size)) * 0.2
    found = of_gradient(prepared, solution, gradient)
    strain = np.linalg.eigvalsh(0.5 * (gradient + gradient.T))
    skew = 0.5 * (gradient - gradient.T)
    assert found["strain"]["value"] == pytest.approx(np.abs(strain).max(), rel=1e-9)
    angle = np.abs(np.linalg.eigvals(skew)).max()  # of a rotation by the angle: ± i
    assert found["rotation"]["value"] == pytest.approx(angle, rel=1e-9)
    assert found["turned"]["value"] == 0


def of_gradient(prepared, solution, gradient):
    """What is found of u = H x."""
    x = prepared.problem.spaces.coordinates[:, : len(gradient)]
    moved = with_body(solution, displacement=x @ gradient.T)
    return LinearRange(prepared.problem).of(moved)


def test_out_of_plane_strains():
    """Around an axis u_r/r; in plane stress what makes σ_zz vanish, −ν/(1 − ν) (e_xx + e_yy)."""
    ring = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        support=(Support("y0", {"y": 0}),),
        load=(Load("y1", pressure=1),),
    )
    prepared = Run(ring, COMM, box_body((4, 4), (1, 1)))
    solution = solve(prepared.problem)
    found = of_gradient(prepared, solution, np.diag([-0.3, 0.05]))
    assert found["strain"]["value"] == pytest.approx(0.3, rel=1e-9)
    moved = with_body(solution, displacement=0 * solution.displacement + [0.3, 0])
    at = LinearRange(prepared.problem).of(moved)["strain"]["value"]  # .3/r, near the axis
    assert 1 < at < 0.3 / 1e-2

    for young in (1000, lambda x: 1000 + 10 * x[0]):
        material = Material(young, 0.45)
        prepared = Run(dataclasses.replace(slab(), material=(material,)), COMM)
        found = of_gradient(prepared, solve(prepared.problem), np.diag([0.1, 0.1]))
        assert found["strain"]["value"] == pytest.approx(0.45 / 0.55 * 0.2, rel=1e-9)


def test_curved_cells_turned_as_a_whole():
    prepared = Run(slab(cell="triangle", order=2), COMM)
    found = of_gradient(prepared, solve(prepared.problem), np.array([[0, -0.2], [0.2, 0]]))
    assert found["rotation"]["value"] == pytest.approx(0.2, rel=1e-9)
    assert found["strain"]["value"] < 1e-9


def failed_kind(found):
    """What fails of a step, or nothing."""
    check = linear_range([{"linear_range": found, "load_factor": 1.0}])
    return "" if check.passed else check.kind


def test_inside_out_twice_over_fails():
    """H = −1.5 I: det(I + H) = .25, but every line of the body has changed its ends."""
    prepared = block(0.1)
    solution = solve(prepared.problem)
    assert failed_kind(of_gradient(prepared, solution, -1.5 * np.eye(2))) == "turned"
    assert not failed_kind(of_gradient(prepared, solution, -0.9 * np.eye(2)))
    nothing = np.full((2, 2), np.nan)
    assert failed_kind(of_gradient(prepared, solution, nothing)) == "turned"


def test_a_thin_layer_inside_out_fails_and_one_corner_does_not():
    prepared = block(0.1, (64, 64))
    solution = solve(prepared.problem)
    x, y = prepared.problem.spaces.coordinates.T[:2]
    for chosen, kind in [(y > 1 - 1e-9, "turned"), ((x > 1 - 1e-9) & (y > 1 - 1e-9), "")]:
        pushed = 0 * solution.displacement
        pushed[chosen, 1] = -0.03  # through a cell of 1/64
        moved = with_body(solution, displacement=pushed)
        found = LinearRange(prepared.problem).of(moved)
        assert failed_kind(found) == kind
        assert (found["turned"]["value"] > TURNED) == bool(kind)
        assert found["turned"]["value"] > 0


def test_unbounded_strains_count_by_volume():
    """c/√r at a corner: what a hundredth of the square exceeds is that at π r²/4 = .01."""
    for cells in (20, 40, 80):
        middles = (np.arange(cells) + 0.5) / cells
        mine = middles[COMM.rank :: COMM.size]
        x, y = np.meshgrid(mine, middles)
        values = 0.1 / np.hypot(x, y).ravel() ** 0.5
        volumes = np.full(len(values), cells**-2.0)
        zone = Zone("square", False, np.arange(len(values)), volumes, 1.0)
        exact = 0.1 / np.sqrt(np.sqrt(0.04 / np.pi))
        assert exceeded(COMM, zone, values) == pytest.approx(exact, rel=2 / cells)


@pytest.mark.parametrize("indentation, said", [(0.04, False), (0.16, True)])
def test_a_finer_mesh_does_not_change_what_is_said_of_a_punch(indentation, said):
    """At its edges the ring strains the smallest cells most, and without bound."""
    found = []
    for size in (0.04, 0.01):
        scene = load_scene(ROOT / "demos" / "annulus.toml")
        source = scene.mesh[0]
        parameters = {**source.parameters, "size": size, "extent": 50}
        obstacle = dataclasses.replace(scene.contact[0].obstacle, indentation=indentation)
        scene = dataclasses.replace(
            scene,
            mesh=dataclasses.replace(source, parameters=parameters),
            contact=(dataclasses.replace(scene.contact[0], obstacle=obstacle),),
            solver=dataclasses.replace(scene.solver, errors="none"),
        )
        result = Run(scene, COMM).solve()
        assert result.passed and (BEYOND in result.verdict) == said
        found.append(result.steps[-1]["linear_range"]["strain"]["value"])
    assert found[0] == pytest.approx(found[1], rel=0.05)


def test_the_worst_load_step_counts():
    """Turned inside out on the way, and brought back."""
    there_and_back = block(1.5, path=Path((0, 0.5, 1), (0, 1, 0.01)), steps=Steps(number=4))
    result = there_and_back.solve()
    assert result.steps[-1]["linear_range"]["strain"]["value"] < 0.02
    assert result.exit_code == 4 and "strains of 150 % in 'body' at time 0.5" in result.verdict


def test_a_body_that_bends_through_its_plane_of_symmetry():
    """A mast held at its foot alone: its mirror image stands where it goes."""
    patches = {"foot": ("x0", lambda x: x[1] < 1)}
    for push, code in [(0.05, 0), (40.0, 4)]:
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            symmetry=("foot",),
            support=(Support("y0", {"y": 0}),),
            load=(Load("x1", traction=(-push, 0)),),
        )
        result = Run(scene, COMM, box_body((4, 16), (1, 4), patches=patches)).solve()
        assert result.exit_code == code
    assert "passes through a plane of symmetry" in result.verdict


def test_a_body_that_slid_into_an_obstacle():
    """Raised by .12 below a cylinder's side, and slid to below its apex, where the gap was 0."""
    obstacle = Obstacle(shape="cylinder", radius=1, position=(1, 1), indentation=0.01)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle),),
        solver=SolverSettings(errors="none"),
    )
    prepared = Run(scene, COMM, box_body((8, 8), (1, 1)))
    assert prepared.solve().passed
    kinematics, count = prepared.problem.contacts[0].kinematics, len(prepared.problem.load)
    for aside, kind in [(0.0, ""), (0.5, "overlap")]:
        moved = np.tile([aside, 0.12], (count, 1))
        kinematics.move(kinematics.relative(moved))
        solution = with_body(prepared.solution, displacement=moved)
        found = LinearRange(prepared.problem).of(solution)
        assert failed_kind(found) == kind
    assert found["overlap"]["value"] == pytest.approx(0.13, abs=1e-6)


def test_indentations_are_over_radius_or_thickness():
    """From where the obstacle first touches, and less what a body is moved by as a whole."""
    shapes = {"radius": Obstacle(shape="parabola", radius=0.3, position=(0.5, 1.2))}
    shapes["thickness"] = Obstacle(shape="plane", position=(0.5, 1.2))
    for (_, shape), wanted in zip(shapes.items(), (0.06 / 0.3, 0.06), strict=True):
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            support=(Support("y0", {"x": 0, "y": 0.1}),),
            contact=(Contact("y1", obstacle=dataclasses.replace(shape, indentation=0.16)),),
            solver=SolverSettings(errors="none"),
        )
        result = Run(scene, COMM, box_body((8, 8), (1, 1))).solve()
        found = result.steps[-1]["linear_range"]["indentation"]
        assert found["value"] == pytest.approx(wanted, rel=1e-9)
        assert ("an indentation of 20 %" in result.verdict) == (wanted > 0.1)
