"""A run that goes on from a locked bolt keeps its unstressed length."""

import dataclasses

import pytest
from mpi4py import MPI

from fenics_contact import Run, Steps
from fenics_contact.simulation.state_file import StateFile
from tests.preload.joints import joint
from tests.preload.test_joint import scene

COMM = MPI.COMM_WORLD


@pytest.mark.parametrize("reached", [1.0, 1.5])
def test_resumed_run_keeps_the_unstressed_length(reached, tmp_path):
    folder = COMM.bcast(tmp_path)
    of = scene(pulled=8.0)
    first = dataclasses.replace(of, steps=Steps(times=(0.5, 1.0, 1.5)[: 2 if reached == 1 else 3]))
    begun = Run(first, COMM, joint())
    assert begun.solve(StateFile(folder, begun.problem)).converged
    rest = Run(of, COMM, joint())
    file = StateFile(folder, rest.problem)
    resumed = rest.solve(file, file.load())
    whole = Run(
        dataclasses.replace(of, steps=Steps(times=(0.5, 1.0, 1.5, 2.0))), COMM, joint()
    ).solve()
    assert resumed.converged, resumed.verdict
    mine, theirs = resumed.preloads["bolt"], whole.preloads["bolt"]
    assert mine.locked
    assert mine.elongation == pytest.approx(theirs.elongation, rel=1e-9)
    assert mine.force == pytest.approx(theirs.force, rel=1e-9)
    for name in ("external_work", "strain_energy"):
        assert resumed.quantities[name] == pytest.approx(whole.quantities[name], rel=1e-9), name
