"""Scenes to start from: each runs as it is, gives what its comments say, and is in the package."""

import json
import re
import tomllib
from math import log, pi, sqrt

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import load_scene, main
from fenics_contact.analytic import contact as formulas
from fenics_contact.analytic.two_bodies import Tube, pressure
from fenics_contact.cli import new_scene
from fenics_contact.common.errors import InputError
from fenics_contact.common.program import mesh_file, templates
from tests.messages import says
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
MODULUS = formulas.plane_strain_modulus(1000, 0.3)
NAMES = (
    *("cycle", "cylinders", "hertz", "joint", "own", "part", "pin", "pressfit", "punch", "slab"),
    "winkler",
)


@pytest.fixture
def found(folder, request, capsys):
    """What a scene to start from gives, solved in an empty folder, on one or more ranks."""
    scene = folder / f"{request.param}.toml"
    assert main(["new", request.param, "--out", str(scene)]) == 0
    out = folder / "results"
    assert main(["run", str(scene), "--out", str(out), "--set", "solver.errors=none"]) == 0
    result = json.loads((out / "result.json").read_text(encoding="utf-8"))
    assert all(check["passed"] for check in result["checks"].values())
    return result


def test_these_are_all():
    assert tuple(templates()) == NAMES


@pytest.mark.parametrize("found", ["hertz"], indirect=True)
def test_hertz(found):
    """The formulas of Hertz, and the numbers that its comments have."""
    exact = formulas.paraboloid(MODULUS, 8, 1)
    assert found["quantities"]["normal_force"] == pytest.approx(exact.force, rel=1e-3)
    assert found["quantities"]["max_contact_pressure"] == pytest.approx(exact.peak, rel=5e-3)
    assert found["quantities"]["contact_area"] == pytest.approx(pi * exact.radius**2, rel=2e-2)
    said = templates()["hertz"].read_text(encoding="utf-8")
    for number in (f"{exact.force:.1f}", f"{exact.radius:.3f}", f"{exact.peak:.1f}", "25.13"):
        assert number in said


@pytest.mark.parametrize("found", ["punch"], indirect=True)
def test_punch(found):
    """Boussinesq's force; the edge is singular, so cells of a twentieth of the radius give .4 %."""
    exact = formulas.flat_punch_force(MODULUS, 1, 0.01)
    assert f"{exact:.2f}" == "21.98"
    assert found["quantities"]["normal_force"] == pytest.approx(exact, rel=1e-2)
    assert load_scene(templates()["punch"]).contact[0].obstacle.shape == "flat punch"  # is drawn


@pytest.mark.parametrize("found", ["slab"], indirect=True)
def test_slab(found):
    """Equilibrium along x, and that friction does not exceed its bound."""
    friction, reaction = found["quantities"]["friction_force"][0], found["quantities"]["reaction"]
    assert friction + reaction[0] == pytest.approx(300, rel=1e-9)
    assert found["quantities"]["stick_area"] == pytest.approx(6.25, abs=0.3)


@pytest.mark.parametrize("found", ["winkler"], indirect=True)
def test_winkler(found):
    """Equilibrium, and the paper's numbers."""
    quantities = found["quantities"]
    assert quantities["normal_force"] == pytest.approx(10, rel=1e-9)
    assert quantities["displacement_middle"][1] == pytest.approx(-0.0578, abs=2e-4)
    assert quantities["contact_area"] == pytest.approx(3.2, abs=0.05)


@pytest.mark.parametrize("found", ["cylinders"], indirect=True)
def test_cylinders(found):
    """Hertz for the force that comes out; Cattaneo's and Mindlin's part that sticks."""
    quantities = found["quantities"]
    force, shift = quantities["normal_force"], abs(quantities["friction_force"][0])
    exact = formulas.line_contact(MODULUS / 2, 4, force)
    assert quantities["max_contact_pressure"] == pytest.approx(exact.peak, rel=1e-2)
    assert quantities["contact_area"] == pytest.approx(2 * exact.radius, rel=4e-2)
    sticks = quantities["stick_area"] / quantities["contact_area"]
    assert sticks == pytest.approx(sqrt(1 - shift / (0.3 * force)), abs=0.03)
    assert found["steps"][0]["quantities"]["slip_area"] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("found", ["cycle"], indirect=True)
