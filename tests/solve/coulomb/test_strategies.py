"""The loop on the contact pressure and its rescues: each has a scene that needs it."""

import logging
import re
from itertools import pairwise

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, Obstacle, Scene, SolverSettings, Support, run
from fenics_contact.common.errors import NoEquilibriumError
from fenics_contact.solve.condensed.condensed_system import CondensedSystem
from fenics_contact.solve.coulomb import at_points
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
TOLERANCE = 1e-6


FEW = {"max_iterations": 8, "max_outer_iterations": 1}


def driven(coefficient, aside, down, strategy="auto", settings=None, **keys):
    """A block on a rough floor whose top is moved."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": aside, "y": down}),),
        contact=(Contact("y0", friction_coefficient=coefficient, **keys),),
        solver=SolverSettings(strategy=strategy, **(settings or {})),
    )
    return run(scene, COMM, box_body((16, 8), (2, 1)))


def pushed(side, strategy="auto", coefficient=0.5, size=(2, 1), cells=(8, 8)):
    """A block that nothing but the floor's friction holds: weight 10 per length on its top."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        load=(Load("y1", traction=(side, -10)),),
        contact=(Contact("y0", friction_coefficient=coefficient),),
        solver=SolverSettings(strategy=strategy),
    )
    return run(scene, COMM, box_body(cells, size))


@pytest.mark.parametrize("coefficient", [0.5, 3.0, 10.0])
def test_strategies_agree(coefficient):
    results = [driven(coefficient, 0.05, -0.01, way) for way in ("campos", "lagged", "monolithic")]
    peak = results[0].quantities["max_contact_pressure"]
    for result in results:
        assert result.passed, result.verdict
        difference = result.points.contact_pressure - results[0].points.contact_pressure
        assert np.abs(difference).max() <= TOLERANCE * peak
        excess = (
            np.linalg.norm(result.points.friction_traction, axis=1)
            - coefficient * result.points.contact_pressure
        )
        assert excess.max() <= TOLERANCE * peak
    assert results[2].steps[0]["outer_iterations"] == 0
    assert 0 < results[0].steps[0]["outer_iterations"] <= 20


@pytest.mark.parametrize(
    ("coefficient", "strategy", "passes"),
    [(0.5, "campos", 12), (3, "campos", 31), (5, "campos", 40), (0.5, "lagged", 40),
     (3, "lagged", 33), (5, "lagged", 40)],
)  # fmt: skip
def test_acceleration_saves_passes_or_the_loop(coefficient, strategy, passes):
    """Counts of the specification's table without it; 40 where that says that the loop fails."""
    result = driven(coefficient, 0.05, -0.01, strategy)
    assert result.passed
    assert result.steps[0]["outer_iterations"] < passes


CAMPOS, LAGGED, NEWTON, RAISED = (
    "the paper's alternation of friction and contact",
    "contact and friction with the bound of the last pass",
    "Newton's method on contact and friction together",
    "the coefficient brought up or down in steps",
)
WORDS = {"campos": CAMPOS, "lagged": LAGGED, "monolithic": NEWTON}


@pytest.mark.parametrize(
    ("body", "failing", "rescue"),
    [
        (lambda way: driven(4.0, 0.4, -0.002, way), ["campos"], LAGGED),
        # Who allows few steps: half the coefficient is nearer than all of it.
        (lambda way: driven(1.0, 0.02, -0.005, way, FEW), list(WORDS), RAISED),
    ],
)  # fmt: skip
def test_each_way_rescues_what_those_before_it_cannot_solve(
    body, failing, rescue, caplog, monkeypatch
):
    """Where there are too many points to solve at these alone; else that is the next way."""
    if rescue == LAGGED:
        assert "at the points" in body("auto").model["strategy"]
    monkeypatch.setattr(at_points, "_FEW", 0)
    for way in failing:
        assert not body(way).converged
    with caplog.at_level(logging.INFO, "fenics_contact"):
        rescued = body("auto")
    failed = {name for name, check in rescued.checks.items() if not check.passed}
    assert rescued.converged and failed <= {"linear_range"}  # corners are sheared far
    assert rescue in rescued.model["strategy"]
    said = " ".join(record.getMessage() for record in caplog.records)
    for failed, following in pairwise([*(WORDS[way] for way in failing), rescue]):
        assert re.search(f"{failed}.*next: .*{following}", said)


@pytest.mark.parametrize("side", [0.0, 2.0, 4.5, 4.9, 4.999])
def test_friction_alone_holds_a_block_up_to_its_limit(side):
    result = pushed(side)
    assert result.passed
    assert result.quantities["friction_force"][0] == pytest.approx(-2 * side, abs=1e-6)
    assert result.quantities["normal_force"] == pytest.approx(20, rel=1e-8)
    assert "paper" not in result.model["strategy"]  # given pressures alone would not hold it


@pytest.mark.parametrize("kinematics", ["plane strain", "axisymmetric"])
@pytest.mark.parametrize("share", [0.9, 0.999])
def test_given_pressures_hold_a_block_up_to_their_limit(share, kinematics):
    """Nearly all of its side slips: a Newton step would take the block far away, and lose it."""
    area = 2 if kinematics == "axisymmetric" else 1  # of the side over that of the top
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0}),),
        load=(Load("y1", traction=(0, share * 0.4 * 3 * area)),),
        contact=(Contact("x1", pressure=3, friction_coefficient=0.4),),
        solver=SolverSettings(errors="none"),
    )
    result = run(scene, COMM, box_body((4, 4), (1, 1)))
    assert result.passed, result.verdict
    assert result.steps[0]["newton_iterations"] <= 20
    held = 0.4 * 3 * (2 * np.pi if area == 2 else 1)
    assert result.quantities["friction_force"][1] == pytest.approx(-share * held, rel=1e-8)


