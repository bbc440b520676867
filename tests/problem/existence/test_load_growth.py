"""Upper bounds of the factor of varying loads, against statics of rigid bodies."""

from dataclasses import replace
from math import hypot, sqrt

import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Run, Scene, Steps, run
from fenics_contact.problem.existence.load_growth import growth_limit
from fenics_contact.scene.settings import SolverSettings
from fenics_contact.trust import slip_factor
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
WEIGHT, FRICTION = 100.0, 0.2
FIRST, LATER = {"time": [0, 1], "factor": [0, 1]}, {"time": [1, 2], "factor": [0, 1]}


def rough(face, friction=FRICTION):
    normal = [0.0, 0.0, 0.0]
    normal["xyz".index(face[0])] = 1.0
    size = 2 if face == "y0" and friction == TALL else 3
    return Contact(
        face,
        obstacle=Obstacle("plane", normal=tuple(normal[:size]), position=(0.0,) * size),
        law="incremental",
        friction_coefficient=friction,
    )


TALL = 0.5


def held(loads, contacts, kinematics="3D", errors="none"):
    """Constant loads first, then the last one, which varies."""
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.0),
        load=tuple(loads),
        contact=tuple(contacts),
        steps=Steps(times=(1, 2)),
        solver=SolverSettings(errors=errors),
    )


def bound(scene, body):
    """The bound of a scene's last load, and the motion that runs there."""
    solved = Run(scene, COMM, body)
    assert solved.solve().passed
    problem = solved.problem
    _, nodal, share = problem.acting_loads[-1]
    return growth_limit(problem, nodal * share, 1.0)


@pytest.mark.parametrize("height", [0.2, 0.8])
def test_a_block_in_a_groove_slides_along_it(height):
    """Just above 2 μ N with N = W cos 45°: 28.2843 for W = 100 and μ = .2, wherever it is pulled.

    Friction across the axis may press the block into the groove: 2 μ N/√(1 − μ²) with the best of
    all pressures. The groove's sides are y = 0 and z = 0; the block is too long to tip.
    """
    down = -WEIGHT / sqrt(2)
    pull = 10.0
    loads = (
        Load("body", body_force=(0, down / 4, down / 4), path=FIRST),
        Load("x1", force=(pull, 0, 0), at=(4, height, height), path=LATER),
    )
    scene = held(loads, (rough("y0"), rough("z0")))
    found = bound(scene, box_body((4, 2, 2), (4, 1, 1)))
    slides = FRICTION * WEIGHT * sqrt(2)
    assert slides == pytest.approx(28.2843, abs=1e-4)
    assert found.factor * pull == pytest.approx(slides / sqrt(1 - FRICTION**2), rel=1e-6)
    assert found.motion == "translation along x"
    steps = SolverSettings(errors="none", slip_limit="steps")
    solved = Run(replace(scene, solver=steps), COMM, box_body((4, 2, 2), (4, 1, 1)))
    reached = solved.solve()
    assert reached.slip_limit.kind == "load steps"
    assert 0.95 * found.factor < reached.slip_limit.factor < found.factor
    # Until it slides, friction across the groove carries a part of the weight.
    assert abs(reached.slip_limit.factor - slides / pull) < solved.end.slip.bracket < 0.1


@pytest.mark.errors
def test_error_bars_of_a_block_in_a_groove(monkeypatch):
    """All sources are known; other answers begin with the loads at which the first ended."""
    tried = []
    at = slip_factor._Growth.limit_at
    monkeypatch.setattr(
        slip_factor._Growth,
        "limit_at",
        lambda self, factor: tried.append(factor) or at(self, factor),
    )
    down, pull = -WEIGHT / sqrt(2), 10.0
    loads = (
        Load("body", body_force=(0, down / 4, down / 4), path=FIRST),
        Load("x1", force=(pull, 0, 0), at=(4, 0.2, 0.2), path=LATER),
    )
    scene = held(loads, (rough("y0"), rough("z0")))
    steps = replace(scene, solver=SolverSettings(errors="all", slip_limit="steps"))
    found = run(steps, COMM, box_body((2, 1, 1), (4, 1, 1))).slip_limit
    slides = FRICTION * WEIGHT * sqrt(2)
    assert abs(found.factor - slides / pull) < found.errors["factor"]["total"] < 0.1
    last = tried.index(1.01, 1) - 1  # the first of another answer is 1 % more load
    assert tried[last + 1 :] == [1.01, tried[last]] * 4


@pytest.mark.parametrize(("height", "right"), [(0.2, 5.0), (2.0, 2.5)])
def test_a_tall_block_slides_or_tips(height, right):
    """Pulled at a height h: the less of μ W and W b/2h."""
    loads = (
        Load("y1", pressure=10.0, path=FIRST),
        Load("x1", force=(1.0, 0), at=(1.0, height), path=LATER),
    )
    found = bound(held(loads, (rough("y0", TALL),), "plane strain"), box_body((4, 8), (1, 2)))
    assert found.factor == pytest.approx(right, rel=1e-9)
    assert ("rotation" in found.motion) == (height > 1)


def test_a_torque_against_pressures_that_may_be_at_the_corners():
    """μ W times half of the diagonal, beside .3826 μ W a of an even pressure.

    The bound holds all the same: what turns the block is less.
    """
    loads = (
        Load("z1", pressure=WEIGHT, path=FIRST),
        Load("z1", moment=(0, 0, 1.0), force=(0, 0, 0), path=LATER),
    )
    found = bound(held(loads, (rough("z0"),)), box_body((4, 4, 2), (1, 1, 0.5)))
    assert found.factor == pytest.approx(FRICTION * WEIGHT * sqrt(0.5), rel=1e-6)
    assert found.motion == "rotation about z"


@pytest.mark.parametrize("constant", [0.0, 3.0])
def test_pushed_and_turned(constant):
    """Constant pull along x, growing pull along y, both low: |F| = μ W."""
    loads = (
        Load("z1", pressure=WEIGHT, path=FIRST),
        Load("z0", traction=(constant, 0, 0), path=FIRST),
        Load("z0", traction=(0, 5.0, 0), path=LATER),
    )
    loads = loads if constant else (loads[0], loads[2])
    found = bound(held(loads, (rough("z0"),)), box_body((2, 2, 2), (1, 1, 0.5)))
    assert hypot(constant, 5 * found.factor) == pytest.approx(FRICTION * WEIGHT, rel=1e-6)


def test_loads_that_press_as_they_pull_have_no_bound():
    """Steeper than the friction's angle they hold themselves."""
    loads = (
        Load("z1", pressure=WEIGHT, path=FIRST),
        Load("z0", traction=(0.1, 0, -1.0), path=LATER),
    )
    assert bound(held(loads, (rough("z0"),)), box_body((2, 2, 2), (1, 1, 0.5))) is None


def test_a_run_says_that_it_tips_before_it_slides():
    """By the pressures found it would slide at 5, which it never reaches."""
    loads = (
        Load("y1", pressure=10.0, path=FIRST),
        Load("x1", force=(1.0, 0), at=(1.0, 2.0), path=LATER),
    )
    scene = held(loads, (rough("y0", TALL),), "plane strain", errors="auto")
    found = run(scene, COMM, body=box_body((4, 8), (1, 2))).slip_limit
    assert found.kind == "upper bound"
    assert found.factor == pytest.approx(2.5, rel=1e-9)
    assert "rotation about z" in found.motion
