"""Coupled faces in motion, and masses at their points: on bars, on springs, against obstacles."""

import dataclasses
import math

import numpy as np
import pytest
from dolfinx import mesh
from mpi4py import MPI
from scipy.optimize import brentq

from fenics_contact import (
    Contact,
    Coupling,
    Load,
    Material,
    Motion,
    Obstacle,
    Path,
    Point,
    Rayleigh,
    Run,
    Scene,
    SolverSettings,
    Spring,
    Support,
)
from fenics_contact.common.errors import InputError, SceneError
from fenics_contact.evaluate.momentum_balance import MovingForces
from fenics_contact.problem.moving import moving
from fenics_contact.verification.published.impacts import along, times_of, touching
from tests.messages import refused
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
ALWAYS = Path((0,), (1,))
E, LENGTH, SIDE, DENSITY = 1000.0, 4.0, 0.5, 0.03
BODY, MASS, FORCE = DENSITY * LENGTH * SIDE, 1.2, 10.0
STIFFNESS = E * SIDE / LENGTH
KINDS = ["rigid", "distributing"]
SHARP = {"displacement": {"y": 0}, "rotation": {"z": 0}}


def bar(kind="rigid", motion=None, spring=(), density=DENSITY, poisson=0.0, **tip):
    """A bar along x in the plane, clamped at its left end, with a mass at the right one."""
    given = {"mass": MASS, "path": ALWAYS} | tip
    return Scene(
        kinematics="plane strain",
        material=Material(E, poisson, density=density),
        support=(Support("x0", {"x": 0, "y": 0}),),
        coupling=(Coupling("x1", kind=kind, name="tip", **given),),
        spring=spring,
        motion=motion,
        point=(Point(name="tip", at=(LENGTH, SIDE / 2)),),
        solver=SolverSettings(errors="none"),
    )


def body(comm=COMM, cells=(8, 2)):
    return box_body(cells, (LENGTH, SIDE), comm=comm)


def solved(scene, where=None):
    found = Run(scene, COMM, where or body()).solve()
    assert found.passed, found.verdict
    return found


def tip(found):
    return along(found, "displacement_tip")


def frequency_of_bar():
    """β tan β = ρ A L/m with ω = β √(E/ρ)/L (radian/time)."""
    beta = brentq(lambda x: x * math.tan(x) - BODY / MASS, 1e-3, 1.5)
    return beta / LENGTH * math.sqrt(E / DENSITY)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_at_the_end_of_a_bar_swings_at_its_frequency(kind):
    """Half a period after a force began to act it is as far as it gets: twice the static way.

    The overtones of a bar of a tenth of the mass take a few per mille of it.
    """
    w = frequency_of_bar()
    third = math.sqrt(STIFFNESS / (MASS + BODY / 3))
    assert w == pytest.approx(third, rel=1e-3)
    period, static = 2 * math.pi / w, FORCE / STIFFNESS
    scene = bar(kind, Motion(step=period / 80, end=period), force=(FORCE, 0), **SHARP)
    found = solved(scene)
    exact = static * (1 - np.cos(w * times_of(found)))
    assert np.abs(tip(found)[:, 0] - exact).max() < 5e-3 * static
    (coupling,) = found.couplings
    assert coupling.displacement == pytest.approx(tip(found)[-1], abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_on_a_spring_is_found_with_order_two(kind):
    """A light block that a velocity at time 0 moves, and k and m alone: x = v/ω sin ωt.

    The midpoint rule's frequency is that of tan(ω' Δt/2) = ω Δt/2.
    """
    k, speed, mass = 40.0, 0.3, 2.0
    light = DENSITY * 1e-3
    errors = []
    for steps in (10, 20, 40):
        spring = Spring(between=("block", "ground"), stiffness={"x": k})
        scene = Scene(
            kinematics="plane strain",
            material=Material(E, 0.0, density=light),
            coupling=(Coupling("x1", kind=kind, name="block", mass=mass - BODY * 1e-3, **SHARP),),
            spring=(spring,),
            motion=Motion(step=0.5 / steps, end=0.5, velocity={"body": (speed, 0)}),
            point=(Point(name="tip", at=(LENGTH, SIDE / 2)),),
            solver=SolverSettings(errors="none"),
        )
        found = solved(scene, body(cells=(2, 1)))
        w = math.sqrt(k / mass)
        slower = 2 * steps / 0.5 * math.atan(w * 0.25 / steps)
        times = times_of(found)
        x = tip(found)[:, 0]
        assert x == pytest.approx(speed / w * np.sin(slower * times), rel=1e-5)
        energy = along(found, "kinetic_energy") + along(found, "spring_energy")
        assert energy == pytest.approx(0.5 * mass * speed**2, rel=1e-5)
        assert found.quantities["momentum"][0] == pytest.approx(
            mass * speed * math.cos(slower * 0.5), rel=1e-5
        )
        errors.append(abs(x[-1] - speed / w * math.sin(w * 0.5)))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2, abs=0.05)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "given",
    [
        {"force": (FORCE, 3.0), "at": (5.0, 0.7), "moment": 2.0},
        {"force": (FORCE, 3.0), "mass": None},
        {"motion": Motion(step=0.01, end=0.4, rayleigh=Rayleigh(mass=2.0, stiffness=1e-3))},
        {"motion": Motion(step=0.01, end=0.4, velocity={"body": (0.1, 0.2)})},
        {"spring": (Spring(between=("tip", "ground"), stiffness=50, rotational_stiffness=30),)},
    ],
    ids=["beside", "no mass", "damped", "thrown", "sprung"],
)
def test_forces_and_energies_are_in_balance(kind, given):
    """To round-off: nothing begins or ceases to touch. Points are where their faces are."""
    given = {"motion": Motion(step=0.01, end=0.4), "force": (FORCE, 3.0)} | given
    found = solved(bar(kind, poisson=0.3, **given))
    assert found.checks["energy_balance"].value < 1e-10
    assert found.checks["momentum_balance"].value < 1e-9
    assert found.checks["coupling"].value < 1e-9


