"""The command as users meet it: exit codes, one sentence for bad input, nothing half-written.

Run in this process, on however many ranks the tests run: a hang would show here.
"""

import csv
import json
import os
import tempfile

import pytest
from mpi4py import MPI

from fenics_contact import main, run
from fenics_contact.cli import program as cli
from fenics_contact.scene import reading as loader
from fenics_contact.simulation.output import run_folder as files
from fenics_contact.simulation.output.journal_file import FolderLock
from tests.messages import says
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
SCENE = (ROOT / "demos" / "slab.toml").read_text(encoding="utf-8")


def write(folder, text):
    path = folder / "scene.toml"
    COMM.barrier()  # what is overwritten may still be read
    if COMM.rank == 0:
        path.write_text(text.replace("../meshes/slab.geo", str(ROOT / "meshes" / "slab.geo")))
    COMM.barrier()
    return str(path)


def error_of(capsys):
    """What rank 0 said on stderr; other ranks say nothing."""
    said = capsys.readouterr().err
    if COMM.rank > 0:
        assert said == ""
    return COMM.bcast(said)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("friction_coefficient", "friction_coeficient", "unknown_key_coeficient"),
        ("youngs_modulus = 1000", 'youngs_modulus = "x"', "youngs_modulus_is_x"),
        ('on = "right"', 'on = "rihgt"', "no_group_rihgt"),
        ("[-300, 0]", "[-300, 0", "toml_list_has_no_end_in_line_28"),
        ("youngs_modulus = 1000", "youngs_modulus = 0", "youngs_modulus_is_zero"),
        ("poissons_ratio = 0.3", "poissons_ratio = 0.5", "poissons_ratio_is_a_half_in_file"),
        ("friction_coefficient = 0.3", "friction_coefficient = -1", "friction_is_minus_1"),
        ("pressure = 300", "pressure = nan", "pressure_is_nan"),
        ('on = "bottom"', 'on = "top"', "contact_shares_boundary_with_support"),
        ("slab.geo", "slob.geo", "mesh_file_slob"),
        ("title = ", "accuracy = -1\ntitle = ", "accuracy_is_negative"),
        ("title = ", "accuracy = true\ntitle = ", "accuracy_is_no_number"),
    ],
)
def test_bad_input_is_one_sentence_exit_2_and_nothing_written(folder, capsys, old, new, message):
    text = SCENE.replace(old, new, 1)
    assert text != SCENE
    out = folder / "out"
    assert main(["run", write(folder, text), "--out", str(out)]) == 2
    said = error_of(capsys)
    says(message, said)
    assert said.startswith("fenics-contact: ") and said.count("\n") == 1
    assert not out.exists()


def test_scene_without_equilibrium_exits_2(folder, capsys):
    text = SCENE.replace('[[support]]\non = "left"\ndisplacement = { x = 0 }', "")
    scene = write(folder, text.replace("[-300, 0]", "[-720.01, 0]"))
    assert main(["run", scene, "--out", str(folder / "out")]) == 2
    motion = "translation along x"
    says("loads_exceed_friction", error_of(capsys), motion=motion, share="1.00001")
    assert not (folder / "out").exists()
    assert main(["check", scene]) == 2


def test_output_folder_that_cannot_be_written(folder, capsys):
    scene = write(folder, SCENE)
    (folder / "file").write_text("not a folder")
    COMM.barrier()
    assert main(["run", scene, "--out", str(folder / "file" / "out")]) == 2
    says("out_is_below_a_file", error_of(capsys))


def test_looking_whether_a_folder_can_be_written_leaves_other_runs_alone(folder, monkeypatch):
    """Runs that start together share folders above theirs, which the first of them makes."""
    real = tempfile.TemporaryFile

    def another_run_writes(*args, **options):
        (folder / "runs" / "other").mkdir(parents=True, exist_ok=True)
        return real(*args, **options)

    monkeypatch.setattr(tempfile, "TemporaryFile", another_run_writes)
    files.require_writable(folder / "runs" / "mine", COMM)
    COMM.barrier()
    assert (folder / "runs" / "other").is_dir()
    assert not (folder / "runs" / "mine").exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_output_folder_without_permission(folder, capsys):
    scene = write(folder, SCENE)
    if COMM.rank == 0:
        (folder / "closed").mkdir(mode=0o500)
    COMM.barrier()
    assert main(["run", scene, "--out", str(folder / "closed" / "out")]) == 2
    says("out_is_closed", error_of(capsys))


