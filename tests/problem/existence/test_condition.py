"""The condition |f(r)| < j(r) against limit loads in closed form."""

import re

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import dblquad
from scipy.optimize import linprog, minimize

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    NoEquilibriumError,
    Run,
    Scene,
    Support,
)
from fenics_contact.cli.summary import print_model
from fenics_contact.problem.existence.condition import require_equilibrium
from fenics_contact.problem.problem import Problem
from tests.messages import refused
from tests.scenes import box_body, slab

COMM = MPI.COMM_WORLD


def test_held_slab_has_no_free_motion():
    motion = Run(slab(), COMM).free_motion
    assert (motion.modes, motion.used_share) == (0, 0)


@pytest.mark.parametrize(
    ("load", "words"), [(719.99999, "just below 1, the limit"), (719.99, "0.999986")]
)
def test_a_share_that_is_no_limit_is_not_shown_as_1(load, words, capsys):
    prepared = Run(slab(end_load=load, held=False), COMM)
    print_model(prepared.scene, prepared.model, "", prepared.contacts())
    (line,) = (x for x in capsys.readouterr().out.splitlines() if "used share" in x)
    assert line.split("load")[1].strip() == words


def test_slab_without_its_left_support_holds_719_99_and_not_720():
    """g × length = 90 × 8 = 720."""
    prepared = Run(slab(end_load=719.99, held=False), COMM)
    assert prepared.free_motion.modes == 1
    assert prepared.free_motion.used_share == pytest.approx(719.99 / 720, rel=1e-12)
    result = prepared.solve()
    assert result.passed
    assert result.quantities["friction_force"][0] == pytest.approx(719.99, rel=1e-9)


@pytest.mark.parametrize("end_load", [720, 720.01, -720, 5000])
def test_slab_beyond_the_limit_is_refused_in_one_sentence(end_load):
    said = {"motion": "translation along x", "share": f"{abs(end_load) / 720:.6g}"}
    with refused("loads_exceed_friction", NoEquilibriumError, **said) as error:
        Run(slab(end_load=end_load, held=False), COMM)
    assert error.value.exit_code == 2


def test_without_friction_a_free_motion_is_refused_even_without_a_load():
    motion = "translation along x"
    with refused("motion_is_undetermined", NoEquilibriumError, motion=motion):
        Run(slab(end_load=0, held=False, coefficient=0.0), COMM)
    with refused("motion_is_pushed", NoEquilibriumError, motion=motion):
        Run(slab(end_load=1, held=False, coefficient=0.0), COMM)


def torsion_pad(torque, force=0.0, cells=8, at=(0.5, 0.5)):
    """A block on a unit-square pad with g = 1; its top is held only along z."""
    polar = 1 / 6  # ∫ (x² + y²) over the unit square

    def traction(axis):
        def value(x):
            arm = -(x[1] - 0.5) if axis == 0 else x[0] - 0.5
            uniform = force if axis == 1 else 0.0
            # A force at a distance from the middle is that force and its moment.
            moment = torque + force * (at[0] - 0.5)
            return uniform + moment * arm / polar

        return value

    scene = Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(2),
        support=(Support("z1", {"z": 0}),),
        load=(Load("z1", traction=(traction(0), traction(1), 0)),),
        contact=(Contact("z0", pressure=1, friction_coefficient=1),),
    )
    return Problem.on_mesh(scene, box_body((cells, cells, 1)))


def clamped_block(force, cells=8):
    """A unit square on a smooth floor, 10 on its other sides with μ = ½; a force on one of them."""
    sides = tuple(Contact(on, pressure=10, friction_coefficient=0.5) for on in ("y1", "x0", "x1"))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        load=(Load("x1", traction=force),),
        contact=(Contact("y0", friction_coefficient=0.0), *sides),
    )
    return Problem.on_mesh(scene, box_body((cells, cells), (1, 1)))


def test_a_block_that_turns_out_from_under_the_pressure_of_its_sides():
    """Lifted by F it turns about its upper left corner, where f = F - 5 and j = 5.

    The pressure on top does the work -5, and friction dissipates μ p = 5 on the right alone.
    """
    found = require_equilibrium(clamped_block((0, 9)))
    assert found.used_share == pytest.approx(4 / 5, rel=1e-9)
    assert require_equilibrium(clamped_block((0, 9.999))).used_share == pytest.approx(0.9998)
    for force, share in ((10.001, "1.0002"), (11, "1.2")):
        motion = "translation along x and y, rotation about z"
        with refused("loads_exceed_friction", NoEquilibriumError, motion=motion, share=share):
            require_equilibrium(clamped_block((0, force)))


def least_share(points, normals, areas, load):
    """The largest f(r)/j(r) over plane motions r, as a linear programme in r and the slips.

    Args:
        points: Of friction of bound 5, and of the floor (where the area is 0), (points, 2).
        normals: There, (points, 2).
        areas: Length that each stands for.
        load: Force along x and y, moment about the origin.
    """
    motions = np.stack(
        [
            np.tile([1.0, 0], (len(points), 1)),
            np.tile([0, 1.0], (len(points), 1)),
            np.column_stack([-points[:, 1], points[:, 0]]),
        ],
        axis=-1,
    )
    floor = areas == 0
    across = np.einsum("qci,qc->qi", motions, normals)[floor]
    along = np.column_stack([-normals[:, 1], normals[:, 0]])
    slips = np.einsum("qci,qc->qi", motions, along)[~floor]
    unit = np.eye(len(slips))
    rows = np.block(
        [
            [slips, -unit],
            [-slips, -unit],
            [across, np.zeros((len(across), len(unit)))],
            [np.zeros((1, 3)), 5 * areas[~floor][None]],
        ]
    )
    found = linprog(
        -np.append(load, np.zeros(len(unit))),
        A_ub=rows,
        b_ub=np.append(np.zeros(len(rows) - 1), 1.0),
        bounds=[(None, None)] * 3 + [(0, None)] * len(unit),
    )
    return -found.fun


