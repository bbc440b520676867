"""Load paths and load steps: what is followed, what is cut, and that nothing rejected stays."""

import dataclasses
import functools
import io
import json
import logging
import pathlib
from itertools import pairwise

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Load,
    Material,
    NotConvergedError,
    Obstacle,
    Path,
    Run,
    Scene,
    Steps,
    Support,
    run,
)
from fenics_contact.cli import progress
from fenics_contact.cli.summary import print_result
from fenics_contact.common.terminal import Terminal
from fenics_contact.scene.loading.load_paths import knots
from fenics_contact.scene.reading import load_scene
from fenics_contact.solve.load_steps.load_steps import LoadSteps
from fenics_contact.solve.load_steps.step_control import AutomaticPace
from fenics_contact.solve.newton import Newton
from tests.messages import refused
from tests.solve.load_steps.histories import (
    DRAGGED,
    OF_THE_PATH,
    block,
    dragged,
    require_same,
    shoved,
    times,
    two_blocks,
)

COMM = MPI.COMM_WORLD
# The drag needs more of Newton's steps than these.
FEW = {"strategy": "monolithic", "max_iterations": 5}
ANY_CHANGE = 1e3


def let_fail(patch, condition, imbalance=lambda size: size):
    """Steps that a condition on time and size names fail, when all has moved already."""
    attempt = LoadSteps._try

    def failing(self, time):
        found = attempt(self, time)
        if condition(time, time - self.time):
            raise NotConvergedError("too far", (1.0, imbalance(time - self.time)))
        return found

    patch.setattr(LoadSteps, "_try", failing)


def test_cycles_repeat_a_table():
    path = Path(time=(1, 2, 4), factor=(1, -1, 1), cycles=3)
    found = [path(t) for t in (0, 0.5, 1, 1.5, 2, 3, 4, 4.5, 5.5, 6, 8, 9.5, 12, 13)]
    assert found == pytest.approx([1, 1, 1, 0, -1, 0, 1, 1, 0, -1, 1, 0, 1, 1])
    assert path.knots == (1, 2, 4, 5, 6, 8, 9, 10, 12)
    with refused("path_of_cycles_jumps", ValueError):
        Path(time=(0, 1), factor=(0, 1), cycles=2)
    with refused("path_begins_before_0", ValueError):
        Path(time=(-1, 1), factor=(1, 1))


def pulled(path, **contact):
    contact = {"pressure": 20.0, "friction_coefficient": 0.5, **contact}
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("x0", {"x": 0}), Support("y0", {"y": 0})),
        load=(Load("x1", traction=(30, 0), path=path),),
        contact=(Contact("y1", **contact),),
        steps=Steps(number=4),
    )


def test_a_function_is_a_path():
    table = run(pulled(Path((0, 0.5, 1), (0, 1, 0.25))), COMM, block())
    function = run(pulled(lambda t: 2 * t if t <= 0.5 else 1.75 - 1.5 * t), COMM, block())
    for one, other in zip(table.steps, function.steps, strict=True):
        for key, value in one["quantities"].items():
            assert value == pytest.approx(other["quantities"][key], rel=1e-9, abs=1e-12), key


@pytest.mark.parametrize("key", ["load[0].path", "support[0].path", "contact[0].pressure_path"])
@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda t: t if t != 0.5 else np.inf, "path_gives_inf"),
        (lambda t: {}["a"], "path_fails"),
    ],
)
def test_a_function_that_gives_no_number_is_named(key, function, words):
    scene = pulled(function if key.startswith("load") else Path((0, 1), (0, 1)))
    if key.startswith("contact"):
        scene = pulled(Path((0, 1), (0, 1)), pressure_path=function)
    if key.startswith("support"):
        supports = (Support("x0", {"x": 0}, path=function), scene.support[1])
        scene = dataclasses.replace(scene, support=supports)
    with refused(words, key=key):
        run(scene, COMM, block())


def test_load_and_friction_bound_follow_a_given_pressure():
    """Half of the pressure is the pressure's half; and no less than none."""
    path = Path((0, 1, 2), (0, 1, 0.5))
    following = dataclasses.replace(pulled(Path((0,), (1,)), pressure_path=path), steps=Steps(3, 2))
    halved = dataclasses.replace(pulled(Path((0,), (1,)), pressure=10.0), steps=Steps())
    found, expected = run(following, COMM, block()), run(halved, COMM, block())
    assert found.passed and expected.passed
    assert found.quantities["normal_force"] == pytest.approx(10)
    for key, value in expected.quantities.items():
        if key not in OF_THE_PATH:
            assert found.quantities[key] == pytest.approx(value, rel=1e-5, abs=1e-7), key
    with refused("pressure_path_is_negative"):
        run(pulled(Path((0,), (1,)), pressure_path=lambda t: -1), COMM, block())
    with refused("pressure_path_alone", ValueError):
        Contact("y1", pressure_path=DRAGGED)


