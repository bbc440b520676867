"""Every demo as users start it: a process of its own, on one and on two ranks."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.scenes import ROOT

pytestmark = pytest.mark.serial
DEMOS = sorted(path.stem.removeprefix("demo_") for path in (ROOT / "demos").glob("demo_*.py"))


def launcher():
    """The mpirun of this Python's MPI."""
    beside = Path(sys.executable).with_name("mpirun")
    return str(beside) if beside.exists() else shutil.which("mpirun")


def start(arguments, ranks):
    command = [sys.executable, *map(str, arguments)]
    if ranks > 1:
        command = [launcher(), "-n", str(ranks), *command]
    environment = dict(
        os.environ,
        OMP_NUM_THREADS="1",
        OMPI_ALLOW_RUN_AS_ROOT="1",
        OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
        PRTE_MCA_rmaps_default_mapping_policy=":oversubscribe",
        PYTHONPATH=str(ROOT),
    )
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=240,
        env=environment,
        check=False,
    )


def quantities(folder):
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))["quantities"]


def test_there_are_demos():
    assert "slab" in DEMOS


@pytest.mark.parametrize("name", DEMOS)
def test_script_and_scene_on_one_and_two_ranks(name, tmp_path):
    script = ROOT / "demos" / f"demo_{name}.py"
    scene = ROOT / "demos" / f"{name}.toml"
    runs = {
        "script": ([script, "--out", tmp_path / "script"], 1),
        "script on 2": ([script, "--out", tmp_path / "script on 2", "--no-pictures"], 2),
        "scene": (["-m", "fenics_contact", "run", scene, "--out", tmp_path / "scene"], 1),
        "scene on 2": (["-m", "fenics_contact", "run", scene, "--out", tmp_path / "scene on 2"], 2),
    }
    for label, (arguments, ranks) in runs.items():
        done = start(arguments, ranks)
        assert done.returncode == 0, f"{label}: {done.stdout}\n{done.stderr}"
        assert "Traceback" not in done.stderr
        assert "checks of the physics passed" in done.stdout
    reference = quantities(tmp_path / "script")
    for label in runs:
        found = quantities(tmp_path / label)
        for key, value in reference.items():
            assert found[key] == pytest.approx(value, rel=1e-9, abs=1e-9), f"{label}: {key}"
    tables = {(tmp_path / label / "contact.csv").read_text() for label in runs}
    assert len(tables) == 1
    pictures = sorted(path.name for path in (tmp_path / "script").glob("*.png"))
    assert "deformed.png" in pictures
    assert (tmp_path / "script" / "report.html").exists()


@pytest.mark.parametrize("ranks", [1, 2])
def test_bad_scene_ends_every_rank_with_exit_code_2(ranks, tmp_path):
    bad = tmp_path / "bad.toml"
    bad.write_text('kinematics = "plane stress"\nfriction = 1\n[mesh]\nfile = "x.geo"\n')
    out = tmp_path / "out"
    done = start(["-m", "fenics_contact", "run", bad, "--out", out], ranks)
    assert done.returncode == 2, done.stderr
    assert done.stderr.count("fenics-contact: ") == 1
    assert "unknown key 'friction'" in done.stderr
    assert "Traceback" not in done.stderr
    assert not out.exists()


def test_an_error_on_one_rank_alone_ends_the_others(tmp_path):
    script = tmp_path / "one_rank_fails.py"
    script.write_text(
        "import fenics_contact\n"
        "from fenics_contact.cli import guarded\n"
        "from mpi4py import MPI\n"
        "def action():\n"
        "    if MPI.COMM_WORLD.rank == 1:\n"
        "        raise MemoryError('too much')\n"
        "    MPI.COMM_WORLD.Barrier()\n"
        "    return 0\n"
        "raise SystemExit(guarded(action))\n"
    )
    done = start([script], 2)
    assert done.returncode == 5, done.stderr
    assert "the machine failed: too much" in done.stderr
