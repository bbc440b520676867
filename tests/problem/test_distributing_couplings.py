"""Points that follow the mean motion of a face: against tractions written out, and by formulas."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Load,
    Material,
    Modes,
    Obstacle,
    Path,
    Point,
    Run,
    Scene,
    SolverSettings,
    Spring,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import InputError, NoEquilibriumError
from fenics_contact.evaluate.nodal_forces import BulkForces
from fenics_contact.trust.resultant_checks import couplings
from tests.messages import refused
from tests.scenes import box_body
from tests.wrong_answers import with_body

COMM = MPI.COMM_WORLD
E, SIDE, LENGTH = 210e3, 10.0, 40.0
SIZES, AT = (LENGTH, SIDE, SIDE), (LENGTH + 8, SIDE / 2 - 2, SIDE / 2 + 15)
CLAMPED = Support("x0", {"x": 0, "y": 0, "z": 0})
CORNERS = tuple(
    Point(f"p{number}", (LENGTH, y, z))
    for number, (y, z) in enumerate([(0, 0), (SIDE, 0), (SIDE / 2, SIDE)])
)
SOLVERS = ["condensed", "full"]


def block(comm=COMM):
    return box_body((6, 2, 2), SIZES, comm=comm)


def bar(solver="full", comm=COMM, **more):
    """A bar along x that stands on x0; in space, with lateral contraction."""
    given = {
        "kinematics": "3D",
        "material": Material(E, 0.3),
        "support": (CLAMPED,),
        "point": CORNERS,
        "solver": SolverSettings(solver=solver, errors="none"),
    }
    found = run(Scene(**given | more), body=block(comm), comm=comm)
    assert found.passed, found.verdict
    return found


def coupled(solver="full", spring=(), comm=COMM, **coupling):
    end = Coupling("x1", kind="distributing", name="end", at=AT, **coupling)
    return bar(solver, comm, coupling=(end,), spring=spring)


def corners(found):
    return np.array([found.quantities[f"displacement_{point.name}"] for point in CORNERS])


def pushed(force, moment):
    """The bar with the traction a + b × (x − c) of a force and a moment at AT, written out."""
    arm = np.subtract(AT, (LENGTH, SIDE / 2, SIDE / 2))
    about = np.array(moment) + np.cross(arm, force)
    b = about / np.array([SIDE**4 / 6, SIDE**4 / 12, SIDE**4 / 12])
    a = np.array(force) / SIDE**2
    y, z = (lambda x: x[1] - SIDE / 2), (lambda x: x[2] - SIDE / 2)
    traction = (
        lambda x: a[0] + b[1] * z(x) - b[2] * y(x),
        lambda x: a[1] - b[0] * z(x),
        lambda x: a[2] + b[0] * y(x),
    )
    return bar(load=(Load("x1", traction=traction),))


FORCE, MOMENT = (1000.0, 50.0, -200.0), (1e3, 2e3, -3e3)
STIFFNESS, TURNING = 7e3, 2e6
TO_GROUND = Spring(between=("end", "ground"), stiffness=STIFFNESS, rotational_stiffness=TURNING)


@pytest.mark.parametrize("solver", SOLVERS)
def test_displacements_are_those_of_the_linear_traction(solver):
    """Free, and with its point on a spring, whose force is −k u."""
    expected = corners(pushed(FORCE, MOMENT))
    close = 1e-10 * np.abs(expected).max()
    found = coupled(solver, force=FORCE, moment=MOMENT)
    assert corners(found) == pytest.approx(expected, abs=close)
    sprung = coupled(solver, spring=(TO_GROUND,), force=FORCE, moment=MOMENT)
    (end,) = sprung.couplings
    force = np.subtract(FORCE, STIFFNESS * np.array(end.displacement))
    moment = np.subtract(MOMENT, TURNING * np.array(end.rotation))
    assert np.linalg.norm(force) < 0.9 * np.linalg.norm(FORCE)
    assert end.force == pytest.approx(force, rel=1e-9)
    assert end.moment == pytest.approx(moment, rel=1e-9)
    expected = corners(pushed(force, moment))
    assert corners(sprung) == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())
    assert sprung.quantities["reaction"] == pytest.approx(-force, abs=1e-7)
    stored = sprung.quantities["strain_energy"] + sprung.quantities["spring_energy"]
    assert sprung.quantities["external_work"] == pytest.approx(2 * stored, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_given_motions_and_the_forces_that_they_need_are_one(solver):
    given = {"displacement": {"x": 0.02, "y": -0.01, "z": 0}, "rotation": {"x": 1e-3, "z": 0}}
    held = coupled(solver, **given)
    (end,) = held.couplings
    assert end.displacement == pytest.approx([0.02, -0.01, 0], abs=1e-13)
    assert [end.rotation[0], end.rotation[2]] == pytest.approx([1e-3, 0], abs=1e-15)
    assert end.moment[1] == pytest.approx(0, abs=1e-6)
    loaded = coupled(solver, force=tuple(end.force), moment=tuple(end.moment))
    assert corners(loaded) == pytest.approx(corners(held), abs=1e-10)
    (moved,) = loaded.couplings
    assert moved.displacement == pytest.approx(end.displacement, abs=1e-11)
    assert moved.rotation == pytest.approx(end.rotation, abs=1e-13)
    assert held.quantities["external_work"] == pytest.approx(
        2 * held.quantities["strain_energy"], rel=1e-9
    )


def test_the_point_has_the_mean_motion_of_the_face():
    """Of a face that is turned and moved as a whole by the body's rigid motion."""
    turn, move, foot = (2e-3, -1e-3, 3e-3), np.array([0.1, 0.2, -0.3]), np.zeros(3)
    base = Coupling(
        "x0", name="base", at=tuple(foot), displacement=dict(zip("xyz", move, strict=True)),
        rotation=dict(zip("xyz", turn, strict=True)),
    )  # fmt: skip
    end = Coupling("x1", kind="distributing", name="end", at=AT)
    found = bar(support=(), coupling=(base, end)).couplings[1]
    assert found.rotation == pytest.approx(turn, rel=1e-9)
    assert found.displacement == pytest.approx(move + np.cross(turn, AT), rel=1e-9)
    assert found.force == pytest.approx(np.zeros(3), abs=1e-6)


