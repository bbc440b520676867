"""Sweeps of scenes in files: their tables, what fails, and how they go on."""

import dataclasses
import json
import logging
import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from fenics_contact import load_scene, main, run
from fenics_contact.common.errors import MachineError, StoppedError
from fenics_contact.scene.reading import SceneFile
from fenics_contact.simulation.output import journal_file
from fenics_contact.simulation.output.journal_file import FolderLock
from fenics_contact.simulation.sweeps import journal, leader
from fenics_contact.simulation.sweeps.journal import Done
from fenics_contact.simulation.sweeps.processes import DiedError
from fenics_contact.simulation.sweeps.rows import row_of
from fenics_contact.simulation.sweeps.sweep import Sweep
from tests.messages import refused
from tests.scenes import ROOT
from tests.simulation.sweeps.inline import (
    MU,
    SLAB,
    InlineProcess,
    inline,
    rows_of,
    states_of,
    summary_of,
    swept,
)

assert inline  # a fixture
pytestmark = [pytest.mark.serial, pytest.mark.usefixtures("inline")]
LOAD = "load.0.traction.0"
GRID = [f"{MU}=0.2,0.3", f"{LOAD}=-300,-200,-100"]


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "slab.toml"
    path.write_text(SLAB.format(mesh=ROOT / "meshes" / "slab.geo"))
    return path