def test_run_writes_what_the_interface_promises(folder):
    out = folder / "out"
    assert main(["run", write(folder, SCENE), "--out", str(out)]) == 0
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert set(result) >= {
        "title",
        "converged",
        "passed",
        "scene",
        "verdict",
        "model",
        "contacts",
        "quantities",
        "steps",
        "checks",
        "errors",
        "timings",
        "versions",
    }
    assert set(result["model"]) >= {
        "kinematics",
        "degree",
        "dofs",
        "contact_points",
        "ranks",
        "solver",
        "strategy",
        "terms",
        "symmetry",
    }
    assert set(result["quantities"]) >= {
        "normal_force",
        "friction_force",
        "reaction",
        "max_contact_pressure",
        "contact_area",
        "stick_area",
        "slip_area",
        "max_penetration",
        "max_slip",
        "strain_energy",
        "external_work",
        "friction_work",
        "penalty_energy",
    }
    assert set(result["contacts"][0]) >= {"name", "contact", "law", "parameters", "quantities"}
    assert set(result["timings"]) == {
        "mesh",
        "compile",
        "assemble",
        "factorise",
        "solve",
        "output",
        "errors",
        "derivatives",
        "vibration",
        "stability",
        "total",
    }
    phases = [seconds for phase, seconds in result["timings"].items() if phase != "total"]
    assert all(seconds >= 0 for seconds in phases)
    assert set(result["steps"][0]) >= {
        "load_factor",
        "newton_iterations",
        "outer_iterations",
        "quantities",
    }
    assert result["converged"] is True
    assert result["model"]["ranks"] == COMM.size
    assert result["model"]["dofs"] == 2 * 33 * 3
    assert result["model"]["contact_points"] == 33
    assert (out / "fields.pvd").exists()


def test_contact_table_is_sorted_and_agrees_with_the_result(folder):
    out = folder / "out"
    main(["run", write(folder, SCENE), "--out", str(out), "--set", "contact.0.name=CD"])
    with (out / "contact.csv").open(newline="") as file:
        assert file.readline().strip() == (
            "contact,x,y,z,nx,ny,nz,gap,contact_pressure,traction_x,traction_y,traction_z,"
            "slip_x,slip_y,slip_z,status"
        )
        file.seek(0)
        rows = list(csv.DictReader(file))
    assert {row["contact"] for row in rows} == {"CD"}
    positions = [float(row["x"]) for row in rows]
    assert positions == sorted(positions)
    assert len(positions) == 33
    simpson = [(1 if i in (0, 32) else 4 if i % 2 else 2) / 12 for i in range(33)]
    friction = sum(w * float(row["traction_x"]) for w, row in zip(simpson, rows, strict=True))
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert friction == pytest.approx(result["quantities"]["friction_force"][0], rel=1e-6)
    assert [row["status"] for row in rows] == ["STICK"] * 26 + ["SLIP"] * 7
    assert {(row["nx"], row["ny"]) for row in rows} == {("0", "1")}


def test_failure_to_converge_exits_3_with_the_history_and_no_numbers(folder, capsys):
    out = folder / "out"
    scene = write(folder, SCENE)
    assert main(["run", scene, "--out", str(out)]) == 0
    code = main(["run", scene, "--out", str(out), "--set", "solver.max_iterations=2"])
    assert code == 3
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["converged"] is False
    assert "Newton steps allowed were used up" in result["verdict"]
    assert "Try" in result["verdict"]
    # Full steps, then a quick and a thorough search along them: two steps each.
    assert len(result["steps"][0]["residual_history"]) == 3 * 3
    assert result["quantities"] == {}
    # what the first run left would be taken for this run's
    assert not (out / "contact.csv").exists()
    assert not list(out.glob("fields*"))


def test_failed_check_exits_4(folder, monkeypatch):
    """Friction forces off by a tenth, as a faulty law would give them."""
    from fenics_contact.simulation.steps_of_run import StepsOfRun

    accepted = StepsOfRun.accepted

    def accept_faulty(self, step):
        for force in step.solution.friction_force:
            force *= 0.9
        accepted(self, step)

    monkeypatch.setattr(StepsOfRun, "accepted", accept_faulty)
    out = folder / "out"
    assert main(["run", write(folder, SCENE), "--out", str(out)]) == 4
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert result["verdict"].startswith("Converged, but do not trust it: failed ")
    assert not result["checks"]["equilibrium"]["passed"]