def test_springs_at_its_point_hold_a_bar():
    """In all six ways; the tip, which is pushed, moves by F/k and turns by F L/k."""
    foot = Coupling("x0", kind="distributing", name="foot", at=(0, SIDE / 2, SIDE / 2))
    spring = replace(TO_GROUND, between=("foot", "ground"))
    tip = Coupling("x1", kind="distributing", name="tip", force=(0, 300.0, 0))
    found = bar("auto", support=(), coupling=(foot, tip), spring=(spring,))
    (end, _) = found.couplings
    assert end.displacement == pytest.approx([0, 300 / STIFFNESS, 0], rel=1e-8, abs=1e-10)
    assert end.rotation == pytest.approx([0, 0, 300 * LENGTH / TURNING], rel=1e-8, abs=1e-10)
    wide = replace(spring, rotational_stiffness={"x": 1.0, "y": 1.0})
    with refused("coupling_leaves_a_hinge", NoEquilibriumError):
        bar("auto", support=(), coupling=(foot, tip), spring=(wide,))
    with refused("mean_point_without_full", InputError):
        bar("condensed", support=(), coupling=(foot, tip), spring=(spring,))
    held = replace(foot, displacement=dict.fromkeys("xyz", 0), rotation=dict.fromkeys("xyz", 0))
    held_bar = bar("auto", support=(), coupling=(held, tip))
    assert held_bar.couplings[0].force == pytest.approx([0, -300, 0], abs=1e-6)
    assert held_bar.couplings[0].moment == pytest.approx([0, 0, -300 * LENGTH], abs=1e-4)


