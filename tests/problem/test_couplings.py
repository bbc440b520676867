"""Faces that move as rigid bodies: bars and beams by formulas, and the same motion given."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Discretisation,
    HalfSpace,
    Load,
    Material,
    Obstacle,
    Path,
    Point,
    Preload,
    Run,
    Scene,
    SolverSettings,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import NoEquilibriumError, SceneError
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.resultant_checks import couplings
from tests.messages import refused
from tests.scenes import box_body
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
QUIET = SolverSettings(errors="none")
E, SIDE, LENGTH = 210e3, 10.0, 100.0
UP = Path(time=(0, 1), factor=(0, 1))
AREA, INERTIA = SIDE**2, SIDE**4 / 12
SOLVERS = ["condensed", "full"]


def bar(solver="condensed", **coupling):
    """A bar along x that stands on x0, and whose end x1 is rigid."""
    scene = Scene(
        kinematics="3D",
        material=Material(E, 0.0),
        support=(Support("x0", {"x": 0, "y": 0, "z": 0}),),
        coupling=(Coupling("x1", name="end", **coupling),),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    found = run(scene, body=box_body((20, 2, 2), (LENGTH, SIDE, SIDE)))
    assert found.exit_code == 0, found.verdict
    return found


@pytest.mark.parametrize("solver", [*SOLVERS, "iterative"])
def test_a_bar_is_pulled_and_bent(solver):
    pulled = bar(solver, force=(1000, 0, 0))
    (end,) = pulled.couplings
    pulls = [1000 * LENGTH / (E * AREA), 0, 0]
    assert end.displacement == pytest.approx(pulls, rel=1e-10, abs=1e-10)
    assert pulled.quantities["reaction"] == pytest.approx([-1000, 0, 0], abs=1e-7)
    assert pulled.quantities["strain_energy"] == pytest.approx(500 * end.displacement[0], rel=1e-10)
    assert pulled.quantities["external_work"] == pytest.approx(1000 * end.displacement[0], rel=1e-9)
    bent = bar(solver, moment=(0, 1e5, 0)).couplings[0]
    near = 1e-9 if solver == "iterative" else 1e-10
    turn, sag = 1e5 * LENGTH / (E * INERTIA), 1e5 * LENGTH**2 / (2 * E * INERTIA)
    assert bent.rotation == pytest.approx([0, turn, 0], rel=near, abs=near * turn)
    assert bent.displacement == pytest.approx([0, 0, -sag], rel=near, abs=near * sag)


def test_a_beam_with_a_force_at_its_tip():
    """P L³/3EI + 6 P L/5 G A, to a tenth of the part by shear: S. P. Timoshenko 1921."""
    by_shear = 1.2 * 1000 * LENGTH / (E / 2 * AREA)
    expected = 1000 * LENGTH**3 / (3 * E * INERTIA) + by_shear
    end = bar(force=(0, -1000, 0)).couplings[0]
    assert -end.displacement[1] == pytest.approx(expected, abs=0.1 * by_shear)


def test_a_force_beside_the_centroid_bends():
    """Given at a point off the face, with the moment that it has about the centroid."""
    off = bar(at=(LENGTH, SIDE / 2, SIDE / 2 + 30), force=(1000, 0, 0)).couplings[0]
    both = bar(force=(1000, 0, 0), moment=(0, 30e3, 0)).couplings[0]
    assert off.rotation == pytest.approx(both.rotation, rel=1e-9, abs=1e-12)
    moved = np.add(both.displacement, np.cross(both.rotation, (0, 0, 30)))
    assert off.displacement == pytest.approx(moved, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
def test_given_motions_need_forces(solver):
    """Of a beam of two clamped ends of which one sinks: 12 EI w/L³ and 6 EI w/L², and shear."""
    free = ("displacement", "rotation")
    given = {kind: dict.fromkeys("xyz", 0.0) for kind in free}
    given["displacement"]["y"] = 0.2
    end = bar(solver, **given).couplings[0]
    softer = 1 + 12 * E * INERTIA / (LENGTH**2 * E / 2 * AREA / 1.2)
    force = 12 * E * INERTIA * 0.2 / LENGTH**3 / softer
    assert end.displacement == pytest.approx([0, 0.2, 0], abs=1e-15)
    assert end.force == pytest.approx([0, force, 0], rel=2e-3, abs=1e-6)
    assert end.moment == pytest.approx([0, 0, -force * LENGTH / 2], rel=2e-3, abs=1e-5)


def test_a_hinge_carries_no_moment():
    """Held across, free to turn: a beam clamped and propped whose support sinks, 3 EI w/L³."""
    shear = 1.2 / (E / 2 * AREA)
    end = bar(displacement={"x": 0, "y": 0.2, "z": 0}).couplings[0]
    force = 0.2 / (LENGTH**3 / (3 * E * INERTIA) + shear * LENGTH)
    assert end.force == pytest.approx([0, force, 0], rel=2e-3, abs=1e-6)
    assert end.moment == pytest.approx([0, 0, 0], abs=1e-6)
    assert end.rotation[2] == pytest.approx(force * LENGTH**2 / (2 * E * INERTIA), rel=2e-3)


FORCE, MOMENT = (2.0, -20.0), 1.5


def punch(solver="condensed", ratio=0.3, **more):
    """A block on a rough plane, whose upper side is rigid."""
    given = {
        "kinematics": "plane strain",
        "material": Material(1000, ratio),
        "coupling": (Coupling("y1", name="punch", force=FORCE, moment=MOMENT),),
        "contact": (
            Contact(
                "y0", obstacle=Obstacle("plane", position=(0, 0)), friction_coefficient=0.4,
                regularisation_parameter=1e-7, penalty_parameter=1e-8,
            ),
        ),
        "solver": SolverSettings(solver=solver, errors="none"),
    }  # fmt: skip
    return Scene(**given | more)


def block(cells=12, comm=COMM):
    return box_body((cells, 2 * cells // 3), (2, 1), comm=comm)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("ratio", [0.3, 0.4999])
def test_forces_and_the_motion_that_they_make_are_one(solver, ratio):
    """Given to a support, that motion needs those forces, with and without contact's help."""
    found = run(punch(solver, ratio), body=block())
    assert found.exit_code == 0, found.verdict
    (moved,) = found.couplings
    x, y = moved.displacement
    turned = {"angle": moved.rotation[0], "at": (1, 1)}
    support = Support("y1", {"x": x, "y": y}, rotation=turned, name="punch")
    given = run(punch(solver, ratio, coupling=(), support=(support,)), body=block())
    (held,) = given.supports
    assert held.reaction == pytest.approx(FORCE, rel=1e-6)
    assert held.reaction_moment == pytest.approx(MOMENT, rel=1e-5)
    for name in ("strain_energy", "normal_force", "max_contact_pressure", "friction_work"):
        expected = pytest.approx(given.quantities[name], rel=1e-5, abs=1e-9)
        assert found.quantities[name] == expected, name


