"""Rules of how large friction may be: their tangents, all ways to solve, files, and refusals."""

import csv
import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Motion,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.common.parallel import on_root
from fenics_contact.problem.problem import Problem
from fenics_contact.scene.values import RAMP
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from tests.contact.laws.test_by_points import both, displaced, matrix_of, use_friction
from tests.messages import refused
from tests.scenes import box_body
from tests.simulation.restart.test_state_file import resumed, stopped_after

COMM = MPI.COMM_WORLD
COMPLIANCE = {
    "normal_law": {"kind": "normal compliance", "coefficient": 4e3, "exponent": 2},
    "friction_law": {"kind": "compliance", "coefficient": 60.0, "exponent": 1.5},
}
BY_PRESSURE = {
    "friction_coefficient": 0.4,
    "friction_law": {
        "kind": "pressure dependent",
        "pressures": [0, 8, 20],
        "shares": [1, 0.9, 0.3],
    },
}
FORMULA = {
    "friction_coefficient": 0.4,
    "friction_law": {
        "kind": "formula",
        "bound": "mu * p / (1 + p / p0)",
        "parameters": {"p0": 20.0},
    },
}
BY_SLIP = {
    "friction_coefficient": 0.4,
    "law": "incremental",
    "friction_law": {"kind": "slip dependent", "slips": [0, 0.001], "shares": [1, 0.5]},
}
BY_SPEED = {
    "friction_coefficient": 0.4,
    "law": "incremental",
    "friction_law": {"kind": "speed dependent", "speeds": [0, 0.1], "shares": [1, 0.5]},
}
LAWS = {"compliance": COMPLIANCE, "pressure dependent": BY_PRESSURE, "formula": FORMULA}
EVERY = LAWS | {"slip dependent": BY_SLIP}
OF_MOTION = {"speed dependent": BY_SPEED}
MOVING = {"motion": Motion(step=0.1, end=1), "density": 1.0, "path": Path((0.0,), (1.0,))}
DEPTH = "contact.0.obstacle.indentation"


def bound(name, pressure):
    """By its formula, in NumPy."""
    if name == "compliance":
        return 60 * (pressure / 4e3) ** 0.75
    if name == "formula":
        return 0.4 * pressure / (1 + pressure / 20)
    return 0.4 * np.interp(pressure, [0, 8, 20], [1, 0.9, 0.3]) * pressure


def sheared(keys, dimension=2, *, density=None, path=RAMP, **scene):
    """A block that is held on its left, pressed onto the ground and sheared along it."""
    load = (3.0, *((1.0,) if dimension == 3 else ()), -10.0)
    axis = "xyz"[dimension - 1]
    return Scene(
        kinematics="3D" if dimension == 3 else "plane strain",
        material=Material(1000, 0.3, density=density),
        support=(Support("x0", dict.fromkeys("xyz"[:dimension], 0)),),
        load=(Load(f"{axis}1", traction=load, path=path),),
        contact=(Contact(f"{axis}0", **keys),),
        **scene,
    )


def rubbed(keys, **scene):
    """A parabola pressed into a block and moved along it."""
    obstacle = Obstacle(
        "parabola", radius=0.5, indentation=0.02, position=(0.5, 1), displacement=(0.01, 0)
    )
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, **keys),),
        **scene,
    )


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
@pytest.mark.parametrize("law", ["static", "incremental"])
def test_points_that_slip_carry_the_bound(name, strategy, law):
    scene = sheared({**LAWS[name], "law": law}, solver={"strategy": strategy})
    result = run(scene, COMM, box_body((6, 3)))
    assert result.passed, result.verdict
    slips, pressure = result.points.status == "SLIP", result.points.contact_pressure
    traction = np.linalg.norm(result.points.friction_traction, axis=1)
    assert slips.sum() > 2
    assert traction[slips] == pytest.approx(bound(name, pressure[slips]), rel=1e-6)
    assert np.all(traction <= bound(name, pressure) * (1 + 1e-9) + 1e-9)
    assert result.points.own["bound"] == pytest.approx(bound(name, pressure), rel=1e-6)
    assert result.contacts[0].parameters["friction_law"].startswith(f"{name}: ")


