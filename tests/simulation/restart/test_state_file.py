"""Runs that are killed, stopped or moved to other ranks, and go on as if nothing had happened."""

import dataclasses
import fcntl
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress

import numpy as np
import pytest
from dolfinx.mesh import CellType
from mpi4py import MPI

from fenics_contact import (
    Contact,
    Coupling,
    Discretisation,
    Load,
    Material,
    Motion,
    Obstacle,
    ObstacleRotation,
    Path,
    Run,
    Scene,
    SpeedDependentFriction,
    Spring,
    Steps,
    Support,
    main,
)
from fenics_contact.common.errors import MachineError
from fenics_contact.common.failures import Interrupts
from fenics_contact.simulation import row_tables, state_file
from fenics_contact.simulation.state_file import StateFile
from tests.messages import refused, says
from tests.problem.sectors import fitted, hub_on_shaft
from tests.scenes import PULLED_BLOCK, ROOT, box_body
from tests.simulation.motion.test_coupled_motion import body as swinging_body
from tests.simulation.motion.test_coupled_motion import swinging
from tests.simulation.motion.test_preloads import joint, joint_body
from tests.solve.load_steps.histories import block, dragged, require_same, shoved, two_blocks
from tests.traffic import counted

COMM = MPI.COMM_WORLD
STEPS = Steps(number=6)


def tetrahedra(comm=COMM):
    return box_body((3, 2, 2), cell=CellType.tetrahedron, comm=comm)


SOLID = dataclasses.replace(
    PULLED_BLOCK,
    load=(Load("x0", traction=(30, 10, 0), path=Path((0, 0.5, 1), (0, 1, -0.5))),),
    contact=(dataclasses.replace(PULLED_BLOCK.contact[0], law="incremental"),),
    steps=STEPS,
)
ALWAYS = Path((0,), (1,))
KICKED = Scene(
    kinematics="3D",
    material=Material(1e3, 0.3, density=1.0),
    discretisation=Discretisation(1),
    load=(Load("body", body_force=(0, 1, -10), path=ALWAYS),),
    contact=(
        Contact(
            "z0",
            obstacle=Obstacle("plane", position=(0, 0, 0), normal=(0, 0, 1)),
            friction_coefficient=0.3,
            law="incremental",
            friction_law=SpeedDependentFriction("speed dependent", (0, 1), (1, 0.5)),
        ),
    ),
    motion=Motion(step=0.01, end=0.06, velocity={"body": (0.5, 0, 0)}, start="static"),
)
RIM = Coupling(
    "hub.y1", at=(0, 0), name="rim", moment=12.0, path=Path((0, 0.3, 0.7, 1), (0, 0, 1, 0.6))
)
SECTOR = dataclasses.replace(
    fitted(False, law="incremental"),
    load=(),
    coupling=(RIM,),
    spring=(Spring(("rim", "ground"), rotational_stiffness=50.0),),
    steps=STEPS,
)
TURNED = {"force": 5.0, "moment": 0.3, "rotation": ObstacleRotation(at=(0.5, 1.5))}
AUTOMATIC = Steps(number=4, automatic=True)
SCENES = {
    "incremental": (dragged(STEPS), block),
    "full": (dragged(STEPS, solver="full"), block),
    "automatic": (dragged(AUTOMATIC), block),
    "force": (dragged(STEPS, driven={"force": 5.0}), block),
    "moment": (dragged(STEPS, driven=TURNED), block),
    "nearly incompressible": (dragged(STEPS, solid=0.499), block),
    "nearly incompressible, full": (dragged(STEPS, solid=0.499, solver="full"), block),
    "two bodies": (shoved(STEPS), two_blocks),
    "centres of tetrahedra": (SOLID, tetrahedra),
    "exact": (shoved(STEPS, strategy="exact"), two_blocks),
    "motion": (KICKED, tetrahedra),
    "bolt in motion": (joint(6.0, end=0.012), joint_body),
    "coupled in motion": (swinging(), swinging_body),
    "coupled in a sector": (SECTOR, lambda comm=COMM: hub_on_shaft(1, comm=comm)),
}


def silent(number, step):
    """Nothing to be said of a step."""


