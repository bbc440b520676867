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
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.systems.contact_stiffness import SurfaceMatrix
from fenics_contact.trust.run_checks import run_checks
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.published.friction_bounds import LENGTH, block_of, stiff_block
from fenics_contact.verification.published.torque import (
    ACROSS,
    ALONG,
    AXES,
    ORTHOTROPIC_CASES,
    sliding_friction,
    starting_to_slide,
)
from tests.contact.laws.test_by_points import both, displaced, matrix_of, use_friction
from tests.messages import refused
from tests.scenes import box_body, with_solver
from tests.simulation.restart.test_state_file import resumed, stopped_after

COMM = MPI.COMM_WORLD
KEYS = ("strain_energy", "friction_work", "max_slip", "stick_area", "pressure_integral")
# What presses a stiff block on springs.
STIFFNESS, DEPTH = 1e3, 0.01
PRESSING = STIFFNESS * DEPTH * LENGTH**2


# What of the direction is across the surface does not count.
def law(along=ALONG, across=ACROSS, direction=(0.8, 0.6, 2.0)):
    return {
        "friction_law": OrthotropicFriction(
            kind="orthotropic", along=along, across=across, direction=direction
        )
    }


def most_dissipating(way, along=ALONG, across=ACROSS, axes=AXES):
    """The traction of the ellipse at a unit pressure that takes most from a slip (2,).

    By trying all of them: the principle that the rule of sliding follows from.
    """
    angles = np.linspace(0, 2 * np.pi, 20001)
    every = np.stack([along * np.cos(angles), across * np.sin(angles)], axis=1) @ axes
    best = np.argmin(every @ way)
    fine = angles[best] + np.linspace(-1e-3, 1e-3, 2001)
    near = np.stack([along * np.cos(fine), across * np.sin(fine)], axis=1) @ axes
    return near[np.argmin(near @ way)]


def way_at(angle, length=0.01):
    return length * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])


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
    expected = pressure * [most_dissipating(way) for way in points.slip[:, :2]]
    assert 3 < slips.sum() < len(slips)
    assert traction[slips] == pytest.approx(expected[slips], rel=1e-4, abs=1e-5)
    # Not along the slip: an isotropic law would pass no test here.
    forces, ways = traction[slips], points.slip[slips, :2]
    turned = np.abs(forces[:, 0] * ways[:, 1] - forces[:, 1] * ways[:, 0])
    assert np.any(turned > 0.1 * np.linalg.norm(forces, axis=1) * np.linalg.norm(ways, axis=1))
    ellipse = np.linalg.norm(traction @ AXES.T / np.array([ALONG, ACROSS]), axis=1)
    assert np.all(ellipse <= pressure[:, 0] * (1 + 1e-9) + 1e-9)
    # The bound is that along the traction: points that slip carry all of it, others less.
    size, bound = np.linalg.norm(traction, axis=1), points.own["bound"]
    assert size[slips] == pytest.approx(bound[slips], rel=1e-6, abs=1e-7)
    assert np.all(size <= bound * (1 + 1e-9))
    rubs = size > 0
    reach = size[rubs] / ellipse[rubs]  # a line along the traction meets the ellipse there
    assert bound[rubs] == pytest.approx(reach * points.contact_pressure[rubs], rel=1e-6)
    assert np.ptp(reach) > 0.05


def test_without_a_traction_the_bound_is_the_one_of_all_directions():
    (contact,) = Problem.on_mesh(sheared(law()), box_body((3, 2, 2))).contacts
    metric, nothing = contact.friction.rule.metric, np.zeros_like(contact.trace.normals)
    bound = np.full(len(nothing), 10 * ACROSS)
    assert metric.bound_along(bound, nothing) == pytest.approx(10 * ALONG)
    for axis, coefficient in zip(np.eye(3)[:2, :2] @ AXES, (ALONG, ACROSS), strict=True):
        along = nothing + np.array([*axis, 0.0])
        assert metric.bound_along(bound, along) == pytest.approx(10 * coefficient)


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
    shift = way_at(angle)
    keys = {"foundation_stiffness": STIFFNESS, **law()}
    scene = stiff_block(DEPTH, tuple(shift), keys, solver={"strategy": strategy, "errors": "none"})
    result = run(scene, COMM, block_of(3, 3))
    assert result.passed, result.verdict
    expected = PRESSING * most_dissipating(shift)
    assert result.quantities["friction_force"][:2] == pytest.approx(expected, rel=1e-4)