@pytest.mark.parametrize("name", EVERY | OF_MOTION)
@pytest.mark.parametrize("dimension", [2, 3])
def test_forms_and_points_have_one_tangent(name, dimension):
    """In every mode, and coupled it is what the bound's difference quotient says."""
    moves = MOVING if name in OF_MOTION else {}
    scene = sheared((EVERY | OF_MOTION)[name], dimension, **moves)
    problem = Problem.on_mesh(scene, box_body((3, 2, 2)[:dimension]))
    (contact,) = problem.contacts
    surface, random = SurfaceMatrix(contact), np.random.default_rng(3)
    contact.friction.regularisation.set(0.005)
    if name == "slip dependent":
        contact.friction.rule.take({"slip_so_far": 0.002 * contact.trace.coordinates[:, 0]})
    if name == "speed dependent":
        contact.friction.rule.follow_speed(0.15 * contact.trace.coordinates[:, 0])
    for mode in ("law", "coupled", "status"):
        slip = displaced(contact, random)
        contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
        use_friction(contact, mode, slip)
        expected, found = both(contact, lambda: matrix_of(surface))
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    pressure = contact.pressure()
    steps = 1e-6 * pressure
    up, down = (contact.friction.bound_of(pressure + sign * steps) for sign in (1, -1))
    slope = contact.friction.bound_slope(pressure)
    touched = pressure > 0
    assert COMM.allreduce(int(touched.sum())) > 2
    quotient = (up - down)[touched] / (2 * steps[touched])
    assert slope[touched] == pytest.approx(quotient, rel=1e-5)


@pytest.mark.parametrize("name", EVERY)
def test_a_study_answers_as_runs_do(name):
    scene, body = rubbed(EVERY[name], steps=Steps(number=2)), box_body((12, 6))
    study = Study(scene, body=body)
    for depth in (0.02, 0.025):
        quick = study.solve({DEPTH: depth})
        obstacle = dataclasses.replace(scene.contact[0].obstacle, indentation=depth)
        contact = dataclasses.replace(scene.contact[0], obstacle=obstacle)
        whole = run(dataclasses.replace(scene, contact=(contact,)), COMM, body)
        assert whole.passed, whole.verdict
        for key in ("normal_force", "strain_energy", "slip_area", "friction_work"):
            assert quick.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-8), key


@pytest.mark.parametrize("name", EVERY)
def test_a_run_is_restarted_on_other_ranks(name, folder):
    scene = rubbed({**EVERY[name], "law": "incremental"}, steps=Steps(number=4))
    whole = run(scene, COMM, box_body((12, 6)))
    assert whole.passed, whole.verdict
    if COMM.rank == 0:
        stopped_after(scene, box_body((12, 6), comm=MPI.COMM_SELF), folder, 2)
    COMM.barrier()
    found = resumed(scene, box_body((12, 6)), folder)
    for key in ("normal_force", "friction_work", "strain_energy"):
        assert found.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-7), key


