"""Springs with a gap, which act once faces have moved so far: bars by formulas, to and fro."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Material,
    Obstacle,
    Path,
    Point,
    Scene,
    SolverSettings,
    Spring,
    Steps,
    Study,
    Support,
    run,
)
from fenics_contact.common.errors import NoEquilibriumError, SceneError
from fenics_contact.verification.boxes import Box, boxes
from tests.messages import refused
from tests.problem.test_coupled_springs import BAR, CLAMPED, LENGTH, SIDE, E, bars, scene

COMM = MPI.COMM_WORLD
STOP, GAP = 70.0, 0.01
BOTH = ["condensed", "full"]


def stop(gap=GAP, **more):
    return Spring(between=("end", "ground"), stiffness={"x": STOP}, gap=gap, **more)


def moved_by(force):
    """Of a bar with a stop at its end: w = (F + k gap)/(E A/L + k) beyond the gap, else F L/E A."""
    free = force / BAR
    return free if free <= GAP else (force + STOP * GAP) / (BAR + STOP)


@pytest.mark.parametrize("solver", BOTH)
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("force", [0.9 * BAR * GAP, 1.1 * BAR * GAP, 5 * BAR * GAP])
def test_a_bar_meets_a_stop(solver, sign, force):
    """Towards either side; the force of the stop is k (w − gap), its energy k (w − gap)²/2."""
    end = Coupling("a.x1", name="end", force=(sign * force, 0))
    found = run(scene(end, spring=(stop(sign * GAP),), solver=solver), COMM, bars())
    assert found.passed, found.verdict
    (row,), moved = found.couplings, moved_by(force)
    pressed = max(moved - GAP, 0.0)
    assert row.displacement == pytest.approx([sign * moved, 0], rel=1e-10, abs=1e-13)
    assert row.force[0] == pytest.approx(sign * (force - STOP * pressed), rel=1e-10)
    assert found.quantities["reaction"][0] == pytest.approx(-sign * BAR * moved, rel=1e-10)
    stored = STOP * pressed**2 / 2
    assert found.quantities["spring_energy"] == pytest.approx(stored, rel=1e-9, abs=1e-15)
    assert found.quantities["strain_energy"] == pytest.approx(BAR * moved**2 / 2, rel=1e-9)


def test_a_stop_does_not_pull():
    end = Coupling("a.x1", name="end", force=(-5 * BAR * GAP, 0))
    found = run(scene(end, spring=(stop(),)), COMM, bars())
    assert found.couplings[0].displacement[0] == pytest.approx(-5 * GAP, rel=1e-10)
    assert found.quantities["spring_energy"] == 0


@pytest.mark.parametrize("solver", [*BOTH, "iterative"])
def test_a_stop_in_space(solver):
    """Beside springs both ways; of a bar of depth 1."""
    spring = (
        Spring(between=("end", "ground"), stiffness={"x": STOP, "y": 3.0}, gap={"x": GAP}),
        Spring(between=("end", "ground"), rotational_stiffness=2.0),
    )
    made = Scene(
        kinematics="3D",
        material=Material(E, 0.0),
        support=(Support("a.x0", {"x": 0.0, "y": 0.0, "z": 0.0}),),
        coupling=(Coupling("a.x1", name="end", force=(5 * BAR * GAP, 0, 0)),),
        spring=spring,
        solver=SolverSettings(solver=solver, errors="none"),
    )
    body = boxes([Box("a", (0.0, 0.0, 0.0), (LENGTH, SIDE, 1.0), (6, 2, 2))], "hexahedron")
    found = run(made, COMM, body)
    assert found.passed, found.verdict
    moved = [moved_by(5 * BAR * GAP), 0, 0]
    assert found.couplings[0].displacement == pytest.approx(moved, rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("solver", BOTH)
def test_it_opens_again(solver):
    """Over load steps to and fro; the work that is done is what is stored at the end."""
    path = Path(time=(0, 1, 2, 3), factor=(0, 1, -0.5, 0.8))
    end = Coupling("a.x1", name="end", force=(5 * BAR * GAP, 0), path=path)
    times = (0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
    asked = scene(end, spring=(stop(),), steps=Steps(times=times), solver=solver)
    found = run(asked, COMM, bars())
    assert found.passed, found.verdict
    for step, time in zip(found.steps, times, strict=True):
        force = 5 * BAR * GAP * path(time)
        reaction = step.quantities["reaction"][0]
        assert reaction == pytest.approx(-BAR * moved_by(force), rel=1e-9, abs=1e-12)
    last = found.quantities
    stored = last["strain_energy"] + last["spring_energy"]
    assert last["external_work"] == pytest.approx(stored, rel=1e-9)
    assert abs(last["energy_defect"]) < 1e-9 * stored


@pytest.mark.parametrize("solver", BOTH)
def test_two_bars_meet(solver):
    """The first moves towards the second by more than the gap: both share what is beyond."""
    spring = Spring(between=("left", "right"), stiffness={"x": STOP}, gap=GAP)
    force = 4 * BAR * GAP
    found = run(
        scene(
            Coupling("a.x1", name="left", force=(force, 0)),
            Coupling("b.x0", name="right"),
            spring=(spring,),
            support=(CLAMPED, Support("b.x1", {"x": 0.0, "y": 0.0})),
            solver=solver,
        ),
        COMM,
        bars(2),
    )
    assert found.passed, found.verdict
    left, right = (row.displacement[0] for row in found.couplings)
    pushed = (force / BAR - GAP) / (1 / STOP + 2 / BAR)
    assert right == pytest.approx(pushed / BAR, rel=1e-10)
    assert left == pytest.approx((force - pushed) / BAR, rel=1e-10)


def test_a_stop_beside_a_rough_contact():
    """A head that is pressed down onto a stop beside a block: what is beyond is shared."""
    contact = Contact(
        "a.y0", obstacle=Obstacle("plane", position=(0, 0)), penalty_parameter=1e-7,
        friction_coefficient=0.3, law="incremental",
    )  # fmt: skip
    head = Coupling("a.y1", name="end", force=(1.0, -40.0), rotation={"z": 0})
    block = E * LENGTH / SIDE / (1 + 1e-7 * E / SIDE)
    gap = -0.5 * 40 / block
    spring = Spring(between=("end", "ground"), stiffness={"y": block}, gap=gap)
    found = run(scene(head, spring=(spring,), support=(), contact=(contact,)), COMM, bars())
    assert found.passed, found.verdict
    assert found.quantities["normal_force"] == pytest.approx(30.0, rel=1e-5)


def test_any_number_of_ranks_has_the_same_answer():
    end = Coupling("a.x1", name="end", force=(5 * BAR * GAP, 0.1))
    made = scene(end, spring=(stop({"x": GAP}),))
    one, found = run(made, MPI.COMM_SELF, bars(comm=MPI.COMM_SELF)), run(made, COMM, bars())
    for name in ("displacement", "rotation", "force"):
        expected = pytest.approx(getattr(one.couplings[0], name), rel=1e-9, abs=1e-12)
        assert getattr(found.couplings[0], name) == expected


@pytest.mark.parametrize("force", [0.9 * BAR * GAP, 5 * BAR * GAP])
def test_derivatives_are_those_of_the_formula(force):
    """Of w beyond the gap: dw/dk = (gap − w)/(E A/L + k), dw/dF = 1/(E A/L + k)."""
    end = Coupling("a.x1", name="end", force=(force, 0))
    made = scene(end, spring=(stop(),), point=(Point("tip", (LENGTH, 0.0)),))
    by = ["spring.0.stiffness.x", "coupling.0.force.0"]
    found = Study(made, body=bars()).derivatives(["displacement_tip_x"], by)["displacement_tip_x"]
    is_met = force > BAR * GAP
    together = BAR + STOP * is_met
    by_stiffness = (GAP - moved_by(force)) / together * is_met
    assert found[by[0]] == pytest.approx(by_stiffness, rel=1e-9, abs=1e-15)
    assert found[by[1]] == pytest.approx(1 / together, rel=1e-9)


@pytest.mark.errors
def test_bars_hold():
    bent = scene(
        Coupling("a.x1", name="end", force=(0, 1)),
        spring=(Spring(between=("end", "ground"), stiffness={"y": 7.0}, gap=GAP),),
    )
    asked = replace(bent, solver=SolverSettings(errors="all"))
    found = run(asked, COMM, bars())
    fine = run(bent, COMM, boxes([Box("a", (0.0, 0.0), (LENGTH, SIDE), (64, 8))], "quadrilateral"))
    error = np.linalg.norm(np.subtract(*(one.couplings[0].displacement for one in (found, fine))))
    assert error < found.couplings[0].errors["displacement"]["total"]
    for name in ("strain_energy", "spring_energy", "external_work"):
        error = abs(found.quantities[name] - fine.quantities[name])
        assert error < found.errors[name]["total"], name


def test_a_stop_alone_holds_nothing():
    end = Coupling("a.x1", name="end", force=(1.0, 0))
    with refused("stop_holds_nothing", NoEquilibriumError):
        run(scene(end, spring=(stop(),), support=(Support("a.x0", {"y": 0.0}),)), COMM, bars())


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (
            lambda: Spring(between=("end", "ground"), rotational_stiffness=1.0, gap=0.1),
            "gap_without_stiffness",
        ),
        (
            lambda: Spring(between=("end", "ground"), stiffness={"x": 1.0}, gap={"y": 0.1}),
            "gap_along_another_axis",
        ),
        (
            lambda: scene(
                Coupling("a.x1", name="end"),
                spring=(Spring(between=("end", "ground"), stiffness=1.0, gap={"z": 0.1}),),
            ),
            "gap_out_of_the_plane",
        ),
    ],
)
def test_what_a_gap_cannot_say_is_refused(make, name):
    with refused(name, SceneError):
        make()
