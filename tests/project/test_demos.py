"""Every demo as users start it: one in a process of its own, several on two ranks."""

import csv
import functools
import json
import os
import runpy
import shutil
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from math import log, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from fenics_contact import main
from fenics_contact.scene.reading import load_scene
from tests.report.test_gallery import draw_coarsely
from tests.scenes import ROOT

pytestmark = pytest.mark.serial
DEMOS = sorted(path.stem.removeprefix("demo_") for path in (ROOT / "demos").glob("demo_*.py"))
NO_FRICTION = "contact.0.friction_coefficient=0"
NO_ERRORS = 'solver.errors="none"'  # where only answers are looked at
# Demos of many load steps → coarser, for tests.
LONG = {
    "cycle": ["mesh.parameters.size=0.14", "steps.number=26", "steps.end=26"],
    "cattaneo": ["mesh.parameters.size=0.3", "mesh.parameters.cells_outside=3"],
    "fretting": ["mesh.parameters.size=0.14", "cycles.increments=8", "cycles.number=1"],
    "joint": [
        "mesh.size=9",
        "mesh.sizes.bolt_M8=4",
        "mesh.curvature=8",
        "steps.times=[1, 1.5, 2, 3, 4, 6]",
    ],
    "impact": ["mesh.parameters.size=0.3", "motion.step=1e-6"],
    "stick_slip": ["motion.end=0.006"],
    "joint_damping": [
        "mesh.0.parameters.cells_along=20",
        "mesh.1.parameters.cells_along=20",
        "damping.amplitudes=[0.05, 0.3]",
    ],
}
# The quickest: it is started as a process, on two ranks, too, and has its pictures drawn.
STARTED = "slab"
WEIGHT, SLOPE, FRICTION = 10, 0.1, 0.3  # of the block on an incline
# Quantity of a demo → value and relative tolerance; of the specification, Section 3.
FLAT_FORCE = 0.9819 * 2 * 1000 / (1 - 0.3**2) * 0.01  # of the annular punch
EXPECTED = {
    "slab": {"normal_force": (2400, 1e-9), "contact_area": (8, 1e-9), "stick_area": (6.41, 5e-3)},
    "winkler": {
        "normal_force": (10, 1e-6),
        "friction_force": ([-8.20, 0], 5e-3),
        "max_penetration": (0.0578, 2e-3),
        "contact_area": (3.20, 5e-3),
    },
    "sphere": {
        "normal_force": (1.0247 * 4144.2, 1e-3),
        "indentation": (1, 1e-12),
    },
    "annulus": {
        "normal_force": (1.0231 * FLAT_FORCE, 1e-3),
        "contact_area": (pi * (1 - 0.5**2), 1e-3),
        "stick_area": (pi * (0.905**2 - 0.510**2), 5e-3),
    },
    "cylinders": {"contact_area": (2 * 0.5024, 5e-3), "max_contact_pressure": (34.50, 3e-3)},
    "incline": {
        "normal_force": (WEIGHT * sqrt(1 + SLOPE**2) / (1 - FRICTION * SLOPE), 1e-9),
        "reaction": ([0, WEIGHT], 1e-9),
        "stick_area": (0, 0),
        "contact_area": (2 * sqrt(1 + SLOPE**2), 1e-9),
    },
    # By the formulas of its page, worked out apart from this program.
    "warm_fit": {
        "pressure_integral": (137.3558 * 2 * pi * 20**2, 1e-5),
        "heat_flow": (-565398.34, 1e-5),
        "max_temperature": (200, 1e-12),
    },
    # Of a program apart from this one, with penalties.
    "ironing": {"contact_force": ([0.123484, -0.411790], 1e-4)},
}
# The same without friction.
FRICTIONLESS = {
    "winkler": {
        "normal_force": (10, 1e-6),
        "max_penetration": (0.0718, 2e-3),
        "contact_area": (2.36, 5e-3),
    },
    "sphere": {
        "normal_force": (4144.2, 1e-3),
        "max_contact_pressure": (247.34, 5e-3),
        "contact_area": (pi * 2.8284**2, 1e-2),
    },
    "annulus": {"normal_force": (FLAT_FORCE, 1e-3)},
}


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


def run_demo(name, folder, *overrides, ranks=1):
    """The quantities of a demo's scene, with other values in it; one rank is this process."""
    settings = [part for override in (NO_ERRORS, *overrides) for part in ("--set", override)]
    words = ["run", str(ROOT / "demos" / f"{name}.toml"), *settings, "--out", str(folder)]
    if ranks == 1:
        assert main([*words, "--quiet"]) == 0
    else:
        done = start(["-m", "fenics_contact", *words], ranks)
        assert done.returncode == 0, done.stdout + done.stderr
    return quantities(folder)


