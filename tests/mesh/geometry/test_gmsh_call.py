"""Gmsh is given so much time and memory, and nothing of it is left when that is used up."""

import dataclasses
import logging
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest
from mpi4py import MPI

from fenics_contact import InputError, MeshSource, main
from fenics_contact.common.errors import StoppedError
from fenics_contact.common.failures import Interrupts
from fenics_contact.common.failures import requested as stop_requested
from fenics_contact.mesh.geometry import gmsh_call
from fenics_contact.mesh.loading import load_body
from tests.mesh.test_loading import RECTANGLE, refusal, write
from tests.messages import refused, says
from tests.scenes import ROOT, SLAB

COMM = MPI.COMM_WORLD
ENDLESS = "x = 0;\nFor i In {0:1e9}\n  x += 1;\nEndFor\n"
SCENE = """
kinematics = "plane strain"
mesh = { file = "g.geo", time_limit = 2 }
material = { youngs_modulus = 1, poissons_ratio = 0.3 }
"""


def processes_of(folder):
    """Command lines of Gmsh's processes that know of a folder; others may run beside these."""
    found = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            line = path.read_bytes().decode(errors="replace")
        except OSError:  # it has ended
            continue
        if f"{folder}/" in line and "gmsh_process" in line:
            found.append(line)
    return found


def left():
    """Folders for Gmsh that are there."""
    return set(Path(tempfile.gettempdir()).glob("fenics_contact_*"))


def left_by_run(place):
    """What a run that was killed left of Gmsh's; Open MPI leaves a folder of its own."""
    return [path for path in place.rglob("*") if not re.search(r"/(ompi|prte|pmix)\b", str(path))]


@pytest.fixture
def temporary(folder, monkeypatch):
    """A place of this test alone for temporary files."""
    place = folder / "tmp"
    if COMM.rank == 0:
        place.mkdir()
    COMM.barrier()
    monkeypatch.setattr(tempfile, "tempdir", str(place))
    return place


@pytest.mark.parametrize(
    "text",
    [
        ENDLESS,
        "Macro a\n  Call a;\nReturn\nIf (0)\nEndIf\n" + ENDLESS,
        "Mesh.MeshSizeMax = 1e-5;\n",
    ],
    ids=["loop", "macro", "size"],
)
def test_meshing_that_does_not_end_is_one_sentence_on_every_rank(folder, temporary, text):
    source = dataclasses.replace(write(folder, RECTANGLE + text), time_limit=1.5)
    began = time.monotonic()
    said = refusal(source)
    says("gmsh_is_not_done", said, limit="mesh.time_limit = 1.5 s")
    assert "fenics_contact_" not in said  # but the user's name of the file
    assert time.monotonic() - began < 30  # also where other programs run
    assert not processes_of(folder) and not left()


def test_the_limit_is_of_each_mesh_and_of_reading(folder, temporary, monkeypatch):
    """A process that only waits, whatever it is to do."""
    write(folder, "import time\ntime.sleep(100)\n", "gmsh_process.py")
    monkeypatch.setattr(gmsh_call, "__file__", str(folder / "gmsh_call.py"))
    sources = [MeshSource(SLAB, name="a"), MeshSource(SLAB, name="b", time_limit=0.5)]
    assert "mesh[1].time_limit = 0.5 s" in refusal([sources[1], sources[0]]).replace("[0]", "[1]")
    write(folder, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "a.msh")
    assert "mesh.time_limit = 0.3 s" in refusal(MeshSource(str(folder / "a.msh"), time_limit=0.3))
    bracket = str(ROOT / "meshes" / "bracket.step")
    assert "mesh.time_limit = 0.3 s" in refusal(MeshSource(bracket, time_limit=0.3), 3)
    assert not processes_of(folder) and not left()


def test_check_ends_at_the_limit_with_2(folder, temporary, capfd):
    write(folder, RECTANGLE + ENDLESS)
    write(folder, SCENE, "s.toml")
    assert main(["check", str(folder / "s.toml")]) == 2
    said = COMM.bcast(capfd.readouterr().err)
    assert said.count("\n") == 1 and "mesh.time_limit = 2 s" in said
    assert not processes_of(folder) and not left()


def test_size_beyond_all_memory_is_one_sentence(folder, temporary, monkeypatch):
    monkeypatch.setattr(gmsh_call, "free_memory", lambda: 2e8)
    said = refusal(dataclasses.replace(write(folder, RECTANGLE), size=1e-9, time_limit=100))
    says("gmsh_needs_more_memory", said)
    assert not processes_of(folder) and not left()