def test_a_point_holds_what_rollers_leave():
    """A bar on rollers, which its other end's point keeps from moving across and from turning."""
    given = {"displacement": {"y": 0, "z": 0.1}, "rotation": dict.fromkeys("xyz", 0)}
    end = Coupling("x1", kind="distributing", name="end", force=(500.0, 0, 0), **given)
    rollers = Support("x0", {"x": 0})
    found = bar("auto", support=(rollers,), material=Material(E, 0.0), coupling=(end,))
    stretched = 500 * LENGTH / (E * SIDE**2)
    assert found.couplings[0].displacement == pytest.approx([stretched, 0, 0.1], abs=1e-9)
    assert found.couplings[0].force == pytest.approx([500, 0, 0], abs=1e-5)
    with refused("mean_point_without_full", InputError):
        bar("condensed", support=(rollers,), coupling=(end,))


def test_two_springs_in_series():
    """From its point to a rigid face, and from there to the ground: one that joins the ground."""
    one, other = 5e3, 3e3
    between = Spring(between=("end", "punch"), stiffness={"x": one})
    ground = Spring(between=("punch", "ground"), stiffness={"x": other})
    block_of_its_own = Coupling(
        "x0", name="punch", displacement={"y": 0, "z": 0}, rotation=dict.fromkeys("xyz", 0)
    )
    held = {"displacement": {"y": 0, "z": 0}, "rotation": dict.fromkeys("xyz", 0)}
    end = Coupling("x1", kind="distributing", name="end", force=(100.0, 0, 0), **held)
    found = bar(support=(), material=Material(E, 0.0), coupling=(block_of_its_own, end),
                spring=(between, ground))  # fmt: skip
    punch, moved = found.couplings
    stretch = E * SIDE**2 / LENGTH + one  # the bar is beside the spring between its ends
    assert punch.displacement[0] == pytest.approx(100 / other, rel=1e-9)
    assert moved.displacement[0] == pytest.approx(100 * (1 / other + 1 / stretch), rel=1e-9)


def test_any_number_of_ranks_has_the_same_answer():
    given = {"spring": (TO_GROUND,), "force": (1000.0, 50.0, 0), "displacement": {"z": 0.01}}
    one, found = (coupled(comm=comm, **given) for comm in (MPI.COMM_SELF, COMM))
    for name in ("displacement", "rotation", "force", "moment"):
        expected = pytest.approx(one.couplings[0][name], rel=1e-8, abs=1e-12)
        assert found.couplings[0][name] == expected


PRESSED = (1.5, -20.0)


def punch(solver="condensed", ratio=0.3, **more):
    """A block on a rough plane, pressed at a point that its upper side follows in the mean."""
    given = {
        "kinematics": "plane strain",
        "material": Material(1000, ratio),
        "coupling": (Coupling("y1", kind="distributing", name="punch", force=PRESSED, moment=1.0),),
        "contact": (
            Contact(
                "y0", obstacle=Obstacle("plane", position=(0, 0)), friction_coefficient=0.4,
                regularisation_parameter=1e-7, penalty_parameter=1e-8,
            ),
        ),
        "solver": SolverSettings(solver=solver, errors="none"),
    }  # fmt: skip
    return Scene(**given | more)


