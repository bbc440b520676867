"""Cycles of loads that a run goes on with where another one ended."""

import dataclasses
import json

import pytest
from mpi4py import MPI

from fenics_contact import Cycles, Path, Run, Steps
from fenics_contact.results.tables import cycle_rows
from fenics_contact.simulation.output.run_folder import solve_and_write
from fenics_contact.simulation.state_file import StateFile
from tests.simulation.cycles.test_cycles import BAR, bar_body, of_the_bar, with_cycles

__all__ = ["of_the_bar"]


def gone_on_in(folder, scene):
    """A run of the bar, which goes on from what is in a folder; None where nothing is left."""
    prepared = Run(scene, MPI.COMM_WORLD, bar_body())
    state = StateFile(folder, prepared.problem)
    saved = state.load()
    if saved is not None and saved.is_done(scene):
        return None
    result = solve_and_write(prepared, folder, state, saved)
    state.finish(result.exit_code)
    return result


def test_more_cycles_may_follow_those_of_an_earlier_run(tmp_path, of_the_bar):
    """A closed loop is not begun again; an open one is gone on with."""
    folder, comm = MPI.COMM_WORLD.bcast(tmp_path), MPI.COMM_WORLD
    assert gone_on_in(folder, with_cycles(BAR, number=1)).cycles.closed_in is None
    found = gone_on_in(folder, BAR)
    # The end of the first cycle is not known to the second run: one more is needed to compare.
    assert [cycle.change is None for cycle in found.cycles.each] == [False, True, False, False]
    assert found.cycles.each[-1].loss == pytest.approx(of_the_bar.cycles.each[-1].loss)
    assert found.cycles.kind == "steady loop"
    assert gone_on_in(folder, with_cycles(BAR, number=60)) is None
    if comm.rank == 0:
        written = json.loads((folder / "result.json").read_text())
        assert written["cycles"]["each"][-1]["kind"] == "steady loop"


def test_a_smaller_tolerance_has_more_to_do(tmp_path):
    """With the one that a loop closed by, or a larger one, all is done."""
    folder = MPI.COMM_WORLD.bcast(tmp_path)
    assert gone_on_in(folder, with_cycles(BAR, tolerance=0.1)).cycles.closed_in == 2
    assert gone_on_in(folder, with_cycles(BAR, tolerance=0.1)) is None
    assert gone_on_in(folder, with_cycles(BAR, tolerance=0.5)) is None
    found = gone_on_in(folder, with_cycles(BAR, tolerance=1e-3)).cycles
    # That of cycle 3 is not known, and 4 has none to be told from.
    assert [cycle.is_closed for cycle in found.each] == [False, True, False, False, True]
    assert (found.closed_in, found.kind) == (5, "steady loop")
    assert gone_on_in(folder, with_cycles(BAR, tolerance=1e-3)) is None


def test_cycles_from_the_start_are_gone_on_with_and_not_compared_with_rest(tmp_path):
    """Else all that was lost so far would be the loss of one cycle, beside which none counts."""
    folder = MPI.COMM_WORLD.bcast(tmp_path)
    load = dataclasses.replace(BAR.load[0], path=Path((0, 1, 3, 4), (0, 1, -1, 0)))
    cycles = Cycles(end=4, number=4, increments=4, until="end", tolerance=0.4)
    scene = dataclasses.replace(BAR, load=(load,), steps=Steps(), cycles=cycles)
    assert gone_on_in(folder, scene).cycles.kind == "steady loop"
    more = gone_on_in(folder, with_cycles(scene, number=8)).cycles
    assert more.each[4].change is None
    assert more.kind == "steady loop", cycle_rows(more)


@pytest.mark.parametrize("until", [("closed", "end"), ("end", "closed")])
def test_automatic_steps_go_on_whatever_ends_the_cycles(tmp_path, until):
    folder = MPI.COMM_WORLD.bcast(tmp_path)
    automatic = Steps(automatic=True, number=1, end=1)
    scene = dataclasses.replace(BAR, steps=automatic, cycles=Cycles(begin=1, end=5, number=2))
    assert gone_on_in(folder, with_cycles(scene, until=until[0])).cycles.computed == 2
    found = gone_on_in(folder, with_cycles(scene, until=until[1], number=3))
    assert (found.cycles.computed, found.steps[-1].load_factor) == (3, 13)