def test_a_damped_mass_loses_what_the_damping_takes():
    """Rayleigh's α of a mass on a spring: x = v/ω_d exp(−αt/2) sin ω_d t."""
    alpha, speed = 1.5, 0.3
    scene = bar(
        "rigid",
        Motion(step=0.005, end=0.4, velocity={"body": (speed, 0)}, rayleigh=Rayleigh(mass=alpha)),
        density=DENSITY * 1e-6,
        **SHARP,
    )
    found = solved(dataclasses.replace(scene, support=(Support("x0", {"x": 0, "y": 0}),)))
    times = times_of(found)
    w = math.sqrt(STIFFNESS / MASS - alpha**2 / 4)
    exact = speed / w * np.exp(-alpha * times / 2) * np.sin(w * times)
    assert np.abs(tip(found)[:, 0] - exact).max() < 2e-3 * speed / w


@pytest.mark.parametrize("kind", KINDS)
def test_what_begins_in_balance_stays_there(kind):
    """Under a force at the point, a spring, and a weight of mass and bar."""
    scene = bar(
        kind,
        Motion(step=0.01, end=0.1, start="static"),
        (Spring(between=("tip", "ground"), stiffness=50.0, rotational_stiffness=30.0),),
        0.03,
        0.3,
        force=(FORCE, 3.0),
    )
    scene = dataclasses.replace(scene, load=(Load("body", acceleration=(0, -3), path=ALWAYS),))
    found = solved(scene)
    assert np.abs(tip(found) - tip(found)[0]).max() < 1e-9 * np.abs(tip(found)).max()
    assert found.quantities["kinetic_energy"] < 1e-12 * found.quantities["strain_energy"]


def test_a_face_goes_where_it_is_given():
    """Turned about a point beside it, which is free to move; and along x by a path with kinks."""
    path = Path((0, 0.1, 0.3), (0, 1, 0))
    motion = Motion(step=0.01, end=0.3)
    for given in ({"rotation": {"z": 0.05}, "at": (5.0, 0.7)}, {"displacement": {"x": 0.1}}):
        found = solved(bar("rigid", motion, poisson=0.3, path=path, **given))
        assert found.checks["energy_balance"].value < 1e-9
        (row,) = found.couplings
        for key, values in given.items():
            if key != "at":
                assert getattr(row, key)[0] == pytest.approx(0.0, abs=1e-12), values


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_that_hits_a_stop_keeps_its_energy(kind):
    """It rebounds with its speed, but for the steps in which the stop begins and ceases to act."""
    stop = Spring(between=("tip", "ground"), stiffness={"x": 500.0}, gap=0.02)
    motion = Motion(step=0.002, end=0.4, velocity={"body": (0.5, 0)})
    scene = bar(kind, motion, (stop,), **SHARP)
    found = solved(dataclasses.replace(scene, support=()))
    assert found.quantities["spring_energy"] == 0
    before = 0.5 * (MASS + BODY) * 0.5**2
    every = along(found, "kinetic_energy") + along(found, "strain_energy")
    assert along(found, "spring_energy").max() > 0.8 * before
    assert every[-1] == pytest.approx(before, rel=5e-3)
    assert found.quantities["momentum"][0] == pytest.approx(-0.5 * (MASS + BODY), rel=2e-2)


