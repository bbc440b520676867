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


def test_time_left():
    """Work that goes evenly from when it was first told of; it begins anew where it falls."""
    clock = [0.0]
    left = progress.TimeLeft(lambda: clock[0])
    for now, share, words in (
        (0.0, None, ""),
        (10.0, 0.2, ""),  # how long the first fifth took nobody has said
        (10.5, 0.21, ""),  # too little is done to tell
        (40.0, 0.6, " (about 0:30 left)"),
        (100.0, 0.8, " (about 0:30 left)"),
        (110.0, 1.0, ""),
        (200.0, 0.0, ""),
        (300.0, 0.5, " (about 1:40 left)"),
        (310.0, None, ""),
    ):
        clock[0] = now
        left.note(share)
        assert left.words == words, now


def test_estimates_say_how_long_they_take(monkeypatch, caplog):
    """Load steps of a history that is solved for an estimate say nothing of the run."""
    monkeypatch.setattr(progress, "_FIRST", 0.02)
    monkeypatch.setattr(progress, "_LONGEST", 0.04)
    steps = logging.getLogger("fenics_contact.solve.load_steps")

    def said(words):
        wait_for(lambda: any(words in line for line in caplog.messages))
        assert any(words in line for line in caplog.messages), caplog.messages

    with caplog.at_level(logging.INFO), progress.activity(Steps(), COMM):
        steps.debug("  time 1 of 4", extra={"share": 0.0})
        steps.debug("  time 3 of 4", extra={"share": 0.5})
        said("time 3 of 4 (about 0:00 left)")
        doing(f"{ESTIMATING} by the mesh", 0.0)
        steps.debug("  time 1 of 4", extra={"share": 0.5})
        said("by the mesh: time 1 of 4")
        assert "left" not in caplog.messages[-1]
        doing(f"{ESTIMATING} by the penalty", 0.9)
        steps.debug("  time 2 of 4", extra={"share": 0.0})
        said("by the penalty: time 2 of 4 (about 0:00 left)")


def test_quiet_is_quiet(monkeypatch, caplog):
    monkeypatch.setattr(progress, "_FIRST", 0.01)
    with caplog.at_level(logging.INFO), progress.activity(Steps(), COMM, quiet=True):
        time.sleep(0.1)
    assert caplog.messages == []
