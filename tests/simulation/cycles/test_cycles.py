"""Cycles of loads: which loops close, what each loses, and that nothing is computed in vain."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Cycles,
    Discretisation,
    Load,
    Material,
    MicroSlipFriction,
    Obstacle,
    Path,
    Point,
    Preload,
    Profile,
    Run,
    Scene,
    SlipDependentFriction,
    SolverSettings,
    Steps,
    Study,
    Support,
    load_scene,
    run,
)
from fenics_contact.contact.state import LastStep
from fenics_contact.results.load_history import cycles_record
from fenics_contact.results.tables import cycle_rows, cycle_words
from fenics_contact.scene.loading.load_paths import cycles_of, knots
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.output.run_folder import solve_and_write
from tests.messages import refused
from tests.scenes import box_body

# A bar on a rigid plane that holds it along its length by up to τ, pulled to and fro at its end.
YOUNG, LENGTH, HEIGHT, LIMIT = 1000.0, 20.0, 0.2, 0.3
FORCE = 0.8 * LIMIT * LENGTH
TO_AND_FRO = Path(time=(0, 1, 3, 5), factor=(0, 1, -1, 1))
# Of a cycle, 2F³/(3EAτ); and how far the end is pulled, F²/(2EAτ).
LOSS = 2 * FORCE**3 / (3 * YOUNG * HEIGHT * LIMIT)
PULLED = FORCE**2 / (2 * YOUNG * HEIGHT * LIMIT)

BAR = Scene(
    kinematics="plane stress",
    material=Material(YOUNG, 0.0),
    support=(Support("y0", {"y": 0}),),
    load=(Load("x1", traction=(FORCE / HEIGHT, 0), path=TO_AND_FRO),),
    contact=(Contact("y1", pressure=1, friction_coefficient=LIMIT, law="incremental"),),
    point=(Point("end", (LENGTH, 0)),),
    steps=Steps(times=(0.5, 1)),
    cycles=Cycles(begin=1, end=5, number=50, increments=8),
    solver=SolverSettings(errors="none"),
)


def bar_body():
    return box_body((20, 1), (LENGTH, HEIGHT))


def with_cycles(scene, **changes):
    return dataclasses.replace(scene, cycles=dataclasses.replace(scene.cycles, **changes))


@pytest.fixture(scope="module")
def of_the_bar():
    return run(BAR, body=bar_body())


def test_a_load_that_varies_has_a_loop_of_its_own(of_the_bar):
    """Its area is the work that is done in the cycle, as nothing else moves."""
    last = of_the_bar.cycles.each[-1]
    (loop,) = last.loops
    assert loop.drive == "the traction on 'x1'"
    assert loop.force == pytest.approx(
        [FORCE, *(FORCE * np.array([0.5, 0, -0.5, -1, -0.5, 0, 0.5, 1]))]
    )
    # Back by 2 F against friction that turns by 2 τ: twice as far as F did at first.
    assert loop.displacement[0] - loop.displacement[4] == pytest.approx(2 * PULLED, rel=2e-2)
    assert loop.work == pytest.approx(last.work, rel=1e-9)
    assert sum(last.contacts.values()) == pytest.approx(last.loss)


def test_the_loop_of_an_elastic_bar_is_a_line():
    scene = dataclasses.replace(
        BAR,
        support=(*BAR.support, Support("x0", {"x": 0})),
        load=(Load("x1", pressure=2.0, path=TO_AND_FRO),),
        contact=(Contact("y1", pressure=1, friction_coefficient=0.0),),
        cycles=dataclasses.replace(BAR.cycles, number=2),
    )
    (loop,) = run(scene, body=bar_body()).cycles.each[-1].loops
    assert loop.drive == "the pressure on 'x1'"
    assert max(loop.force) == pytest.approx(2.0 * HEIGHT)
    assert max(loop.displacement) == pytest.approx(2.0 / YOUNG * LENGTH, rel=1e-6)
    assert loop.work == pytest.approx(0.0, abs=1e-12)  # elastic: a line, there and back


def rocked(pushed):
    """A block whose pressure moves from one side to the other, and that is pushed meanwhile."""
    there_and_back = Path(time=(1, 1.5, 2, 2.5, 3), factor=(0, 1, 0, -1, 0))
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        discretisation=Discretisation(1),
        load=(
            Load("y1", pressure=10),
            Load("y1", pressure=Profile("x", (0, 2), (9, -9)), path=there_and_back),
            Load("x0", traction=(pushed, 0)),
        ),
        contact=(
            Contact(
                "y0",
                friction_coefficient=0.3,
                law="incremental",
                obstacle=Obstacle("plane", position=(0, 0)),
            ),
        ),
        cycles=Cycles(begin=1, end=3, number=30, increments=4),
        solver=SolverSettings(errors="none"),
    )


def test_a_bar_loses_what_the_formula_says_and_repeats_it(of_the_bar):
    found = of_the_bar.cycles
    assert of_the_bar.passed, of_the_bar.verdict
    assert (found.kind, found.closed_in, found.computed, found.number) == ("steady loop", 2, 2, 50)
    for cycle in found.each:
        assert cycle.loss == pytest.approx(LOSS, rel=0.005)
        assert cycle.contacts == {"y1": pytest.approx(cycle.loss)}
    assert found.loss == pytest.approx(50 * LOSS, rel=0.005)
    # The loop closes, so that the work goes nowhere else; straight lines between 8 loads lose
    # some of it.
    assert found.each[1].work == pytest.approx(LOSS, rel=0.08)
    ends = [of_the_bar.steps[n - 1].quantities["displacement_end"][0] for n in found.each[1].steps]
    assert ends[1] == pytest.approx(PULLED, rel=0.005)
    assert "The loop closed in cycle 2 of 50, a steady loop" in of_the_bar.verdict
    assert found.each[0].steps == [3, 10]
    assert len(of_the_bar.steps) == 18


STRETCHED = dataclasses.replace(
    with_cycles(BAR, increments=16), load=(*BAR.load, Load("y1", traction=(0, 0.1 * YOUNG)))
)


def test_the_loss_of_a_closed_cycle_is_the_area_of_its_loops():
    """To what 16 straight lines leave open; over the work that is done in the cycle alone."""
    check = run(STRETCHED, body=bar_body()).checks["cycle_loss"]
    assert check.passed
    assert check.limit < 0.03


def test_a_wrong_loss_is_seen_beside_much_work_before(monkeypatch):
    """Friction that says 10 % more than it takes: the balance of all work does not see it."""
    dissipation = LastStep.dissipation
    monkeypatch.setattr(LastStep, "dissipation", lambda *at: 1.1 * dissipation(*at))
    found = run(STRETCHED, body=bar_body())
    assert found.cycles.kind == "steady loop"
    assert found.checks["energy_balance"].passed
    assert not found.checks["cycle_loss"].passed
    assert "cycle loss: the areas of the loops and the loss of the cycle differ" in found.verdict


def test_loops_that_are_not_closed_are_not_compared_with_their_loss(of_the_bar):
    open_loop = run(with_cycles(BAR, number=1), body=bar_body())
    assert "cycle_loss" in of_the_bar.checks
    assert "cycle_loss" not in open_loop.checks


def test_the_path_says_the_same_in_short(of_the_bar):
    """The table of one cycle by ``cycles``: all cycles are computed, and each loses as much."""
    around = Path(time=(0, 1, 3, 4), factor=(0, 1, -1, 0), cycles=3)
    load = dataclasses.replace(BAR.load[0], path=around)
    times = tuple(4 * c + t for c in range(3) for t in (0.5, 1, 5 / 3, 7 / 3, 3, 3.5, 4))
    scene = dataclasses.replace(BAR, load=(load,), cycles=None, steps=Steps(times=times))
    assert cycles_of(scene) == Cycles(end=4, number=3, until="end")
    found = run(scene, body=bar_body())
    assert len(found.steps) == len(times)
    assert [cycle.kind for cycle in found.cycles.each] == ["", "", "steady loop"]
    # The first cycle begins in the middle, and leaves out what the others lose before its top.
    assert found.cycles.each[0].loss < 0.9 * found.cycles.each[1].loss
    assert found.cycles.each[2].loss == pytest.approx(LOSS, rel=0.01)


@pytest.mark.parametrize(("pushed", "kind"), [(0.3, "shakedown"), (4.0, "ratchetting")])
def test_a_rocked_block_comes_to_rest_or_walks(pushed, kind):
    """Of the limit .3 × 20 / 1 = 6: with more it would slide away, with little all sticks."""
    found = run(rocked(pushed), body=box_body((6, 3), (2, 1)))
    last = found.cycles.each[-1]
    assert (found.cycles.kind, last.is_closed) == (kind, True), cycle_rows(found.cycles)
    assert found.cycles.computed < 30
    losses = [cycle.loss for cycle in found.cycles.each]
    if kind == "shakedown":
        assert losses[-1] < 2e-3 * max(losses)
    if kind == "ratchetting":
        # All of it walks in the direction of the push, by as much in every cycle.
        before, after = (found.steps[c.steps[1] - 1] for c in found.cycles.each[-2:])
        gone = after.quantities["max_slip"] - before.quantities["max_slip"]
        assert gone == pytest.approx(last.advance, rel=0.01)
        assert last.advance == pytest.approx(found.cycles.each[-2].advance, rel=2e-3)
    else:
        assert last.advance < 2e-3 * found.steps[-1].quantities["max_slip"]


def test_a_loop_that_is_not_closed_is_not_said_to_be():
    found = run(with_cycles(rocked(0.3), number=2), body=box_body((6, 3), (2, 1)))
    assert (found.cycles.kind, found.cycles.closed_in) == ("", None)
    assert found.cycles.computed == 2
    assert found.cycles.loss == pytest.approx(sum(c.loss for c in found.cycles.each))
    assert "The loop is not closed after 2 cycles; tractions still change by" in found.verdict


def test_all_cycles_are_computed_where_the_scene_says_so(of_the_bar):
    found = run(with_cycles(BAR, until="end", number=4), body=bar_body())
    assert found.cycles.computed == 4
    assert found.cycles.closed_in == 2
    total = found.quantities["friction_work"] - found.steps[1].quantities["friction_work"]
    assert found.cycles.loss == pytest.approx(total)
    assert found.cycles.loss == pytest.approx(4 / 50 * of_the_bar.cycles.loss)


def test_a_study_ends_where_a_run_does(of_the_bar):
    found = Study(BAR, body=bar_body()).quantities()
    work = of_the_bar.quantities["friction_work"]
    assert found.quantities["friction_work"] == pytest.approx(work, rel=1e-6)


def test_fields_may_be_kept_of_the_ends_of_cycles_only(tmp_path):
    folder = MPI.COMM_WORLD.bcast(tmp_path)
    scene = with_cycles(BAR, keep="cycles", number=2)
    solve_and_write(Run(scene, body=bar_body()), folder)
    if MPI.COMM_WORLD.rank == 0:
        assert (folder / "fields.pvd").read_text().count("<DataSet") == 2


def test_load_steps_end_at_every_turn_of_every_cycle():
    scene = with_cycles(BAR, number=3, increments=6)
    assert scene.load_steps.all_times[:5] == pytest.approx((0.5, 1, 5 / 3, 7 / 3, 3))
    assert scene.load_steps.last == 13
    assert len(scene.load_steps.all_times) == 2 + 3 * 6
    assert knots(scene) == pytest.approx([0, 1, 3, 5, 7, 9, 11, 13])
    assert [scene.path_time(t) for t in (0.5, 4, 5, 8.5, 13)] == pytest.approx([0.5, 4, 1, 4.5, 5])
    automatic = dataclasses.replace(scene, steps=Steps(automatic=True, number=4, end=1))
    assert (automatic.load_steps.last, automatic.load_steps.first_size) == (13, 0.25)
    own = with_cycles(dataclasses.replace(BAR, steps=Steps(times=(1, 2, 5))), increments=None)
    assert own.load_steps.all_times[:5] == (1, 2, 5, 6, 9)


def test_obstacles_loops_are_theirs():
    """Of the demo, with the loop's formula: 4 (μP)²/(πE*) ((1 − q) ln(1 − q) + q − q²/2)."""
    scene = load_scene("demos/cycle.toml", ["mesh.parameters.size=0.2", "solver.errors='none'"])
    contact = scene.contact[0]
    path = Path(time=(1, 6, 16, 26), factor=(0, 1, -1, 1))
    obstacle = dataclasses.replace(contact.obstacle, displacement_path=path)
    contact = dataclasses.replace(contact, obstacle=obstacle)
    cycles = Cycles(begin=6, end=26, number=9, increments=8)
    scene = dataclasses.replace(scene, contact=(contact,), steps=Steps(times=(1, 6)), cycles=cycles)
    found = run(scene).cycles
    assert (found.kind, found.closed_in) == ("steady loop", found.computed)
    assert found.computed < 9
    limit, stiffness = 0.5 * 20, 1000 / (1 - 0.49**2)
    (loop,) = found.each[-1].loops
    q = max(loop.force) / limit
    expected = 4 * limit**2 / (np.pi * stiffness) * ((1 - q) * np.log(1 - q) + q - q * q / 2)
    assert found.each[-1].loss == pytest.approx(expected, rel=0.03)
    assert loop.work == pytest.approx(expected, rel=0.08)
    assert loop.force[0] == pytest.approx(loop.force[-1], rel=1e-3)