def test_any_number_of_ranks_has_the_same_answer():
    one, all_ranks = (run(punch(), body=block(comm=comm)) for comm in (MPI.COMM_SELF, COMM))
    for name in ("displacement", "rotation", "force", "moment"):
        expected = pytest.approx(one.couplings[0][name], rel=1e-8, abs=1e-12)
        assert all_ranks.couplings[0][name] == expected


@pytest.mark.parametrize("kinematics", ["axisymmetric", "plane stress", "plane strain"])
@pytest.mark.parametrize("solver", SOLVERS)
def test_loads_on_the_face_push_it_too(kinematics, solver):
    """Without lateral contraction: w = (p + F/A) h/E + ρ g h²/2E."""
    axis = {"y": 0} if kinematics == "axisymmetric" else {"x": 0, "y": 0}
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.0),
        thickness=0.5 if kinematics == "plane stress" else None,
        support=(Support("y0", axis),),
        coupling=(Coupling("y1", force=(0, -20)),),
        load=(Load("body", body_force=(0, -3)), Load("y1", pressure=5)),
        solver=SolverSettings(solver=solver, errors="none"),
    )
    area = {"axisymmetric": 4 * np.pi, "plane stress": 1.0, "plane strain": 2.0}[kinematics]
    found = run(scene, body=box_body((6, 4), (2, 1)))
    (top,) = found.couplings
    sinks = (5 + 20 / area) / 1000 + 3 / 2000
    assert top.displacement == pytest.approx([0, -sinks], rel=1e-10, abs=1e-14)
    assert top.force == pytest.approx([0, -20], rel=1e-9, abs=1e-10)
    expected = 20 + area * 8
    assert found.quantities["reaction"][1] == pytest.approx(expected, rel=1e-10)