@pytest.mark.parametrize("seed", range(6))
def test_loads_at_random_against_a_linear_programme_of_their_own(seed):
    """Its points and normals are written down, its friction is summed by the trapezoidal rule."""
    random = np.random.default_rng(seed)
    cells = 6
    x = np.linspace(0, 1, cells + 1)
    area = np.full(cells + 1, 1 / cells)
    area[[0, -1]] /= 2
    zero, one = np.zeros_like(x), np.ones_like(x)
    points = np.concatenate(
        [np.column_stack(c) for c in ((x, one), (zero, x), (one, x), (x, zero))]
    )
    normals = np.repeat([[0, 1], [-1, 0], [1, 0], [0, -1]], cells + 1, axis=0)
    areas = np.concatenate([area, area, area, zero])
    # The pressure on top presses with 10 at x = ½; those on the left and right balance.
    tractions = random.uniform(-8, 8, (3, 2)) + np.array([0, 2])
    for traction in tractions:
        load = np.array([traction[0], traction[1] - 10, traction[1] - traction[0] / 2 - 5])
        expected = least_share(points, normals, areas, load)
        try:
            found = require_equilibrium(clamped_block(tuple(traction), cells)).used_share
        except NoEquilibriumError as refused:
            found = float(re.search(r"are (\S+) times", str(refused)).group(1))
        assert found == pytest.approx(expected, rel=1e-5)


def pushed_tube(force):
    """A tube 1 < r < 2 of length 1.5 in a bore that presses on it with 4, at μ = .25."""
    body = box_body((3, 4), (1, 1.5))
    body.mesh.geometry.x[:, 0] += 1
    scene = Scene(
        kinematics="axisymmetric",
        material=Material(1000, 0.3),
        load=(Load("y0", traction=(0, force)),),
        contact=(Contact("x1", pressure=4, friction_coefficient=0.25),),
    )
    return Problem.on_mesh(scene, body)


def pushed_half(force):
    """One half of a block 2 wide and 1.5 high that two jaws press with 4, at μ = .25."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        symmetry=("x0",),
        load=(Load("y0", traction=(0, force)),),
        contact=(Contact("x1", pressure=4, friction_coefficient=0.25),),
    )
    return Problem.on_mesh(scene, box_body((3, 4), (1, 1.5)))


@pytest.mark.parametrize(
    ("make", "limit"),
    # g times the bore's area over that of the ring; g times the jaw's height.
    [(pushed_tube, 2 * 2 * 1.5 / (2**2 - 1**2)), (pushed_half, 1.5)],
    ids=["axisymmetric", "symmetry"],
)
def test_a_body_pushed_along_what_presses_on_it(make, limit):
    motion = require_equilibrium(make(0.999 * limit))
    assert motion.used_share == pytest.approx(0.999, rel=1e-9)
    assert motion.motion == "translation along y"
    said = {"motion": "translation along y", "share": "1.001"}
    with refused("loads_exceed_friction", NoEquilibriumError, **said):
        require_equilibrium(make(1.001 * limit))


LIMIT_TORQUE = dblquad(lambda y, x: np.hypot(x, y), -0.5, 0.5, -0.5, 0.5)[0]


def test_limit_torque_of_a_square_pad():
    """∫ |r| over the unit square = .38260."""
    assert pytest.approx(0.38260, abs=5e-6) == LIMIT_TORQUE
    motion = require_equilibrium(torsion_pad(0.3))
    assert motion.modes == 3
    assert motion.motion == "rotation about z"
    assert 0.3 / motion.used_share == pytest.approx(LIMIT_TORQUE, rel=2e-4)
    with refused("loads_exceed_friction", NoEquilibriumError, motion=motion.motion, share="…"):
        require_equilibrium(torsion_pad(0.3828))


def test_eccentric_force_against_an_independent_minimisation():
    """Force F along y at x = .9: least ∫ |v − ω × r| per unit work over rigid motions."""
    arm = 0.4

    def per_work(centre):
        """j/f for a rotation about (centre, 0) measured from the middle, by quadrature."""
        x = (np.arange(400) + 0.5) / 400 - 0.5
        distance = np.hypot(x[:, None] - centre[0], x[None, :])
        return distance.mean() / abs(arm - centre[0])

    limit = minimize(per_work, [-0.3], method="Nelder-Mead", tol=1e-10).fun
    motion = require_equilibrium(torsion_pad(0.0, force=0.3, at=(0.5 + arm, 0.5)))
    assert 0.3 / motion.used_share == pytest.approx(limit, rel=1e-3)
    turns = "translation along y, rotation about z"
    with refused("loads_exceed_friction", NoEquilibriumError, motion=turns, share="…"):
        require_equilibrium(torsion_pad(0.0, force=1.01 * limit, at=(0.5 + arm, 0.5)))


def test_several_free_modes_solve_close_to_the_limit():
    problem = torsion_pad(0.97 * LIMIT_TORQUE, cells=4)
    from fenics_contact.solve.load_steps.load_stepper import solve

    require_equilibrium(problem)
    solution = solve(problem)
    assert solution.residual_history[-1] <= solution.imbalance_limit