def test_the_formula_of_verify_is_what_dissipates_most():
    ways = np.array([way_at(angle) for angle in range(0, 360, 17)])
    expected = np.array([most_dissipating(way) for way in ways])
    np.testing.assert_allclose(sliding_friction(ways), expected, atol=2e-6)


@pytest.mark.parametrize("angle", [20, 110])
@pytest.mark.parametrize("slave", ["on", "against"])
def test_of_two_bodies_the_slave_carries_the_axes(slave, angle):
    """A stiff block on another one, dragged over it, on meshes that do not match."""
    shift, half = way_at(angle), LENGTH / 2
    lower = Box("lower", (-1, -1, -0.2), (1, 1, 0), (5, 5, 1))
    upper = Box("upper", (-half, -half, 0), (half, half, 0.2), (3, 3, 1))
    keys = {"against": "lower.z1", "slave": slave, "foundation_stiffness": STIFFNESS}
    scene = Scene(
        kinematics="3D",
        material=Material(1e8, 0.0),
        support=(
            Support("lower.z0", dict.fromkeys("xyz", 0)),
            Support("upper.z1", {"x": shift[0], "y": shift[1], "z": -DEPTH}),
        ),
        contact=(Contact("upper.z0", law="incremental", **keys, **law()),),
        solver=SolverSettings(errors="none"),
    )
    result = run(scene, COMM, boxes((lower, upper), "hexahedron"))
    assert result.passed, result.verdict
    # Of the larger surface as the slave, the edge of the smaller one is found within its cells.
    pressing = result.quantities["normal_force"]
    assert pressing == pytest.approx(PRESSING, rel=1e-4 if slave == "on" else 0.2)
    expected = pressing * most_dissipating(shift)
    assert result.quantities["friction_force"][:2] == pytest.approx(expected, rel=2e-4)
    held = np.array(result.supports[0].reaction)
    assert held[:2] == pytest.approx(expected, rel=2e-4)


@pytest.mark.parametrize("angle", [0, 50, 90])
def test_coefficients_vary_over_the_surface(angle):
    """Along either axis the force is the mean coefficient's; askew it is an integral."""

    def along(x):
        return 0.2 + 0.2 * (x[0] + LENGTH / 2)

    def across(x):
        return 0.5 - 0.1 * (x[1] + LENGTH / 2)

    shift, cells = way_at(angle), 4
    keys = {"foundation_stiffness": STIFFNESS, **law(along, across, (1, 0, 0))}
    scene = stiff_block(DEPTH, tuple(shift), keys, solver={"errors": "none"})
    result = run(scene, COMM, block_of(cells, 3))
    assert result.passed, result.verdict
    middles = LENGTH * ((np.arange(24) + 0.5) / 24 - 0.5)
    places = np.stack(np.meshgrid(middles, middles), axis=-1).reshape(-1, 2)
    own = [most_dissipating(shift, along(x), across(x), np.eye(2)) for x in places]
    expected = PRESSING * np.mean(own, axis=0)
    if angle == 0:
        assert expected[0] == pytest.approx(-PRESSING * 0.3, rel=1e-5)
    if angle == 90:
        assert expected[1] == pytest.approx(-PRESSING * 0.45, rel=1e-5)
    found = result.quantities["friction_force"][:2]
    assert found == pytest.approx(expected, rel=2e-3, abs=1e-4 * PRESSING)


@pytest.mark.parametrize("mode", ["law", "coupled", "status"])
def test_forms_and_points_have_one_tangent(mode):
    problem = Problem.on_mesh(sheared(law()), box_body((3, 2, 2)))
    (contact,) = problem.contacts
    surface, random = SurfaceMatrix(contact), np.random.default_rng(3)
    contact.friction.regularisation.set(0.005)
    slip = displaced(contact, random)
    contact.friction.set_bound(contact.friction.bound_of(contact.pressure()))
    use_friction(contact, mode, slip)
    expected, found = both(contact, lambda: matrix_of(surface))
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
    expected, found = both(contact, contact.forces.all)
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_the_true_tangent_is_the_derivative_of_the_traction():
    """By difference quotients of the traction at points, sticking and slipping."""
    problem = Problem.on_mesh(sheared(law()), box_body((3, 2, 2)))
    (contact,) = problem.contacts
    friction, random = contact.friction, np.random.default_rng(5)
    friction.regularisation.set(0.01)
    slip = displaced(contact, random)
    friction.set_bound(friction.bound_of(contact.pressure()))
    felt = np.linalg.norm(friction.scaled_slip(slip), axis=1)
    pressed = friction.bound > 0
    assert COMM.allreduce(int((pressed & (felt < 0.01)).sum())) > 0
    assert COMM.allreduce(int((pressed & (felt > 0.01)).sum())) > 0
    contact.friction_term.tangent_state.take_true(slip)
    tangent = contact.friction_term.tangent_at_points()
    clear = np.abs(felt - 0.01) > 1e-5
    for axis in range(2):
        step = np.zeros(3)
        step[axis] = 1e-8
        quotient = (friction.traction(slip - step) - friction.traction(slip + step)) / 2e-8
        expected = tangent[..., axis]
        scale = np.abs(expected).max(initial=1.0)
        assert np.abs(quotient - expected)[clear].max(initial=0.0) <= 1e-5 * scale


