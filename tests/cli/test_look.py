"""``fenics-contact look``: from a file to a page, and to a scene that ``check`` accepts."""

import json
import random
import re
import tomllib
from html.parser import HTMLParser

import numpy as np
import pytest

from fenics_contact import load_scene, main, run
from tests import cad
from tests.mesh.geometry.test_bodies import LABELS, NAMES
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.soundness.damages import seam_through_the_body
from tests.mesh.test_loading import with_gmsh
from tests.messages import says
from tests.scenes import ROOT

pytestmark = pytest.mark.serial

STACK = """
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 2, 2, 1};
Box(2) = {0.5, 0.5, 1, 1, 1, 1};
Mesh.MeshSizeMax = 0.7;
"""
GLUED = STACK + "BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }\n"
DISK = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0,0,0,2,1};\nDisk(2) = {1,1.5,0,.5,.5};\n'


def look(path, out, *options):
    code = main(["look", str(path), "--out", str(out), *options])
    return code, out / "scene.toml"


def checked(path, out):
    """The scene that is proposed for a file, which ``check`` accepts."""
    code, scene = look(path, out)
    assert code == 0
    assert main(["check", str(scene), "--quiet"]) == 0
    return tomllib.loads(scene.read_text())


def test_three_solids_of_a_step_file_to_a_scene_that_check_accepts(folder, capsys):
    """No number is looked up by hand."""
    cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    scene = checked(folder / "joint.step", folder / "out")
    said = capsys.readouterr().out
    assert "joint.step: 3 bodies, 21 surfaces" in said
    assert "lower_plate-upper_plate: lower_plate: 3; upper_plate: 12; they touch over" in said
    assert [material["on"] for material in scene["material"]] == NAMES
    assert [contact["name"] for contact in scene["contact"]] == [
        "lower_plate-upper_plate",
        *("lower_plate-Bolt_1", "lower_plate-Bolt_2", "upper_plate-Bolt_1", "upper_plate-Bolt_2"),
    ]
    (bolt,) = scene["preload"]
    assert (bolt["on"], bolt["axis"]) == ("Bolt", [0, 0, 1])
    assert 0 < bolt["between"][0] < bolt["between"][1] < 2 * cad.THICK
    assert bolt["locked_from"] == 1 and scene["steps"]["times"] == [1, 2]
    assert {contact["law"] for contact in scene["contact"]} == {"incremental"}
    text = (folder / "out" / "scene.toml").read_text()
    assert "# Held by contacts alone: 'upper_plate', 'Bolt'" in text
    assert "# moment = [0, 0, 1000]" in text
    assert len(scene["support"]) == 1  # the head and the nut hold on to the other bodies
    assert scene["mesh"]["file"] == "../joint.step"


def test_a_stack_is_held_and_can_be_pressed(folder):
    """Nothing holds the upper block down before a load does: the example holds both."""
    (folder / "stack.geo").write_text(STACK)
    scene = checked(folder / "stack.geo", folder / "out")
    assert len(scene["support"]) == 2
    path = folder / "out" / "scene.toml"
    groups = scene["mesh"]["groups"]
    assert groups[scene["contact"][0]["against"]] == [11]
    (top,) = (s["on"] for s in scene["support"] if groups[s["on"]] > [6])  # of the upper block
    lines = path.read_text().splitlines()
    place = lines.index(f'on = "{top}"')
    lines[place - 1 : place + 2] = ["[[load]]", f'on = "{top}"', "pressure = 3"]
    path.write_text("\n".join(lines))
    result = run(load_scene(path, ["solver.errors='none'"]))
    assert result.passed
    assert result.contacts[0].quantities["normal_force"] == pytest.approx(3)


@pytest.mark.parametrize(
    ("text", "supports", "contacts"),
    [(GLUED, 1, []), (DISK, 1, ["bonded"]), (STACK.replace("Box(2)", "//"), 1, [])],
)
def test_geometries_of_one_body_or_glued_or_of_a_disk(folder, text, supports, contacts):
    (folder / "g.geo").write_text(text)
    scene = checked(folder / "g.geo", folder / "out")
    assert len(scene["support"]) == supports
    assert [contact["contact"] for contact in scene.get("contact", [])] == contacts


ROUND = """
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 1, 1};
Box(2) = {-2, -2, 0, 4, 4, 1};
Cylinder(3) = {0, 0, 0, 0, 0, 1, 1};
BooleanDifference{ Volume{2}; Delete; }{ Volume{3}; Delete; }
"""