@pytest.mark.parametrize("kind", KINDS)
def test_a_mass_that_hits_an_obstacle_by_an_elastic_foot(kind):
    """Half a swing of m on E A/L of a light bar: it touches for π/ω, and F is v √(k m) at most.

    The front of the first wave has ρ c v A besides.
    """
    speed, density = 0.1, DENSITY / 30
    obstacle = Obstacle("plane", position=(0, 0), normal=(1, 0))
    motion = Motion(step=0.002, end=0.4, velocity={"body": (-speed, 0)})
    scene = bar(kind, motion, density=density, **SHARP)
    scene = dataclasses.replace(scene, support=(), contact=(Contact("x0", obstacle=obstacle),))
    found = solved(scene)
    w = math.sqrt(STIFFNESS / (MASS + BODY / 90))
    assert touching(found).sum() * motion.size == pytest.approx(math.pi / w, rel=0.02)
    front = math.sqrt(density * E) * SIDE * speed
    force = along(found, "normal_force").max()
    assert force == pytest.approx(speed * math.sqrt(STIFFNESS * MASS), abs=1.1 * front)
    defect = np.abs(along(found, "energy_defect")).max()
    assert defect < 5e-3 * 0.5 * MASS * speed**2
    gained = found.quantities["momentum"][0] + speed * (MASS + BODY / 30)
    assert found.quantities["impulse"][0] == pytest.approx(gained, rel=1e-6)
    assert gained == pytest.approx(2 * speed * MASS, rel=0.02)


def swinging(kind="distributing"):
    """A mass beside a bar's end, which meets a stop."""
    stop = Spring(between=("tip", "ground"), stiffness={"x": 500.0}, gap=0.001)
    motion = Motion(step=0.01, end=0.1, velocity={"body": (0.1, 0.2)}, rayleigh=Rayleigh(mass=2.0))
    return bar(kind, motion, (stop,), poisson=0.3, force=(FORCE, 3.0), at=(5.0, 0.7))


@pytest.mark.parametrize("kind", KINDS)
def test_any_number_of_ranks_has_the_same_motion(kind):
    scene = swinging(kind)
    every = solved(scene)
    one = Run(scene, MPI.COMM_SELF, body(MPI.COMM_SELF)).solve()
    assert tip(every) == pytest.approx(tip(one), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_half_of_a_bar_moves_as_the_whole(kind):
    """Bent by nothing: half of the mass and of the force is at the half, which symmetry cuts."""
    motion = Motion(step=0.01, end=0.1, velocity={"body": (0.2, 0)})
    spring = Spring(between=("tip", "ground"), stiffness={"x": 80.0})
    half = Spring(between=("tip", "ground"), stiffness={"x": 40.0})
    held = (Support("x0", {"x": 0}),)
    whole = bar(kind, motion, (spring,), poisson=0.3, force=(FORCE, 0))
    whole = dataclasses.replace(whole, support=held, point=())
    part = bar(kind, motion, (half,), poisson=0.3, force=(FORCE / 2, 0), mass=MASS / 2)
    part = dataclasses.replace(part, support=held, symmetry=("y0",), point=())
    found = solved(part, box_body((8, 2), (LENGTH, SIDE / 2), cell=mesh.CellType.quadrilateral))
    other = solved(whole, box_body((8, 4), (LENGTH, SIDE), cell=mesh.CellType.quadrilateral))
    (one,), (two,) = found.couplings, other.couplings
    assert one.displacement[0] == pytest.approx(two.displacement[0], rel=1e-9)
    assert 2 * one.force[0] == pytest.approx(two.force[0], rel=1e-8)
    for name in ("kinetic_energy", "strain_energy", "spring_energy"):
        assert 2 * along(found, name) == pytest.approx(along(other, name), rel=1e-8), name


@pytest.mark.parametrize("kind", KINDS)
def test_a_wrong_motion_of_the_point_fails_the_check(kind):
    """A mass that is taken for a tenth more than it is."""
    run = Run(bar(kind, Motion(step=0.01, end=0.1), force=(FORCE, 3.0), poisson=0.3), COMM, body())
    found = run.solve()
    assert found.passed
    points = moving(run.problem.inertia).points
    rows = points.every
    assert len(rows) == 3
    points.masses = 1.1 * points.masses
    forces = MovingForces(run.problem, run.solution)
    off = [abs(row.asked - row.found) for row in forces.scalar_balances()]
    assert max(off) > 1e-2


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"kind": "distributing", "displacement": {"x": 0.1}}, "motion_of_distributing"),
        ({"path": Path((0, 1), (0, 1)), "force": (1.0, 0)}, "motion_without_path_of_coupling"),
    ],
)
def test_scenes_that_cannot_be_are_refused(change, name):
    with refused(name, SceneError):
        bar(motion=Motion(step=0.01, end=0.1), **{"kind": "rigid"} | change)


def test_contacts_apart_from_couplings():
    scene = bar("distributing", Motion(step=0.01, end=0.1), force=(FORCE, 0))
    plane = Obstacle("plane", position=(0, 0), normal=(0, 1))
    scene = dataclasses.replace(scene, contact=(Contact("y0", obstacle=plane),))
    with refused("motion_contact_at_coupling", InputError):
        Run(scene, COMM, body())


def test_velocities_that_holds_oppose():
    motion = Motion(step=0.01, end=0.1, velocity={"body": (0.0, 1.0)})
    with refused("motion_velocity_of_held_coupling", InputError):
        Run(bar("distributing", motion, displacement={"y": 0}), COMM, body())