def test_cycle(found):
    """The work of friction from 6 to 26, a cycle, by the formula of demos/cycle.toml."""
    work = {step["load_factor"]: step["quantities"]["friction_work"] for step in found["steps"]}
    most = 0.5 * 20
    share = abs(found["quantities"]["friction_force"][0]) / most
    shape = (1 - share) * log(1 - share) + share - share**2 / 2
    exact = 4 * most**2 / (pi * formulas.plane_strain_modulus(1000, 0.49)) * shape
    assert exact == pytest.approx(0.0196, abs=1e-4)
    assert work[26] - work[6] == pytest.approx(exact, rel=3e-2)


@pytest.mark.parametrize("found", ["pressfit"], indirect=True)
def test_pressfit(found):
    """Lamé's pressure where the shaft is fitted, and Coulomb's force when all of it slips."""
    tubes = Tube(10, 20, 210e3, 0.3), Tube(20, 30, 210e3, 0.3)
    exact, area = pressure(*tubes, 2.5e-3, is_long=False), 2 * pi * 20 * 20
    assert f"{exact:.2f}" == "6.15" and f"{0.1 * exact * area:.0f}" == "1546"
    fitted = found["steps"][0]["quantities"]
    assert fitted["pressure_integral"] / area == pytest.approx(exact, rel=1e-2)
    quantities = found["quantities"]
    assert quantities["stick_area"] == 0
    assert quantities["friction_force"][1] == pytest.approx(0.1 * exact * area, rel=5e-3)
    assert quantities["friction_force"][1] == pytest.approx(
        0.1 * quantities["pressure_integral"], rel=1e-9
    )


@pytest.mark.parametrize("found", ["pin"], indirect=True)
def test_pin(found):
    """Equilibrium, and Hertz for a contact that is narrow against the hole."""
    quantities = found["quantities"]
    assert quantities["reaction"][0] == pytest.approx(-50, rel=1e-3)  # facets of a round pin
    exact = formulas.line_contact(210e3 / 2, 1 / (1 / 9.95 - 1 / 10), 100)
    assert f"{exact.radius:.2f}" == "1.55" and f"{exact.peak:.1f}" == "41.0"
    assert quantities["max_contact_pressure"] == pytest.approx(exact.peak, rel=1e-2)
    assert quantities["contact_area"] == pytest.approx(exact.radius, rel=5e-2)


@pytest.mark.parametrize("found", ["joint"], indirect=True)
def test_joint(found):
    """Balance of forces on each part."""
    assert found["steps"][0]["preloads"]["bolt"]["force"] == pytest.approx(10e3, rel=1e-9)
    forces = {contact["name"]: contact["quantities"] for contact in found["contacts"]}
    for name in ("head", "nut"):
        bolt = found["preloads"]["bolt"]["force"]
        assert forces[name]["normal_force"] == pytest.approx(bolt, rel=1e-6)
    lap, head = (forces[name]["friction_force"][0] for name in ("lap", "head"))
    assert lap - head == pytest.approx(1500, rel=1e-6)
    (across,) = (row["reaction"][2] for row in found["supports"] if row["on"] == "pulled")
    clamped = forces["head"]["normal_force"] - across
    assert forces["lap"]["normal_force"] == pytest.approx(clamped, rel=1e-6)
    assert forces["hole above"]["contact_area"] == forces["hole below"]["contact_area"] == 0


@pytest.mark.parametrize("found", ["part"], indirect=True)
def test_part(found):
    """Balance of forces; friction of each pad within its limit, which the smooth one reaches."""
    pads = [contact["quantities"] for contact in found["contacts"]]
    assert [pad["normal_force"] for pad in pads] == pytest.approx([16e3, 16e3], rel=1e-9)
    held = np.sum([pad["friction_force"] for pad in pads], axis=0) + found["quantities"]["reaction"]
    assert held[:2] == pytest.approx([-9600, -2400], rel=1e-6)
    sizes = [np.linalg.norm(pad["friction_force"]) for pad in pads]
    assert sizes[0] < 9600 and 0.9 * 3200 < sizes[1] <= 3200


