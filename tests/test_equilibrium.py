"""The condition |f(r)| < j(r) against limit loads in closed form."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import dblquad
from scipy.optimize import minimize

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
from fenics_contact.equilibrium import require_equilibrium
from fenics_contact.problem import Problem
from fenics_contact.summary import print_model
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
    with pytest.raises(NoEquilibriumError, match="translation along x") as error:
        Run(slab(end_load=end_load, held=False), COMM)
    assert "\n" not in str(error.value)
    assert error.value.exit_code == 2


def test_without_friction_a_free_motion_is_refused_even_without_a_load():
    with pytest.raises(NoEquilibriumError, match="left undetermined"):
        Run(slab(end_load=0, held=False, coefficient=0.0), COMM)
    with pytest.raises(NoEquilibriumError, match="which the loads push"):
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
    return Problem(scene, box_body((cells, cells, 1)))


LIMIT_TORQUE = dblquad(lambda y, x: np.hypot(x, y), -0.5, 0.5, -0.5, 0.5)[0]


def test_limit_torque_of_a_square_pad():
    """∫ |r| over the unit square = .38260."""
    assert pytest.approx(0.38260, abs=5e-6) == LIMIT_TORQUE
    motion = require_equilibrium(torsion_pad(0.3))
    assert motion.modes == 3
    assert motion.motion == "rotation about z"
    assert 0.3 / motion.used_share == pytest.approx(LIMIT_TORQUE, rel=2e-4)
    with pytest.raises(NoEquilibriumError, match="rotation about z"):
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
    with pytest.raises(NoEquilibriumError, match="rotation"):
        require_equilibrium(torsion_pad(0.0, force=1.01 * limit, at=(0.5 + arm, 0.5)))


def test_several_free_modes_solve_close_to_the_limit():
    problem = torsion_pad(0.97 * LIMIT_TORQUE, cells=4)
    from fenics_contact.load_steps import solve

    require_equilibrium(problem)
    solution = solve(problem)
    assert solution.residual_history[-1] <= solution.imbalance_limit
