"""Springs between coupled faces and the ground: bars and springs in series and side by side."""

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

COMM = MPI.COMM_WORLD
E, LENGTH, SIDE, FORCE = 1000.0, 4.0, 0.5, 3.0
BAR, BENDING = E * SIDE / LENGTH, E * SIDE**3 / 12
SOLVERS = ["condensed", "full"]
CLAMPED = Support("a.x0", {"x": 0.0, "y": 0.0})


def bars(count=1, comm=COMM):
    """Bars along x, one after the other with room between, named a, b, ….

    In the plane, without lateral contraction.
    """
    places = [(name, 1.5 * LENGTH * number) for number, name in enumerate("abc"[:count])]
    parts = [Box(name, (x, 0.0), (x + LENGTH, SIDE), (8, 2)) for name, x in places]
    return boxes(parts, "quadrilateral", comm)


def scene(*couplings, spring=(), support=(CLAMPED,), solver="condensed", **more):
    return Scene(
        kinematics="plane strain",
        material=Material(E, 0.0),
        support=support,
        coupling=couplings,
        spring=spring,
        solver=SolverSettings(solver=solver, errors="none"),
        **more,
    )


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_bar_beside_a_spring(solver):
    """Both resist the force at the end: w = F/(E A/L + k)."""
    stiffness = 70.0
    found = run(
        scene(
            Coupling("a.x1", name="end", force=(FORCE, 0)),
            spring=(Spring(between=("end", "ground"), stiffness={"x": stiffness}),),
            solver=solver,
        ),
        COMM,
        bars(),
    )
    assert found.passed, found.verdict
    (end,), moved = found.couplings, FORCE / (BAR + stiffness)
    assert end.displacement == pytest.approx([moved, 0], rel=1e-10, abs=1e-13)
    assert end.force[0] == pytest.approx(FORCE - stiffness * moved, rel=1e-10)
    assert found.quantities["reaction"][0] == pytest.approx(-BAR * moved, rel=1e-10)
    assert found.quantities["strain_energy"] == pytest.approx(BAR * moved**2 / 2, rel=1e-9)
    assert found.quantities["spring_energy"] == pytest.approx(stiffness * moved**2 / 2, rel=1e-9)
    assert found.quantities["external_work"] == pytest.approx(FORCE * moved, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_moment_beside_a_spring_that_turns(solver):
    """θ = M/(E I/L + k)."""
    stiffness, moment = 20.0, 0.3
    spring = Spring(between=("end", "ground"), rotational_stiffness=stiffness)
    found = run(
        scene(Coupling("a.x1", name="end", moment=moment), spring=(spring,), solver=solver),
        COMM,
        bars(),
    )
    turned = moment / (BENDING / LENGTH + stiffness)
    assert found.couplings[0].rotation[0] == pytest.approx(turned, rel=1e-9)
    assert found.couplings[0].moment[0] == pytest.approx(moment - stiffness * turned, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_two_bars_with_a_spring_between(solver):
    """The second bar and the spring are in series, and beside the first."""
    stiffness = 70.0
    found = run(
        scene(
            Coupling("a.x1", name="left", force=(FORCE, 0)),
            Coupling("b.x0", name="right"),
            spring=(Spring(between=("left", "right"), stiffness=stiffness),),
            support=(CLAMPED, Support("b.x1", {"x": 0.0, "y": 0.0}, name="wall")),
            solver=solver,
        ),
        COMM,
        bars(2),
    )
    assert found.passed, found.verdict
    series = 1 / (1 / stiffness + 1 / BAR)
    left, right = found.couplings
    assert left.displacement[0] == pytest.approx(FORCE / (BAR + series), rel=1e-10)
    assert right.displacement[0] == pytest.approx(series / BAR * left.displacement[0], rel=1e-9)
    assert right.force[0] == pytest.approx(series * left.displacement[0], rel=1e-9)
    wall = next(row for row in found.supports if row.name == "wall")
    assert wall.reaction[0] == pytest.approx(-series * left.displacement[0], rel=1e-9)


def test_springs_alone_hold_a_bar():
    """A force at its free end, by a coupling, bends the springs at the other one: F/k and F L/k."""
    stiffness, turning = 70.0, 500.0
    spring = Spring(between=("foot", "ground"), stiffness=stiffness, rotational_stiffness=turning)
    found = run(
        scene(
            Coupling("a.x0", name="foot"),
            Coupling("a.x1", name="tip", force=(0, FORCE)),
            spring=(spring,),
            support=(),
        ),
        COMM,
        bars(),
    )
    assert found.passed, found.verdict
    foot, _ = found.couplings
    assert foot.displacement == pytest.approx([0, FORCE / stiffness], rel=1e-9, abs=1e-11)
    assert foot.rotation[0] == pytest.approx(FORCE * LENGTH / turning, rel=1e-9)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_spring_presses_a_block_on_a_plane(solver):
    """By its foot, a second coupling, that is moved: all in series, over load steps to and fro."""
    stiffness, pressed = 40.0, 0.1
    path = Path(time=(0, 1, 2), factor=(0, 1, 0.4))
    foot = Coupling(
        "b.y1", name="foot", displacement={"x": 0, "y": -pressed}, rotation={"z": 0}, path=path
    )
    contact = Contact(
        "a.y0", obstacle=Obstacle("plane", position=(0, 0)), penalty_parameter=1e-7,
        friction_coefficient=0.3, law="incremental",
    )  # fmt: skip
    found = run(
        scene(
            Coupling("a.y1", name="head", rotation={"z": 0}),
            foot,
            spring=(Spring(between=("head", "foot"), stiffness=stiffness),),
            support=(Support("b.y0", {"x": 0, "y": 0}),),
            contact=(contact,),
            steps=Steps(times=(1.0, 2.0)),
            solver=solver,
        ),
        COMM,
        bars(2),
    )
    assert found.passed, found.verdict
    series = 1 / (1 / stiffness + SIDE / (E * LENGTH) + 1e-7 / LENGTH)
    for step, factor in zip(found.steps, (1, 0.4), strict=True):
        force = factor * pressed * series
        assert step.quantities["normal_force"] == pytest.approx(force, rel=1e-5)
    work = found.quantities["external_work"]
    assert abs(found.quantities["energy_defect"]) < 1e-6 * work


def test_any_number_of_ranks_has_the_same_answer():
    spring = Spring(between=("end", "ground"), stiffness=7.0, rotational_stiffness=9.0)
    made = scene(Coupling("a.x1", name="end", force=(FORCE, 1)), spring=(spring,))
    alone = boxes([Box("a", (0.0, 0.0), (LENGTH, SIDE), (8, 2))], comm=MPI.COMM_SELF)
    one, found = run(made, MPI.COMM_SELF, alone), run(made, COMM, bars())
    for name in ("displacement", "rotation", "force"):
        expected = pytest.approx(one.couplings[0][name], rel=1e-9, abs=1e-12)
        assert found.couplings[0][name] == expected


def test_derivatives_by_a_stiffness_are_those_of_the_formula():
    """Of w = F/(E A/L + k), of the bar's energy and of its reaction −E A/L w."""
    stiffness = 70.0
    spring = Spring(between=("end", "ground"), stiffness={"x": stiffness})
    made = scene(
        Coupling("a.x1", name="end", force=(FORCE, 0)),
        spring=(spring,),
        point=(Point("tip", (LENGTH, 0.0)),),
    )
    of = ["displacement_tip_x", "strain_energy", "reaction_x", "end.reaction_x"]
    found = Study(made, body=bars()).derivatives(of, ["spring.0.stiffness.x"])
    moved = FORCE / (BAR + stiffness)
    slope = -moved / (BAR + stiffness)
    expected = (slope, BAR * moved * slope, -BAR * slope, BAR * slope)
    for name, value in zip(of, expected, strict=True):
        assert found[name]["spring.0.stiffness.x"] == pytest.approx(value, rel=1e-9), name


def test_derivatives_by_a_rotational_stiffness_are_those_of_the_formula():
    """Of θ = M/(E I/L + k): the end moves by θ L/2 across the bar."""
    stiffness, moment = 20.0, 0.3
    spring = Spring(between=("end", "ground"), rotational_stiffness=stiffness)
    end = Coupling("a.x1", name="end", moment=moment)
    made = scene(end, spring=(spring,), point=(Point("tip", (LENGTH, 0.0)),))
    of, key = ["displacement_tip_y", "end.reaction_moment"], "spring.0.rotational_stiffness"
    found = Study(made, body=bars()).derivatives(of, [key])
    bends = BENDING / LENGTH
    slope = -moment / (bends + stiffness) ** 2
    assert found[of[0]][key] == pytest.approx(slope * LENGTH / 2, rel=1e-8)
    assert found[of[1]][key] == pytest.approx(slope * bends, rel=1e-8)


def test_derivatives_by_stiffnesses_are_those_of_differences():
    """Between two couplings, one loaded and one moved, above a rough plane; one to the ground."""
    values = {
        "spring.0.stiffness": 40.0,
        "spring.1.stiffness.y": 15.0,
        "spring.1.rotational_stiffness": 8.0,
    }
    springs = (
        Spring(between=("head", "foot"), stiffness=40.0),
        Spring(between=("head", "ground"), stiffness={"y": 15.0}, rotational_stiffness=8.0),
    )
    contact = Contact(
        "a.y0", obstacle=Obstacle("plane", position=(0, 0)), penalty_parameter=1e-5,
        friction_coefficient=0.3, regularisation_parameter=1e-5,
    )  # fmt: skip
    made = scene(
        Coupling("a.y1", name="head", force=(0.2, -2.0), moment=0.3),
        Coupling("b.y1", name="foot", displacement={"x": 0, "y": -0.1}),
        spring=springs,
        support=(Support("b.y0", {"x": 0, "y": 0}),),
        contact=(contact,),
        point=(Point("inside", (0.5 * LENGTH, 0.8 * SIDE)),),
    )
    of = ["strain_energy", "normal_force", "foot.reaction_y", "displacement_inside_x"]
    study = Study(made, body=bars(2))
    slopes = study.derivatives(of, list(values))
    for key, value in values.items():
        below, above = (study.solve({key: value * (1 + 1e-4 * sign)}) for sign in (-1, 1))
        for name in of:
            change = quantity_of(above, name) - quantity_of(below, name)
            expected = pytest.approx(change / (2e-4 * value), rel=1e-6, abs=1e-10)
            assert slopes[name][key] == expected, (name, key)


def quantity_of(answer, name):
    if name.endswith("reaction_y"):
        return next(row for row in answer.supports if row.name == "foot").reaction[1]
    if name == "displacement_inside_x":
        return answer.quantities["displacement_inside"][0]
    return answer.quantities[name]


@pytest.mark.errors
def test_bars_hold():
    spring = Spring(between=("end", "ground"), stiffness=7.0, rotational_stiffness=9.0)
    bent = scene(Coupling("a.x1", name="end", force=(0, 1)), spring=(spring,))
    asked = replace(bent, solver=SolverSettings(errors="all"))
    found = run(asked, COMM, bars())
    fine = run(bent, COMM, boxes([Box("a", (0.0, 0.0), (LENGTH, SIDE), (64, 8))], "quadrilateral"))
    for name in ("displacement", "rotation"):
        error = np.linalg.norm(np.subtract(found.couplings[0][name], fine.couplings[0][name]))
        assert error < found.couplings[0].errors[name]["total"], name
    for name in ("strain_energy", "spring_energy", "external_work"):
        error = abs(found.quantities[name] - fine.quantities[name])
        assert error < found.errors[name]["total"], name


def test_a_spring_along_one_axis_leaves_the_others_free():
    end = Coupling("a.x1", name="end", force=(FORCE, 0))
    spring = Spring(between=("end", "ground"), stiffness={"x": 70.0})
    with refused("springs_leave_a_motion", NoEquilibriumError):
        run(scene(end, spring=(spring,), support=()), COMM, bars())


END = Coupling("a.x1", name="end")


@pytest.mark.parametrize(
    ("make", "name"),
    [
        (lambda: Spring(between=("end", "ground")), "spring_without_stiffness"),
        (lambda: Spring(between=("ground", "end"), stiffness=1.0), "spring_between_what"),
        (
            lambda: scene(END, spring=(Spring(between=("end", "no"), stiffness=1.0),)),
            "spring_to_nothing",
        ),
        (
            lambda: scene(
                END, spring=(Spring(between=("end", "ground"), rotational_stiffness={"x": 1.0}),)
            ),
            "spring_turns_in_the_plane",
        ),
    ],
)
def test_what_a_spring_cannot_say_is_refused(make, name):
    with refused(name, SceneError):
        make()
