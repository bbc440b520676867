"""Cycles of loads solved exactly: nothing creeps, so that states repeat to round-off."""

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Cycles, Material, Obstacle, Path, Run, Scene, Steps, Support
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.state_file import StateFile
from tests.scenes import box_body, with_solver

COMM = MPI.COMM_WORLD
WAY = 0.01
CYCLES = Cycles(begin=2, end=6, number=10_000, increments=8, tolerance=1e-12)
# Pressed in until 1, aside until 2, then back and forth.
RUBBED = with_solver(
    Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0, "y": 0}),),
        contact=(
            Contact(
                "y0",
                law="incremental",
                friction_coefficient=0.3,
                obstacle=Obstacle(
                    indentation=0.01,
                    path=Path(time=(0, 1), factor=(0, 1)),
                    displacement=(WAY, 0),
                    displacement_path=Path(time=(1, 2, 4, 6), factor=(0, 1, -1, 1)),
                ),
            ),
        ),
        steps=Steps(times=(1, 2, 4, 6)),
        cycles=CYCLES,
    ),
    strategy="exact",
    errors="none",
)


def body():
    return box_body((4, 3), (1, 1))


def test_a_loop_is_closed_to_round_off_and_no_further_cycle_is_solved() -> None:
    """10,000 cycles are over after a few; the loss is the area of the loop of the obstacle."""
    found = Run(RUBBED, COMM, body()).solve()
    assert found.passed, found.verdict
    assert {"energy_balance", "cycle_loss"} <= set(found.checks)
    ends = [step.cycle for step in found.steps if step.cycle is not None]
    assert ends[-1].kind == "steady loop"
    assert ends[-1].change <= 1e-12
    assert len(ends) <= 4
    loop = found.steps[-CYCLES.increments - 1 :]
    times = np.array([step.load_factor for step in loop])
    moved = WAY * np.interp(times % 4, (0, 2, 4), (-1, 1, -1))
    forces = np.array([step.quantities["friction_force"][0] for step in loop])
    area = abs(np.sum((forces[1:] + forces[:-1]) / 2 * np.diff(moved)))
    lost = loop[-1].quantities["friction_work"] - loop[0].quantities["friction_work"]
    assert lost == pytest.approx(area, rel=0.06)  # of 8 increments


def written(made: Run, out, resume: bool = False):
    """The result of a run with its files."""
    files.require_writable(out, COMM)
    state = StateFile(out, made.problem)
    return files.solve_and_write(made, out, state, state.load() if resume else None)


def test_cycles_go_on_where_a_run_ended(folder) -> None:
    """Forces at the points are kept: the answer is that of the run that was not interrupted."""
    short, long = (
        dataclasses.replace(RUBBED, cycles=dataclasses.replace(CYCLES, number=n, until="end"))
        for n in (1, 2)
    )
    written(Run(short, COMM, body()), folder / "out")
    found = written(Run(long, COMM, body()), folder / "out", resume=True)
    expected = Run(long, COMM, body()).solve()
    assert found.passed, found.verdict
    assert len(found.steps) == len(expected.steps)
    for name in ("friction_force", "normal_force", "friction_work", "slip_area"):
        value = expected.quantities[name]
        assert found.quantities[name] == pytest.approx(value, rel=1e-10, abs=1e-12), name