def test_beyond_the_limit_there_is_no_answer():
    said = {"motion": "translation along x", "share": "1.02"}
    with refused("loads_exceed_friction", NoEquilibriumError, **said):
        pushed(5.1)


@pytest.mark.parametrize("side", [1.0, 2.4, 2.49])
def test_block_stands_until_it_tips(side):
    """Half the width over the height times the weight: tips at 2.5 (specification, Section 5)."""
    result = pushed(side, coefficient=2.0, size=(1, 2), cells=(8, 16))
    assert result.passed
    assert result.steps[0]["outer_iterations"] <= 3
    motion = "translation along x and y, rotation about z"
    with refused("loads_push_away", NoEquilibriumError, motion=motion):
        pushed(2.51, coefficient=2.0, size=(1, 2), cells=(8, 16))


def test_lifted_block_touches_nothing():
    for way in ("auto", "campos", "lagged", "monolithic"):
        result = driven(1.0, 0.02, 0.001, way)
        assert result.passed
        assert result.quantities["contact_area"] == 0
        assert "does not touch" in result.verdict


def test_no_coefficient_is_no_friction():
    """Bit for bit in what is modelled, and the same numbers."""
    without = driven(0.0, 0.05, -0.01)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.05, "y": -0.01}),),
        contact=(Contact("y0", law="none"),),
    )
    frictionless = run(scene, COMM, box_body((16, 8), (2, 1)))
    assert without.model["terms"] == frictionless.model["terms"]
    for key, value in frictionless.quantities.items():
        assert without.quantities[key] == pytest.approx(value, rel=1e-12, abs=1e-12)


def test_obstacle_that_moves_aside_takes_its_gap_along():
    """A parabola set down at x = 1.2, or set down at 1 and moved there without friction."""

    def pressed(position, **keys):
        obstacle = Obstacle("parabola", radius=2, position=(position, 1), indentation=0.02, **keys)
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3),
            support=(Support("y0", {"x": 0, "y": 0}),),
            contact=(Contact("y1", obstacle=obstacle),),
        )
        return run(scene, COMM, box_body((20, 8), (2, 1)))

    there, moved = pressed(1.2), pressed(1.0, displacement=(0.2, 0))
    for key in ("normal_force", "max_contact_pressure", "contact_area"):
        assert moved.quantities[key] == pytest.approx(there.quantities[key], rel=1e-6)
    drop = pressed(1.2, displacement=(0, -0.01))
    deeper = pressed(1.2)
    assert drop.quantities["normal_force"] > 1.3 * deeper.quantities["normal_force"]


def test_rough_obstacle_drags_the_body_along():
    """Slip counts from the obstacle: stuck to it, the surface goes where it goes."""
    obstacle = Obstacle(indentation=0.02, displacement=(0.001, 0))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=50.0),),
    )
    result = run(scene, COMM, box_body((12, 6), (2, 1)))
    assert result.passed
    assert (result.points.status == "STICK").mean() > 0.8
    assert result.quantities["friction_force"][0] > 0
    assert result.quantities["max_slip"] < 1e-3


@pytest.mark.parametrize("strategy", ["auto", "lagged", "monolithic"])
def test_block_between_a_brake_and_a_floor(strategy):
    """The brake alone, .5 × 3, is less than the push of 1.9; the floor can add .2 × 3."""
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        load=(Load("x1", traction=(1.9, 0)),),
        contact=(
            Contact("y1", pressure=3, friction_coefficient=0.5),
            Contact("y0", friction_coefficient=0.2),
        ),
        solver=SolverSettings(strategy=strategy),
    )
    result = run(scene, COMM, box_body((8, 8), (1, 1)))
    assert result.passed
    assert result.model["used_share_of_limit_load"] == pytest.approx(1.9 / 2.1, rel=1e-4)
    brake, floor = (contact["quantities"]["friction_force"][0] for contact in result.contacts)
    assert brake + floor == pytest.approx(-1.9, rel=1e-6)
    assert abs(brake) <= 1.5 * (1 + 1e-6) and abs(floor) <= 0.6 * (1 + 1e-6)


def test_a_clearance_is_not_used_up_to_find_the_regularisation(monkeypatch):
    """Without friction the pushed block would slide to a wall a quarter of its length away."""
    wall = Obstacle("plane", position=(2.5, 0.0), normal=(-1, 0))
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        load=(Load("y1", traction=(2.0, -10)),),
        contact=(Contact("y0", friction_coefficient=0.5), Contact("x1", obstacle=wall)),
        solver=SolverSettings(strategy="monolithic", errors="none"),
    )
    gone, take = [], CondensedSystem.take

    def watched(self, state):
        take(self, state)
        gone.append(self.moved())

    monkeypatch.setattr(CondensedSystem, "take", watched)
    result = run(scene, COMM, box_body((8, 8), (2, 1)))
    assert result.passed, result.verdict
    assert result.quantities["friction_force"] is None  # of two contacts, each has its own
    assert np.isclose(result.contacts[0].quantities["friction_force"][0], -4.0, rtol=1e-6)
    assert max(gone) < 0.1