def test_half_of_a_punch_is_half_of_it():
    """A face that reaches the plane of symmetry is one with its mirror image: it does not turn."""
    whole = run(punch(coupling=(Coupling("y1", name="punch", force=(0, -20)),)), body=block())
    coupling = (Coupling("y1", name="punch", force=(0, -10)),)
    half = run(punch(coupling=coupling, symmetry=("x0",)), body=box_body((6, 8), (1, 1)))
    assert half.couplings[0].rotation == [0]
    sinks = whole.couplings[0].displacement[1]
    assert half.couplings[0].displacement == pytest.approx([0, sinks], rel=1e-6)
    assert half.couplings[0].force[1] == pytest.approx(-10, rel=1e-9)


@pytest.mark.parametrize("kind", ["rigid", "distributing"])
def test_a_quarter_of_a_punch_is_a_quarter_of_it(kind):
    """Its face reaches two planes of symmetry: it moves along their edge, without turning."""

    def pressed(cells, sides, symmetry=(), **coupling):
        scene = Scene(
            kinematics="3D",
            material=Material(1000, 0.3),
            symmetry=symmetry,
            contact=(Contact("z0", friction_coefficient=0.2, obstacle=Obstacle("plane")),),
            coupling=(Coupling("z1", kind=kind, **coupling),),
            discretisation=Discretisation(1),
            solver=QUIET,
        )
        found = run(scene, body=box_body(cells, sides))
        assert found.exit_code == 0, found.verdict
        return found

    held = {"displacement": {"x": 0, "y": 0}, "rotation": dict.fromkeys("xyz", 0)}
    whole = pressed((6, 4, 2), (2, 2, 1), force=(0, 0, -40), **held)
    quarter = pressed((3, 2, 2), (1, 1, 1), ("x1", "y1"), force=(0, 0, -10))
    (one,), (other,) = whole.couplings, quarter.couplings
    assert not np.any(other.rotation)
    assert other.displacement == pytest.approx(one.displacement, rel=1e-6, abs=1e-12)
    for name in ("normal_force", "friction_work", "strain_energy"):
        assert 4 * quarter.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-6), name


def test_a_bolt_that_ends_at_the_face():
    """Its shortening and the motion are scalars of one energy: F = E A (w + q)/L at given w."""
    ends = {"x0": {"x": 0, "y": 0}}
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.0),
        support=tuple(Support(on, held) for on, held in ends.items()),
        coupling=(
            Coupling("x1", displacement={"x": 0.001, "y": 0}, rotation={"z": 0}, name="end"),
        ),
        preload=(Preload("body", axis=(1, 0), force=3.0),),
        solver=QUIET,
    )
    for solver in SOLVERS:
        found = run(
            replace(scene, solver=SolverSettings(solver=solver, errors="none")),
            body=box_body((4, 2), (2, 0.5)),
        )
        assert found.exit_code == 0, found.verdict
        stiffness = 1000 * 0.5 / 2
        assert found.preloads["body"].elongation == pytest.approx(3 / stiffness - 0.001, rel=1e-9)
        assert found.couplings[0].force == pytest.approx([3, 0], rel=1e-9, abs=1e-10)
        loose = replace(scene.coupling[0], displacement={"y": 0})
        free = run(replace(scene, coupling=(loose,), preload=()), body=box_body((4, 2), (2, 0.5)))
        assert free.couplings[0].displacement == pytest.approx([0, 0], abs=1e-14)