@pytest.mark.parametrize("text", [ROUND, STACK])
def test_curved_cells_have_displacements_of_degree_2(folder, text):
    """Those of degree 1 hold no rigid rotation on curved cells."""
    (folder / "g.geo").write_text(text)
    code, path = look(folder / "g.geo", folder / "out")
    scene = tomllib.loads(path.read_text())
    assert code == 0 and len(scene["contact"]) == 1
    orders = scene["mesh"].get("order", 1), scene["discretisation"]["degree"]
    assert orders == ((2, 2) if text is ROUND else (1, 1))


@pytest.mark.parametrize(("vent", "least"), [(0.4, 2 * 3.14159 * 2 / 12), (1.5, None)])
def test_small_radii_that_nothing_touches_do_not_have_the_smallest_cells(folder, vent, least):
    """A thin vent in the lower plate, far from the bolt, whose shank has a radius of 2."""

    def build(occ):
        cad.joint(occ)
        hole = occ.addCylinder(2.5, 2.5, 0, 0, 0, cad.THICK, vent)
        occ.cut([(3, 1)], [(3, hole)])

    cad.write_shapes(folder / "joint.step", build, LABELS)
    mesh = checked(folder / "joint.step", folder / "out")["mesh"]
    assert mesh["curvature"] == 12
    assert mesh.get("least_size") == (least and pytest.approx(least, rel=0.05))


@pytest.mark.parametrize(
    ("kind", "order", "kinematics", "degree"),
    [("CAX4", 1, "axisymmetric", 1), ("CPS8", 2, "plane stress", 2), ("S4", 1, "plane strain", 1)],
)
def test_what_elements_are_made_for_is_the_kinematics(folder, kind, order, kinematics, degree):
    text = inp(Block("quadrilateral", order), kind, surfaces=not kind.startswith("S"))
    (folder / "b.inp").write_text(text)
    scene = checked(folder / "b.inp", folder / "out")
    assert scene["kinematics"] == kinematics
    assert scene["discretisation"]["degree"] == degree


def test_a_file_without_surfaces_has_sides_and_says_what_to_add_for_others(folder, capsys):
    """And a scene in which nothing holds, touches or loads the bodies is not called one to run."""
    (folder / "b.bdf").write_text(bdf(Block("hexahedron"), "CHEXA"))
    code, scene = look(folder / "b.bdf", folder / "out")
    said = capsys.readouterr().out
    assert code == 0 and "side_1 to side_6" in said
    assert "add to the file: BSURFS, or shells (CQUAD4" in said
    assert main(["check", str(scene)]) == 0
    capsys.readouterr()
    support = (
        '[[support]]  # TO BE REPLACED: an example that holds all of a surface\non = "side_1"\n'
    )
    text = scene.read_text()
    assert support in text
    scene.write_text(text.replace(support, "").replace("displacement = {", "# {"))
    assert main(["check", str(scene)]) == 2
    said = capsys.readouterr()
    assert "can be run" not in said.out
    assert "neither a support nor a contact nor a load" in said.err and "BSURFS" in said.err


def test_a_torn_mesh_can_be_looked_at(folder, capsys):
    block = Block("quadrilateral", cells=(4, 2))
    seam_through_the_body(block, random.Random(1))
    (folder / "b.inp").write_text(inp(block, "CPE4"))
    code, scene = look(folder / "b.inp", folder / "out")
    assert code == 0 and "share no nodes there" in capsys.readouterr().out
    assert main(["check", str(scene)]) == 2


HOSTILE = ["<script>x()</script>", "a\"\"\"b''' ]]> [x]", "Ö \u202e\x1b[2J\u2028"]


def mesh_with_names(gmsh, path, groups):
    gmsh.model.occ.addBox(0, 0, 0, 2, 2, 1)
    gmsh.model.occ.addBox(0.5, 0.5, 1, 1, 1, 1)
    gmsh.model.occ.synchronize()
    for number, (dimension, part, name) in enumerate(groups, start=1):
        gmsh.model.addPhysicalGroup(dimension, [part], number, name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.7)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(path))