def test_only_the_programs_own_files_are_replaced(folder):
    out = folder / "out"
    if COMM.rank == 0:
        out.mkdir()
        for name in ("holiday.png", "fields_of_wheat.vtu", "contact_me.csv", "result.json.bak"):
            (out / name).write_text("mine")
        (out / "contact_7.png").write_text("of an earlier run")
    COMM.barrier()
    assert main(["run", write(folder, SCENE), "--out", str(out)]) == 0
    assert (out / "holiday.png").exists()
    assert (out / "fields_of_wheat.vtu").exists()
    assert (out / "contact_me.csv").exists()
    assert (out / "result.json.bak").exists()
    assert not (out / "contact_7.png").exists()


def test_title_is_shown_as_it_is(folder, capsys):
    scene = write(folder, SCENE.replace('title = "Slab', 'title = "a [/b] [red] Slab'))
    assert main(["run", scene, "--out", str(folder / "out")]) == 0
    assert main(["check", scene]) == 0
    assert "a [/b] [red] Slab" in COMM.bcast(capsys.readouterr().out)


def test_quiet_says_nothing_of_a_success(folder, capsys):
    assert main(["run", write(folder, SCENE), "--out", str(folder / "out"), "--quiet"]) == 0
    said = capsys.readouterr()
    assert said.out + said.err == ""


def test_pictures_that_cannot_be_drawn_do_not_spoil_the_answer(folder, capsys, monkeypatch):
    from demos.demo_slab import scene
    from fenics_contact import InputError
    from fenics_contact.report import report

    def refuse(folder):
        raise InputError("pictures need a display")

    monkeypatch.setattr(report, "write_report", refuse)
    assert cli.run_script(scene, "unused", arguments=["--out", str(folder / "out")]) == 0
    says("no_pictures", COMM.bcast(capsys.readouterr().err))


def test_check_says_what_would_be_modelled_and_writes_nothing(folder, capsys):
    scene = write(folder, SCENE)
    before = sorted(folder.iterdir())
    assert main(["check", scene]) == 0
    said = COMM.bcast(capsys.readouterr().out)
    for word in ("plane stress", "198", "regularised friction on top", "elastic energy", "4.5e-07"):
        assert word in said
    for line in ("Support 'bottom': y = 0", "Load 'right': traction (-300, 0)"):
        assert f"\n{line}\n" in said
    assert "bottom, left, right, slab, top" in said  # the mesh's groups
    assert sorted(folder.iterdir()) == before


@pytest.mark.serial
@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (OSError(28, "No space left on device"), 5, "machine_has_no_space"),
        (MemoryError(), 5, "machine_has_no_memory"),
        (KeyboardInterrupt(), 130, "run_is_interrupted"),
    ],
)
def test_machine_failure_and_interrupt(folder, capsys, monkeypatch, error, code, words):
    def fail(*arguments):
        raise error

    monkeypatch.setattr(files, "solve_and_write", fail)
    assert main(["run", write(folder, SCENE), "--out", str(folder / "out")]) == code
    says(words, capsys.readouterr().err)


def test_result_cannot_be_read_is_refused(folder, capsys):
    assert main(["report", str(folder)]) == 2
    says("result_cannot_be_read", error_of(capsys))


def test_scene_in_python_and_in_toml_agree(folder):
    from demos.demo_slab import scene as in_python

    in_toml = loader.load_scene(ROOT / "demos" / "slab.toml")
    assert in_python.title == in_toml.title
    first, second = run(in_python, COMM), run(in_toml, COMM)
    assert first.quantities == second.quantities


def test_script_takes_out_and_no_pictures(folder, capsys):
    from demos.demo_slab import scene

    out = folder / "script"
    assert cli.run_script(scene, "unused", arguments=["--out", str(out), "--no-pictures"]) == 0
    assert (out / "result.json").exists()
    assert not list(out.glob("*.png"))


@pytest.mark.serial
def test_of_two_runs_in_one_folder_the_second_is_refused(tmp_path, capsys):
    """Both would write the same files; the first goes on, and whoever comes later may begin."""
    scene, out = write(tmp_path, SCENE), tmp_path / "out"
    first = FolderLock(out)
    first.take(make=True)
    command = ["run", scene, "--out", str(out), "--quiet"]
    assert main(command) == 2
    said = error_of(capsys)
    says("another_run_is_at_work", said)
    assert said.count("\n") == 1
    assert list(out.iterdir()) == []
    first.give_up()
    assert main(command) == 0
    assert (out / "result.json").exists()
