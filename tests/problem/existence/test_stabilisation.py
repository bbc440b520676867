"""Motions that nothing resists: held without a force, or refused; and named before contact."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    Load,
    Material,
    MeshSource,
    NoEquilibriumError,
    Obstacle,
    Run,
    Scene,
    SolverSettings,
    Support,
    run,
)
from fenics_contact.body.supports import AppliedSupport
from fenics_contact.common.parallel import largest
from fenics_contact.problem.existence import condition as equilibrium
from fenics_contact.problem.existence.stabilisation import stabilise
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FLAT, HALF = box_body((8, 3), (2, 1)), box_body((4, 3), (1, 1))
CUBE = box_body((4, 4, 3), (1, 1, 1))
UPPER, LOWER = Box("upper", (0.5, 1), (1.5, 2), (5, 3)), Box("lower", (0, 0), (2, 1), (8, 3))
PILE = boxes((UPPER, LOWER))
HUMP = Load("y1", pressure=lambda x: 10 * x[0] * (2 - x[0]))


def scene(*contacts, load=(HUMP,), kinematics="plane strain", **settings):
    return Scene(
        kinematics=kinematics,
        material=Material(1000, 0.3),
        load=load,
        contact=contacts or (Contact("y0"),),
        solver=SolverSettings(**{"stabilisation": True, "tolerance": 1e-12} | settings),
    )


def solved(case, body=FLAT):
    run = Run(case, COMM, body)
    result = run.solve()
    assert result.passed, result.verdict
    assert result.checks["stabilisation"].value <= 1e-9
    return run, result


def elsewhere(monkeypatch, where):
    """Let other nodes be held."""

    def otherwise(problem, rigid, motions):
        return stabilise(problem, rigid, motions, where(problem.spaces.coordinates.T))

    monkeypatch.setattr(equilibrium, "stabilise", otherwise)


def test_a_block_that_slides_freely_is_as_one_half_of_it_with_its_plane_of_symmetry():
    _, result = solved(scene())
    half = dataclasses.replace(scene(stabilisation=False), symmetry=("x1",))
    reference = Run(half, COMM, HALF).solve().quantities
    for key, factor in (("normal_force", 2), ("strain_energy", 2), ("max_contact_pressure", 1)):
        assert result.quantities[key] == pytest.approx(factor * reference[key], rel=1e-9)
    assert result.model["stabilised_motions"] == ["translation along x"]
    (row,) = result.supports
    assert row["on"] == "the stabilisation"
    assert np.abs(row["reaction"]).max() <= 1e-9 * 40 / 3


def test_without_the_option_the_refusal_names_it():
    with refused("motion_is_undetermined", NoEquilibriumError, motion="translation along x"):
        Run(scene(stabilisation=False), COMM, FLAT)


def test_a_stabilisation_holds_no_loads():
    push = Load("body", body_force=(1e-3, 0))
    with refused("motion_is_pushed", NoEquilibriumError, motion="translation along x"):
        Run(scene(load=(HUMP, push)), COMM, FLAT)
    with refused("nothing_presses", NoEquilibriumError, motion="translation along y"):
        Run(scene(load=()), COMM, FLAT)


def test_the_check_fails_where_a_load_is_held(monkeypatch):
    """A push that is 1.5e-6 of what presses the block, held all the same."""
    push = Load("body", body_force=(1e-5, 0))

    def held(problem, rigid, motions):
        there = problem.spaces.nodes(problem.body.group("x0", "x0"))[:1].astype(np.int64)
        problem.stabilise(AppliedSupport("here", there * 2, np.zeros(len(there))))
        return ()

    monkeypatch.setattr(equilibrium, "stabilise", held)
    result = Run(scene(load=(HUMP, push)), COMM, FLAT).solve()
    assert result.converged and not result.passed
    assert [name for name, check in result.checks.items() if not check.passed] == ["stabilisation"]


@pytest.mark.parametrize("solver", ["condensed", "full", "iterative"])
def test_in_space_by_every_solver_whatever_is_held(solver, monkeypatch):
    """Two slides and a spin of a block on a smooth floor; the pressure is that of its weight."""
    down = Load("z1", pressure=lambda x: 5 + x[0] + 2 * x[0] * x[1])
    case = scene(Contact("z0"), load=(down,), kinematics="3D", solver=solver, tolerance=1e-11)
    case = dataclasses.replace(case, discretisation=Discretisation(1))
    first, result = solved(case, CUBE)
    assert set(result.model["stabilised_motions"]) == {
        "translation along x",
        "translation along y",
        "rotation about z",
    }
    elsewhere(monkeypatch, lambda x: (x[2] > 0.2) & (x[2] < 0.8) & (np.abs(x[0] + x[1] - 1) < 0.7))
    second, other = solved(case, CUBE)
    held = [{int(d) for d in run.problem.stabilisation[0].dofs} for run in (first, second)]
    assert COMM.allreduce(len(held[0] & held[1])) == 0
    peak = result.quantities["max_contact_pressure"]
    pressures = [run.solution.states[0].contact_pressure for run in (first, second)]
    assert largest(COMM, np.abs(pressures[0] - pressures[1])) <= 1e-7 * peak
    assert other.quantities["strain_energy"] == pytest.approx(
        result.quantities["strain_energy"], rel=1e-9
    )
    # ∫ 5 + x + 2 x y over the unit square.
    assert result.quantities["normal_force"] == pytest.approx(6, rel=1e-9)


@pytest.mark.parametrize(
    "between, held",
    [
        (0.0, {"translation along x of 'upper'", "translation along x of 'lower'"}),
        (0.3, {"translation along x of 'upper', translation along x of 'lower'"}),
    ],
    ids=["smooth", "rough"],
)
@pytest.mark.parametrize("solver", ["condensed", "full"])
def test_two_bodies_are_held_each_or_together(between, held, solver, monkeypatch):
    top = Load("upper.y1", pressure=lambda x: 5 + x[0])
    contacts = (
        Contact("upper.y0", against="lower.y1", friction_coefficient=between),
        Contact("lower.y0"),
    )
    case = scene(*contacts, load=(top,), solver=solver)
    first, result = solved(case, PILE)
    assert set(result.model["stabilised_motions"]) == held
    assert len(result.supports) == len(held)
    elsewhere(monkeypatch, lambda x: (x[1] > 0.1) & (x[1] < 1.7) & (np.abs(x[1] - 1) > 0.1))
    second, other = solved(case, PILE)
    for number in range(2):
        pressures = [run.solution.states[number].contact_pressure for run in (first, second)]
        peak = largest(COMM, pressures[0])
        assert largest(COMM, np.abs(pressures[0] - pressures[1])) <= 1e-6 * peak
    assert other.quantities["strain_energy"] == pytest.approx(
        result.quantities["strain_energy"], rel=1e-8
    )


DISC = """
Point(1) = {0, 1, 0}; Point(2) = {0, 0, 0}; Point(3) = {1, 1, 0};
Point(4) = {0, 2, 0}; Point(5) = {-1, 1, 0};
Circle(1) = {2, 1, 3}; Circle(2) = {3, 1, 4}; Circle(3) = {4, 1, 5}; Circle(4) = {5, 1, 2};
Transfinite Curve {1, 2, 3, 4} = 13;
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Physical Curve("round") = {1, 2, 3, 4}; Physical Surface("disc") = {1};
"""


def test_a_smooth_disc_may_spin(tmp_path):
    """Its weight, π, passes through the point where it rests; the spin about its centre is held."""
    path = COMM.bcast(str(tmp_path / "disc.geo"))
    if COMM.rank == 0:
        with open(path, "w") as file:
            file.write(DISC)
    COMM.Barrier()
    floor = Obstacle("plane", position=(0, 0), normal=(0, 1))
    case = scene(Contact("round", obstacle=floor), load=(Load("disc", body_force=(0, -1)),))
    case = dataclasses.replace(case, mesh=(MeshSource(path, order=2),))
    _, result = solved(case, None)
    (held,) = result.model["stabilised_motions"]
    assert "rotation about z" in held
    assert result.quantities["normal_force"] == pytest.approx(np.pi, rel=1e-5)


def test_rigid_motions_are_named_for_each_body_before_contact():
    """What the supports leave free, and what may resist it once bodies touch."""
    top = Load("upper.y1", pressure=5.0)
    contacts = (
        Contact("upper.y0", against="lower.y1", friction_coefficient=0.3, name="joint"),
        Contact("lower.y0", name="floor"),
    )
    model = Run(scene(*contacts, load=(top,)), COMM, PILE).model
    assert model["free_rigid_motions"] == 6
    found = {row["motion"]: row for row in model["rigid_motions"]}
    slide = found["translation along x of 'lower'"]
    assert slide == {
        "motion": "translation along x of 'lower'",
        "bodies": ["lower"],
        "resisted_by": ["friction at 'joint'"],
    }
    lift = found["translation along y of 'lower'"]["resisted_by"]
    assert lift == ["contact at 'joint'", "contact at 'floor'"]
    turn = found["rotation about z of 'upper'"]
    assert turn["bodies"] == ["upper"]
    assert turn["resisted_by"] == ["contact at 'joint'", "friction at 'joint'"]
    glued = (Contact("upper.y0", against="lower.y1", contact="bonded"), contacts[1])
    together = Run(scene(*glued, load=(top,)), COMM, PILE).model["rigid_motions"]
    assert len(together) == 3 and all(len(row["bodies"]) == 2 for row in together)


def test_a_body_held_everywhere_has_no_rigid_motion_and_no_check():
    case = dataclasses.replace(scene(), symmetry=("x0",))
    result = Run(case, COMM, HALF).solve()
    assert result.passed and "stabilisation" not in result.checks
    assert [row["motion"] for row in result.model["rigid_motions"]] == ["translation along y"]


@pytest.mark.parametrize("contact", [Contact("y0"), Contact("x1", pressure=5.0)])
def test_nothing_is_stabilised_where_supports_hold_all(contact):
    contact = dataclasses.replace(contact, friction_coefficient=0.3)
    held = Support("y1", {"x": 0, "y": -0.01})
    result = run(dataclasses.replace(scene(contact, load=()), support=(held,)), COMM, FLAT)
    assert result.passed
    assert "stabilisation" not in result.checks
    assert result.model["rigid_motions"] == [] == result.model["stabilised_motions"]