@pytest.mark.parametrize(("slid", "kind"), [(0.2, "steady loop"), (0.04, "shakedown")])
def test_elastic_slip_is_no_creep(slid, kind):
    """A stiff block with micro-slip of length l = .05 loses 4 μpA (s − l) in a cycle, or nothing.

    What its law keeps comes back to round-off, in the first cycle that is compared already.
    """
    law = MicroSlipFriction("micro-slip", elastic_slip=0.05)
    block = dataclasses.replace(
        BAR,
        material=Material(1e9, 0.0),
        load=(),
        support=(BAR.support[0], Support("x1", {"x": slid}, path=TO_AND_FRO)),
        contact=(dataclasses.replace(BAR.contact[0], friction_law=law),),
    )
    found = run(with_cycles(block, number=6), body=bar_body()).cycles
    assert (found.kind, found.computed) == (kind, 2), cycle_rows(found)
    expected = 4 * LIMIT * LENGTH * max(slid - 0.05, 0.0)
    assert found.each[-1].loss == pytest.approx(expected, rel=1e-4, abs=1e-6)


def test_what_a_law_keeps_may_be_none_of_a_rank():
    """A column that stands on its short side, which two ranks do not share."""
    law = MicroSlipFriction("micro-slip", elastic_slip=0.05)
    contact = Contact(
        "y0", pressure=1, friction_coefficient=LIMIT, law="incremental", friction_law=law
    )
    column = dataclasses.replace(
        BAR,
        material=Material(1e6, 0.0),
        support=(Support("y1", {"y": 0}), Support("y1", {"x": 0.2}, path=TO_AND_FRO)),
        load=(),
        contact=(contact,),
        point=(),
    )
    found = run(column, body=box_body((1, 8), (1, 4))).cycles
    assert (found.kind, found.computed) == ("steady loop", 2)
    assert found.loss == pytest.approx(50 * 4 * LIMIT * 0.15, rel=1e-3)


