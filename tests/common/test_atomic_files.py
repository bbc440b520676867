"""Full disks, folders that go away: the file is named, and none is left half written.

Disks are full for real: what is written goes to /dev/full by a link of the name under which files
are begun.
"""

import json
import pathlib
import resource
import shutil
from contextlib import contextmanager

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Material, Run, Scene, Steps, Support, main
from fenics_contact.cli.commands import guarded
from fenics_contact.common.atomic_files import append, replace_file
from fenics_contact.common.errors import MachineError
from fenics_contact.report import report
from fenics_contact.report.contacts import film as animation
from fenics_contact.report.drawing import figures
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.state_file import StateFile
from tests.messages import refused, says
from tests.scenes import box_body

COMM = MPI.COMM_WORLD
FULL = "No space left on device"


def pushed(steps=1):
    """A block on a rough floor, in some load steps."""
    return Scene(
        kinematics="plane strain",
        material=Material(1000, 0.3),
        support=(Support("y1", {"x": 0.01, "y": -0.02}),),
        contact=(Contact("y0", friction_coefficient=0.4),),
        steps=Steps(number=steps, end=float(steps)),
    )


@pytest.fixture(scope="module")
def body():
    return box_body((4, 3), (1, 1))


@pytest.fixture(scope="module")
def prepared(body):
    return Run(pushed(), body=body)


def written(made, out, resume=False):
    """What ``fenics-contact run`` does once a scene is made ready: its exit code."""

    def work():
        files.require_writable(out, COMM)
        state = StateFile(out, made.problem)
        saved = state.load() if resume else None
        return files.solve_and_write(made, out, state, saved).exit_code

    return guarded(work)


def without_room_for(monkeypatch, name):
    """Link the name under which a file is begun to a device that is always full."""
    clear = files._clear

    def clear_and_link(folder, names):
        clear(folder, names)
        (folder / f".{name}").symlink_to("/dev/full")

    monkeypatch.setattr(files, "_clear", clear_and_link)


@pytest.mark.parametrize(
    "name",
    [
        *("steps.csv", "fields_p0_000001.vtu", "fields000001.pvtu", "fields.pvd"),
        *("state.npz", "contact.csv", "result.json"),
    ],
)
def test_full_disk_names_the_file_and_leaves_no_half_of_it(
    folder, prepared, monkeypatch, capsys, name
):
    out = folder / "out"
    without_room_for(monkeypatch, name)
    assert written(prepared, out) == 5
    said = COMM.bcast(capsys.readouterr().err)
    says("file_cannot_be_written", said, file=out / name)
    left = {path.name for path in out.iterdir()}
    assert name not in left and "result.json" not in left
    assert not [hidden for hidden in left if hidden.startswith(".")]


def test_full_disk_keeps_the_last_state(folder, body, monkeypatch, capsys):
    """And the run goes on from it when there is room."""
    out = folder / "out"
    assert written(Run(pushed(2), body=body), out) == 0
    before = (out / "state.npz").read_bytes()
    longer = Run(pushed(3), body=body)
    with monkeypatch.context() as patch:
        without_room_for(patch, "state.npz")
        assert written(longer, out, resume=True) == 5
    assert FULL in COMM.bcast(capsys.readouterr().err)
    assert (out / "state.npz").read_bytes() == before
    COMM.barrier()
    assert written(Run(pushed(3), body=body), out, resume=True) == 0
    result = json.loads((out / "result.json").read_text())
    assert [step["load_factor"] for step in result["steps"]] == [1, 2, 3]


@contextmanager
def files_up_to(size):
    """No file of this process may grow beyond some bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.serial
def test_a_row_is_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "steps.csv"
    replace_file(path, b"step\n1\n")
    append(path, b"2\n")
    with files_up_to(12), refused("table_cannot_be_written", MachineError):
        append(path, b"3333333333\n")  # four bytes of it fit
    assert path.read_bytes() == b"step\n1\n2\n"
    with files_up_to(12), refused("table_cannot_be_written", MachineError):
        replace_file(path, b"step\n1\n22222222\n")
    assert path.read_bytes() == b"step\n1\n2\n"
    assert [found.name for found in tmp_path.iterdir()] == ["steps.csv"]
    path.unlink()
    with refused("table_is_not_there", MachineError):
        append(path, b"3\n")  # not a table without its head
    assert not path.exists()


def test_folder_that_goes_away_is_not_made_anew(folder, prepared, monkeypatch, capsys):
    out, add = folder / "out", files.StepFiles.add

    def add_and_remove(steps):
        add(steps)
        if COMM.rank == 0:
            shutil.rmtree(out)
        COMM.barrier()

    monkeypatch.setattr(files.StepFiles, "add", add_and_remove)
    assert written(prepared, out) == 5
    said = COMM.bcast(capsys.readouterr().err)
    says("folder_is_gone", said)
    assert not out.exists()


def test_folder_that_cannot_be_written_is_bad_input(prepared, capsys):
    for out in ("/proc/nothing/out", "/dev/full/out"):  # to root, too
        assert written(prepared, pathlib.Path(out)) == 2
        says("out_cannot_be_written_to", COMM.bcast(capsys.readouterr().err), out=out)


@pytest.mark.serial
def test_pictures_and_pages_on_a_full_disk(tmp_path, prepared, monkeypatch, capsys):
    out = tmp_path / "out"
    assert written(prepared, out) == 0
    for name in ("draw_pictures", "draw_convergence"):
        monkeypatch.setattr(report, name, lambda folder, result: [])
    (out / ".report.html").symlink_to("/dev/full")
    assert main(["report", str(out)]) == 5
    said = capsys.readouterr().err
    says("file_cannot_be_written", said, file=out / "report.html")
    assert not (out / "report.html").exists() and (out / "result.json").exists()
    for name in ("contact_0.png", "animation_0.gif"):
        (out / f".{name}").symlink_to("/dev/full")
    figure, _ = figures.new_figure("", (1, 1))
    with refused("picture_cannot_be_written", MachineError):
        figures.save(figure, out / "contact_0.png")
    frames = [np.zeros((9, 9, 3), dtype=np.uint8)] * 2
    with refused("animation_cannot_be_written", MachineError):
        animation.write_gif(frames, out / "animation_0.gif")
    assert not list(out.glob("*.png")) and not list(out.glob("*.gif"))