@pytest.mark.parametrize("found", ["own"], indirect=True)
def test_own(found):
    """Equilibrium: friction carries what pulls, the floor what presses."""
    assert found["quantities"]["normal_force"] == pytest.approx(20, rel=1e-9)
    assert found["quantities"]["friction_force"] == pytest.approx([-3, 0], abs=1e-8)
    before = found["steps"][0]["quantities"]["friction_force"]
    assert before == pytest.approx([0, 0], abs=1e-8)


@pytest.mark.serial
def test_keys_behind_a_comment_sign_are_keys(tmp_path):
    """Each of them may be put in, alone, where it stands: it is understood, or contradicts."""
    text = templates()["own"].read_text(encoding="utf-8")
    lines = text.splitlines()
    keys = [n for n, line in enumerate(lines) if re.match(r"# \w+ = ", line)]
    assert len(keys) > 15
    for number in keys:
        changed = list(lines)
        changed[number] = changed[number].removeprefix("# ")
        for above in range(number - 1, 0, -1):  # its table, where that is behind a sign, too
            if changed[above].startswith("# ["):
                changed[above] = changed[above].removeprefix("# ")
                needed = above + 1
                while needed < len(lines) and re.match(r"# \w+ = ", changed[needed]):
                    changed[needed] = changed[needed].removeprefix("# ")
                    needed += 1
            elif not changed[above].startswith("#"):
                break
        path = tmp_path / "own.toml"
        path.write_text("\n".join(changed), encoding="utf-8")
        try:
            load_scene(path)
        except InputError as error:
            assert "unknown key" not in str(error) and "must be" not in str(error), lines[number]


def test_nothing_is_overwritten(folder, capsys):
    scene, geometry = folder / "mine.toml", folder / "mine.geo"
    for present in (scene, geometry):
        if COMM.rank == 0:
            present.write_text("mine")
        COMM.barrier()
        assert main(["new", "hertz", "--out", str(scene)]) == 2
        said = COMM.bcast(capsys.readouterr().err)
        says("file_exists", said, name=present.name)
        assert said.count("\n") == 1
        assert present.read_text() == "mine"
        assert len(list(folder.iterdir())) == 1
        COMM.barrier()
        if COMM.rank == 0:
            present.unlink()
        COMM.barrier()


def test_unknown_names_and_bad_files(folder, capsys):
    for arguments, words in (
        (["hertzz"], "no_scene_hertzz"),
        (["gearbox"], "no_scene_gearbox"),
        ([], "no_scene_is_said"),
        (["slab", "--out", str(folder / "slab")], "out_is_no_toml"),
        (["slab", "--out", "/proc/none/slab.toml"], "out_in_proc"),
    ):
        assert main(["new", *arguments]) == 2
        said = COMM.bcast(capsys.readouterr().err)
        says(words, said, names=", ".join(NAMES))
        assert said.count("\n") == 1
    assert not list(folder.iterdir())


def test_a_name_with_quotes_still_makes_a_scene(folder, capsys):
    scene = folder / 'a "b" $c' / "d 'e'.toml"
    assert main(["new", "slab", "--out", str(scene)]) == 0
    said = COMM.bcast(capsys.readouterr().out)
    assert "results/d '\"'\"'e'\"'\"''" in said  # as a shell takes it
    made = load_scene(scene)
    assert made.mesh[0].file == str(scene.with_suffix(".geo"))
    assert scene.with_suffix(".geo").read_bytes() == (ROOT / "meshes" / "slab.geo").read_bytes()


def test_the_list_names_them_all(capsys):
    assert main(["new", "--list"]) == 0
    said = COMM.bcast(capsys.readouterr().out)
    for name, path in templates().items():
        title = tomllib.loads(path.read_text(encoding="utf-8"))["title"]
        assert re.search(rf"^  {name} +{re.escape(title)}$", said, re.MULTILINE)


def test_their_meshes_come_with_the_program():
    for path in templates().values():
        for name in new_scene.geometries(path.read_text(encoding="utf-8")):
            assert (ROOT / "meshes" / name).is_file() and mesh_file(name).endswith(name)