@pytest.mark.errors
def test_the_traction_on_a_rigid_face_is_no_error():
    """Bars of a bar that is pulled are about as large as what a finer mesh changes."""
    scene = Scene(
        kinematics="plane stress",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0}),),
        symmetry=("y0",),
        discretisation=Discretisation(1),
        coupling=(Coupling("x1", force=(3.0, 0.0)),),
        solver=SolverSettings(errors="all"),
    )
    coarse = run(scene, body=box_body((4, 2), (2, 0.5))).couplings[0]
    fine = run(replace(scene, solver=QUIET), body=box_body((32, 16), (2, 0.5))).couplings[0]
    apart = abs(coarse.displacement[0] - fine.displacement[0])
    assert apart < coarse.errors["displacement"]["total"] < 5 * apart


@pytest.mark.errors
def test_bars_hold():
    scene = punch(point=(Point("inside", (1.3, 0.5)),))
    coarse = run(replace(scene, solver=SolverSettings(errors="all")), body=block(8))
    fine = run(replace(scene, solver=QUIET), body=block(32))
    for name in ("displacement", "rotation"):
        error = np.linalg.norm(np.subtract(coarse.couplings[0][name], fine.couplings[0][name]))
        bar = coarse.couplings[0].errors[name]["total"]
        size = np.linalg.norm(fine.couplings[0][name])
        assert error <= bar <= 0.05 * size, (name, error, bar)
    for name in ("strain_energy", "external_work", "displacement_inside"):
        error = np.linalg.norm(np.subtract(coarse.quantities[name], fine.quantities[name]))
        assert error <= coarse.errors[name]["total"], name
    # Equilibrium alone decides what is given and what it presses with.
    assert coarse.couplings[0].errors["force"]["total"] < 1e-9
    assert coarse.couplings[0].errors["moment"]["total"] < 1e-9
    assert coarse.errors["normal_force"]["total"] < 1e-9


@pytest.mark.parametrize(
    ("key", "step"),
    [
        ("coupling.0.force.1", 1e-3),
        ("coupling.0.force.0", 1e-3),
        ("coupling.0.moment", 1e-3),
        ("load.0.pressure", 1e-2),
        ("material.youngs_modulus", 1.0),
    ],
)
def test_derivatives_are_those_of_differences(key, step):
    scene = punch(
        coupling=(Coupling("y1", name="punch", force=FORCE, moment=MOMENT),),
        load=(Load("y1", pressure=0.5),),
        point=(Point("inside", (1.3, 0.97)),),
    )
    of = ["strain_energy", "displacement_inside_y", "normal_force", "punch.reaction_y"]
    study = Study(scene, body=block(6))
    slopes = study.derivatives(of, [key])
    value = {
        "coupling.0.force.1": FORCE[1], "coupling.0.force.0": FORCE[0], "coupling.0.moment": MOMENT,
        "load.0.pressure": 0.5, "material.youngs_modulus": 1000.0,
    }[key]  # fmt: skip
    below, above = (study.solve({key: value + sign * step}) for sign in (-1, 1))
    for name in of:
        one, other = (_value(answer, name) for answer in (below, above))
        expected = (other - one) / (2 * step)
        assert slopes[name][key] == pytest.approx(expected, rel=2e-4, abs=2e-7), name


