"""With real processes: side by side, killed, and interrupted."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import main
from fenics_contact.simulation.sweeps.journal import NAME
from tests.messages import says
from tests.scenes import ROOT
from tests.simulation.sweeps.inline import MU, SLAB, inline, rows_of, summary_of

assert inline  # a fixture
NUMBER = 24
POINTS = f"{MU}=0.01:0.6:{NUMBER}"


@pytest.fixture
def scene(folder):
    path = folder / "slab.toml"
    if MPI.COMM_WORLD.rank == 0:
        path.write_text(SLAB.format(mesh=ROOT / "meshes" / "slab.geo"))
    MPI.COMM_WORLD.barrier()
    return path


def start(*words):
    command = [sys.executable, "-m", "fenics_contact", "sweep", *map(str, words)]
    return subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True)


def wait_for(condition, process, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.02)


def workers_of(process):
    """Processes that a sweep has started."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[1]) == process.pid and fields[0] != "Z":
            found.append(int(path.parent.name))
    return found


def is_gone(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


@pytest.mark.serial
def test_two_processes_share_one_body_and_one_mesh(scene, folder, capsys):
    """A mesh is made once, and each process makes a body of it."""
    out = folder / "out"
    words = ["sweep", str(scene), "--vary", f"{MU}=0.1,0.2,0.3,0.4", "--jobs", "2"]
    assert main([*words, "--out", str(out)]) == 0
    assert "4 points: 4 passed" in capsys.readouterr().out
    assert [row["exit_code"] for row in rows_of(out)] == ["0"] * 4
    for row in rows_of(out):
        held = float(row["friction_force_x"]) + float(row["left.reaction_x"])
        assert held == pytest.approx(300, rel=1e-9)
    assert 1 <= summary_of(out)["bulk_factorisations"] <= 2


@pytest.mark.serial
def test_killed_it_goes_on_and_leaves_no_process(scene, folder, inline):
    """First one of its processes, then itself; and interrupted."""
    out = folder / "out"
    words = (scene, "--vary", POINTS, "--out", out, "--jobs", 1)
    process = start(*words)
    journal = out / NAME

    def has_grown(by):
        before = journal.stat().st_size if journal.exists() else 0
        return lambda: journal.exists() and journal.stat().st_size > before + by

    wait_for(has_grown(0), process)
    (worker,) = workers_of(process)
    os.kill(worker, signal.SIGKILL)
    wait_for(lambda: workers_of(process) not in ([], [worker]), process)
    (second,) = workers_of(process)
    wait_for(has_grown(0), process)
    process.kill()
    process.wait()
    end = time.monotonic() + 20
    while not is_gone(second) and time.monotonic() < end:
        time.sleep(0.05)
    assert is_gone(second)
    assert not (out / "sweep.csv").exists()

    process = start(*words, "--resume")
    wait_for(has_grown(0), process)
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 130, said
    assert "stopping at the last point that is done" in said
    codes = [row["exit_code"] for row in rows_of(out)]
    assert {"0", "130"} <= set(codes)
    assert main(["sweep", *map(str, words), "--resume", "--quiet"]) == 0  # by this process
    assert [row["exit_code"] for row in rows_of(out)] == ["0"] * NUMBER


def test_on_several_ranks_it_is_refused(scene, folder, capsys):
    if MPI.COMM_WORLD.size == 1:
        pytest.skip("of several ranks")
    out = folder / "out"
    assert main(["sweep", str(scene), "--vary", f"{MU}=0.1,0.2", "--out", str(out)]) == 2
    said = MPI.COMM_WORLD.bcast(capsys.readouterr().err)
    says("sweep_on_several_ranks", said)
    assert said.count("\n") == 1
    assert not out.exists()