def test_the_table_has_a_row_for_each_point_as_run_gives_it(scene, tmp_path):
    sweep, solved = swept(scene, GRID, tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    assert [(float(row[MU]), float(row[LOAD])) for row in rows] == list(sweep.grid.values())
    assert solved == [0, 1, 2, 5, 4, 3]  # a snake
    states = states_of(tmp_path / "out")
    assert {len(array) for array in states.values()} == {len(states["point"])}
    assert states["point"].dtype.kind == "i" and states["status"].dtype == np.int8
    for number, row in enumerate(rows):
        settings = [f"{MU}={row[MU]}", f"{LOAD}={row[LOAD]}"]
        expected = run(load_scene(scene, settings))
        assert row.pop("exit_code") == "0"
        for name, value in row_of(expected).items():
            found = row.get(name, "")
            if value is None:
                assert found == "", name
            else:
                assert float(found) == pytest.approx(value, rel=1e-9, abs=1e-9 * 2400), name
        here = states["point"] == number
        points = expected.points
        assert states["x"][here].tolist() == points.coordinates[:, 0].tolist()
        assert states["traction_x"][here] == pytest.approx(points.friction_traction[:, 0])
        assert states["slip_x"][here] == pytest.approx(points.slip[:, 0], abs=1e-12)
        named = np.array(["OPEN", "STICK", "SLIP"])[states["status"][here]]
        assert named.tolist() == points.status.tolist()
    summary = summary_of(tmp_path / "out")
    assert summary.pop("seconds") > 0
    assert summary == {
        "title": "Slab",
        "kinematics": "plane stress",
        "scene": str(scene),
        "vary": {MU: [0.2, 0.3], LOAD: [-300, -200, -100]},
        "contacts": ["top"],
        "rows": 6,
        "answered": 6,
        "bulk_factorisations": 1,
        "failures": {},
    }


_HOLDS = """
import sys, time
from pathlib import Path
from fenics_contact.simulation.output.journal_file import FolderLock
lock = FolderLock(Path(sys.argv[1]))
lock.take()
print("held", flush=True)
time.sleep(600)
"""


def test_a_folder_has_one_sweep_at_a_time(scene, tmp_path):
    """Another one is refused, and writes nothing; a sweep that was killed is in nobody's way."""
    out = tmp_path / "out"
    swept(scene, [f"{MU}=0.2,0.3"], out)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    command = [sys.executable, "-c", _HOLDS, str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "held\n"
        for resume in (False, True):
            with refused("another_run_is_at_work"):
                swept(scene, [f"{MU}=0.2,0.3,0.4"], out, resume=resume)
        assert {path.name: path.read_bytes() for path in out.iterdir()} == before
        other.kill()
    _, solved = swept(scene, [f"{MU}=0.2,0.3,0.4"], out, resume=True)
    assert solved == [2]
    assert {path.name for path in out.iterdir()} == set(before)


def test_of_two_sweeps_that_begin_at_once_one_has_the_folder(scene, tmp_path, monkeypatch):
    """There was none when they began: the first to have an answer makes it, and has it."""
    out = tmp_path / "out"
    other = FolderLock(out)

    def make_folder(path):
        path.mkdir()
        other.take()

    with monkeypatch.context() as meanwhile:
        meanwhile.setattr(journal_file, "make_folder", make_folder)
        with refused("another_run_is_at_work"):
            swept(scene, [f"{MU}=0.2"], out)
    assert not list(out.iterdir())
    other.give_up()
    swept(scene, [f"{MU}=0.2"], out)
    assert len(rows_of(out)) == 1


def test_friction_that_begins_at_0_takes_no_second_factorisation(scene, tmp_path):
    """Contact under a given pressure exerts forces along the surface by its friction alone."""
    sweep, _ = swept(scene, [f"{MU}=0,0.1,0.2"], tmp_path / "out")
    assert sweep.factorisations == 1
    assert float(rows_of(tmp_path / "out")[0]["friction_force_x"]) == 0


def test_what_needs_another_body_is_grouped(scene, tmp_path):
    """Moduli and parameters of the mesh: one factorisation each, whatever runs fastest."""
    vary = [f"{MU}=0.2,0.3", "material.youngs_modulus=500,1000", "mesh.parameters.height=1,2"]
    sweep, _ = swept(scene, vary, tmp_path / "out")
    assert sweep.factorisations == 4
    rows = rows_of(tmp_path / "out")
    assert [row["mesh.parameters.height"] for row in rows] == ["1", "2"] * 4
    other = load_scene(scene, ["material.youngs_modulus=500", "mesh.parameters.height=2"])
    energy = run(dataclasses.replace(other)).quantities["strain_energy"]
    assert float(rows[7 - 2]["strain_energy"]) == pytest.approx(energy, rel=1e-9)


def test_laws_meshes_and_lists_are_values_too(scene, tmp_path):
    vary = [
        "contact.0.law=static,incremental",
        "load.0.traction=[-300, 0],[-200, 0]",
        f"mesh.file='{ROOT}/meshes/slab.geo',nowhere.geo",
    ]
    sweep, _ = swept(scene, vary, tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    assert [row["exit_code"] for row in rows] == ["0", "2"] * 4
    assert [row["contact.0.law"] for row in rows] == ["static"] * 4 + ["incremental"] * 4
    assert json.loads(rows[2]["load.0.traction"]) == [-200, 0]
    assert "no such file" in summary_of(tmp_path / "out")["failures"]["1"]
    assert sweep.exit_code == 3


def test_numbers_are_in_the_scene_s_units(scene, tmp_path):
    text = scene.read_text().replace("[mesh]", '[units]\nlength = "mm"\nforce = "N"\n[mesh]', 1)
    scene.write_text(text)
    modulus = "material.youngs_modulus"
    sweep, _ = swept(scene, [f"{modulus}=1000,1 GPa,2 N"], tmp_path / "out")
    first, second, third = rows_of(tmp_path / "out")
    assert float(first["strain_energy"]) == pytest.approx(float(second["strain_energy"]), 1e-12)
    assert (third["exit_code"], third["strain_energy"]) == ("2", "")
    units = summary_of(tmp_path / "out")["units"]
    assert units["stress"] == "MPa" and units["quantities"]["normal_force"]
    assert sweep.exit_code == 3


def test_what_fails_is_a_row_and_not_the_end(scene, tmp_path):
    """Refused by the scene, and without equilibrium: friction carries μ 300 × 8 at the most."""
    text = scene.read_text().replace('[[support]]\non = "left"\ndisplacement = { x = 0 }', "")
    scene.write_text(text)
    sweep, _ = swept(scene, [f"{MU}=-1,0.1", f"{LOAD}=-250,-50"], tmp_path / "out")
    rows = rows_of(tmp_path / "out")
    assert [row["exit_code"] for row in rows] == ["2", "2", "2", "0"]
    assert [row["strain_energy"] != "" for row in rows] == [False, False, False, True]
    failures = summary_of(tmp_path / "out")["failures"]
    assert f"with --vary {MU}=-1 --vary {LOAD}=-250: " in failures["0"]
    assert "no equilibrium" in failures["2"]
    assert sweep.exit_code == 3
    assert states_of(tmp_path / "out")["point"].min() == 3


def test_without_any_answer_there_are_all_files(scene, tmp_path, capsys):
    """Newton's method may take one step, which is not enough where points slip."""
    out = tmp_path / "out"
    words = ["sweep", str(scene), "--vary", f"{LOAD}=-600,-700", "--set", "solver.max_iterations=1"]
    assert main([*words, "--out", str(out), "--jobs", "1"]) == 3
    assert "2 points: 2 not converged" in capsys.readouterr().out
    assert [row["exit_code"] for row in rows_of(out)] == ["3", "3"]
    assert summary_of(out)["answered"] == 0
    assert summary_of(out)["failures"]["0"].startswith("No answer")
    assert len(states_of(out)["point"]) == 0
    assert (out / "sweep.html").exists()


@pytest.mark.parametrize(
    ("codes", "code"),
    [
        ((0, 0), 0),
        ((0, 4), 4),
        ((4, 3), 3),
        ((0, 2), 3),
        ((3, 5), 5),
        ((0, None), 130),
        ((5, 1), 1),
    ],
)
def test_the_exit_code_is_that_of_the_largest_concern(codes, code, scene, tmp_path):
    sweep = Sweep(SceneFile(scene), [], [f"{MU}=0.1,0.2"], tmp_path / "out")
    sweep.done |= {n: Done("", c, "") for n, c in enumerate(codes) if c is not None}
    assert sweep.exit_code == code


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        (["contact.0.friction=1,2"], "vary_unknown_key"),
        ([f"{MU}=-1,-2"], "vary_to_negative_friction"),
        (["contact.1.pressure=1,2"], "vary_contact_1"),
        (["mesh.parameters.cells_alon=1,2"], "vary_no_such_constant"),
        (["contact.0.on=above,below"], "vary_to_no_group"),
    ],
)
def test_what_is_refused_at_every_point_is_one_sentence(vary, said, scene, tmp_path):
    with refused(said):
        swept(scene, vary, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def stopping_after(count, monkeypatch):
    """Have a sweep be interrupted once so many points are done."""
    heard = []

    def solve(path, vary, folder):
        sweep = Sweep(SceneFile(path), [], vary, folder)
        note = lambda number, done: heard.append(number)  # noqa: E731
        with pytest.raises(StoppedError):
            sweep.solve(1, note, lambda: len(heard) >= count)
        return sweep

    return solve


def test_an_interrupted_sweep_goes_on_where_it_was(scene, tmp_path, monkeypatch):
    out = tmp_path / "out"
    first = stopping_after(2, monkeypatch)(scene, GRID, out)
    assert first.exit_code == 130
    assert [row["exit_code"] for row in rows_of(out)] == ["0", "0", "130", "130", "130", "130"]
    sweep, solved = swept(scene, GRID, out, resume=True)
    assert solved == [2, 5, 4, 3]
    assert sweep.exit_code == 0
    resumed = rows_of(out)
    swept(scene, GRID, tmp_path / "whole")
    for row, expected in zip(resumed, rows_of(tmp_path / "whole"), strict=True):
        assert list(row) == list(expected)
        numbers = [float(text or "nan") for text in expected.values()]
        found = [float(text or "nan") for text in row.values()]
        assert found == pytest.approx(numbers, rel=1e-9, abs=1e-9 * 2400, nan_ok=True)
    assert states_of(out)["point"].tolist() == states_of(tmp_path / "whole")["point"].tolist()
    again, solved = swept(scene, GRID, out, resume=True)
    assert solved == [] and rows_of(out) == resumed
    assert again.factorisations == 2


def test_interrupted_before_the_first_point_it_has_written_nothing(scene, tmp_path, capsys):
    """By a signal that comes while a process is started."""
    out = tmp_path / "out"

    def interrupting(folder):
        os.kill(os.getpid(), signal.SIGINT)
        return InlineProcess(folder)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(leader, "WorkerProcess", interrupting)
        words = ["sweep", str(scene), "--vary", f"{MU}=-1,0.2,0.3", "--jobs", "1"]
        assert main([*words, "--out", str(out)]) == 130
    assert capsys.readouterr().err.endswith("fenics-contact: interrupted\n")
    assert not out.exists()


def test_a_longer_range_goes_on_from_a_shorter_one(scene, tmp_path):
    out = tmp_path / "out"
    swept(scene, [f"{MU}=0.2,0.3"], out)
    _, solved = swept(scene, [f"{MU}=0.1,0.2,0.3"], out, resume=True)
    assert solved == [0]
    assert [row[MU] for row in rows_of(out)] == ["0.1", "0.2", "0.3"]


def test_what_the_machine_failed_is_tried_again(scene, tmp_path, monkeypatch):
    out, answer = tmp_path / "out", InlineProcess.hear
    with monkeypatch.context() as patch:
        calls = []

        def dying(process):
            calls.append(process)
            if len(calls) == 2:
                raise DiedError("it was killed")
            return answer(process)

        patch.setattr(InlineProcess, "hear", dying)
        sweep, solved = swept(scene, [f"{MU}=0.1,0.2,0.3"], out)
    assert solved == [0, 1, 2]
    assert [row["exit_code"] for row in rows_of(out)] == ["0", "5", "0"]
    assert "the process that solved it has died: it was killed" in sweep.done[1].said
    assert sweep.exit_code == 5
    sweep, solved = swept(scene, [f"{MU}=0.1,0.2,0.3"], out, resume=True)
    assert solved == [1] and sweep.exit_code == 0


def test_processes_that_die_one_after_the_other_end_it(scene, tmp_path, monkeypatch):
    def dying(process):
        raise DiedError("it was killed")

    monkeypatch.setattr(InlineProcess, "hear", dying)
    with refused("processes_of_sweep_died", MachineError):
        swept(scene, [f"{MU}=0.1:0.5:5"], tmp_path / "out")
    codes = [row["exit_code"] for row in rows_of(tmp_path / "out")]
    assert codes == ["5", "5", "5", "130", "130"]


@pytest.mark.parametrize(("free", "started"), [(1e9, 1), (10e9, 3), (1e12, 4)])
def test_memory_has_room_for_so_many_processes(free, started, scene, tmp_path, monkeypatch):
    """Each says what it needs, 3 GB beside the program itself, before it solves."""
    processes = []

    class Telling(InlineProcess):
        def __init__(self, folder):
            super().__init__(folder)
            processes.append(self)
            self._needs = [2.9e9]

        def hear(self):
            return self._needs.pop() if self._needs else super().hear()

    monkeypatch.setattr(leader, "WorkerProcess", Telling)
    monkeypatch.setattr(leader, "free_memory", lambda: free)
    monkeypatch.setattr(leader, "cores", lambda: 4)
    swept(scene, [f"{MU}=0.1:0.6:6"], tmp_path / "out", jobs=None)
    assert len(processes) == started
    assert [row["exit_code"] for row in rows_of(tmp_path / "out")] == ["0"] * 6


def test_where_no_process_starts_it_is_said(scene, tmp_path, monkeypatch):
    def none(folder):
        raise OSError("no room for another process")

    monkeypatch.setattr(leader, "WorkerProcess", none)
    with refused("no_process_starts", MachineError):
        swept(scene, [f"{MU}=0.1,0.2"], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def changed_scene(scene, out, monkeypatch):
    scene.write_text(scene.read_text().replace("poissons_ratio = 0.3", "poissons_ratio = 0.2"))


def changed_mesh(scene, out, monkeypatch):
    text = (ROOT / "meshes" / "slab.geo").read_text()
    (scene.parent / "own.geo").write_text(text + "// another\n")


def other_version(scene, out, monkeypatch):
    found = journal_file._made_by() | {"dolfinx": "0.1"}
    monkeypatch.setattr(journal_file, "_made_by", lambda: found)


def no_journal(scene, out, monkeypatch):
    (out / journal.NAME).write_bytes(b"nothing of the kind, but some bytes")


def damaged(scene, out, monkeypatch):
    path = out / journal.NAME
    records = [json.dumps(journal_file._made_by()).encode(), b"x"]
    path.write_bytes(b"".join(map(journal_file.JournalFile(path, "sweep").record, records)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed_scene, "resume_of_another_sweep"),
        (changed_mesh, "resume_of_another_sweep"),
        (other_version, "resume_sweep_of_another_dolfinx"),
        (no_journal, "resume_of_a_damaged_journal"),
        (damaged, "resume_of_a_damaged_journal"),
    ],
)
def test_what_is_of_another_sweep_is_not_resumed(change, said, scene, tmp_path, monkeypatch):
    mesh = scene.parent / "own.geo"
    mesh.write_text((ROOT / "meshes" / "slab.geo").read_text())
    scene.write_text(SLAB.format(mesh="own.geo"))
    out = tmp_path / "out"
    swept(scene, [f"{MU}=0.2"], out)
    change(scene, out, monkeypatch)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    with refused(said):
        swept(scene, [f"{MU}=0.2"], out, resume=True)
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before


def test_other_values_are_another_sweep(scene, tmp_path):
    swept(scene, [f"{MU}=0.2,0.3"], tmp_path / "out")
    for vary in ([f"{MU}=0.2"], [f"{LOAD}=-300,-100"]):
        with refused("resume_of_another_sweep"):
            swept(scene, vary, tmp_path / "out", resume=True)


def test_what_a_kill_has_cut_off_is_solved_again(scene, tmp_path):
    out = tmp_path / "out"
    swept(scene, GRID, out)
    file = out / journal.NAME
    os.truncate(file, file.stat().st_size - 100)
    sweep, solved = swept(scene, GRID, out, resume=True)
    assert solved == [3] and sweep.exit_code == 0
    assert all(row["exit_code"] == "0" for row in rows_of(out))


def test_without_a_journal_it_begins_at_the_start(scene, tmp_path, caplog):
    with caplog.at_level(logging.INFO):
        _, solved = swept(scene, [f"{MU}=0.2"], tmp_path / "out", resume=True)
    assert solved == [0]
    assert any("beginning at the start" in line for line in caplog.messages)


@pytest.mark.errors
def test_each_point_of_a_scene_with_an_accuracy_has_meshes_of_its_own(scene, tmp_path):
    text = (
        scene.read_text().replace('errors = "none"', "").replace("title", "accuracy = 0.05\ntitle")
    )
    scene.write_text(text)
    swept(scene, [f"{MU}=0.2"], tmp_path / "out")
    for row in rows_of(tmp_path / "out"):
        expected = run(load_scene(scene, [f"{MU}={row[MU]}"]))
        assert int(row["exit_code"]) == expected.exit_code
        energy = expected.quantities["strain_energy"]
        assert float(row["strain_energy"]) == pytest.approx(energy, rel=1e-9)
        bar = expected.errors["strain_energy"]["total"]
        assert float(row["strain_energy_error"]) == pytest.approx(bar, rel=0.01)


def test_the_command_says_what_came_out(scene, tmp_path, capsys):
    out = tmp_path / "out"
    words = ["sweep", str(scene), "--vary", f"{MU}=-1,0.2", "--jobs", "1", "--out", str(out)]
    assert main(words) == 3
    said = capsys.readouterr()
    assert "2 points: 1 passed, 1 refused" in said.out
    assert "row 0, exit code 2: " in said.out
    assert "1 body, up to 1 process" in said.err
    page = (out / "sweep.html").read_text(encoding="utf-8")
    assert MU in page
    (out / "sweep.html").unlink()
    assert main(["report", str(out), "--quiet"]) == 0
    assert (out / "sweep.html").read_text(encoding="utf-8") == page
    assert main([*words, "--quiet", "--set", "title=other"]) == 3
    assert main([*words[:3], f"{MU}=0.2", *words[4:], "--quiet"]) == 0
    assert capsys.readouterr().err == ""
