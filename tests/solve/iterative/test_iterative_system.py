"""The iterative solver: the full one's answers, multigrid set up once, and few V-cycles."""

import dataclasses

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    NotConvergedError,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Support,
    run,
)
from fenics_contact.common.parallel import largest
from fenics_contact.common.timings import Timings
from fenics_contact.problem.problem import Problem
from fenics_contact.solve.coulomb.strategies import solve_step
from fenics_contact.solve.iterative.iterative_system import IterativeSystem
from fenics_contact.solve.newton import Newton
from fenics_contact.solve.systems.full_system import FullSystem
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
TOLERANCE = 1e-8
HELD = (Support("z0", {"x": 0, "y": 0, "z": 0}),)


def sphere(coefficient=0.5, degree=1, steps=1, law="static", shear=0.008, **keys):
    """A rigid sphere pressed into the middle of a block's top, and sheared."""
    drive = {"force": keys.pop("force")} if "force" in keys else {"indentation": 0.03}
    obstacle = Obstacle(
        shape="sphere", radius=2, position=(1, 1, 1), displacement=(shear, 0, 0), **drive
    )
    contact = Contact(
        "patch", friction_coefficient=coefficient, law=law, obstacle=obstacle,
        regularisation_parameter=keys.pop("epsilon", 1e-6),
        penalty_parameter=keys.pop("penalty", "auto"),
    )  # fmt: skip
    scene = {"support": HELD} | keys
    return Scene(
        kinematics="3D",
        material=Material(1000, 0.3),
        discretisation=Discretisation(degree),
        contact=(contact,),
        steps=Steps(number=steps),
        **scene,
    )