@pytest.mark.parametrize("case", ORTHOTROPIC_CASES, ids=lambda case: case.name)
def test_dragged_blocks_and_the_start_of_sliding_meet_the_formulas(case):
    for finding in case.run(True):
        assert finding.passed, finding


@pytest.mark.parametrize("angle", [0, 60])
def test_beyond_the_ellipse_no_pressure_holds_the_block(angle):
    motion = "translation along x and y"
    with refused("loads_exceed_friction", NoEquilibriumError, motion=motion, share="1.02"):
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
    motion = "translation along x and y"
    with refused("loads_exceed_friction", NoEquilibriumError, motion=motion, share="1.02"):
        run(scene(1.02), COMM, block_of(2, 3))


def test_a_study_answers_as_runs_do_and_derives_by_all_numbers():
    fixed = {"regularisation_parameter": 1e-6, "penalty_parameter": 1e-6}
    scene, body = sheared(law() | fixed, solver={"errors": "none"}), block()
    study = Study(scene, body=body)
    names = ("along", "across", "direction.0", "direction.1")
    keys = [f"contact.0.friction_law.{name}" for name in names]
    wanted = ["strain_energy", "friction_work"]
    found = study.derivatives(wanted, keys)
    given = scene.contact[0].friction_law.direction
    for key, value in zip(keys, (ALONG, ACROSS, *given[:2]), strict=True):
        up, down = (study.solve({key: value + s * 1e-5}).quantities for s in (1, -1))
        for name in wanted:
            quotient = (up[name] - down[name]) / 2e-5
            assert abs(quotient) > 1e-6
            assert found[name][key] == pytest.approx(quotient, rel=1e-4), (name, key)
    quick = study.solve({keys[0]: 0.3})
    whole = run(sheared(law(along=0.3) | fixed, solver={"errors": "none"}), COMM, body)
    for key in KEYS:
        assert quick.quantities[key] == pytest.approx(whole.quantities[key], rel=1e-8), key


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
        (law() | {"friction_coefficient": 0.1}, "orthotropic_with_friction_coefficient"),
        ({"friction_law": {"kind": "orthotropic", "along": 0, "across": 1}}, "along_is_zero"),
        ({"friction_law": {"kind": "orthotropic", "along": 1, "across": -1}}, "across_is_negative"),
    ],
)
def test_contradictions_are_refused(keys, message):
    if isinstance(keys["friction_law"], dict):
        keys["friction_law"]["direction"] = (1, 0, 0)
    with refused(message, ValueError):
        Contact("top", **keys)


def test_other_models_and_directions_without_an_axis_are_refused_on_all_ranks():
    for kinematics in ("plane strain", "plane stress", "axisymmetric"):
        with refused("orthotropic_friction_in_2d", ValueError, kinematics=kinematics):
            Scene(kinematics=kinematics, material=Material(1, 0), contact=(Contact("y0", **law()),))
    with refused("direction_is_zero", ValueError):
        law(direction=(0, 0, 0))
    with refused("direction_along_the_normal"):
        run(sheared(law(direction=(0, 0, 3))), COMM, block())
    with refused("along_is_zero_somewhere"):
        run(sheared(law(along=lambda x: np.maximum(x[0], 0))), COMM, block())
    half = dataclasses.replace(sheared(law(), symmetry=("y0",)), load=())
    with refused("direction_oblique_to_symmetry"):
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
    expected = most_dissipating(np.array([2.0, 1.0]), axes=np.eye(2))
    found = result.quantities
    np.testing.assert_allclose(
        found["friction_force"][:2], found["normal_force"] * expected, rtol=1e-2
    )
