"""Cycles that wear in a run, most of them passed over: as a study's, stopped and gone on with."""

import csv
import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import (
    CycleJump,
    Cycles,
    Path,
    Run,
    SolverSettings,
    Steps,
    Study,
    Wear,
    load_scene,
)
from fenics_contact.common.errors import SceneError
from fenics_contact.common.parallel import on_root
from fenics_contact.results.result import read_result
from fenics_contact.results.tables import cycle_rows
from fenics_contact.scene.writing import scene_text
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.simulation.state_file import StateFile
from tests.analyses.wear_cycles.test_wear_cycles import fretting
from tests.messages import refused
from tests.scenes import ROOT, box_body

COMM = MPI.COMM_WORLD
CYCLES = Cycles(begin=1, end=5, number=14, increments=8, jumps=CycleJump(error=0.05))


def scene(**changes):
    cycles = dataclasses.replace(CYCLES, **changes)
    return dataclasses.replace(fretting(), steps=Steps(number=2), cycles=cycles)


def body():
    return box_body((24, 5), (1, 1))


def ran(folder, of, stop_after=None):
    """A run in a folder, which goes on from what is there; None where nothing is left."""
    prepared, done = Run(of, COMM, body()), []
    state = StateFile(folder, prepared.problem, prepared.scene)
    saved = state.load()
    if saved is not None and saved.is_done(of):
        return None
    result = solve_and_write(
        prepared,
        folder,
        state,
        saved,
        stopped=lambda: len(done) == stop_after,
        announce=lambda number, step: done.append(step),
    )
    if result.converged:
        state.finish(result.exit_code)
    return result


def rows(folder, name):
    def read():
        with (folder / name).open(newline="") as file:
            return list(csv.DictReader(file))

    return on_root(COMM, read)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = COMM.bcast(tmp_path_factory.mktemp("whole") if COMM.rank == 0 else None)
    return ran(folder, scene()), folder


def test_a_run_passes_over_the_cycles_that_a_study_does(whole):
    result, folder = whole
    assert result.passed, result.verdict
    expected = list(Study(fretting(), COMM, body()).wear_cycles(1.0, 14, CYCLES.jumps))
    found, last = result.cycles, expected[-1]
    assert [one.number for one in found.each] == [one.number for one in expected]
    assert found.computed == len(expected) < 14 == found.number
    assert result.quantities["worn_volume"] == pytest.approx(last.worn_volume, rel=1e-7)
    assert result.quantities["max_wear_depth"] == pytest.approx(last.max_wear_depth, rel=1e-7)
    assert result.quantities["friction_work"] == pytest.approx(last.friction_work, rel=1e-7)
    assert result.quantities["external_work"] is None
    for one, other in zip(found.each, expected, strict=True):
        assert one.worn.errors == pytest.approx(other.errors, rel=1e-4, abs=1e-12)
        assert one.loss == pytest.approx(sum(other.losses), rel=1e-6)
    # All that friction loses, from the begin of the first cycle on.
    before = expected[0].friction_work - sum(expected[0].losses)
    assert found.loss == pytest.approx(last.friction_work - before, rel=1e-7)
    assert "14 cycles wear, of which" in result.verdict
    assert [step.load_factor for step in result.steps] == [1 + 4 * one.number for one in found.each]
    table = rows(folder, "wear.csv")
    assert [int(row["cycle"]) for row in table] == [one.number for one in found.each]
    written = on_root(COMM, lambda: read_result(folder))
    assert written.cycles.each[-1].worn.errors == pytest.approx(last.errors, rel=1e-4)
    assert cycle_rows(written.cycles)[-1][0] == "14"
    profile = [float(row["worn_depth"]) for row in rows(folder, "wear_profiles.csv")]
    np.testing.assert_allclose(
        profile[-len(result.points.gap) :], result.points.own["worn_depth"], rtol=1e-12
    )


def test_one_that_was_stopped_goes_on(whole, tmp_path):
    """As if nothing had happened; all of it is worn and dissipated once."""
    expected, of_whole = whole
    folder = COMM.bcast(tmp_path)
    stopped = ran(folder, scene(), stop_after=2)
    assert (stopped.interrupted, stopped.cycles.computed) == (True, 2)
    assert "at time " in stopped.verdict
    table = rows(folder, "wear.csv")
    assert len(table) == 2
    # A row that was written before the state was, and one that is not whole.
    on_root(COMM, lambda: _spoil(folder / "wear.csv"))
    found = ran(folder, scene())
    assert [one.number for one in found.cycles.each] == [one.number for one in expected.cycles.each]
    for name in ("worn_volume", "max_wear_depth", "friction_work", "normal_force"):
        assert found.quantities[name] == pytest.approx(expected.quantities[name], rel=1e-7), name
    last, also = found.cycles.each[-1].worn, expected.cycles.each[-1].worn
    assert last.errors == pytest.approx(also.errors, rel=1e-4)
    names = ("cycle", "worn_volume", "friction_work", "stick_area_of_cycle", "passed_over")
    for row, other in zip(rows(folder, "wear.csv"), rows(of_whole, "wear.csv"), strict=True):
        for name in names:
            assert float(row[name]) == pytest.approx(float(other[name]), rel=1e-6), name
    assert ran(folder, scene()) is None
    more = ran(folder, scene(number=20, jumps=CycleJump(error=0.1)))
    assert more.cycles.each[-1].number == 20
    assert more.quantities["worn_volume"] > found.quantities["worn_volume"]


