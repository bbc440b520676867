"""Without a terminal: a line now and then, of what is being done meanwhile."""

import logging
import re
import time

import pytest
from mpi4py import MPI

from fenics_contact.cli import progress
from fenics_contact.common.timings import ESTIMATING, doing
from fenics_contact.scene.scene import Steps

pytestmark = pytest.mark.serial
COMM = MPI.COMM_SELF


def wait_for(condition):
    end = time.monotonic() + 5
    while not condition() and time.monotonic() < end:
        time.sleep(0.005)


def test_what_takes_long_says_so_now_and_then(monkeypatch, caplog):
    monkeypatch.setattr(progress, "_FIRST", 0.02)
    monkeypatch.setattr(progress, "_LONGEST", 0.04)
    with caplog.at_level(logging.INFO), progress.activity(Steps(), COMM) as announce:
        assert announce is None
        doing("making the mesh")
        wait_for(lambda: any("making the mesh" in line for line in caplog.messages))
        doing(f"{ESTIMATING} by the mesh")
        logging.getLogger("fenics_contact.solve").debug("  Newton step 3")
        wait_for(lambda: any("Newton" in line for line in caplog.messages))
    said = "making ready|making the mesh|estimating errors by the mesh(: Newton step 3)?"
    assert all(re.fullmatch(rf"  after 0:\d\d: ({said})", line) for line in caplog.messages)
    assert caplog.messages[-1].endswith(f": {ESTIMATING} by the mesh: Newton step 3")
    before = len(caplog.messages)
    time.sleep(0.1)
    assert len(caplog.messages) == before  # it ends with the run


def test_where_others_say_enough_it_is_silent(monkeypatch, caplog):
    monkeypatch.setattr(progress, "_FIRST", 0.3)
    with caplog.at_level(logging.INFO), progress.activity(Steps(), COMM):
        end = time.monotonic() + 0.5
        while time.monotonic() < end:
            logging.getLogger("fenics_contact.simulation").info("step")
            time.sleep(0.02)
    assert set(caplog.messages) == {"step"}


def test_quiet_is_quiet(monkeypatch, caplog):
    monkeypatch.setattr(progress, "_FIRST", 0.01)
    with caplog.at_level(logging.INFO), progress.activity(Steps(), COMM, quiet=True):
        time.sleep(0.1)
    assert caplog.messages == []