def test_friction_that_goes_on_weakening_closes_no_loop():
    """It goes by all that has slipped, so that no cycle repeats the one before."""
    law = SlipDependentFriction("slip dependent", slips=(0, 100 * PULLED), shares=(1, 0.5))
    contact = dataclasses.replace(BAR.contact[0], friction_law=law)
    found = run(
        with_cycles(dataclasses.replace(BAR, contact=(contact,)), number=4), body=bar_body()
    )
    assert (found.cycles.kind, found.cycles.computed) == ("", 4)
    assert "and so does what is kept at the contact points, such as wear" in found.verdict
    losses = [cycle.loss for cycle in found.cycles.each]
    assert losses == sorted(losses)  # less friction lets more of the bar slip, by F³/τ


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"cycles": Cycles(begin=2, end=5)}, "cycles_do_not_come_back"),
        ({"cycles": Cycles(begin=5, end=9)}, "nothing_changes_in_cycles"),
        (
            {"load": (Load("x1", traction=(1, 0), path=Path((0, 1, 2), (0, 1, 0), 2)),)},
            "cycles_twice",
        ),
        ({"contact": (dataclasses.replace(BAR.contact[0], law="static"),)}, "cycles_of_static_law"),
        ({"cycles": Cycles(begin=1, end=5)}, "cycle_of_one_step"),
        ({"cycles": Cycles(begin=1, end=5, number=100_000, increments=11)}, "too_many_cycles"),
        (
            {"preload": (Preload("body", (1, 0), 1, locked_from=3),), "steps": Steps(3, 3)},
            "locked_late",
        ),
    ],
)
def test_cycles_that_make_no_sense_are_refused(change, said):
    with refused(said):
        dataclasses.replace(BAR, **change)
    with refused("cycles_begin_at_their_end"):
        Cycles(begin=5, end=5)