def test_progress_is_told_and_quiet_is_quiet(folder, temporary, caplog, monkeypatch):
    monkeypatch.setattr(gmsh_call, "_FIRST_WORD", 0.1)
    source = dataclasses.replace(write(folder, RECTANGLE), size=2e-2, time_limit=60)
    with caplog.at_level(logging.DEBUG, logger="fenics_contact"):
        load_body(source, 2, COMM)
    told = [record for record in caplog.records if record.name == gmsh_call.__name__]
    if COMM.rank == 0:
        levels = {record.levelname: record.getMessage() for record in told}
        assert re.search(r"Gmsh works for \d+ s of mesh.time_limit = 60 s", levels["INFO"])
        assert any(re.match(r"Gmsh: .*Mesh", record.getMessage()) for record in told)
    else:
        assert not told


# Another user, where the tests are root's, to whom the system allows any number of processes.
AS_OTHER_USER = """
import gmsh, io, os, re, resource, signal, sys, tempfile
from fenics_contact.mesh.geometry import bodies, preparations, process_room
import numpy as np
np.savez(io.BytesIO(), a=np.zeros(2))
program = open({path!r}).read()
if os.getuid() == 0:
    os.chown(".", 65534, 65534)
    os.setgid(65534)
    os.setuid(65534)
exec(compile(program.replace({merge!r}, {change!r}), {path!r}, "exec"))
"""


@pytest.mark.serial
@pytest.mark.parametrize("starts", [True, False])
def test_no_program_can_be_started_and_threads_need_none(folder, temporary, monkeypatch, starts):
    """The second line of defence; and algorithms of Gmsh that use threads work behind it."""
    path = str(Path(gmsh_call.__file__).with_name("gmsh_process.py"))
    merge = '    gmsh.merge(job["file"])'
    change = '    gmsh.merge("1.geo")'  # from the working folder: others above may be closed
    if starts:
        change = f"    assert os.fork() >= 0\n{change}"
    write(folder, AS_OTHER_USER.format(path=path, merge=merge, change=change), "gmsh_process.py")
    monkeypatch.setattr(gmsh_call, "__file__", str(folder / "gmsh_call.py"))
    text = 'SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1, 1, 1};\nMesh.Algorithm3D = 10;\n'
    source = write(folder, text + "Mesh.MaxNumThreads3D = 4;\nMesh.MeshSizeMax = 0.3;\n")
    if starts:
        assert "Resource temporarily unavailable" in refusal(source, 3)
    else:
        assert load_body(source, 3, COMM).mesh.topology.index_map(3).size_global > 100


def test_a_mark_to_stop_ends_meshing(folder, temporary):
    """As in a run that makes mesh after mesh, where signals only set a mark."""
    source = write(folder, RECTANGLE + ENDLESS)
    with Interrupts() as marked:
        if COMM.rank == 0:
            marked._requested = True
        with pytest.raises(StoppedError):
            load_body(source, 2, COMM)
    assert not stop_requested()
    assert not processes_of(folder) and not left()


@pytest.mark.serial
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_nothing_outlives_a_run_that_is_stopped(folder, number):
    write(folder, RECTANGLE + ENDLESS)
    write(folder, SCENE.replace("time_limit = 2", "time_limit = 100"), "s.toml")
    (folder / "tmp").mkdir()
    command = [sys.executable, "-m", "fenics_contact", "check", str(folder / "s.toml")]
    environment = os.environ | {"TMPDIR": str(folder / "tmp")}
    with subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        env=environment,
        cwd=ROOT,
        # What a shell starts in the background does not hear it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as run:
        end = time.monotonic() + 60
        while not processes_of(folder) and time.monotonic() < end:
            time.sleep(0.1)
        assert processes_of(folder)
        time.sleep(0.5)
        run.send_signal(number)
        _, said = run.communicate(timeout=30)
    assert run.returncode in ((130,) if number == signal.SIGINT else (number, -number))
    assert b"Traceback" not in said
    end = time.monotonic() + 10
    while (processes_of(folder) or left_by_run(folder / "tmp")) and time.monotonic() < end:
        time.sleep(0.1)
    assert not processes_of(folder) and not left_by_run(folder / "tmp")


def test_file_that_crashes_gmsh_is_one_sentence(folder, temporary, monkeypatch):
    write(folder, "import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n", "gmsh_process.py")
    monkeypatch.setattr(gmsh_call, "__file__", str(folder / "gmsh_call.py"))
    says("gmsh_crashed", refusal(MeshSource(SLAB)))
    assert not left()


def test_time_limit_is_more_than_nothing():
    with refused("time_limit_is_zero", (InputError, ValueError)):
        MeshSource(SLAB, time_limit=0)