def stopped_after(scene, body, folder, count):
    """A run that is stopped after some steps; its state is in the folder."""
    run, done = Run(scene, body.mesh.comm, body), []
    run.solve(
        StateFile(folder, run.problem),
        stopped=lambda: len(done) == count,
        announce=lambda number, step: done.append(number),
    )
    return run


def resumed(scene, body, folder):
    run = Run(scene, body.mesh.comm, body)
    saved = StateFile(folder, run.problem).load()
    assert saved is not None
    return run.solve(saved=saved, announce=silent)


@pytest.mark.parametrize(
    "name",
    [
        *("automatic", "nearly incompressible, full", "two bodies", "centres of tetrahedra"),
        *("exact", "motion", "bolt in motion", "coupled in motion", "coupled in a sector"),
    ],
)
def test_a_run_goes_on_on_other_ranks(name, folder, monkeypatch):
    """From one rank to all, and from all to one; of the file, ranks get a few rows at a time."""
    monkeypatch.setattr(row_tables, "_MOST_ROWS", 7)
    scene, body = SCENES[name]
    whole = Run(scene, COMM, body()).solve(announce=silent)
    if COMM.rank == 0:
        stopped_after(scene, body(MPI.COMM_SELF), folder / "one", 4)
    stopped_after(scene, body(), folder / "all", 4)
    COMM.barrier()
    require_same(resumed(scene, body(), folder / "one"), whole)
    require_same(resumed(scene, body(MPI.COMM_SELF), folder / "all"), whole)


class CountedFile(StateFile):
    """A state file that knows the most bytes that a rank got at once."""

    peak = 0

    def save(self, *state):
        with counted() as traffic:
            super().save(*state)
        self.peak = max(self.peak, traffic.peak)

    def end_and_load(self):
        with counted() as traffic:
            self.finish(0)
            assert self.load() is not None
        return COMM.allreduce(max(self.peak, traffic.peak), op=MPI.MAX)


def test_no_rank_gets_all_rows_of_a_state(folder, monkeypatch):
    """What passes at a time is a block, however large the body is."""
    monkeypatch.setattr(row_tables, "_MOST_ROWS", 20)
    scene, peaks = SCENES["incremental"][0], []
    for depth in (6, 96):
        run = Run(scene, COMM, box_body((8, depth), (1, 1)))
        state, done = CountedFile(folder / str(depth), run.problem), []
        run.solve(state, stopped=lambda n=done: bool(n), announce=lambda n, _, d=done: d.append(n))
        peaks.append(state.end_and_load())
    nodes = run.problem.spaces.displacement_space.dofmap.index_map.size_global
    assert peaks[1] < min(1.1 * peaks[0], 16 * nodes)  # less than one displacement field


@pytest.mark.parametrize("name", ["automatic", "force", "moment", "full", "nearly incompressible"])
def test_a_run_goes_on_where_it_was_stopped(name, folder):
    """Also by the same Newton steps: the prediction and the size of the next step are kept."""
    scene, body = SCENES[name]
    whole = Run(scene, COMM, body()).solve(announce=silent)
    assert whole.converged
    stopped_after(scene, body(), folder, 5 if name == "automatic" else 4)
    found = resumed(scene, body(), folder)
    assert found.exit_code == whole.exit_code
    require_same(found, whole)
    assert len(found.steps) == len(whole.steps)
    for one, other in zip(found.steps, whole.steps, strict=True):
        assert one["newton_iterations"] == other["newton_iterations"]
        assert one["load_factor"] == pytest.approx(other["load_factor"], rel=1e-12)
        work = one["quantities"]["friction_work"], other["quantities"]["friction_work"]
        assert work[0] == pytest.approx(work[1], rel=1e-9, abs=1e-15)


def test_a_motion_goes_on_with_steps_of_the_same_length_only(folder):
    """Also where it did not stop at a step whose state was written before."""
    scene, body = SCENES["motion"]
    longer = dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, end=0.08))
    stopped_after(scene, body(), folder, 4)
    require_same(resumed(longer, body(), folder), Run(longer, COMM, body()).solve(announce=silent))
    other = dataclasses.replace(scene, motion=dataclasses.replace(scene.motion, end=0.065))
    with refused("resume_with_another_time_step"):
        resumed(other, body(), folder)


