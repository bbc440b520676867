"""Orthotropic friction against its ellipse, statics, Coulomb's law, and difference quotients."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    Obstacle,
    OrthotropicFriction,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import InputError, NoEquilibriumError
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.trust.checks.run_checks import run_checks
from fenics_contact.verification.laws.orthotropic import (
    ACROSS,
    ALONG,
    AXES,
    CASES,
    sliding_friction,
    starting_to_slide,
)
from fenics_contact.verification.laws.stiff_block import block_of, stiff_block
from tests.contact.laws.test_by_points import both, displaced, matrix_of
from tests.scenes import box_body, with_solver
from tests.simulation.restart.test_state_file import resumed, stopped_after

COMM = MPI.COMM_WORLD
KEYS = ("strain_energy", "friction_work", "max_slip", "stick_area", "pressure_integral")


# What of the direction is across the surface does not count.
def law(along=ALONG, across=ACROSS, direction=(0.8, 0.6, 2.0)):
    return {
        "friction_law": OrthotropicFriction(
            kind="orthotropic", along=along, across=across, direction=direction
        )
    }


def sheared(keys, **scene):
    """A block that is held on its left, pressed onto the ground and sheared along it."""
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        support=(Support("x0", dict.fromkeys("xyz", 0)),),
        load=(Load("z1", traction=(3.0, 1.5, -10.0)),),
        contact=(Contact("z0", **keys),),
        **scene,
    )


def block():
    return box_body((4, 3, 2), (1, 1, 0.5))


@pytest.mark.parametrize("strategy", ["lagged", "monolithic"])
@pytest.mark.parametrize("kind", ["static", "incremental"])
def test_points_that_slip_carry_the_ellipse_and_others_lie_within(strategy, kind):
    scene = sheared({**law(), "law": kind}, solver={"strategy": strategy})
    result = run(scene, COMM, block())
    assert result.passed, result.verdict
    points = result.points
    slips, pressure = points.status == "SLIP", points.contact_pressure[:, None]
    traction = points.friction_traction[:, :2]
    expected = pressure * sliding_friction(points.slip[:, :2])
    assert 3 < slips.sum() < len(slips)
    assert traction[slips] == pytest.approx(expected[slips], rel=1e-6, abs=1e-7)
    # Not along the slip: an isotropic law would pass no test here.
    forces, ways = traction[slips], points.slip[slips, :2]
    turned = np.abs(forces[:, 0] * ways[:, 1] - forces[:, 1] * ways[:, 0])
    assert np.any(turned > 0.1 * np.linalg.norm(forces, axis=1) * np.linalg.norm(ways, axis=1))
    ellipse = np.linalg.norm(traction @ AXES.T / np.array([ALONG, ACROSS]), axis=1)
    assert np.all(ellipse <= pressure[:, 0] * (1 + 1e-9) + 1e-9)
    assert points.own["bound"] == pytest.approx(ACROSS * points.contact_pressure, rel=1e-6)


@pytest.mark.parametrize("kind", ["static", "incremental"])
def test_equal_coefficients_are_coulombs_law(kind):
    """To round-off: the same passes, iterations and numbers, and the same error bars."""
    keys = {"law": kind}
    same = run(sheared({**law(0.3, 0.3), **keys}), COMM, block())
    plain = run(sheared({"friction_coefficient": 0.3, **keys}), COMM, block())
    assert same.passed, same.verdict
    assert 0 < plain.quantities["stick_area"] < plain.quantities["contact_area"]
    for key in KEYS:
        assert same.quantities[key] == pytest.approx(plain.quantities[key], rel=1e-10), key
        one, other = (answer.errors.get(key) for answer in (same, plain))
        if other is not None and other["total"]:
            assert one["total"] == pytest.approx(other["total"], rel=1e-4), key
    for name, check in plain.checks.items():
        assert same.checks[name].limit == pytest.approx(check.limit, rel=1e-6), name


@pytest.mark.parametrize("strategy", ["campos", "lagged", "monolithic"])
@pytest.mark.parametrize("angle", [10, 50])
def test_a_block_that_is_dragged_meets_the_formula(strategy, angle):
    shift = 0.01 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    keys = {"foundation_stiffness": 1e3, **law()}
    scene = stiff_block(0.01, tuple(shift), keys, solver={"strategy": strategy, "errors": "none"})
    result = run(scene, COMM, block_of(3, 3))
    assert result.passed, result.verdict
    expected = 10 * sliding_friction(shift[None, :])[0]
    assert result.quantities["friction_force"][:2] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("mode", ["law", "coupled", "status"])
def test_forms_and_points_have_one_tangent(mode):
    problem = Problem.on_mesh(sheared(law()), box_body((3, 2, 2)))
    (contact,) = problem.contacts
    surface, random = SurfaceMatrix(contact), np.random.default_rng(3)
    contact.friction.set_scale(0.005)
    slip = displaced(contact, random)
    contact.friction.mode = mode
    contact.friction.follow(0.7 * slip)
    contact.friction.follow(slip)
    contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
    if mode == "status":
        bound, sticks = contact.friction.bound, contact.trace.coordinates[:, 0] < 0.4
        contact.friction.set_status(sticks, slip / np.linalg.norm(slip, axis=1)[:, None], bound)
    expected, found = both(contact, lambda: matrix_of(surface))
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    expected, found = both(contact, contact.all_forces)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_the_true_tangent_is_the_derivative_of_the_traction():
    """By difference quotients of the traction at points, sticking and slipping."""
    problem = Problem.on_mesh(sheared(law()), box_body((3, 2, 2)))
    (contact,) = problem.contacts
    friction, random = contact.friction, np.random.default_rng(5)
    friction.set_scale(0.01)
    slip = displaced(contact, random)
    friction.set_bound(friction.bound_of(contact.pressure()))
    felt = np.linalg.norm(friction.felt(slip), axis=1)
    pressed = friction.bound > 0
    assert COMM.allreduce(int((pressed & (felt < 0.01)).sum())) > 0
    assert COMM.allreduce(int((pressed & (felt > 0.01)).sum())) > 0
    friction.take_true_tangent(slip)
    tangent = friction.tangent_at_points()
    clear = np.abs(felt - 0.01) > 1e-5
    for axis in range(2):
        step = np.zeros(3)
        step[axis] = 1e-8
        quotient = (friction.traction(slip - step) - friction.traction(slip + step)) / 2e-8
        expected = tangent[..., axis]
        scale = np.abs(expected).max(initial=1.0)
        assert np.abs(quotient - expected)[clear].max(initial=0.0) <= 1e-5 * scale


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_dragged_blocks_and_the_start_of_sliding_meet_the_formulas(case):
    for finding in case.run(True):
        assert finding.passed, finding


@pytest.mark.parametrize("angle", [0, 60])
def test_beyond_the_ellipse_no_pressure_holds_the_block(angle):
    with pytest.raises(NoEquilibriumError, match=r"the loads\s+are 1.02"):
        run(starting_to_slide(angle, 1.02), COMM, block_of(2, 3))


@pytest.mark.parametrize("angle", [0, 25, 60, 90])
def test_pressures_that_are_found_hold_the_block_up_to_the_ellipse(angle):
    def scene(share):
        given = starting_to_slide(angle, share)
        pressed = Load("block.z1", traction=(0, 0, -4.0))
        return dataclasses.replace(
            given,
            support=(),
            load=(*given.load, pressed),
            contact=(dataclasses.replace(given.contact[0], pressure=None),),
        )

    held = run(scene(0.97), COMM, block_of(2, 3))
    assert held.passed, held.verdict
    assert held.model["used_share_of_limit_load"] == pytest.approx(0.97, rel=2e-6)
    with pytest.raises(NoEquilibriumError, match=r"the loads\s+are 1.02"):
        run(scene(1.02), COMM, block_of(2, 3))


def test_a_study_answers_as_runs_do_and_derives_by_both_coefficients():
    fixed = {"regularisation_parameter": 1e-6, "penalty_parameter": 1e-6}
    scene, body = sheared(law() | fixed, solver={"errors": "none"}), block()
    study = Study(scene, body=body)
    keys = [f"contact.0.friction_law.{name}" for name in ("along", "across")]
    wanted = ["strain_energy", "friction_work"]
    found = study.derivatives(wanted, keys)
    for key, value in zip(keys, (ALONG, ACROSS), strict=True):
        up, down = (study.solve({key: value + s * 1e-5}).quantities for s in (1, -1))
        for name in wanted:
            quotient = (up[name] - down[name]) / 2e-5
            assert abs(quotient) > 1e-6
            assert found[name][key] == pytest.approx(quotient, rel=1e-4), (name, key)
    quick = study.solve({keys[0]: 0.3})
    whole = run(sheared(law(along=0.3) | fixed, solver={"errors": "none"}), COMM, body)
    for key in KEYS:
        assert quick.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-8), key
    with pytest.raises(InputError, match="direction"):
        study.derivatives(wanted, ["contact.0.friction_law.direction.0"])


def test_a_run_is_restarted_on_other_ranks(folder):
    keys = {**law(), "law": "incremental"}
    scene = with_solver(sheared(keys, steps=Steps(number=3)), errors="none")
    whole = run(scene, COMM, block())
    assert whole.passed, whole.verdict
    if COMM.rank == 0:
        body = box_body((4, 3, 2), (1, 1, 0.5), comm=MPI.COMM_SELF)
        stopped_after(scene, body, folder, 2)
    COMM.barrier()
    found = resumed(scene, block(), folder)
    for key in KEYS:
        assert found.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-7), key


@pytest.mark.parametrize("degree", [1, 2])
def test_checks_fail_on_the_answer_of_a_circle(degree):
    """Friction of the larger coefficient in all directions is outside of the ellipse."""
    scene = sheared({"friction_coefficient": ACROSS}, discretisation={"degree": degree})
    scene = with_solver(scene, errors="none")
    wrong = Run(scene, COMM, block())
    assert wrong.solve().passed
    contact = dataclasses.replace(scene.contact[0], friction_coefficient=0.0, **law())
    judged = Run(dataclasses.replace(scene, contact=(contact,)), COMM, block())
    assert judged.solve().passed
    checks = run_checks(BulkForces(judged.problem, wrong.solution))
    assert checks["friction_cone"].value > 0.05
    right = run_checks(BulkForces(judged.problem, judged.solution))
    assert right["friction_cone"].passed
    own = dataclasses.replace(wrong.solution, friction_force=judged.solution.friction_force)
    assert not run_checks(BulkForces(judged.problem, own))["friction_law"].passed


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (law() | {"friction_coefficient": 0.1}, "has coefficients of its own"),
        ({"friction_law": {"kind": "orthotropic", "along": 0, "across": 1}}, "along = 0 must be"),
        ({"friction_law": {"kind": "orthotropic", "along": 1, "across": -1}}, "across = -1 must"),
    ],
)
def test_contradictions_are_refused(keys, message):
    if isinstance(keys["friction_law"], dict):
        keys["friction_law"]["direction"] = (1, 0, 0)
    with pytest.raises(ValueError, match=message):
        Contact("top", **keys)


def test_other_models_and_directions_without_an_axis_are_refused_on_all_ranks():
    for kinematics in ("plane strain", "plane stress", "axisymmetric"):
        with pytest.raises(ValueError, match=rf"contact\[0\].*3D models; in a {kinematics} model"):
            Scene(kinematics=kinematics, material=Material(1, 0), contact=(Contact("y0", **law()),))
    with pytest.raises(ValueError, match="must not be a zero vector"):
        law(direction=(0, 0, 0))
    with pytest.raises(InputError, match=r"direction = \[0.0, 0.0, 3.0\] is along the normal"):
        run(sheared(law(direction=(0, 0, 3))), COMM, block())
    with pytest.raises(InputError, match=r"along: its smallest value is 0, but it must be > 0"):
        run(sheared(law(along=lambda x: np.maximum(x[0], 0))), COMM, block())
    half = dataclasses.replace(sheared(law(), symmetry=("y0",)), load=())
    with pytest.raises(InputError, match="behind the plane of symmetry across y"):
        run(half, COMM, block())
    nearly = run(sheared(law(direction=(0.8e-3, 0.6e-3, 1))), COMM, block())
    plain = run(sheared(law()), COMM, block())
    assert nearly.quantities["friction_work"] == pytest.approx(
        plain.quantities["friction_work"], rel=1e-9
    )


def test_a_column_slides_on_an_end_that_two_ranks_do_not_share():
    ground = Obstacle("plane", position=(0, 0, 0))
    scene = Scene(
        kinematics="3D",
        material=Material(1e6, 0.0),
        support=(Support("z1", {"x": 0.02, "y": 0.01, "z": -1e-5}),),
        contact=(Contact("z0", obstacle=ground, **law(direction=(1, 0, 0))),),
        solver=SolverSettings(errors="none"),
    )
    result = run(scene, body=box_body((1, 1, 6), (1, 1, 3)))
    assert result.passed, result.verdict
    pull = np.array([ALONG**2 * 2, ACROSS**2]) / np.hypot(ALONG * 2, ACROSS)
    found = result.quantities
    np.testing.assert_allclose(
        found["friction_force"][:2], -found["normal_force"] * pull, rtol=1e-2
    )