@pytest.fixture(scope="module")
def of_script(tmp_path_factory):
    """Where a demo's script wrote, by its name: run once, on one rank, one with all pictures."""

    @functools.cache
    def folder(name):
        out, script = tmp_path_factory.mktemp(name), ROOT / "demos" / f"demo_{name}.py"
        options = [] if name == STARTED else ["--no-pictures"]
        run_here(script, "--out", out, *options)
        return out

    return folder


def run_here(script, *arguments):
    """Run a script by this process: another one takes seconds to start."""
    with pytest.MonkeyPatch.context() as patch:
        draw_coarsely(patch)
        patch.setattr(sys, "argv", [str(script), *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            runpy.run_path(str(script), run_name="__main__")
    assert end.value.code == 0


def require_success(done):
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr
    assert "checks of the physics passed" in done.stdout


def assert_values(found, expected):
    for key, (value, tolerance) in expected.items():
        assert found[key] == pytest.approx(value, rel=tolerance, abs=1e-9), key


def assert_same(first, second):
    """The quantities and the tables of two runs, by their folders."""
    found = quantities(second)
    for key, value in quantities(first).items():
        assert found[key] == pytest.approx(value, rel=1e-9, abs=1e-9), key
    assert_same_table(first, second)


def assert_same_table(first, second):
    """Row by row the same points, status and numbers, to what the penalty leaves of digits."""
    words, numbers = zip(*(table(folder) for folder in (first, second)), strict=True)
    assert words[0] == words[1], second
    sizes = np.nan_to_num(np.abs(numbers[0]), posinf=0.0).max(axis=0)
    np.testing.assert_allclose(
        numbers[0] / np.where(sizes > 0, sizes, 1),
        numbers[1] / np.where(sizes > 0, sizes, 1),
        rtol=0,
        atol=1e-7,
        err_msg=str(second),
    )


def table(folder):
    """The texts and the numbers of a ``contact.csv``."""
    with (folder / "contact.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    words = [(row.pop("contact"), row.pop("status")) for row in rows]
    return words, np.array([[float(value) for value in row.values()] for row in rows])


def test_there_are_demos():
    assert sorted([*EXPECTED, *LONG]) == DEMOS


@pytest.mark.parametrize("name", EXPECTED)
def test_script_on_one_and_two_ranks(name, of_script, tmp_path):
    script = of_script(name)
    reference = quantities(script)
    assert_values(reference, EXPECTED[name])
    if name == STARTED:
        demo = ROOT / "demos" / f"demo_{name}.py"
        require_success(start([demo, "--no-pictures", "--out", tmp_path], ranks=2))
        assert_same(script, tmp_path)
        pictures = sorted(path.name for path in script.glob("*.png"))
        expected = ["contact_0.png", "convergence.png", "deformed.png", "surface_displacement.png"]
        assert pictures == expected
        assert (script / "report.html").exists()
    if name == "sphere":
        sticks = (reference["stick_area"] / reference["contact_area"]) ** 0.5
        assert sticks == pytest.approx(0.765, rel=3e-3)


def test_cylinders_against_hertz_and_cattaneo(of_script):
    """Johnson, Contact Mechanics (1985), (4.43), (4.45) and (7.27): by the forces that came out."""
    modulus, radius = 1000 / (2 * (1 - 0.3**2)), 8 / 2
    found = quantities(of_script("cylinders"))
    force, shear = found["normal_force"], -found["friction_force"][0]
    half_width = sqrt(4 * force * radius / (pi * modulus))
    assert found["contact_area"] == pytest.approx(2 * half_width, rel=5e-3)
    assert found["max_contact_pressure"] == pytest.approx(2 * force / (pi * half_width), rel=3e-3)
    used = shear / (0.3 * force)
    assert used == pytest.approx(0.57, abs=5e-3)
    assert found["stick_area"] == pytest.approx(2 * half_width * sqrt(1 - used), rel=1e-2)


@pytest.mark.parametrize("name", DEMOS)
def test_script_says_what_the_scene_does(name):
    script = runpy.run_path(str(ROOT / "demos" / f"demo_{name}.py"))["scene"]
    scene = load_scene(ROOT / "demos" / f"{name}.toml", ())
    assert placed(script) == placed(scene)


def placed(scene):
    """A scene whose files have their whole paths."""
    meshes = [replace(mesh, file=str(Path(mesh.file).resolve())) for mesh in scene.mesh]
    return replace(scene, mesh=meshes)


def history_of(name, folder, ranks):
    """Quantities of each step of a long demo, on a coarser mesh."""
    run_demo(name, folder, *LONG[name], ranks=ranks)
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    return [step["quantities"] for step in result["steps"]]


def test_stick_zone_of_a_specimen_that_is_pulled(tmp_path):
    """Half as wide as c, shifted by e, as its page says; the criteria are worst at the edge."""
    run_demo("fretting", tmp_path, *LONG["fretting"])
    found = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert found["quantities"]["friction_force"][0] == pytest.approx(-80.16, rel=1e-3)
    words, numbers = table(tmp_path)
    sticks = [x for (_, status), x in zip(words, numbers[:, 0], strict=True) if status == "STICK"]
    assert (max(sticks) + min(sticks)) / 2 == pytest.approx(-0.25, abs=0.07)  # half a cell
    assert (max(sticks) - min(sticks)) / 2 == pytest.approx(0.707, abs=0.07)
    for name in ("swt", "crossland", "dang_van"):
        assert found["fretting"]["worst"][name]["at"][0] == pytest.approx(1.0, abs=0.14), name


def test_work_of_a_cycle(tmp_path):
    """Of the formula in the demo, for the largest force of the second half of the cycle."""
    friction, force, modulus = 0.5, 20, 1000 / (1 - 0.49**2)
    steps = history_of("cycle", tmp_path, ranks=1)
    turns = [steps[number - 1] for number in (6, 16, 26)]
    forces = [turn["friction_force"][0] for turn in turns]
    assert forces == pytest.approx([forces[2], -forces[2], forces[2]], rel=1e-3)
    most = forces[2] / (friction * force)
    assert most == pytest.approx(0.848, rel=2e-3)
    share = (1 - most) * log(1 - most) + most - most**2 / 2
    work = 4 * (friction * force) ** 2 / (pi * modulus) * share
    found = turns[2]["friction_work"] - turns[0]["friction_work"]
    assert found == pytest.approx(work, rel=0.02)
    loop = np.array([step["friction_force"][0] for step in steps[5:26]])
    there = 0.022 * np.linspace(1, -1, 11)
    moved = np.concatenate([there, there[-2::-1]])
    area = np.sum((loop[1:] + loop[:-1]) / 2 * np.diff(moved))
    assert abs(area) == pytest.approx(work, rel=0.02)


def test_sheared_sphere_sticks_on_cattaneos_circle(tmp_path):
    """And its report has an animation with a frame a step, which changes."""
    steps = history_of("cattaneo", tmp_path, ranks=2)
    for step in steps[3:]:
        share = step["friction_force"][0] / (0.3 * step["normal_force"])
        sticks = sqrt(step["stick_area"] / step["contact_area"])
        assert sticks == pytest.approx((1 - share) ** (1 / 3), abs=0.03)
    assert share == pytest.approx(0.9, abs=5e-3)
    done = start(["-m", "fenics_contact", "report", tmp_path], 1)
    assert done.returncode == 0, done.stderr
    with Image.open(tmp_path / "animation_0.gif") as film:
        frames = [np.array(frame.convert("RGB")) for frame in ImageSequence.Iterator(film)]
    assert len(frames) == len(steps)
    assert all((one != other).any() for one, other in pairwise(frames))
    assert "animation_0.gif" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_bolted_joint_carries_its_load_by_friction(tmp_path):
    """By balance of forces on each part, on any mesh; as an engineer checks such a joint."""
    run_demo("joint", tmp_path, *LONG["joint"])
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    steps = result["steps"]
    assert len(steps) == 6
    for step in steps:
        forces = {row["name"]: row["quantities"] for row in step["contacts"]}
        bolt = step["preloads"]["bolt"]
        for name in ("head", "nut"):
            assert forces[name]["normal_force"] == pytest.approx(bolt["force"], rel=1e-6)
        pull = np.interp(step["load_factor"], (1, 2, 4, 6), (0, 1500, -1500, 1500))
        on_left_bar = forces["lap"]["friction_force"][0] - forces["head"]["friction_force"][0]
        assert on_left_bar == pytest.approx(pull, abs=1e-3)
        assert forces["lap"]["max_slip"] < 0.01  # far from the clearance of .5
        assert forces["hole above"]["contact_area"] == 0
    assert steps[0]["preloads"]["bolt"]["force"] == pytest.approx(10e3, rel=1e-9)
    work = [step["quantities"]["friction_work"] for step in steps]
    assert all(more - less > 0 for less, more in pairwise(work))


def test_block_slides_up_the_incline(of_script):
    """By balance of forces, for any pressure: F/G = (μ + tan α) / (1 − μ tan α)."""
    result = json.loads((of_script("incline") / "result.json").read_text(encoding="utf-8"))
    push = {row["on"]: row["reaction"] for row in result["supports"]}["block.left"]
    limit = (FRICTION + SLOPE) / (1 - FRICTION * SLOPE)
    assert push == pytest.approx([WEIGHT * limit, 0], rel=1e-9, abs=1e-9)
    shares = [step["quantities"]["slip_area"] for step in result["steps"]]
    assert shares[0] < 0.1 and 0.5 < shares[5] < 1.9  # at rest; slipping in part


@pytest.mark.parametrize(
    ("name", "ranks", "coarser"),
    [
        ("sphere", 3, ["mesh.parameters.size=0.5"]),
        ("cylinders", 2, ["mesh.0.parameters.size=0.15", "mesh.1.parameters.size=0.1"]),
    ],
)
def test_several_ranks_give_the_answer_of_one(name, ranks, coarser, tmp_path):
    """Contact, stick and slip: with a half-space's resultant as an unknown, and of two bodies."""
    run_demo(name, tmp_path / "alone", *coarser)
    run_demo(name, tmp_path / "together", *coarser, ranks=ranks)
    assert_same(tmp_path / "alone", tmp_path / "together")


@pytest.mark.parametrize("name", FRICTIONLESS)
def test_without_friction(name, tmp_path):
    found = run_demo(name, tmp_path, NO_FRICTION)
    assert_values(found, FRICTIONLESS[name])


def test_annulus_in_the_adhesive_limit(tmp_path):
    """Glued to the half-space, as the demo's comment says: 1.0276 times the force."""
    found = run_demo("annulus", tmp_path, 'contact.0.contact="bonded"', NO_FRICTION)
    assert found["normal_force"] == pytest.approx(1.0276 * FLAT_FORCE, rel=1e-3)


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
        "from fenics_contact.cli.commands import guarded\n"
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
    assert "the machine failed: out of memory: too much; " in done.stderr


def test_layers_slip_more_the_further_they_bend(tmp_path):
    """They begin as Euler's beam of both heights, and slip makes them softer."""
    run_demo("joint_damping", tmp_path, *LONG["joint_damping"])
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    beam = 3.516015 * sqrt(210e3 / 7.85e-9) * 10 / sqrt(12) / (2 * pi * 200**2)
    assert result["modes"][0]["natural_frequency"] == pytest.approx(beam, rel=5e-3)
    little, much = result["damping"]
    assert little["natural_frequency"] == pytest.approx(beam, rel=5e-3)
    assert little["damping_ratio"] < 1e-6 < 0.1 < much["damping_ratio"] < 0.3
    assert 0.5 * beam < much["natural_frequency"] < 0.8 * beam


def test_a_ball_bounces_as_hertz_and_newton_say(tmp_path):
    """Coarser than the demo: the force to 10 %, what it gives back to 1 %."""
    found = run_demo("impact", tmp_path, *LONG["impact"])
    steps = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["steps"]
    forces = [step["quantities"]["normal_force"] for step in steps]
    assert max(forces) == pytest.approx(15934, rel=0.1)
    assert 1e-6 * sum(force > 0 for force in forces) == pytest.approx(38e-6, rel=0.1)
    mass = found["momentum"][1] / 5000
    assert mass == pytest.approx(4 / 3 * pi * 10**3 * 7.85e-9, rel=0.02)
    assert found["impulse"][1] == pytest.approx(2 * mass * 5000, rel=0.01)


def test_rubber_on_a_belt_sticks_and_slips(tmp_path):
    """All of it slides with the coefficient of sliding, and sticks with more than that."""
    run_demo("stick_slip", tmp_path, *LONG["stick_slip"])
    steps = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["steps"]
    found = [step["quantities"] for step in steps]
    shares = np.array([step["friction_force"][0] / step["normal_force"] for step in found])
    slides = np.array([step["stick_area"] == 0 for step in found])
    late = np.arange(len(shares)) > len(shares) // 2
    assert np.abs(shares[slides & late] - 0.5).max() < 1e-6
    assert (slides & late).sum() > 10
    assert 0.52 < shares[late & ~slides].max() < 0.8
