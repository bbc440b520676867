"""Nonlocal friction against averages made here, closed forms, other solvers, and Coulomb's law."""

import dataclasses

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    InputError,
    Load,
    Material,
    NoEquilibriumError,
    NonlocalFriction,
    Obstacle,
    Run,
    Scene,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.run_checks import run_checks
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
MU, RADIUS = 0.4, 0.3
CELLS = {"2": (12, 6), "3": (3, 4, 2)}


def nonlocal_law(radius=RADIUS):
    return None if radius is None else NonlocalFriction(kind="nonlocal", averaging_radius=radius)


def block(radius=RADIUS, kinematics="plane strain", degree=2, shift=0.003, **keys):
    """Pressed onto a rough plane by its glued top, which is moved along it, too."""
    axes = "xyz" if kinematics == "3D" else "xy"
    across = axes[-1]
    moved = dict.fromkeys(axes, 0.0) | {across: -0.01}
    if kinematics != "axisymmetric":
        moved["x"] = shift
    normal = tuple(float(axis == across) for axis in axes)
    contact = Contact(
        f"{across}0",
        obstacle=Obstacle("plane", position=(0.0,) * len(axes), normal=normal),
        friction_coefficient=MU,
        friction_law=nonlocal_law(radius),
        **keys,
    )
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        support=(Support(f"{across}1", moved),),
        contact=(contact,),
    )


def body_of(scene, cell=None):
    cells = CELLS["3" if scene.kinematics == "3D" else "2"]
    return box_body(cells, (1, 1, 0.5), cell)


def quantities(scene, body):
    result = run(with_solver(scene, errors="none"), COMM, body)
    assert result.passed, result.verdict
    return result.quantities


def same(found, expected, near=1e-8):
    for name in ("pressure_integral", "friction_force", "friction_work", "max_slip"):
        scale = np.abs(expected[name]).max() if name != "friction_force" else None
        scale = scale or expected["pressure_integral"]
        assert found[name] == pytest.approx(expected[name], abs=near * scale), name


def averaged(x, pressure, weights, radius):
    """The kernel's mean of a pressure, on a straight line far from its ends."""
    ratio = np.abs(x[:, None] - x[None, :]) / radius
    with np.errstate(divide="ignore", over="ignore"):
        kernel = np.where(ratio < 1, np.exp(-1 / (1 - np.minimum(ratio, 1 - 1e-12) ** 2)), 0)
    return (kernel @ (weights * pressure)) / (kernel @ weights)


def test_where_all_slips_friction_is_the_averaged_pressure():
    """t = μ (w ∗ p) at each point, and μ P in all; Coulomb's law has μ p instead."""
    scene = block(shift=0.1, radius=0.12)
    made = Run(with_solver(scene, errors="none"), COMM, box_body((40, 8)))
    result = made.solve()
    assert result.passed, result.verdict
    points = result.points
    trace = made.problem.contacts[0].trace
    rows = np.column_stack([trace.coordinates[:, 0], trace.weights])[trace.owned]
    rows = np.concatenate(COMM.allgather(rows))
    rows = rows[np.argsort(rows[:, 0])]
    if COMM.rank == 0:  # which has the points
        assert "STICK" not in points.status
        order = np.argsort(points.coordinates[:, 0])
        x, pressure = points.coordinates[order, 0], points.contact_pressure[order]
        traction = -points.friction_traction[order, 0]
        expected = MU * averaged(x, pressure, rows[:, 1], 0.12)
        inner = (x > 0.3) & (x < 0.7)
        assert traction[inner] == pytest.approx(expected[inner], rel=1e-4)
        assert np.abs(traction - MU * pressure).max() > 0.1 * MU * pressure.max()
    total = result.quantities["pressure_integral"]
    assert result.quantities["friction_force"][0] == pytest.approx(-MU * total, rel=1e-10)


@pytest.mark.parametrize("kinematics", ["plane strain", "axisymmetric", "3D"])
def test_a_radius_of_a_tenth_of_a_cell_is_coulombs_law(kinematics):
    scene = block(1 / 120, kinematics)
    body = body_of(scene)
    same(quantities(scene, body), quantities(block(None, kinematics), body), 1e-10)