def taken(steps, turns, refuse=lambda time, size: False, change=lambda time, size: 0.0, newton=5):
    """Pseudo-times that an automatic pace takes where some steps do not converge."""
    pace, time, reached = AutomaticPace(steps, turns), 0.0, []
    while (goal := pace.next(time)) is not None:
        size = goal - time
        changed = change(goal, size)
        if refuse(time, size) or pace.exceeds(changed):
            if not pace.cut():
                return reached, False
            continue
        time = goal
        reached.append(time)
        pace.went(newton, changed)
    return reached, True


def test_steps_end_at_knots():
    found, _ = taken(Steps(automatic=True, number=3, end=2), [0, 0.7, 1.9, 3.0])
    assert {0.7, 1.9, 2.0} <= set(found)
    assert np.diff([0, *found]).max() <= 2 / 3 + 1e-12
    assert taken(Steps(automatic=True, number=7), [0, 1])[0] == pytest.approx(np.arange(1, 8) / 7)


def test_steps_are_cut_and_grow():
    steps = Steps(automatic=True, number=4)
    found, done = taken(steps, [], lambda time, size: 0.25 <= time < 0.5 and size > 0.1)
    assert done and found[0] == 0.25
    sizes = np.diff([0, *found])
    # Half the first; then as the refusals end, half as much again each time, to the first.
    assert sizes.max() == 0.25 and sizes.min() < 0.1
    assert all(b <= 1.5 * a + 1e-12 for a, b in pairwise(sizes))
    grown, _ = taken(Steps(automatic=True, number=20, largest=0.2), [])
    assert len(grown) < 10
    hard, _ = taken(Steps(automatic=True, number=20, largest=0.2), [], newton=40)
    assert len(hard) == 20
    _, done = taken(dataclasses.replace(steps, smallest=0.1), [], lambda time, size: time > 0.3)
    assert not done


def test_changes_of_area_cut_steps_unless_they_are_jumps():
    steps = Steps(automatic=True, number=2, area_change=0.1)
    smooth, _ = taken(steps, [], change=lambda goal, size: size)
    assert np.diff([0, *smooth]).max() <= 0.1 and 10 <= len(smooth) <= 20
    for jump in (0.01, 0.24, 0.26, 0.49, 0.999):
        jumping, _ = taken(steps, [], change=lambda goal, size, at=jump: goal - size < at <= goal)
        assert len(jumping) <= 5  # a step or two in vain, not ten


def test_knots_of_a_scene_are_those_of_all_its_paths():
    assert knots(dragged(Steps())) == [0, 0.5, 1]
    assert knots(pulled(lambda t: t)) == [0, 1]  # those of supports, and a pressure's
    result = run(dragged(Steps(automatic=True, number=3, area_change=ANY_CHANGE)), COMM, block())
    assert 0.5 in times(result)


@pytest.mark.parametrize(
    ("scene", "body"), [(dragged, block), (shoved, two_blocks)], ids=["obstacle", "two bodies"]
)
def test_steps_that_are_rejected_leave_no_trace(scene, body):
    automatic = Steps(number=2, automatic=True, area_change=ANY_CHANGE, largest=0.25)
    with pytest.MonkeyPatch.context() as patch:
        let_fail(patch, lambda time, size: size > 0.11)
        found = run(scene(automatic), COMM, body())
    assert found.passed, found.verdict
    assert 0.5 in times(found) and 9 <= len(found.steps) <= 20
    assert found.model["bulk_factorisations"] == 1
    listed = run(scene(Steps(times=times(found))), COMM, body())
    require_same(found, listed)
    for one, other in zip(found.steps, listed.steps, strict=True):
        assert one["quantities"]["friction_work"] == pytest.approx(
            other["quantities"]["friction_work"], rel=1e-8, abs=1e-12
        )


def test_smaller_steps_that_fail_in_the_same_way_are_not_cut_further(monkeypatch):
    """The size is not the cause; a minute a step, of which there may be many."""
    automatic = Steps(number=2, automatic=True, area_change=ANY_CHANGE)
    tried = []

    def late(time, size):
        tried.append(time)
        return time > 0.5

    let_fail(monkeypatch, late, lambda size: 1e-6)
    result = run(dragged(automatic), COMM, block())
    assert result.exit_code == 3
    assert "A larger load step ended in the same way." in result.verdict
    assert "steps.smallest" not in result.verdict
    assert tried == pytest.approx([0.5, 1.0, 0.75])
    tried.clear()
    monkeypatch.undo()
    let_fail(monkeypatch, late, lambda size: 1e-6 * size)  # it depends on the size
    assert run(dragged(automatic), COMM, block()).exit_code == 3
    assert len(tried) > 5