def block(cells=8, cell=mesh.CellType.hexahedron):
    patch = {"patch": ("z1", lambda x: (np.abs(x[0] - 1) < 0.4) & (np.abs(x[1] - 1) < 0.4))}
    return box_body((cells, cells, cells // 2), (2, 2, 1), cell, patches=patch)


def solved(scene, body, kind=IterativeSystem):
    """The last solution, its Newton solver and its system, which is freed."""
    problem = Problem.on_mesh(scene, body)
    system = kind(problem, Timings())
    newton = Newton(problem, system, Timings())
    for number, time in enumerate(scene.steps.all_times):
        problem.set_time(time)
        newton.forget()
        newton.begin.anew() if number == 0 else newton.begin.from_last_step()
        solution = solve_step(newton)
        for contact in problem.contacts:
            contact.accept()
    system.destroy()
    return solution, newton, system


def difference(found, wanted):
    """Largest over the largest wanted, on all ranks."""
    return largest(COMM, np.abs(found - wanted)) / largest(COMM, np.abs(wanted))


def require_same(scene, body):
    found, _, system = solved(scene, body)
    wanted, *_ = solved(scene, body, FullSystem)
    assert difference(found.displacement, wanted.displacement) < TOLERANCE
    assert difference(found.internal_force, wanted.internal_force) < TOLERANCE
    for one, other in zip(found.contact_force, wanted.contact_force, strict=True):
        assert difference(one, other) < TOLERANCE
    for one, other in zip(found.states, wanted.states, strict=True):
        assert (one.status == other.status).all()
    assert system.multigrid.setups == 1


PRESSED = {
    "frictionless": sphere(0.0),
    "Coulomb": sphere(0.5),
    "driven by a force": sphere(0.5, force=13),
    "paths": sphere(0.5, force=13, steps=3, law="incremental"),
    "half-space": sphere(support=(), half_space=HalfSpace(on=("z0", "x0", "x1", "y0", "y1"))),
}


@pytest.mark.parametrize("name", PRESSED)
def test_answers_are_those_of_the_full_solver(name):
    require_same(PRESSED[name], block())


def test_quadratic_tetrahedra():
    require_same(sphere(0.3, degree=2), block(6, mesh.CellType.tetrahedron))


@pytest.mark.parametrize("coefficient", [0.1, 0.3, 1.0])
def test_a_whole_face_that_rubs(coefficient):
    """All of it touches, a part sticks and a part slips; ε follows from the pressure."""
    plane = Obstacle(
        shape="plane", position=(1, 1, 1), indentation=0.02, displacement=(0.004, 0, 0)
    )
    contact = Contact("z1", friction_coefficient=coefficient, obstacle=plane)
    scene = dataclasses.replace(sphere(), contact=(contact,))
    found, newton, system = solved(scene, block())
    wanted, *_ = solved(scene, block(), FullSystem)
    assert difference(found.displacement, wanted.displacement) < TOLERANCE
    assert difference(found.contact_force[0], wanted.contact_force[0]) < 10 * TOLERANCE
    assert newton.steps <= 10
    assert system.multigrid.cycles <= 70


def test_bodies_that_only_contacts_hold():
    """K is singular: on a rough floor, glued to it, and under the sphere as well."""
    top = sphere(0.5, force=13, shear=0.004).contact[0]
    floor = Contact("z0", friction_coefficient=0.3)
    loads = (Load("x1", traction=(1, 0.5, 0)), Load("z1", pressure=5))
    for contacts, load in (
        ((floor,), loads),
        ((dataclasses.replace(floor, friction_coefficient=0, contact="bonded"),), loads),
        ((floor, top), ()),
    ):
        require_same(
            dataclasses.replace(sphere(), support=(), contact=contacts, load=load), block()
        )


def test_multigrid_is_set_up_once_over_load_steps():
    _, _, system = solved(sphere(0.5, force=13, steps=4, law="incremental"), block())
    assert system.multigrid.setups == system.factorisations == 1
    assert system.multigrid.cycles < 4 * 30


FAR = {"support": (), "half_space": HalfSpace(on=("z0", "x0", "x1", "y0", "y1"))}


@pytest.mark.parametrize("coefficient", [0.0, 0.5])
@pytest.mark.parametrize("keys", [FAR, {"force": 13}, FAR | {"force": 13}], ids=str)
def test_few_steps_where_scalars_move_the_contact(coefficient, keys):
    """Resultants move the outer boundary of a half-space, a force its obstacle."""
    _, newton, system = solved(sphere(coefficient, **keys), block(14))
    assert newton.steps <= 8
    assert system.multigrid.cycles <= 30


def test_cycles_hold_under_refinement():
    cycles, steps = [], []
    for cells in (8, 16):
        _, newton, system = solved(sphere(0.5), block(cells))
        cycles.append(system.multigrid.cycles)
        steps.append(newton.steps)
    assert max(steps) <= 7
    assert cycles[1] <= 1.6 * cycles[0] <= 40


@pytest.mark.parametrize("coefficient", [0.3, 0.6])
def test_cycles_hold_for_small_parameters(coefficient):
    """ε and ε₁ from .001 to 1e-8 of slip and depth."""
    body = block()
    cycles = []
    for share in (1e-3, 1e-5, 1e-8):
        scene = sphere(coefficient, epsilon=share * 0.008, penalty=share * 0.03 / 50)
        cycles.append(solved(scene, body)[2].multigrid.cycles)
    assert max(cycles) <= 1.25 * min(cycles) <= 40


def test_a_larger_contact_surface_costs_no_cycles():
    """What touches is what is solved directly; the zone follows it."""
    # One mesh: dolfinx 0.9 may part a second one otherwise among the ranks.
    scene, body = sphere(0.5), block(16)
    whole = dataclasses.replace(scene.contact[0], on="z1")
    found, _, system = solved(dataclasses.replace(scene, contact=(whole,)), body)
    patch, _, smaller = solved(scene, body)
    assert difference(found.displacement, patch.displacement) < TOLERANCE
    assert system.multigrid.cycles <= 1.1 * smaller.multigrid.cycles
    assert COMM.allreduce(len(system.zone.places)) <= 1.1 * COMM.allreduce(len(smaller.zone.places))


def test_a_contact_that_grows_over_load_steps():
    """The zone is moved while K_c has values, which must not stay behind in it."""
    scene = sphere(0.5, steps=4, law="incremental")
    wide = dataclasses.replace(scene.contact[0].obstacle, radius=20)
    contact = dataclasses.replace(scene.contact[0], on="z1", obstacle=wide)
    scene = dataclasses.replace(scene, contact=(contact,))
    body = block(12)
    require_same(scene, body)
    _, _, system = solved(scene, body)
    assert system.multigrid.cycles < 4 * 30


def test_a_scene_may_ask_for_it():
    scene = dataclasses.replace(sphere(0.5), solver=SolverSettings(solver="iterative"))
    result = run(scene, COMM, block())
    assert result.passed, result.verdict
    assert result.model["solver"] == "iterative"


def test_linear_solves_that_come_to_nothing_are_given_up(monkeypatch):
    """Each costs as many cycles as are allowed; a hundred Newton steps of them took minutes."""
    monkeypatch.setattr("fenics_contact.solve.iterative.nonlinear_elimination._MOST_ITERATIONS", 1)
    # What is gained is nothing.
    monkeypatch.setattr("fenics_contact.solve.iterative.nonlinear_elimination._GAIN", 1e-3)
    scene = dataclasses.replace(
        sphere(steps=1), solver=SolverSettings(strategy="monolithic", max_iterations=60)
    )
    with refused("linear_system_not_solved", NotConvergedError) as caught:
        solved(scene, block())
    assert len(caught.value.residual_history) < 30