def test_a_run_that_stops_at_once_after_resuming_has_its_last_step(folder):
    scene, body = SCENES["two bodies"]
    stopped = stopped_after(scene, body(), folder, 4)
    run = Run(scene, COMM, body())
    saved = StateFile(folder, run.problem).load()
    found = run.solve(saved=saved, stopped=lambda: True)
    assert found.exit_code == 130 and len(found.steps) == 4
    require_same(found, stopped._result.evaluate())


def test_more_steps_and_another_solver_may_follow(folder):
    scene, body = SCENES["incremental"]
    stopped_after(scene, body(), folder, 3)
    changed = dragged(Steps(times=(0.25, 0.5, 0.7, 1)), solver="full")
    found = resumed(changed, body(), folder)
    assert [round(step["load_factor"], 6) for step in found.steps[3:]] == [0.7, 1]
    assert found.passed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"material": (Material(1001, 0.3),)}, "resume_with_another_material"),
        (
            {"support": (Support("y0", {"x": 0, "y": 0.0}, path=lambda t: t),)},
            "resume_other_support",
        ),
        ({"thickness": 2.0, "kinematics": "plane stress"}, "resume_with_other_kinematics"),
    ],
)
def test_another_scene_is_refused(folder, change, words):
    scene, body = SCENES["incremental"]
    stopped_after(scene, body(), folder, 2)
    with refused(words):
        resumed(dataclasses.replace(scene, **change), body(), folder)


def test_a_key_that_is_left_out_is_a_difference(folder):
    scene, body = SCENES["bolt in motion"]
    stopped_after(scene, body(), folder, 2)
    with refused("resume_with_another_preload"):
        resumed(dataclasses.replace(scene, preload=()), body(), folder)


def test_another_mesh_or_version_is_refused(folder, monkeypatch):
    scene, body = SCENES["incremental"]
    stopped_after(scene, body(), folder, 2)
    for other in (box_body((6, 8), (1, 1)), box_body((8, 6), (1, 1 + 1e-9))):
        with refused("resume_on_another_mesh"):
            resumed(scene, other, folder)
    versions = state_file.compat.versions()
    monkeypatch.setattr(state_file.compat, "versions", lambda: {**versions, "fenics_contact": "7"})
    with refused("resume_of_another_version"):
        resumed(scene, body(), folder)


def test_another_format_is_refused(folder, monkeypatch):
    scene, body = SCENES["incremental"]
    with monkeypatch.context() as patch:
        patch.setattr(state_file, "_FORMAT", 3)
        stopped_after(scene, body(), folder, 2)
    with refused("resume_of_another_format"):
        resumed(scene, body(), folder)


def test_a_single_step_is_no_beginning_of_several(folder):
    """What a history is, its works among others, is decided before its first step."""
    scene, body = SCENES["incremental"]
    stopped_after(scene, body(), folder, 2)
    with refused("resume_of_a_single_step"):
        resumed(dataclasses.replace(scene, steps=Steps()), body(), folder)


def test_other_contact_facets_are_refused(folder):
    def patched(width):
        return box_body(
            (8, 6), (1, 1), patches={"pad": ("y1", lambda x: np.abs(x[0] - 0.5) < width)}
        )

    scene, _ = SCENES["incremental"]
    contact = dataclasses.replace(scene.contact[0], on="pad")
    scene = dataclasses.replace(scene, contact=(contact,))
    stopped_after(scene, patched(0.3), folder, 2)
    with refused("resume_with_other_facets"):
        resumed(scene, patched(0.45), folder)