def test_labels_of_files_are_text_and_nothing_else(folder, capsys):
    """In the page, in the scene and on the terminal."""
    path = folder / "mesh.msh"
    groups = [(3, 1, "SOLIDA"), (3, 2, "SOLIDB"), (2, 6, "SIDE"), (2, 11, "b"), (2, 5, "c")]
    with_gmsh(lambda gmsh: mesh_with_names(gmsh, path, groups))
    text = path.read_text()
    for (_, _, name), label in zip(groups, HOSTILE, strict=False):
        text = text.replace(f'"{name}"', '"' + label.replace('"', "'") + '"')
    path.write_text(text)
    scene = checked(path, folder / "out")
    said = capsys.readouterr()
    assert "\x1b" not in said.out + said.err and "\u202e" not in said.out
    (contact,) = scene["contact"]
    assert re.fullmatch(r"[A-Za-z0-9_-]+", contact["name"])
    assert (contact["on"], contact["against"]) == (HOSTILE[2], "b")
    assert {m["on"] for m in scene["material"]} == {h.replace('"', "'") for h in HOSTILE[:2]}
    page = (folder / "out" / "look.html").read_text()
    read = Page()
    read.feed(page)
    assert read.tags.count("script") == 3  # data, plotly, the page's own
    assert {surface["called"] for surface in json.loads(read.scripts[0])["surfaces"]} == {
        "6",
        "11",
        "5",
    }
    assert "<script>x()</script>" in read.texts
    ours = read.scripts[0] + "".join(read.texts)
    assert not any(character in ours for character in "\u202e\u2028\x1b")


class Page(HTMLParser):
    """Tags, texts and scripts of a page, as a browser takes them."""

    def __init__(self):
        super().__init__()
        self.tags, self.texts, self.scripts = [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)

    def handle_data(self, data):
        (self.scripts if self.tags[-1:] == ["script"] else self.texts).append(data)


def test_sets_of_another_program_may_overlap(folder):
    """Sets of nodes name the same facets as surfaces: each facet stands in one contact."""

    def write(gmsh):
        gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
        names = [(3, 1, "lower"), (3, 2, "upper"), (2, 6, "top"), (2, 11, "foot"), (2, 5, "ground")]
        mesh_with_names(gmsh, folder / "mesh.inp", names)

    with_gmsh(write)
    scene = checked(folder / "mesh.inp", folder / "out")
    assert len(scene["contact"]) == 1
    assert "groups" not in scene["mesh"]


def test_scenes_are_left_alone_and_files_are_refused_as_by_check(folder, capsys):
    (folder / "out").mkdir()
    (folder / "out" / "scene.toml").write_text("mine")
    assert look(ROOT / "meshes" / "bracket.step", folder / "out")[0] == 2
    assert (folder / "out" / "scene.toml").read_text() == "mine"
    says("scene_exists", capsys.readouterr().err)
    (folder / "bad.geo").write_text('SystemCall "touch x";\n')
    for name, said in (("bad.geo", "statement_in_bad_geo"), ("no.step", "no_mesh_file_no_step")):
        assert look(folder / name, folder / "new")[0] == 2
        says(said, capsys.readouterr().err)
    assert not (folder / "new").exists()
    with pytest.raises(SystemExit, match="2"):
        look(folder / "bad.geo", folder / "new", "--tolerance", "-1")


def test_points_and_edges_that_supports_may_hold(folder, capsys):
    """Named ones first, then numbers; a scene holds what the page calls by them."""
    (folder / "g.geo").write_text(STACK + 'Physical Point("foot") = {1};\n')
    scene = checked(folder / "g.geo", folder / "out")
    said = capsys.readouterr().out
    assert '17 points and 24 edges that supports may hold, such as on = "foot"' in said
    page = (folder / "out" / "look.html").read_text()
    data = re.search(r'id="look-data"[^>]*>(.*?)</script>', page, re.DOTALL)[1]
    places = {one["called"]: one["pieces"] for one in json.loads(data)["places"]}
    assert len(places) == 41 and places["foot"] == places["point 1"]
    assert places["foot"] == [[[0, 0, 1]] * 2]
    # Each edge of both blocks runs along an axis, over all of its side.
    edges = {name: np.array(pieces) for name, pieces in places.items() if "edge" in name}
    lengths = sorted(float(np.ptp(ends.reshape(-1, 3), axis=0).sum()) for ends in edges.values())
    assert lengths == pytest.approx([1.0] * 16 + [2.0] * 8)
    assert "from (0, 0, 0) to (0, 0, 1)" in page
    path = folder / "out" / "scene.toml"
    held = scene["support"][0]["on"]
    path.write_text(path.read_text().replace(f'on = "{held}"', 'on = "edge 1"', 1))
    assert main(["check", str(path), "--quiet"]) == 0