def _value(answer, name):
    if name.startswith("punch."):
        return answer.supports[0].reaction[1]
    if name.startswith("displacement_inside"):
        return answer.quantities["displacement_inside"][1]
    return answer.quantities[name]


def test_load_steps_follow_the_path():
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.5))
    coupling = Coupling("y1", name="punch", force=(0, -20), path=path)
    found = run(punch(coupling=(coupling,), steps=Steps(2, end=2)), body=block(6))
    assert found.exit_code == 0, found.verdict
    forces = [step.quantities["normal_force"] for step in found.steps]
    assert forces == pytest.approx([20, 10], rel=1e-9)
    half = run(punch(coupling=(replace(coupling, force=(0, -10), path=UP),)), body=block(6))
    assert found.couplings[0].displacement == pytest.approx(
        half.couplings[0].displacement, rel=1e-6
    )


def test_a_wrong_answer_fails_its_check():
    solved = Run(punch(), COMM, block(6))
    assert solved.solve().checks["coupling"].passed
    moved = 1.01 * solved.solution.displacement
    wrong = with_body(solved.solution, displacement=moved)
    assert not couplings(BulkForces(solved.problem, wrong)).passed


@pytest.mark.parametrize(
    ("coupling", "name"),
    [
        (Coupling("y1", force=(0, 20)), "coupling_is_pulled_off"),
        (Coupling("y1", force=(10, -20)), "coupling_is_pushed_along"),
    ],
)
def test_what_nothing_holds_is_refused_before_it_is_solved(coupling, name):
    with refused(name, NoEquilibriumError):
        run(punch(coupling=(coupling,)), body=block(6))


def test_a_beam_on_a_hinge_alone_turns_over():
    scene = punch(contact=(), coupling=(Coupling("x0", displacement={"x": 0, "y": 0}),))
    with refused("coupling_leaves_a_hinge", NoEquilibriumError):
        run(replace(scene, load=(Load("x1", traction=(0, 1)),)), body=block(6))
    given = replace(scene.coupling[0], rotation={"z": 0})
    held = run(
        replace(scene, coupling=(given,), load=(Load("x1", traction=(0, 1)),)), body=block(6)
    )
    assert held.couplings[0].force == pytest.approx([0, -1], abs=1e-10)
    assert held.couplings[0].moment == pytest.approx([-2], rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"coupling": (Coupling("y0"),)}, "coupling_at_a_contact"),
        ({"support": (Support("x0", {"x": 0}),)}, "coupling_at_a_support"),
        ({"coupling": (Coupling("y1"), Coupling("x1"))}, "couplings_at_each_other"),
        ({"coupling": (Coupling("body"),)}, "coupling_of_a_body"),
        (
            {"coupling": (Coupling("y1", displacement={"x": 0.1}),), "symmetry": ("x0",)},
            "coupling_across_symmetry",
        ),
    ],
)
def test_faces_that_something_else_holds_are_refused(changes, name):
    with refused(name):
        run(punch(**changes), body=block(6))


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Coupling("y1", force=(0, 1), displacement={"y": 0}), "coupling_given_twice"),
        (lambda: punch(coupling=(Coupling("y1", moment=(0, 0, 1)),)), "coupling_moment_in_plane"),
        (
            lambda: punch(coupling=(Coupling("y1", rotation={"x": 1}),)),
            "coupling_rotation_in_plane",
        ),
        (lambda: punch(coupling=(Coupling("y1", force=(0, 0, 1)),)), "coupling_force_in_plane"),
        (
            lambda: punch(
                coupling=(Coupling("y1", name="x0"),), support=(Support("x0", {"x": 0}),)
            ),
            "coupling_named_as_a_support",
        ),
        (lambda: punch(half_space=HalfSpace(on=("x0",))), "coupling_of_a_half_space"),
    ],
)
def test_what_a_coupling_cannot_say_is_refused(make, name):
    with refused(name, SceneError):
        make()
