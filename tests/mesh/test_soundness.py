"""Fifty damaged scenes and meshes, the same on every machine and in every run.

Each must end with exit code 2 and one sentence, or, where the damage leaves a valid
scene, be solved with all checks passed: no traceback, no hang, no crash, nothing written.
Run in this process, so that under MPI a rank left behind would show as a hang.
"""

import json
import random
import re
import struct
import time

import pytest
from mpi4py import MPI

from fenics_contact import main
from tests.scenes import ROOT

COMM = MPI.COMM_WORLD
SCENE = (ROOT / "demos" / "slab.toml").read_text(encoding="utf-8")
SCENE = re.sub(r"cell = .*\nparameters = .*\n", "", SCENE).replace("../meshes/slab.geo", "m.msh")
FORMATS = [(2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)]
SECONDS = 20.0


def truncated(data, chance):
    return data[: chance.randrange(len(data))]


def rubbish(data, chance):
    """Random bytes over a random stretch."""
    start = chance.randrange(len(data))
    return data[:start] + chance.randbytes(chance.choice([1, 8, 200])) + data[start + 8 :]


def scattered(data, chance):
    """Single bytes changed here and there."""
    changed = bytearray(data)
    for _ in range(chance.choice([1, 5, 50])):
        changed[chance.randrange(len(data))] = chance.randrange(256)
    return bytes(changed)


def swapped(data, chance):
    """The wrong byte order in a few words."""
    changed = bytearray(data)
    for _ in range(5):
        start = chance.randrange(len(data) - 8)
        changed[start : start + 8] = changed[start : start + 8][::-1]
    return bytes(changed)


def huge(data, chance):
    """A number of the text becomes huge."""
    number = chance.choice(list(re.finditer(rb"(?<![\w.])\d+(?![\w.])", data)))
    value = chance.choice([b"99999999999999999999", b"4000000000", b"-7", b"1e308", b"nan"])
    return data[: number.start()] + value + data[number.end() :]


def wrong_tag(data, chance):
    """A word of the file's own becomes another."""
    word = chance.choice(list(re.finditer(rb'\$?[A-Za-z]{3,}|"\w+"', data)))
    return data[: word.start()] + chance.choice([b"$Nodes", b"x", b""]) + data[word.end() :]


def without_a_line(data, chance):
    lines = data.splitlines(keepends=True)
    del lines[chance.randrange(len(lines))]
    return b"".join(lines)


def emptied(data, chance):
    """A section, or table, without its content."""
    sections = list(re.finditer(rb"(?<=\n)(\$[A-Z]\w+|\[+\w+\]+)\n", data))
    first = chance.choice(sections)
    following = re.search(rb"\n(\$End|\[)", data[first.end() :])
    end = first.end() + following.start() if following else len(data)
    return data[: first.end()] + data[end:]


MESH_MUTATIONS = [truncated, rubbish, scattered, swapped, huge, wrong_tag, without_a_line, emptied]
SCENE_MUTATIONS = [truncated, rubbish, scattered, huge, wrong_tag, without_a_line, emptied]


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    """The slab's mesh as bytes in each format."""
    found = None
    if COMM.rank == 0:
        import gmsh

        folder = tmp_path_factory.mktemp("sound")
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.RecombineAll", 1)
        gmsh.merge(str(ROOT / "meshes" / "slab.geo"))
        gmsh.model.mesh.generate(2)
        found = []
        for version, binary in FORMATS:
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(folder / "m.msh"))
            found.append((folder / "m.msh").read_bytes())
        gmsh.finalize()
    return COMM.bcast(found)


def judge(folder, capfd, scene, mesh):
    """Run a scene and hold it to what this module promises.

    Returns:
        What was said of it; nothing of a scene that was solved.
    """
    if COMM.rank == 0:
        (folder / "scene.toml").write_bytes(scene)
        (folder / "m.msh").write_bytes(mesh)
    COMM.barrier()
    out = folder / "out"
    capfd.readouterr()
    start = time.perf_counter()
    code = main(["run", str(folder / "scene.toml"), "--out", str(out), "--quiet"])
    assert time.perf_counter() - start < SECONDS
    said = COMM.bcast(capfd.readouterr())
    if code == 0:
        result = json.loads((out / "result.json").read_text(encoding="utf-8"))
        assert result["checks"] and all(check["passed"] for check in result["checks"].values())
        return ""
    assert code == 2, (code, said)
    assert said.err.startswith("fenics-contact: ")
    assert said.err.count("\n") == 1, said.err
    assert "Traceback" not in said.err
    assert said.out == ""
    if COMM.rank == 0:
        assert sorted(p.name for p in folder.iterdir()) == ["m.msh", "scene.toml"]
    COMM.barrier()
    return said.err