@pytest.mark.serial
def test_damaged_files_are_refused(tmp_path):
    path = tmp_path / "state.npz"
    seal(path, {"a": 1})
    assert row_tables.read_header(path) == {"a": 1}
    whole = path.read_bytes()
    for damaged in (whole[:-30], whole[: len(whole) // 2], b"", b"no archive", _flipped(whole)):
        path.write_bytes(damaged)
        with refused("resume_of_a_damaged_state"):
            row_tables.read_header(path)
    # The archive is whole, what is in it is not what was written.
    with np.load(tmp_path / _saved(tmp_path, whole)) as file:
        arrays = {name: file[name] for name in file.files}
    np.savez(path, **(arrays | {"b": arrays["b"] + 1e-16 + 1}))
    with refused("resume_of_a_damaged_state"):
        row_tables.read_header(path)


def seal(path, header):
    with row_tables.replaced_arrays(path) as new:
        new.add("b", np.arange(1000.0))
        new.seal(header)


@pytest.mark.serial
def test_a_header_is_replaced_and_the_arrays_stay(tmp_path):
    path = tmp_path / "state.npz"
    seal(path, {"a": 1})
    row_tables.replace_header(path, {"a": 2})
    assert row_tables.read_header(path) == {"a": 2}
    np.testing.assert_array_equal(row_tables.read_arrays(path, ["b"])[0], np.arange(1000.0))


def _flipped(whole):
    middle = len(whole) // 2
    return whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]


def _saved(folder, contents):
    (folder / "whole.npz").write_bytes(contents)
    return "whole.npz"


@pytest.mark.serial
@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_a_write_that_ends_half_way_leaves_the_old_file(tmp_path, monkeypatch, failing):
    path = tmp_path / "state.npz"
    seal(path, {"step": 1})

    def die(*arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, failing, die)
    with refused("state_cannot_be_written", MachineError):
        seal(path, {"step": 2})
    assert row_tables.read_header(path) == {"step": 1}
    assert [found.name for found in tmp_path.iterdir()] == ["state.npz"]


SCENE = f"""
kinematics = "plane strain"
mesh = {{ file = "{ROOT / "meshes" / "slab.geo"}", parameters = {{ cells_along = 16 }} }}
material = {{ youngs_modulus = 1000, poissons_ratio = 0.3 }}
steps = {{ number = 40, end = 8 }}
[[support]]
on = "bottom"
displacement = {{ y = 0 }}
[[support]]
on = "left"
displacement = {{ x = 0 }}
[[load]]
on = "right"
traction = [-300, 0]
path = {{ time = [0, 1, 3, 4], factor = [0, 1, -1, 0], cycles = 2 }}
[[contact]]
on = "top"
law = "incremental"
friction_coefficient = 0.3
pressure = 300
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The result of the run that nobody stops."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "scene.toml").write_text(SCENE)
    assert main(["run", str(folder / "scene.toml"), "--out", str(folder / "out"), "--quiet"]) == 0
    return json.loads((folder / "out" / "result.json").read_text())


def command(scene, out, *more, ranks=1):
    launcher = [] if ranks == 1 else ["mpirun", "-n", str(ranks)]
    if launcher:
        beside = os.path.join(os.path.dirname(sys.executable), "mpirun")
        launcher[0] = beside if os.path.exists(beside) else shutil.which("mpirun")
    program = [*launcher, sys.executable, "-m", "fenics_contact"]
    return [*program, "run", str(scene), "--out", str(out), *more]


def started(scene, out, *more, ranks=1):
    return subprocess.Popen(
        command(scene, out, *more, ranks=ranks),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env={**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)},
    )


def kill_ranks(out):
    """Of a launcher that was killed: Open MPI's ranks are in groups of their own, and live on."""
    while ranks := ranks_of(out):
        for rank in ranks:
            with suppress(ProcessLookupError):
                os.kill(rank, signal.SIGKILL)
        time.sleep(0.05)
    with open_folder(out) as folder:  # a rank that ends has lost its words before its files
        fcntl.flock(folder, fcntl.LOCK_EX)


@contextmanager
def open_folder(path):
    opened = os.open(path, os.O_RDONLY)
    try:
        yield opened
    finally:
        os.close(opened)


def ranks_of(out):
    """Numbers of the processes that run and write into a folder."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # it has just ended
            words = (folder / "cmdline").read_bytes().split(b"\0")
            if os.fsencode(out) in words and int(folder.name) != os.getpid():
                found.append(int(folder.name))
    return found


def wait_for_steps(process, out, seconds=0.0, begun=0):
    """Until a state is written that was not there before the process, and a moment more."""
    end = time.monotonic() + 60
    while written(out) <= begun and process.poll() is None and time.monotonic() < end:
        time.sleep(0.01)
    time.sleep(seconds)


def written(out):
    """When the state was, 0 if never (nanoseconds)."""
    return (out / "state.npz").stat().st_mtime_ns if (out / "state.npz").exists() else 0


def require_as_whole(out, whole):
    found = json.loads((out / "result.json").read_text())
    assert found["converged"]
    assert len(found["steps"]) == len(whole["steps"])
    for one, other in zip(found["steps"], whole["steps"], strict=True):
        for key, value in other["quantities"].items():
            size = max(1e-9 * np.abs(value).max(), 1e-9)
            assert np.abs(np.array(one["quantities"][key]) - value).max() <= size, key


@pytest.mark.serial
def test_killed_again_and_again(tmp_path, whole):
    """At random moments, writing among them: the state is written all the time."""
    scene, out = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(SCENE)
    for _ in range(2):
        begun = written(out)
        process = started(scene, out, "--resume")
        wait_for_steps(process, out, random.uniform(0, 0.2), begun)
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        assert process.returncode == -signal.SIGKILL  # it was at work
    assert main(["run", str(scene), "--out", str(out), "--resume", "--quiet"]) == 0
    require_as_whole(out, whole)


@pytest.mark.serial
def test_killed_on_two_ranks_and_resumed_on_one(tmp_path, whole):
    scene, out = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(SCENE)
    process = started(scene, out, ranks=2)
    wait_for_steps(process, out, random.uniform(0, 0.2))
    os.killpg(process.pid, signal.SIGKILL)
    kill_ranks(out)
    process.communicate()
    assert main(["run", str(scene), "--out", str(out), "--resume", "--quiet"]) == 0
    require_as_whole(out, whole)


@pytest.mark.serial
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_asked_to_stop(tmp_path, whole, number, capsys):
    """130 with files, then on two ranks to the end; and a finished run says so."""
    scene, out = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(SCENE)
    process = started(scene, out)
    wait_for_steps(process, out)
    process.send_signal(number)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert "stopping at the last load step" in said
    stopped = json.loads((out / "result.json").read_text())
    assert not stopped["converged"] and "--resume" in stopped["verdict"]
    assert (
        stopped["quantities"] and (out / "contact.csv").exists() and (out / "fields.pvd").exists()
    )
    if number == signal.SIGTERM:
        process = started(scene, out, "--resume", ranks=2)
        said = process.communicate(timeout=100)[1]
        assert process.returncode == 0
    else:
        assert main(["run", str(scene), "--out", str(out), "--resume"]) == 0
        said = capsys.readouterr().err
    assert "resuming after time" in said
    require_as_whole(out, whole)
    assert main(["run", str(scene), "--out", str(out), "--resume"]) == 0
    says("nothing_to_resume", capsys.readouterr().err)


@pytest.mark.serial
def test_one_rank_that_is_asked_stops_both(tmp_path):
    scene, out = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(SCENE)
    process = started(scene, out, ranks=2)
    wait_for_steps(process, out)
    ranks = subprocess.run(
        ["pgrep", "-f", f"^{sys.executable} -m fenics_contact run {scene}"],
        capture_output=True,
        text=True,
    ).stdout.split()
    assert len(ranks) == 2
    os.kill(int(ranks[1]), signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert not json.loads((out / "result.json").read_text())["converged"]


@pytest.mark.serial
def test_nothing_to_resume_from(tmp_path, capsys):
    scene, out = tmp_path / "scene.toml", tmp_path / "out"
    scene.write_text(SCENE.replace("number = 40, end = 8", "number = 2"))
    assert main(["run", str(scene), "--out", str(out), "--resume"]) == 0
    assert "beginning at the start" in capsys.readouterr().err
    (out / "state.npz").write_text("x")
    assert main(["run", str(scene), "--out", str(out), "--resume"]) == 2
    assert "is damaged" in capsys.readouterr().err
    assert main(["run", str(scene), "--out", str(out)]) == 0


@pytest.mark.serial
def test_handlers_of_before_come_back_and_the_second_signal_kills():
    before = signal.getsignal(signal.SIGINT)
    with Interrupts() as interrupts:
        assert not interrupts.requested()
        os.kill(os.getpid(), signal.SIGINT)
        assert interrupts.requested()
    assert signal.getsignal(signal.SIGINT) is before
    text = (
        "import os, signal\nfrom fenics_contact.common.failures import Interrupts\n"
        "with Interrupts():\n"
        "    os.kill(os.getpid(), signal.SIGTERM)\n    print('on', flush=True)\n"
        "    os.kill(os.getpid(), signal.SIGTERM)\n    print('still on', flush=True)\n"
    )
    killed = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, cwd=ROOT)
    assert killed.stdout == "on\n" and killed.returncode == -signal.SIGTERM