@pytest.mark.parametrize(
    ("kinematics", "solver", "strategy", "cell"),
    [
        ("plane strain", "full", "monolithic", None),
        ("plane strain", "condensed", "campos", None),
        ("plane strain", "condensed", "lagged", None),
        ("axisymmetric", "full", "lagged", None),
        ("3D", "iterative", "monolithic", None),
        ("3D", "full", "monolithic", CellType.tetrahedron),
        ("3D", "iterative", "monolithic", CellType.tetrahedron),
    ],
)
def test_every_solver_finds_the_same(kinematics, solver, strategy, cell):
    """Also with points between nodes, as tetrahedra have; and it is not Coulomb's answer."""
    scene = block(RADIUS, kinematics)
    body = body_of(scene, cell)
    expected = quantities(with_solver(scene, solver="condensed"), body)
    found = quantities(with_solver(scene, solver=solver, strategy=strategy), body)
    same(found, expected, 1e-7)
    coulomb = quantities(block(None, kinematics), body)
    assert abs(coulomb["friction_work"] / expected["friction_work"] - 1) > 0.05


@pytest.mark.parametrize("radius", [RADIUS, 2.0])
def test_the_answer_is_one_of_many_load_steps(radius):
    """Incrementally, under a load that only grows: pressed, then moved along in steps."""
    scene = block(radius, law="incremental", shift=0.02)
    body = box_body((8, 4))
    stepped = dataclasses.replace(scene, steps=Steps(4))
    result = run(with_solver(stepped, errors="none"), COMM, body)
    assert result.passed, result.verdict
    total = result.quantities["pressure_integral"]
    assert abs(result.quantities["friction_force"][0]) <= MU * total * (1 + 1e-9)
    assert {"friction_cone", "friction_law", "outer_loop", "dissipation"} <= set(result.checks)


@pytest.mark.parametrize(("dimension", "solver"), [(2, "full"), (3, "full"), (3, "iterative")])
def test_two_bodies_answer_alike_by_every_solver(dimension, solver):
    """The slave is the smaller one's surface; all of it averages, and what it faces none."""
    if dimension == 2:
        lower = Box("lower", (0.0, -1.0), (2.0, 0.0), (12, 5))
        upper = Box("upper", (0.1, 0.0), (1.1, 1.0), (7, 6))
    else:
        lower = Box("lower", (0.0, 0.0, -0.5), (1.0, 1.0, 0.0), (3, 3, 1))
        upper = Box("upper", (0.2, 0.2, 0.0), (0.8, 0.8, 0.5), (3, 3, 2))
    axes = "xyz"[:dimension]
    scene = Scene(
        kinematics="plane strain" if dimension == 2 else "3D",
        material=Material(1000, 0.3),
        support=(
            Support(f"lower.{axes[-1]}0", dict.fromkeys(axes, 0)),
            Support(f"upper.{axes[-1]}1", dict.fromkeys(axes, 0) | {"x": 0.004, axes[-1]: -0.01}),
        ),
        contact=(
            Contact(
                f"upper.{axes[-1]}0",
                against=f"lower.{axes[-1]}1",
                friction_coefficient=MU,
                friction_law=nonlocal_law(),
            ),
        ),
    )
    body = boxes((lower, upper), "quadrilateral" if dimension == 2 else "hexahedron", COMM)
    expected = quantities(with_solver(scene, solver="condensed"), body)
    same(quantities(with_solver(scene, solver=solver, strategy="monolithic"), body), expected, 1e-7)
    assert abs(expected["friction_force"][0]) <= MU * expected["pressure_integral"]
    assert expected["friction_work"] > 0


def test_half_of_a_model_finds_half_of_the_whole():
    """Mirror images press, too."""
    whole = block(RADIUS, shift=0.0)
    half = dataclasses.replace(whole, symmetry=("x0",))
    found = quantities(half, box_body((6, 6), (0.5, 1)))
    expected = quantities(whole, box_body((12, 6)))
    for name in ("pressure_integral", "friction_work"):
        assert 2 * found[name] == pytest.approx(expected[name], rel=1e-7)


@pytest.mark.parametrize("radius", [0.05, RADIUS])
def test_a_load_along_is_held_up_to_the_coefficient_times_the_pressing_force(radius):
    """No force is lost to averages, at the edges of the block neither."""

    def pulled(share):
        return Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            load=(Load("y1", traction=(share * MU * 10, -10)),),
            contact=(
                Contact(
                    "y0",
                    obstacle=Obstacle("plane", position=(0, 0), normal=(0, 1)),
                    friction_coefficient=MU,
                    friction_law=nonlocal_law(radius),
                ),
            ),
        )

    body = box_body((10, 2), (1, 0.1))
    result = run(with_solver(pulled(0.99), errors="none"), COMM, body)
    assert result.passed, result.verdict
    assert result.quantities["friction_force"][0] == pytest.approx(-0.99 * MU * 10, rel=1e-8)
    motion = "translation along x"
    with refused("loads_exceed_friction", NoEquilibriumError, motion=motion, share="1.01"):
        run(pulled(1.01), COMM, body)