def test_one_that_was_stopped_within_a_cycle_goes_on_from_the_cycle_before(whole, tmp_path):
    """A state within a cycle says nothing of the cycles before, so none is kept."""
    expected, folder = whole[0], COMM.bcast(tmp_path)
    prepared, done, asked = Run(scene(), COMM, body()), [], []

    def stopped():
        asked.extend([None] * (len(done) == 2))
        return len(asked) > 12  # Newton steps of the third cycle

    state = StateFile(folder, prepared.problem, prepared.scene)
    calls = {"stopped": stopped, "announce": lambda number, step: done.append(step)}
    assert solve_and_write(prepared, folder, state, None, **calls).interrupted
    found = ran(folder, scene())
    assert [one.number for one in found.cycles.each] == [one.number for one in expected.cycles.each]
    for name in ("worn_volume", "max_wear_depth", "friction_work", "normal_force"):
        assert found.quantities[name] == pytest.approx(expected.quantities[name], rel=1e-7), name


def _spoil(path):
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join([*lines, lines[-1].replace("2,", "7,", 1), "9,1"]))


def test_what_never_slips_in_a_cycle_is_told(whole):
    """At its end most of the contact sticks; over all of it only the middle, which is not worn."""
    result, folder = whole
    last, first = rows(folder, "wear.csv")[-1], rows(folder, "wear.csv")[0]
    assert float(last["stick_area_of_cycle"]) < 0.8 * float(last["stick_area"])
    points = result.points
    worn = points.own["worn_depth"] > 1e-3 * points.own["worn_depth"].max()
    touched = points.status != "OPEN"
    unworn = float(points.weights[touched & ~worn].sum())
    assert float(first["stick_area_of_cycle"]) == pytest.approx(unworn, rel=0.3)
    assert result.cycles.each[-1].worn.stick_areas["y1"] == pytest.approx(
        float(last["stick_area_of_cycle"])
    )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"steps": Steps(automatic=True)}, "jumps_beside_automatic_steps"),
        ({"solver": SolverSettings(branches=True)}, "jumps_beside_branches"),
        ({"solver": SolverSettings(solver="full")}, "jumps_beside_full_solver"),
        ({"cycles": dataclasses.replace(CYCLES, begin=0, end=5)}, "obstacle_does_not_come_back"),
    ],
)
def test_what_goes_not_with_jumps_is_refused(change, said):
    with refused(said, SceneError):
        dataclasses.replace(scene(), **change)


def test_jumps_need_wear_and_a_run():
    smooth = dataclasses.replace(scene().contact[0], wear=None)
    with refused("jumps_without_wear", SceneError):
        dataclasses.replace(scene(), contact=(smooth,))
    with refused("cycle_jump_is_no_whole_number", SceneError):
        CycleJump(fixed=2.5)
    with refused("cycle_jump_error_is_a_text", SceneError):
        CycleJump(error="1 %")
    with refused("jumps_where_each_step_is_computed"):
        Study(scene(), COMM, body()).quantities()


def test_a_scene_with_jumps_is_written_and_read_again(tmp_path):
    own = load_scene(ROOT / "demos/winkler.toml")
    contact = dataclasses.replace(own.contact[0], law="incremental", wear=Wear(1e-5))
    path = Path(time=(0, 1, 2, 3), factor=(0, 1, -1, 1))
    load = dataclasses.replace(own.load[0], path=path)
    cycles = Cycles(begin=1, end=3, number=100_000, increments=40, jumps=CycleJump(error=0.02))
    worn = dataclasses.replace(
        own, contact=(contact,), load=(load,), steps=Steps(number=2), cycles=cycles
    )
    file = tmp_path / "again.toml"
    file.write_text(scene_text(worn))
    assert load_scene(file).cycles == cycles
    file.write_text(scene_text(worn).replace("error = 0.02", "error = -1"))
    with refused("cycle_jump_error_is_negative_in_file"):
        load_scene(file)