@pytest.mark.parametrize("kind", range(len(FORMATS)))
def test_sound_meshes_are_solved(folder, capfd, meshes, kind):
    assert judge(folder, capfd, SCENE.encode(), meshes[kind]) == ""


@pytest.mark.parametrize("number", range(32))
def test_damaged_mesh(folder, capfd, meshes, number):
    chance = random.Random(1982 + number)
    mutate = MESH_MUTATIONS[number % len(MESH_MUTATIONS)]
    judge(folder, capfd, SCENE.encode(), mutate(meshes[number // 8], chance))


@pytest.mark.parametrize("number", range(18))
def test_damaged_scene(folder, capfd, meshes, number):
    chance = random.Random(834 + number)
    mutate = SCENE_MUTATIONS[number % len(SCENE_MUTATIONS)]
    judge(folder, capfd, mutate(SCENE.encode(), chance), meshes[0])


def test_entity_counts_beyond_all_memory(folder, capfd, meshes):
    """Such a count in a binary file crashes Gmsh itself: here it must not crash us."""
    start = meshes[3].index(b"$Nodes\n") + len(b"$Nodes\n")
    for count in (2**62, 2**33):
        damaged = meshes[3][:start] + struct.pack("<QQ", count, count) + meshes[3][start + 16 :]
        assert judge(folder, capfd, SCENE.encode(), damaged).startswith("fenics-contact: mesh.file")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("youngs_modulus = 1000", "youngs_modulus = 1e300", "of a size between 1e-100 and 1e+100"),
        ("youngs_modulus = 1000", "youngs_modulus = 1e-300", "of a size between"),
        ("pressure = 300", "pressure = 1" + 400 * "0", "of a size between"),
        ("pressure = 300", "pressure = 1" + 9000 * "0", "cannot be read"),
        ("pressure = 300", "pressure = " + 3000 * "[" + 3000 * "]", "cannot be read"),
        ("[-300, 0]", "[-300, inf]", r"load[0].traction[1] = inf: must be a finite number"),
        ('on = "top"', "on = 3", "contact[0].on = 3: must be a text, in quotes"),
        ('"m.msh"', '"m\\u0000.msh"', "there is no such file"),
        ('"m.msh"', '"."', "is a folder, not a file"),
        ('"m.msh"', '"/dev/zero"', "there is no such file"),
        ('"m.msh"', '"scene.toml"', "must end in .geo, .msh"),
        ('"m.msh"', '"m.msh"\ngroups = { a = [-1] }', "mesh.groups.a: "),
        ('"m.msh"', '"m.msh"\ngroups = { a = "b" }', "mesh.groups.a = 'b': must be a list"),
        ('"m.msh"', '"m.msh"\ngroups = { top = [1] }', "has a group of that name already"),
        ('"m.msh"', '"m.msh"\nsize = 1', "is a mesh already"),
        ('"m.msh"', '"m.msh"\ncurvature = 2', "mesh.curvature = 2: must be"),
    ],
)
def test_values_that_no_scene_can_mean(folder, capfd, meshes, old, new, message):
    text = SCENE.replace(old, new, 1)
    assert text != SCENE
    assert message in judge(folder, capfd, text.encode(), meshes[0])


def test_no_name_in_a_scene_is_a_path(folder, capfd, meshes):
    """Results go to the output folder, whatever things are called."""
    text = SCENE.replace('on = "top"', 'on = "top"\nname = "../../beyond_it"').replace(
        'title = "Slab', 'title = "../beyond_it'
    )
    assert judge(folder, capfd, text.encode(), meshes[0]) == ""
    assert sorted(p.name for p in folder.iterdir()) == ["m.msh", "out", "scene.toml"]
    assert not list(folder.parent.glob("*beyond_it*"))