def test_checks_are_made_against_the_averaged_bound():
    """Coulomb's answer is no answer here: it lies beyond the bound, and was solved with another."""
    body = box_body((12, 6))
    runs = [Run(with_solver(block(r), errors="none"), COMM, body) for r in (RADIUS, None)]
    for one in runs:
        assert one.solve().passed
    problem = runs[0].problem
    checks = run_checks(BulkForces(problem, runs[0].solution))
    assert all(check.passed for check in checks.values())
    wrong = dataclasses.replace(runs[0].solution, friction_bound=runs[1].solution.friction_bound)
    assert not run_checks(BulkForces(problem, wrong))["outer_loop"].passed
    jump = runs[1].problem.contacts[0].kinematics.jump.x.array
    problem.contacts[0].kinematics.jump.x.array[:] = jump
    assert not run_checks(BulkForces(problem, runs[1].solution))["friction_cone"].passed


@pytest.mark.parametrize("key", ["contact.0.friction_coefficient", "support.0.displacement.y"])
def test_derivatives_are_those_of_whole_runs(key):
    scene = block(RADIUS)
    body = box_body((12, 6))
    names = ("pressure_integral", "friction_force_x")
    study = Study(with_solver(scene, errors="none"), COMM, body)
    found = study.derivatives(names, (key,))
    value = MU if "friction" in key else -0.01
    step = 1e-3 * value
    ends = [study.solve({key: value + sign * step}).quantities for sign in (1, -1)]
    for name in names:
        values = [end["friction_force"][0] if name.endswith("_x") else end[name] for end in ends]
        expected = (values[0] - values[1]) / (2 * step)
        size = abs(values[0] / value)  # of a derivative of what grows in proportion
        assert found[name][key] == pytest.approx(expected, rel=3e-5, abs=1e-6 * size), name


def test_studies_find_what_single_runs_find():
    """By the point-wise way, from the answer before; another radius is another average."""
    scene = with_solver(block(RADIUS), errors="none")
    body = box_body((12, 6))
    study = Study(scene, COMM, body)
    for radius in (RADIUS, 0.15, 0.6, 1 / 120):
        law = nonlocal_law(radius)
        found = study.solve({"contact.0.friction_law": law}).quantities
        same(found, quantities(block(radius), body))
        key = "contact.0.friction_law.averaging_radius"
        same(study.solve({key: radius}).quantities, found)


def test_a_radius_must_be_positive():
    with refused("averaging_radius_is_zero", (InputError, ValueError)):
        NonlocalFriction(kind="nonlocal", averaging_radius=0)


def test_results_have_the_bound():
    """At open points, too; its integral is μ times that of the pressure."""
    made = Run(with_solver(block(RADIUS, shift=0.1), errors="none"), COMM, box_body((12, 6)))
    result = made.solve()
    assert result.contacts[0].parameters["friction_law"].startswith("nonlocal")
    bound = made.solution.states[0].own["bound"]
    total = made.problem.contacts[0].trace.integral(bound)
    assert total == pytest.approx(MU * result.quantities["pressure_integral"], rel=1e-9)
    points = result.points
    if COMM.rank == 0:
        assert (points.own["bound"][points.status == "OPEN"] > 0).any()


def test_a_torque_is_held_up_to_the_coefficient_times_the_mean_lever():
    """Averaged over all of a square of side 1, μ F (√2 + ln(1 + √2)) / 6, wherever it is pressed.

    Coulomb's friction may be at the corners alone, with the lever √2 / 2.
    """
    lever, share = (np.sqrt(2) + np.log(1 + np.sqrt(2))) / 6, 1.2
    turning = share * lever * MU * 10 * 6  # of a traction (−y, x): ∫ x² + y² is 1/6

    def turned(radius):
        return Scene(
            kinematics="3D",
            material=Material(1000, 0.3),
            load=(
                Load(
                    "z1",
                    traction=(
                        lambda x: -turning * (x[1] - 0.5),
                        lambda x: turning * (x[0] - 0.5),
                        -10,
                    ),
                ),
            ),
            contact=(
                Contact(
                    "z0",
                    obstacle=Obstacle("plane", position=(0, 0, 0), normal=(0, 0, 1)),
                    friction_coefficient=MU,
                    friction_law=nonlocal_law(radius),
                ),
            ),
        )

    body = box_body((6, 6, 1))
    turned_over = {"motion": "rotation about z", "share": "…"}
    with refused("loads_exceed_friction", NoEquilibriumError, **turned_over) as caught:
        Run(turned(100.0), COMM, body)
    found = float(str(caught.value).split("the loads are ")[1].split(" times")[0])
    assert found == pytest.approx(share, rel=0.01)
    Run(turned(None), COMM, body)