def test_what_is_held_or_smooth_has_cycles_from_the_start():
    """The ramp of a support that holds at 0 moves nothing; what does not rub has no law."""
    load = dataclasses.replace(BAR.load[0], path=Path((0, 1, 3, 4), (0, 1, -1, 0)))
    held = Obstacle("plane", position=(0, HEIGHT))
    scene = dataclasses.replace(
        BAR,
        load=(load,),
        contact=(Contact("y1", obstacle=held),),
        cycles=Cycles(end=4, increments=4),
    )
    assert scene.load_steps.last == 80
    moved = dataclasses.replace(held, indentation=0.1)
    with refused("cycles_of_obstacle_do_not_come_back_at_4"):
        dataclasses.replace(scene, contact=(Contact("y1", obstacle=moved),))


def test_functions_have_cycles_too():
    wave = Load("x1", traction=(1, 0), path=lambda t: float(np.sin(np.pi * t / 2)))
    assert dataclasses.replace(BAR, load=(wave,)).load_steps.last == 201


def test_a_scene_with_cycles_is_written_and_read_again(tmp_path):
    scene = load_scene("demos/slab.toml")
    load = dataclasses.replace(scene.load[0], path=TO_AND_FRO)
    contact = dataclasses.replace(scene.contact[0], law="incremental")
    scene = dataclasses.replace(scene, load=(load,), contact=(contact,), cycles=BAR.cycles)
    file = tmp_path / "again.toml"
    file.write_text(scene_text(dataclasses.replace(scene, mesh=load_scene("demos/slab.toml").mesh)))
    assert load_scene(file).cycles == BAR.cycles


def test_nothing_is_said_where_nothing_comes_again(of_the_bar):
    assert cycle_words(None) == ""
    assert cycle_rows(None) == []
    assert cycles_record(of_the_bar.steps, of_the_bar.contacts, None) is None
    rows = cycle_rows(of_the_bar.cycles)
    assert len(rows) == 3
    assert rows[2][-1] == "steady loop"
    assert rows[1][2] == "?"  # no bar was estimated
