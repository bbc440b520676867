"""docs/ten_tasks.md, carried out as it stands there in a folder that is empty at first."""

import ast
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.project.test_docs_examples import blocks_of
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

PAGE = ROOT / "docs" / "ten_tasks.md"
FIRST_PICTURE = 60.0  # seconds

# What an installation brings, of this checkout; its `mpirun` is the one that suits its dolfinx.
COMMANDS = {
    "fenics-contact": f'exec "{sys.executable}" -m fenics_contact "$@"',
    "python": f'exec "{sys.executable}" "$@"',
    "mpirun": f'ranks=$2; shift 3; exec "{ROOT}/bootstrap" mpi $ranks -m fenics_contact "$@"',
}


def sections():
    """Of the page: number of the task → its title; 0 is what stands before them."""
    titles = re.findall(r"^## (\d+)\. (.+)$", PAGE.read_text(encoding="utf-8"), re.M)
    return {0: "a first picture: 3 steps"} | {int(number): title for number, title in titles}


def blocks_of_task(number):
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    starts = [0, *(line for line, text in enumerate(lines, 1) if text.startswith("## "))]
    ends = [*starts[1:], len(lines) + 1]
    return [block for block in blocks_of(PAGE) if starts[number] <= block.line < ends[number]]


def commands_of(block):
    return [line for line in block.text.splitlines() if line.strip()]


def steps_of(number):
    """Commands, files to save, and cells."""
    return sum(len(commands_of(b)) if b.language == "sh" else 1 for b in blocks_of_task(number))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The empty folder, and the programs of an installation."""
    programs = tmp_path_factory.mktemp("programs")
    for name, text in COMMANDS.items():
        (programs / name).write_text(f"#!/bin/sh\n{text}\n")
        (programs / name).chmod(0o755)
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": "ignore"}
    return tmp_path_factory.mktemp("empty"), environment


@pytest.fixture(scope="module")
def carry_out(place):
    folder, environment = place

    def task(number):
        """Do what a task says; returns what it printed."""
        said = ""
        for block in blocks_of_task(number):
            if block.said.startswith("saved as "):
                (folder / block.said.removeprefix("saved as ")).write_text(block.text)
            elif block.language == "sh":
                done = subprocess.run(
                    ["bash", "-e", "-c", block.text],
                    cwd=folder,
                    env=environment,
                    capture_output=True,
                    text=True,
                    timeout=200,
                    stdin=subprocess.DEVNULL,
                    check=False,
                )
                assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
                said += done.stdout
            else:
                said += cell(block.text, folder, environment)
        return said

    return task


def cell(text, folder, environment):
    """A notebook's cell in a process of its own; what its last line is shown as."""
    *before, last = ast.parse(text).body
    assert isinstance(last, ast.Expr), "a cell ends with what is to be shown"
    lines = [ast.unparse(one) for one in before]
    lines.append(f"print(({ast.unparse(last)})._repr_html_())")
    command = [sys.executable, "-c", "\n".join(lines)]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.fixture(scope="module")
def first(carry_out, place):
    """The first picture, from which others go on; and how long it took (seconds)."""
    began = time.monotonic()
    carry_out(0)
    return place[0], time.monotonic() - began


def quantities(folder):
    return json.loads((folder / "result.json").read_text())["quantities"]


@pytest.mark.parametrize("number", range(11))
def test_a_task_takes_the_steps_that_its_title_says(number):
    told = re.search(r": (\d+) steps?$", sections()[number])
    assert told, sections()[number]
    assert steps_of(number) == int(told[1])


def test_first_picture(first):
    folder, seconds = first
    assert (folder / "results/slab/report.html").stat().st_size > 10_000
    assert (folder / "results/slab/deformed.png").read_bytes()[:4] == b"\x89PNG"
    if os.getloadavg()[0] < 2 * (os.cpu_count() or 1):  # else it says nothing of us
        assert seconds < FIRST_PICTURE


def test_cad_file(carry_out, place):
    carry_out(1)
    folder = place[0]
    # ∫ p dA of the loaded surface, 20 × 20, is what the support holds.
    reaction = quantities(folder / "results/part")["reaction"]
    assert sum(component**2 for component in reaction) ** 0.5 == pytest.approx(400, rel=1e-6)
    assert (folder / "cad/look.html").is_file()


def test_mesh_in_memory(carry_out):
    force, _, verdict = carry_out(2).partition(" ")
    assert float(force) == pytest.approx(10, rel=1e-9)
    assert verdict.startswith("Converged; all")


def test_friction_sweep(carry_out, first):
    carry_out(3)
    with (first[0] / "sweep/sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    found = {float(row["contact.0.friction_coefficient"]): row for row in rows}
    assert sorted(found) == [0.1, 0.2, 0.3]
    one = quantities(first[0] / "results/slab")["friction_force"][0]
    assert float(found[0.3]["friction_force_x"]) == pytest.approx(one, rel=1e-9)


def test_stress_at_a_point(carry_out, first):
    numbers = [float(word) for word in re.findall(r"-?\d+\.\d*(?:e[-+]\d+)?", carry_out(4))]
    assert len(numbers) == 9
    assert numbers[4] == pytest.approx(-300, rel=0.05)  # just below where 300 presses


def test_restart(carry_out, place):
    carry_out(5)
    with (place[0] / "results/cycle/steps.csv").open(newline="") as file:
        times = [float(row["time"]) for row in csv.DictReader(file)]
    assert times == [1, 2, 3]


def test_two_processes(carry_out, first):
    carry_out(6)
    one, two = (quantities(first[0] / "results" / name) for name in ("slab", "two"))
    record = json.loads((first[0] / "results/two/result.json").read_text())
    assert record["model"]["ranks"] == 2
    assert two["friction_force"][0] == pytest.approx(one["friction_force"][0], rel=1e-9)


def test_docker():
    """Building the image takes minutes, which `.ci/debian` does; what it runs, if it is there."""
    docker = shutil.which("docker")
    image = "fenics-contact"
    known = docker and subprocess.run(
        [docker, "image", "inspect", image], capture_output=True, check=False
    )
    if not known or known.returncode:
        pytest.skip("no docker, or no image fenics-contact: the commands are not run here")
    *_, command = blocks_of_task(7)[0].text.strip().splitlines()
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_notebook(carry_out):
    shown = carry_out(8)
    assert "<table" in shown and "normal force" in shown


def test_report(carry_out, first):
    if not Path(first[0] / "results/two").exists():
        carry_out(6)
    carry_out(9)
    assert (
        "<svg" in (first[0] / "results/two/report.html").read_text()
        or (first[0] / "results/two/deformed.png").is_file()
    )


def test_fit(carry_out, place):
    carry_out(10)
    found = json.loads((place[0] / "fit/fit.json").read_text())
    radius = found["parameters"]["contact.0.obstacle.radius"]
    assert radius["low"] < 10 < radius["high"]
    assert radius["value"] == pytest.approx(10, rel=0.01)