def test_changes_of_the_contact_cut_steps():
    coarse = run(dragged(Steps(number=4, automatic=True, area_change=ANY_CHANGE)), COMM, block())
    fine = run(dragged(Steps(number=4, automatic=True)), COMM, block())
    assert len(coarse.steps) == 4 < len(fine.steps)
    require_same(fine, run(dragged(Steps(times=times(fine))), COMM, block()))


def test_a_step_that_fails_keeps_the_one_before():
    result = run(dragged(Steps(number=2), **FEW), COMM, block())
    assert result.exit_code == 3 and not result.converged
    assert "No answer at time 1:" in result.verdict and "at time 0.5 of 1" in result.verdict
    assert "steps.automatic = true" in result.verdict
    half = run(dragged(Steps(times=(0.5,)), **FEW), COMM, block())
    require_same(result, half)
    assert set(result.checks) == set(half.checks) | {"energy_balance"}  # where steps may follow
    assert all(check.passed for check in (*result.checks.values(), *half.checks.values()))
    assert [bool(step["quantities"]) for step in result.steps] == [True, False]
    stuck = Steps(number=2, automatic=True, smallest=0.4)
    last = run(dragged(stuck, **FEW), COMM, block())
    assert last.exit_code == 3 and "steps.smallest" in last.verdict
    require_same(last, half)


def test_two_bodies_that_fail_are_evaluated_as_they_were_paired(monkeypatch):
    expected = run(shoved(Steps(times=(0.5, 0.7, 0.8))), COMM, two_blocks())
    let_fail(monkeypatch, lambda time, size: time > 0.9)
    found = run(shoved(Steps(times=(0.5, 0.7, 0.8, 1))), COMM, two_blocks())
    assert found.exit_code == 3
    require_same(found, expected)


@pytest.mark.parametrize("solver", ["condensed", "full"])
@pytest.mark.parametrize("law", ["static", "incremental"])
def test_obstacle_that_lifts_off(solver, law):
    """Through nothing to nothing: no forces are left to compare an imbalance with."""
    away = Path((0, 0.5, 1, 1.5), (0, 1, 0, -1))
    result = run(dragged(Steps(6, 1.5), law, away, solver=solver), COMM, block())
    assert result.passed, result.verdict
    peaks = [step["quantities"]["max_contact_pressure"] for step in result.steps]
    assert peaks[1] > peaks[2] > 0 and peaks[3:] == [0, 0, 0]
    energies = [step["quantities"]["strain_energy"] for step in result.steps]
    assert energies[-1] <= 1e-15 * energies[1]


def test_loads_that_go_back_to_nothing():
    there = Path((0, 1, 2), (0, 1, 0))
    scene = dataclasses.replace(pulled(there, law="incremental"), steps=Steps(8, 2.0))
    result = run(scene, COMM, block())
    assert result.passed, result.verdict


def test_a_prediction_saves_newton_steps(monkeypatch):
    def count():
        result = run(dragged(Steps(number=16)), COMM, block())
        assert result.passed
        return result, sum(step["newton_iterations"] for step in result.steps[9:])

    predicted, few = count()
    monkeypatch.setattr(LoadSteps, "_prediction", lambda self, time: None)
    plain, many = count()
    assert few <= 0.6 * many
    require_same(predicted, plain, 1e-6)


def test_a_prediction_that_leads_nowhere_is_forgotten(monkeypatch):
    plain = run(dragged(Steps(number=8)), COMM, block())
    predict = LoadSteps._prediction

    def wild(self, time):
        found = predict(self, time)
        if found is None:
            return None
        return dataclasses.replace(found, position=found.position * np.nan)

    monkeypatch.setattr(LoadSteps, "_prediction", wild)
    require_same(run(dragged(Steps(number=8)), COMM, block()), plain)


def test_a_rank_that_is_asked_to_stop_stops_all(capsys):
    prepared = Run(dragged(Steps(number=8)), COMM, block())
    said = []

    def asked():
        return COMM.rank == COMM.size - 1 and len(said) == 3

    result = prepared.solve(stopped=asked, announce=lambda number, step: said.append(number))
    assert result.exit_code == 130 and not result.converged
    assert len(result.steps) == 3 and "at time 0.375 of 1" in result.verdict
    require_same(result, run(dragged(Steps(times=(0.125, 0.25, 0.375))), COMM, block()))
    none = Run(dragged(Steps()), COMM, block()).solve(stopped=lambda: True)
    assert none.exit_code == 130 and none.quantities == {} and none.points is None
    print_result(none, pathlib.Path("nowhere"))
    assert "Interrupted before any load step was done." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"automatic": True, "times": (1.0,)}, "automatic_steps_with_times"),
        ({"smallest": 0.1}, "smallest_step_alone"),
        ({"automatic": True, "smallest": 0.3, "number": 4}, "smallest_step_exceeds_largest"),
    ],
)
def test_keys_of_automatic_steps_that_contradict(keys, words):
    with refused(words, ValueError):
        Steps(**keys)