def plate(cells=8, comm=COMM):
    return box_body((cells, 2 * cells // 3), (2, 1), comm=comm)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("ratio", [0.3, 0.4999])
def test_beside_contact_it_is_the_load_that_it_stands_for(solver, ratio):
    found = run(punch(solver, ratio), body=plate())
    assert found.passed, found.verdict
    load = Load("y1", force=PRESSED, moment=1.0)
    given = run(punch(solver, ratio, coupling=(), load=(load,)), body=plate())
    for name in ("strain_energy", "normal_force", "max_contact_pressure", "friction_work"):
        expected = pytest.approx(given.quantities[name], rel=1e-6, abs=1e-10)
        assert found.quantities[name] == expected, name
    motion = found.couplings[0]
    x, y = motion.displacement
    moved = Coupling(
        "y1", kind="distributing", name="punch", displacement={"x": x, "y": y},
        rotation={"z": motion.rotation[0]},
    )  # fmt: skip
    again = run(punch(solver, ratio, coupling=(moved,)), body=plate())
    assert again.passed, again.verdict
    assert again.couplings[0].force == pytest.approx(PRESSED, rel=1e-5)
    assert again.couplings[0].moment == pytest.approx([1.0], rel=1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
def test_energies_balance_along_load_steps(solver):
    """Pushed over a spring to and fro, with friction that follows the path."""
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.4))
    made = punch(
        solver,
        coupling=(replace(punch().coupling[0], path=path),),
        spring=(Spring(between=("punch", "ground"), stiffness={"x": 50.0}),),
        contact=(replace(punch().contact[0], law="incremental"),),
        steps=Steps(times=(0.5, 1.0, 1.5, 2.0)),
    )
    found = run(made, body=plate())
    assert found.passed, found.verdict
    forces = [step.quantities["normal_force"] for step in found.steps]
    assert forces == pytest.approx([10, 20, 14, 8], rel=1e-9)
    work = found.quantities["external_work"]
    assert abs(found.quantities["energy_defect"]) < 2e-3 * work


def test_a_stop_acts_at_its_point():
    """A bar is pulled to a stop, and over it: F = E A u/L + k (u − gap)."""
    stop = Spring(between=("end", "ground"), stiffness={"x": 4e3}, gap=0.002)
    end = Coupling("x1", kind="distributing", name="end", force=(2000.0, 0, 0))
    found = bar(material=Material(E, 0.0), coupling=(end,), spring=(stop,))
    stiff = E * SIDE**2 / LENGTH
    expected = (2000 + 4e3 * 0.002) / (stiff + 4e3)
    assert found.couplings[0].displacement[0] == pytest.approx(expected, rel=1e-9)


def test_half_of_a_face_is_half_of_it():
    """Its mirror image takes moments and forces across the plane away."""
    load = {"force": (0, -20.0)}
    whole = run(punch(coupling=(Coupling("y1", kind="distributing", **load),)), body=plate(12))
    coupling = (Coupling("y1", kind="distributing", force=(0, -10.0)),)
    half = run(punch(coupling=coupling, symmetry=("x0",)), body=box_body((6, 8), (1, 1)))
    assert half.couplings[0].rotation == [0]
    sinks = whole.couplings[0].displacement[1]
    assert half.couplings[0].displacement == pytest.approx([0, sinks], rel=1e-6)
    assert half.couplings[0].force[1] == pytest.approx(-10, rel=1e-9)


@pytest.mark.parametrize("kinematics", ["axisymmetric", "plane stress"])
def test_in_plane_models_and_around_an_axis(kinematics):
    """Without lateral contraction: w = F h/(E A), of a column beside a spring."""
    axis = {"y": 0} if kinematics == "axisymmetric" else {"x": 0, "y": 0}
    spring = Spring(between=("y1", "ground"), stiffness={"y": 300.0})
    scene = Scene(
        kinematics=kinematics,
        material=Material(1000, 0.0),
        thickness=0.5 if kinematics == "plane stress" else None,
        support=(Support("y0", axis),),
        coupling=(Coupling("y1", kind="distributing", force=(0, -20)),),
        spring=(spring,),
        solver=SolverSettings(errors="none"),
    )
    area = 4 * np.pi if kinematics == "axisymmetric" else 1.0
    found = run(scene, body=box_body((6, 4), (2, 1)))
    assert found.passed, found.verdict
    sinks = 20 / (1000 * area + 300)
    assert found.couplings[0].displacement == pytest.approx([0, -sinks], rel=1e-10, abs=1e-13)


@pytest.mark.parametrize(
    ("key", "step"),
    [
        ("coupling.0.force.1", 1e-3),
        ("spring.0.stiffness.x", 1e-3),
        ("material.youngs_modulus", 1.0),
    ],
)
def test_derivatives_are_those_of_differences(key, step):
    spring = Spring(between=("punch", "ground"), stiffness={"x": 50.0}, rotational_stiffness=9.0)
    scene = punch(spring=(spring,), point=(Point("inside", (1.3, 0.97)),))
    of = ["strain_energy", "displacement_inside_y", "punch.reaction_x", "punch.reaction_moment"]
    study = Study(scene, body=plate(6))
    slopes = study.derivatives(of, [key])
    value = {
        "coupling.0.force.1": PRESSED[1], "spring.0.stiffness.x": 50.0,
        "material.youngs_modulus": 1000.0,
    }[key]  # fmt: skip
    below, above = (study.solve({key: value + sign * step}) for sign in (-1, 1))
    for name in of:
        one, other = (_value(answer, name) for answer in (below, above))
        expected = (other - one) / (2 * step)
        assert slopes[name][key] == pytest.approx(expected, rel=2e-4, abs=2e-7), name


def _value(answer, name):
    if name == "punch.reaction_x":
        return answer.supports[0].reaction[0]
    if name == "punch.reaction_moment":
        return answer.supports[0].reaction_moment
    if name.startswith("displacement_inside"):
        return answer.quantities["displacement_inside"][1]
    return answer.quantities[name]


@pytest.mark.errors
def test_bars_hold():
    scene = punch(spring=(Spring(between=("punch", "ground"), stiffness={"x": 50.0}),))
    coarse = run(replace(scene, solver=SolverSettings(errors="all")), body=plate(8))
    fine = run(scene, body=plate(32))
    for name in ("displacement", "rotation"):
        error = np.linalg.norm(np.subtract(coarse.couplings[0][name], fine.couplings[0][name]))
        bar = coarse.couplings[0].errors[name]["total"]
        size = np.linalg.norm(fine.couplings[0][name])
        assert error <= bar <= 0.1 * size, (name, error, bar)
    for name in ("strain_energy", "external_work"):
        error = abs(coarse.quantities[name] - fine.quantities[name])
        assert error <= coarse.errors[name]["total"], name


def test_a_wrong_answer_fails_its_check():
    solved = Run(punch(), COMM, plate())
    assert solved.solve().checks["coupling"].passed
    wrong = with_body(solved.solution, displacement=1.01 * solved.solution.displacement)
    assert not couplings(BulkForces(solved.problem, wrong)).passed


def test_a_face_as_thin_as_a_line_is_refused():
    end = Coupling("x1", kind="distributing", force=(100.0, 0, 0))
    scene = Scene(kinematics="3D", material=Material(E, 0.3), support=(CLAMPED,), coupling=(end,))
    with refused("mean_point_of_a_line"):
        run(scene, body=box_body((2, 1, 4), (1.0, 1e-6, 1.0)))


def test_iterative_is_refused():
    with refused("mean_point_with_multigrid"):
        coupled("iterative", force=FORCE)


def test_a_rigid_face_shares_no_point_with_it():
    both = (Coupling("y1", kind="distributing"), Coupling("x1"))
    with refused("rigid_and_mean_share_points"):
        run(punch(coupling=both, contact=()), body=plate(6))


def test_a_mass_at_a_plane_of_symmetry():
    """Modes of a half are those of the whole that are symmetric: its mass moves along the plane."""
    found = []
    for half in (False, True):
        mass = 2.0 * (0.5 if half else 1.0)
        scene = Scene(
            kinematics="plane strain",
            material=Material(1000, 0.3, density=0.5),
            support=(Support("y0", {"x": 0, "y": 0}),),
            symmetry=("x0",) if half else (),
            coupling=(Coupling("y1", kind="distributing", at=(1.0, 3.0), mass=mass),),
            modes=Modes(3 if half else 9),
            solver=SolverSettings(errors="none"),
        )
        body = box_body((3 if half else 6, 6), (1 if half else 2, 3))
        body.mesh.geometry.x[:, 0] += 1.0 if half else 0.0
        modes = run(scene, body=body).modes
        found.append([mode.natural_frequency for mode in modes])
    for frequency in found[1]:
        assert min(abs(frequency / other - 1) for other in found[0]) < 1e-9