def test_files_have_the_bound(folder):
    files.solve_and_write(Run(rubbed(BY_PRESSURE), COMM, box_body((12, 6))), folder)

    def read():
        with (folder / "contact.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        pressure = np.array([float(row["contact_pressure"]) for row in rows])
        found = np.array([float(row["friction_bound"]) for row in rows])
        assert pressure.max() > 20
        np.testing.assert_allclose(found, bound("pressure dependent", pressure), rtol=1e-6)

    on_root(COMM, read)


@pytest.mark.errors
@pytest.mark.parametrize("name", LAWS)
def test_error_bars_cover_what_a_finer_mesh_finds(name):
    coarse, fine = (run(rubbed(LAWS[name]), COMM, box_body(n)) for n in ((12, 6), (48, 24)))
    for key in ("strain_energy", "max_contact_pressure"):
        error = abs(coarse.quantities[key] - fine.quantities[key])
        assert error < 1.5 * coarse.errors[key]["total"], key
    assert coarse.errors["friction_force"]["total"] > 0
    assert coarse.errors["friction_work"]["total"] > 0


@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
def test_a_coefficient_falls_with_the_slip_of_the_steps_before(strategy):
    """At every point that slips: by the table, at the length of the point's path."""
    scene = rubbed(BY_SLIP, steps=Steps(number=4), solver={"strategy": strategy})
    prepared, before = Run(scene, COMM, box_body((12, 6))), []
    (contact,) = prepared.problem.contacts
    result = prepared.solve(accepted=lambda: before.append(contact.friction.slip_so_far.copy()))
    assert result.passed, result.verdict
    state = prepared.solution.states[0]
    share = np.interp(before[-1], [0, 0.001], [1, 0.5])
    slips = state.status == "SLIP"
    assert COMM.allreduce(float(share[slips].min(initial=1.0)), MPI.MIN) < 0.9
    traction = np.linalg.norm(state.friction_traction, axis=1)[slips]
    expected = 0.4 * share[slips] * state.contact_pressure[slips]
    assert traction == pytest.approx(expected, rel=1e-6)
    assert np.all(state.own["slip_so_far"] >= before[-1])


@pytest.mark.parametrize(("across", "along"), [(1, 10), (10, 1), (10, 10)])
def test_exponents_far_from_one_another(across, along):
    """Scaled so that pressure and bound are 20 and 6 at the depth of the parabola."""
    keys = {
        "normal_law": {
            "kind": "normal compliance",
            "coefficient": 20 / 0.02**across,
            "exponent": across,
        },
        "friction_law": {"kind": "compliance", "coefficient": 6 / 0.02**along, "exponent": along},
    }
    result = run(rubbed(keys, solver={"errors": "none"}), COMM, box_body((12, 6)))
    assert result.passed, result.verdict
    slips = result.points.status == "SLIP"
    traction = np.linalg.norm(result.points.friction_traction, axis=1)[slips]
    depth = -result.points.gap[slips] / 0.02
    assert COMM.allreduce(traction.max(initial=0.0), MPI.MAX) > 0.1  # something rubs
    assert traction == pytest.approx(6 * depth**along, rel=1e-6)


@pytest.mark.parametrize("shares", [[1, 0], [0, 3]])
def test_a_coefficient_that_jumps_at_a_pressure(shares):
    law = BY_PRESSURE["friction_law"] | {"pressures": [40, 40.001], "shares": shares}
    keys = BY_PRESSURE | {"friction_law": law}
    result = run(rubbed(keys, solver={"errors": "none"}), COMM, box_body((12, 6)))
    assert result.passed, result.verdict
    pressure = result.points.contact_pressure
    expected = 0.4 * np.interp(pressure, [40, 40.001], shares) * pressure
    slips = result.points.status == "SLIP"
    traction = np.linalg.norm(result.points.friction_traction, axis=1)
    assert traction[slips] == pytest.approx(expected[slips], rel=1e-4, abs=1e-6)


def test_the_same_exponent_twice_is_coulombs_law():
    """μ = c_t/c: to the tolerance of the solver."""
    same = COMPLIANCE["friction_law"] | {"coefficient": 0.3 * 4e3, "exponent": 2}
    answers = [
        run(sheared({"normal_law": COMPLIANCE["normal_law"], **keys}), COMM, box_body((6, 3)))
        for keys in ({"friction_law": same}, {"friction_coefficient": 0.3})
    ]
    assert answers[0].passed, answers[0].verdict
    for key in ("strain_energy", "friction_work", "max_slip", "stick_area"):
        one, other = (answer.quantities[key] for answer in answers)
        assert one == pytest.approx(other, rel=1e-7), key


def test_derivatives_follow_the_pressure():
    """Of the coefficient, against differences of answers."""
    key = "contact.0.friction_coefficient"
    fixed = {"regularisation_parameter": 1e-6, "penalty_parameter": 1e-6}
    study = Study(sheared(BY_PRESSURE | fixed), body=box_body((6, 3)))
    found = study.derivatives(["strain_energy"], [key])["strain_energy"][key]
    up, down = (
        study.solve({key: 0.4 + sign * 1e-5}).quantities["strain_energy"] for sign in (1, -1)
    )
    assert found == pytest.approx((up - down) / 2e-5, rel=1e-5)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"friction_law": {"kind": "sticky"}}, "no_friction_law_sticky"),
        ({"friction_law": COMPLIANCE["friction_law"]}, "compliance_of_unilateral_contact"),
        (COMPLIANCE | {"friction_coefficient": 0.1}, "compliance_with_friction_coefficient"),
        (
            {"friction_law": BY_PRESSURE["friction_law"] | {"pressures": [0, 9, 3]}},
            "pressures_fall",
        ),
        (
            {"friction_law": BY_PRESSURE["friction_law"] | {"pressures": [0, 9]}},
            "too_few_pressures",
        ),
        (BY_SLIP | {"law": "static"}, "static_slip_dependent_friction"),
        ({"friction_law": BY_PRESSURE["friction_law"] | {"share": 1}}, "unknown_key_share"),
    ],
)
def test_contradictions_are_refused(keys, message):
    with refused(message, ValueError):
        Contact("top", **keys)


def test_coulombs_law_that_is_named_moves_as_the_default_does():
    """Other rules without velocities are refused in motion."""
    keys = {"friction_coefficient": 0.4, "law": "incremental"}
    named = keys | {"friction_law": {"kind": "coulomb"}}
    one, other = (
        run(
            sheared(given, **MOVING | {"motion": Motion(step=0.1, end=0.3)}), COMM, box_body((4, 2))
        )
        for given in (keys, named)
    )
    assert one.quantities["max_slip"] > 0
    for name in ("friction_force", "max_slip", "kinetic_energy"):
        assert one.quantities[name] == pytest.approx(other.quantities[name], rel=1e-12), name
    with refused("no_velocities", ValueError):
        sheared(BY_PRESSURE | {"law": "incremental"}, **MOVING)
