"""What friction of unknown pressure can hold, against statics in closed form."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import linprog

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    NoEquilibriumError,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
)
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.existence.friction_cones import ContactCones
from fenics_contact.problem.existence.limit_analysis import LimitAnalysis
from fenics_contact.problem.problem import Problem
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FLAT, CUBE = box_body((4, 2), (2, 1)), box_body((3, 3, 3), (1, 1, 1))
TALL = box_body((8, 16), (1, 2))
NEAR = 1e-4


def on_floor(load, coefficient=0.3, body=FLAT, support=(), **keys):
    """A block on a rigid floor, held by nothing else; not solved."""
    space = body.dimension == 3
    scene = Scene(
        kinematics="3D" if space else "plane strain",
        material=Material(1000, 0.3),
        support=support,
        load=load if isinstance(load, tuple) else (load,),
        contact=keys.pop(
            "contact", (Contact("z0" if space else "y0", friction_coefficient=coefficient),)
        ),
        **keys,
    )
    return Problem.on_mesh(scene, body)


IN_PLANE = "translation along x and y, rotation about z"


def weight(*force):
    return Load("body", body_force=force)


def share(problem):
    return require_equilibrium(problem).used_share


def require_refusal(problem, motion, share="…", name="loads_exceed_friction"):
    with refused(name, NoEquilibriumError, motion=motion, share=share) as error:
        require_equilibrium(problem)
    assert error.value.exit_code == 2


def require_limit(make, limit, motion):
    """Accepted just below a limit load, refused just beyond it, with its motion named."""
    found = require_equilibrium(make((1 - NEAR) * limit))
    assert 1 - 2 * NEAR < found.used_share < 1
    assert found.motion == motion
    require_refusal(make((1 + NEAR) * limit), motion)


@pytest.mark.parametrize("coefficient", [1e-3, 0.3, 0.6])
@pytest.mark.parametrize("side", [1, -1])
def test_a_block_slides_at_its_weight_times_the_coefficient(coefficient, side):
    def pushed(force):
        return on_floor(weight(side * force / 2, -5), coefficient)

    require_limit(pushed, coefficient * 10, "translation along x")


def test_at_the_limit_the_slip_is_undetermined():
    require_refusal(on_floor(weight(1.5, -5)), "translation along x", "1")


def test_a_block_pushed_just_below_its_limit_is_solved():
    """All of it is about to slide: friction is what pushes it."""
    scene = on_floor(weight(0.3 * (1 - NEAR) * 5, -5)).scene
    result = Run(scene, COMM, FLAT).solve()
    assert result.passed, result.verdict
    assert result.quantities["friction_force"][0] == pytest.approx(-3 * (1 - NEAR), rel=1e-8)
    assert result.model["used_share_of_limit_load"] == pytest.approx(1 - NEAR, abs=1e-5)


def test_the_tipping_block_of_the_specification():
    """Width 1, height 2, force 10 down on its top: it tips at Fx = 10 × ½ / 2."""

    def pushed(force):
        return on_floor(Load("y1", traction=(force, -10)), 2.0, body=TALL)

    assert share(pushed(2.4999)) == pytest.approx(2.4999 / 10 / 2, abs=1.1e-5)
    for force in (2.5001, -2.5001):
        require_refusal(pushed(force), IN_PLANE, name="loads_push_away")
    # Where it slides first, it does so at μ times the force.
    slides = on_floor(Load("y1", traction=(2.1, -10)), 0.2, body=TALL)
    require_refusal(slides, "translation along x", "1.05")


@pytest.mark.parametrize("angle", [0.0, 2.0])
def test_the_friction_cone_in_space_is_round(angle):
    def pushed(force):
        return on_floor(weight(force * np.cos(angle), force * np.sin(angle), -8), 0.25, body=CUBE)

    axes = [a for a, part in (("x", np.cos(angle)), ("y", np.sin(angle))) if abs(part) > 1e-9]
    require_limit(pushed, 2.0, f"translation along {' and '.join(axes)}")


def test_torque_on_a_square_is_bounded_by_pressure_at_its_corners():
    """The pressure may lie anywhere: at most at the corners, T = μ W √½; if even, .38260 μ W."""

    def twisted(torque):
        spin = Load(
            "z1",
            traction=(
                lambda x: -6 * torque * (x[1] - 0.5),
                lambda x: 6 * torque * (x[0] - 0.5),
                -8,
            ),
        )
        return on_floor(spin, 0.25, body=CUBE)

    require_limit(twisted, 2 * np.sqrt(0.5), "rotation about z")
    assert share(twisted(2 * 0.3826)) < 1


def test_groove_of_two_walls():
    """A cube in a corner of two walls, pushed along it.

    Each wall's friction along x or y, s, adds to the pressure w + s of the other: the most they
    hold along the corner is 2 max √(μ²(w + s)² − s²) = 2 μ w / √(1 − μ²).
    """
    walls = tuple(Contact(side, friction_coefficient=0.6) for side in ("x0", "y0"))

    def pushed(force):
        return on_floor(weight(-1, -1, force), body=CUBE, contact=walls)

    require_limit(pushed, 2 * 0.6 / 0.8, "translation along z")


def test_a_block_in_a_smooth_corner_needs_no_friction():
    walls = tuple(Contact(side) for side in ("x0", "y0"))
    assert share(on_floor(weight(-1, -1), contact=walls)) == 0


def test_a_coefficient_that_varies_and_a_moment():
    """Smooth on the left half, μ on the right one; the push at half the height turns it, too.

    To the right all of the weight can go to the right half: μ W. To the left the resultant of
    the pressure is F H/2 left of the middle: least on the smooth half where that carries its part
    at the very end, N₁ b/2 = F H/2 with F = μ N₂ and N₁ + N₂ = W.
    """

    def pushed(force):
        return on_floor(weight(force / 2, -5), lambda x: np.where(x[0] >= 1 - 1e-9, 0.4, 0.0))

    require_limit(pushed, 4.0, "translation along x")
    assert share(pushed(-(1 - NEAR) * 4 / 1.2)) < 1
    require_refusal(pushed(-(1 + NEAR) * 4 / 1.2), "translation along x")


def sloped(slope, coefficient):
    """A block on a slope of another body: gravity is turned in its place."""
    parts = [Box("upper", (0, 0), (2, 1), (5, 2)), Box("lower", (-1, -1), (3, 0), (6, 2))]
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("lower.y0", {"x": 0, "y": 0}),),
        load=(Load("upper", body_force=(slope * 5, -5)),),
        contact=(Contact("upper.y0", against="lower.y1", friction_coefficient=coefficient),),
    )
    return Problem.on_mesh(scene, boxes(parts))


def test_a_block_of_two_on_a_slope_at_its_angle_of_friction():
    assert share(sloped(0.1, 0.1 * (1 + NEAR))) == pytest.approx(1 / (1 + NEAR), abs=1.1e-5)
    for coefficient, used in ((0.1, "1"), (0.1 * (1 - NEAR), "…"), (0.099, "1.0101")):
        require_refusal(sloped(0.1, coefficient), "translation along x of 'upper'", used)


def test_bodies_in_a_pile_are_judged_together():
    """The lower one is smooth below: what the upper one takes from it, it cannot pass on."""
    parts = [Box("upper", (0, 1), (2, 2), (5, 2)), Box("lower", (0, 0), (2, 1), (6, 2))]

    def pile(force, below):
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            load=(Load("upper", body_force=(force / 2, -5)), Load("lower", body_force=(0, -5))),
            contact=(
                Contact("upper.y0", against="lower.y1", friction_coefficient=0.5),
                Contact("lower.y0", friction_coefficient=below),
            ),
        )
        return Problem.on_mesh(scene, boxes(parts))

    assert share(pile(2.0, 0.2)) == pytest.approx(0.5, abs=1e-5)
    both = "translation along x of 'upper', translation along x of 'lower'"
    require_refusal(pile(4.1, 0.2), both, "1.025")


def test_squeezed_between_two_jaws_no_pressure_is_too_large():
    """Walls that do not give way may press as they like: any weight hangs between them."""
    jaws = tuple(Contact(side, friction_coefficient=0.01) for side in ("x0", "x1"))
    found = require_equilibrium(on_floor(weight(0, -5), contact=jaws))
    assert found.used_share < 1


def test_jaws_under_force_hold_twice_the_coefficient_times_it():
    def hung(force):
        jaws = (
            Contact("x0", friction_coefficient=0.3),
            Contact(
                "x1",
                friction_coefficient=0.3,
                obstacle=Obstacle("plane", position=(2, 0), force=10),
            ),
        )
        return on_floor(weight(0, -force / 2), contact=jaws)

    require_limit(hung, 2 * 0.3 * 10, "translation along y")


def test_known_and_unknown_friction_add_up():
    """A pad above with g × length = 2 × 2 that presses with 4 × 2 besides the weight of 10."""
    pad = Contact("y1", pressure=4, friction_coefficient=0.5)

    def pushed(force):
        floor = Contact("y0", friction_coefficient=0.3)
        return on_floor(weight(force / 2, -5), contact=(floor, pad))

    require_limit(pushed, 0.5 * 4 * 2 + 0.3 * (10 + 4 * 2), "translation along x")


def test_a_body_moved_by_its_support_is_not_judged():
    held = (Support("x0", {"x": 0.1}),)
    assert share(on_floor(weight(20, -5), support=held)) == 0


PUSH = Path(time=(0, 1, 2, 3), factor=(0, 0, 1, 0.5))


@pytest.mark.parametrize(
    "steps",
    [Steps(times=(1, 1.5, 2, 2.5, 3)), Steps(number=3, end=3.0, automatic=True)],
    ids=["fixed", "automatic"],
)
def test_every_turn_of_the_loads_is_judged(steps):
    """The push goes beyond its limit on the way, and back below it."""

    def pushed(force):
        push = Load("body", body_force=(force / 2, 0), path=PUSH)
        down = Load("body", body_force=(0, -5))
        return on_floor((push, down), steps=steps)

    assert share(pushed(3 * (1 - NEAR))) == pytest.approx(0.5, rel=1e-3)
    beyond = pushed(3 * (1 + NEAR))
    require_refusal(beyond, "translation along x", name="loads_exceed_friction_at_time_2")
    # A step that passes over the turn does not meet it.
    passing = on_floor(pushed(3.2).scene.load, steps=Steps(times=(1, 1.5, 2.5, 3)))
    assert share(passing) == pytest.approx(1.6 / 3, rel=1e-3)


def test_loss_of_contact_on_the_way_is_refused_with_its_time():
    lift = Load("body", body_force=(0, 10), path=Path(time=(0, 1, 2, 3), factor=(0, -1, 1, -1)))
    problem = on_floor(lift, support=(Support("x0", {"x": 0}),), steps=Steps(number=3, end=3.0))
    require_refusal(problem, "translation along y", name="no_friction_holds_at_time_2")


def test_units_and_other_loads_in_balance_do_not_matter():
    """A squeeze of 1e4 times the weight, in balance by itself, leaves the limit where it is."""
    for scale in (1e-6, 1e6):
        squeeze = (Load("x0", traction=(1e4 * scale, 0)), Load("x1", traction=(-1e4 * scale, 0)))
        scene = on_floor((weight(1.5 * 0.99 * scale, -5 * scale), *squeeze)).scene
        scene = dataclasses.replace(scene, material=Material(1000 * scale, 0.3))
        assert share(Problem.on_mesh(scene, FLAT)) == pytest.approx(0.99, rel=1e-4)
        heavier = (weight(1.5 * 1.01 * scale, -5 * scale), *squeeze)
        beyond = Problem.on_mesh(dataclasses.replace(scene, load=heavier), FLAT)
        require_refusal(beyond, "translation along x")


def test_in_space_degree_1_and_2_agree():
    for degree in (1, 2):
        problem = on_floor(
            weight(1.2, 1.6 * (1 + NEAR), -8),
            0.25,
            body=CUBE,
            discretisation=Discretisation(degree),
        )
        require_refusal(problem, "translation along x and y")


def random_cones(seed, components, bounded):
    """Random jumps of 4 or 6 motions at as many points, and at 4 where the bound is known."""
    random = np.random.default_rng(seed)
    motions = points = 2 * components
    closing = random.normal(size=(points, motions))
    slips = random.normal(size=(points, components - 1, motions))
    coefficients = random.uniform(0, 0.8, points)
    known = random.normal(size=(4, components - 1, motions))
    bounds = random.uniform(0.05, 0.3, 4) if bounded else np.zeros(4)
    return ContactCones(closing, coefficients, slips, bounds, known), random


def primal(cones, force, sides, outside):
    """Whether forces within polygons around or in the circles balance a load, by their LP."""
    angles = 2 * np.pi * np.arange(sides) / sides
    size = 1 / np.cos(np.pi / sides) if outside else 1.0
    corners = np.array([[1.0], [-1.0]]) if cones.slips.shape[1] == 1 else None
    if corners is None:
        corners = size * np.column_stack([np.cos(angles), np.sin(angles)])
    across = -cones.closing[:, None] + np.einsum(
        "q,kc,qci->qki", cones.coefficients, corners, cones.slips
    )
    along = np.einsum("q,kc,qci->qki", cones.bounds, corners, cones.bounded_slips)
    count = len(corners)
    columns = np.concatenate([across.reshape(-1, len(force)), along.reshape(-1, len(force))])
    shares = np.kron(np.eye(len(cones.bounds)), np.ones(count))
    limits = np.hstack([np.zeros((len(shares), across.shape[0] * count)), shares])
    found = linprog(
        np.zeros(len(columns)),
        A_eq=columns.T,
        b_eq=-force,
        A_ub=limits,
        b_ub=np.ones(len(limits)),
        bounds=(0, None),
    )
    return found.status == 0


@pytest.mark.parametrize("bounded", [False, True], ids=["Coulomb", "known, too"])
@pytest.mark.parametrize("components", [2, 3])
def test_duals_agree_with_the_primal_programme(components, bounded):
    """Refused is what forces within polygons around the circles cannot balance, and the reverse."""
    refused = 0
    for seed in range(30):
        cones, random = random_cones(seed, components, bounded)
        force = random.normal(size=cones.closing.shape[1])
        if seed % 2:  # nearer to what can be held
            force -= random.uniform(0, 0.6, len(cones.closing)) @ -cones.closing
        analysis = LimitAnalysis(cones, force, np.abs(force).max())
        runs = analysis.motion_that_runs(1.0)
        if runs is None:
            assert primal(cones, force, 64, outside=True)
            continue
        refused += 1
        assert not primal(cones, force, 64, outside=False)
        rises = cones.coefficients * np.linalg.norm(cones.slips @ runs, axis=1)
        assert (cones.closing @ runs + rises).max() <= 1e-9
        held = cones.bounds @ np.linalg.norm(cones.bounded_slips @ runs, axis=1)
        assert force @ runs > held
    assert 3 <= refused <= 27


def test_what_forces_within_the_cones_balance_is_never_refused():
    for seed in range(40):
        cones, random = random_cones(seed, 3, True)
        pressures = random.exponential(size=6) * (random.uniform(size=6) < 0.5)
        angles = random.uniform(0, 2 * np.pi, 10)
        unit = np.column_stack([np.cos(angles), np.sin(angles)])
        rubs = (cones.coefficients * pressures)[:, None] * unit[:6]
        force = cones.closing.T @ pressures - np.einsum("qc,qci->i", rubs, cones.slips)
        force -= np.einsum("q,qc,qci->i", cones.bounds, unit[6:], cones.bounded_slips)
        assert LimitAnalysis(cones, force, np.abs(force).max()).motion_that_runs(1.0) is None


def rougher(cones, share):
    """The same with all friction so many times as strong."""
    return dataclasses.replace(
        cones, coefficients=share * cones.coefficients, bounds=share * cones.bounds
    )


@pytest.mark.parametrize("bounded", [False, True], ids=["Coulomb", "known, too"])
@pytest.mark.parametrize("components", [2, 3])
def test_the_share_is_where_the_primal_programme_becomes_solvable(components, bounded):
    """Forces within polygons of 256 sides, 7.5e-5 around or in the circles, bound it."""
    between = 0
    for seed in range(100, 112):
        cones, random = random_cones(seed, components, bounded)
        force = random.normal(size=cones.closing.shape[1])
        force -= random.uniform(0, 0.6, len(cones.closing)) @ -cones.closing
        share, motion = LimitAnalysis(cones, force, np.abs(force).max()).used_share()
        if share == 0:
            assert primal(rougher(cones, 1e-6), force, 256, outside=False)
        elif share == np.inf:
            assert not primal(rougher(cones, 1e5), force, 256, outside=True)
        else:
            between += 1
            assert primal(rougher(cones, share * (1 + 2e-4)), force, 256, outside=False)
            assert not primal(rougher(cones, share * (1 - 2e-4)), force, 256, outside=True)
            assert np.abs(motion).max() > 0
    assert between >= 4


def test_a_decision_is_right_to_1e_8_of_the_limit():
    """Friction of a known bound alone: the limit of a load is its f(a)/j(a), whatever its size."""
    for seed in range(3):
        random = np.random.default_rng(seed)
        nothing, turns = np.zeros(0), random.normal(size=(40, 2, 6))
        cones = ContactCones(
            np.zeros((0, 6)), nothing, np.zeros((0, 2, 6)), np.full(40, 0.1), turns
        )
        force = random.normal(size=6)
        limit = 1 / LimitAnalysis(cones, force, 1.0).used_share()[0]
        for scale in (1e-6, 1e6):
            scaled = dataclasses.replace(cones, bounds=scale * cones.bounds)
            for factor, runs in ((1 - 1e-8, False), (1 + 1e-8, True)):
                load = factor * limit * scale * force
                motion = LimitAnalysis(scaled, load, np.abs(load).max()).motion_that_runs(1.0)
                assert (motion is not None) is runs