@pytest.mark.serial
def test_a_terminal_has_a_bar_and_a_file_lines(monkeypatch, caplog):
    terminal = io.StringIO()
    console = functools.partial(Terminal, file=terminal, force_terminal=True, width=120)
    monkeypatch.setattr(progress, "Terminal", lambda stderr: console())
    with progress.activity(Steps(number=4), COMM) as announce, caplog.at_level(logging.INFO):
        Run(dragged(Steps(number=4)), COMM, block()).solve(announce=announce)
    assert "step 4: time 1, " in terminal.getvalue()
    assert not caplog.messages
    monkeypatch.setattr(progress, "Terminal", lambda stderr: console(force_terminal=False))
    with progress.activity(Steps(number=4), COMM) as announce, caplog.at_level(logging.INFO):
        Run(dragged(Steps(number=4)), COMM, block()).solve(announce=announce)
    assert announce is None and len(caplog.messages) == 4
    assert caplog.messages[-1].startswith("step 4: time 1, ")
    assert "sticking" in caplog.messages[-1]


@pytest.mark.serial
def test_paths_in_a_file(tmp_path):
    text = """
    kinematics = "plane strain"
    mesh = { file = "a.msh" }
    material = { youngs_modulus = 1, poissons_ratio = 0.3 }
    steps = { automatic = true, number = 10, end = 40 }
    [[load]]
    on = "a"
    traction = [1, 0]
    path = { time = [0, 1, 3, 4], factor = [0, 1, -1, 0], CYCLES = 10 }
    """
    (tmp_path / "a.toml").write_text(text.replace("CYCLES", "cycles"))
    scene = load_scene(tmp_path / "a.toml")
    assert scene.load[0].path(39) == pytest.approx(-1) and scene.steps.automatic
    (tmp_path / "a.toml").write_text(text.replace("CYCLES", "cycels"))
    with refused("unknown_key_cycels"):
        load_scene(tmp_path / "a.toml")
    wrong = text.replace(", CYCLES = 10", "").replace("[0, 1, -1, 0]", '"x"')
    (tmp_path / "a.toml").write_text(wrong)
    with refused("path_factor_is_a_letter"):
        load_scene(tmp_path / "a.toml")
    json.dumps(dataclasses.asdict(scene))


def test_a_force_that_comes_and_goes():
    """An obstacle that nothing presses on is brought up again when something does."""
    path = Path((0, 0.5, 1), (0, 1, 0), cycles=2)
    obstacle = Obstacle("parabola", radius=2, position=(0.5, 1), force=6, path=path)
    scene = Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y0", {"x": 0, "y": 0}),),
        contact=(Contact("y1", obstacle=obstacle, friction_coefficient=0.3, law="incremental"),),
        steps=Steps(number=16, end=2),
    )
    result = run(scene, COMM, block())
    assert result.passed
    forces = [step["quantities"]["normal_force"] for step in result.steps]
    assert forces == pytest.approx(2 * [1.5, 3, 4.5, 6, 4.5, 3, 1.5, 0], rel=1e-7, abs=1e-6)
    pulling = dataclasses.replace(obstacle, path=Path((0, 1), (0, -1)))
    contact = dataclasses.replace(scene.contact[0], obstacle=pulling)
    with refused("obstacle_path_is_negative"):
        run(dataclasses.replace(scene, contact=(contact,), steps=Steps(8)), COMM, block())


@pytest.mark.parametrize("fails", [False, True])
def test_all_newton_steps_are_counted_also_of_what_was_cut(monkeypatch, fails):
    """Against PETSc's own count, of steps that are cut twice, and of one that never converges."""
    taken, converged = [0], Newton._converged

    def counted(self, snes, iteration, norms):
        taken[0] += iteration > 0
        return converged(self, snes, iteration, norms)

    monkeypatch.setattr(Newton, "_converged", counted)
    first = [1.0]

    def too_far(time, size):
        first[0] = min(first[0], size)
        return fails if time > 0.6 else size > 0.3

    steps = Steps(automatic=True, number=1, largest=0.5, smallest=0.05, area_change=ANY_CHANGE)
    let_fail(monkeypatch, too_far, lambda size: 1 + size)
    scene = dragged(steps)
    quiet = dataclasses.replace(scene.solver, errors="none")
    result = Run(dataclasses.replace(scene, solver=quiet), COMM, block()).solve()
    assert result.converged != fails and first[0] < 0.3
    assert sum(step.newton_iterations for step in result.steps) == taken[0] > 0
