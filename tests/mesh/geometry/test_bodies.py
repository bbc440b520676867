"""Solids of CAD files are bodies: their names, sizes, and how they lie together."""

import dataclasses
import functools
import logging
import math
import re
from collections import Counter

import numpy as np
import pytest
from dolfinx import fem
from mpi4py import MPI
from ufl import Measure

from fenics_contact import MeshSource, main
from fenics_contact.common.wording import plain_name
from fenics_contact.mesh.geometry import bodies
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.size_field import SizeField
from fenics_contact.mesh.tagged_mesh import Relation
from tests import cad
from tests.body.test_connected_parts import parts_of
from tests.mesh.test_loading import area, refusal, with_gmsh, write
from tests.messages import refused, says

COMM = MPI.COMM_WORLD
LABELS = ("lower plate", "upper plate", "Bolt")
NAMES = ["lower_plate", "upper_plate", "Bolt"]


def volume(body, name):
    tags = body.entities(body.groups[name])
    owned = tags[tags < body.mesh.topology.index_map(body.dimension).size_local]
    dx = Measure("dx", domain=body.mesh, subdomain_data=[(1, owned)])
    form = fem.form(fem.Constant(body.mesh, 1.0) * dx(1))
    return COMM.allreduce(fem.assemble_scalar(form))


def cells_of(body, name):
    tags = body.entities(body.groups[name])
    return COMM.allreduce(
        int((tags < body.mesh.topology.index_map(body.dimension).size_local).sum())
    )


def kinds_of(body):
    return {frozenset(relation.bodies): relation.kind for relation in body.relations}


def test_solids_of_a_step_file_are_bodies_with_its_labels(folder):
    file = cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    body = load_body(MeshSource(file, size=4, curvature=8, sizes={"Bolt": 2.0}), 3, COMM)
    assert list(body.groups) == [*NAMES, "body"]
    assert parts_of(body, 3)[0].names == tuple(NAMES)
    plate = cad.WIDE**2 * cad.THICK
    exact = plate - math.pi * cad.HOLE**2 / 4 * cad.THICK
    assert plate > volume(body, "upper_plate") == pytest.approx(exact, rel=0.01)
    assert volume(body, "body") == pytest.approx(sum(volume(body, name) for name in NAMES))
    pairs = [(0, 1), (0, 2), (1, 2)]
    assert kinds_of(body) == {frozenset((NAMES[a], NAMES[b])): "touching" for a, b in pairs}
    assert {str(number) for number in range(1, 15)} <= set(body.numbers)


def test_shared_face_glues_and_equal_faces_do_not(folder):
    def boxes(occ, glued):
        made = [(3, occ.addBox(0, 0, level, 1, 1, 1)) for level in (0, 1)]
        made.append((3, occ.addBox(0, 0, 5, 1, 1, 1)))
        if glued:
            occ.fragment(made[:1], made[1:2])

    found = {}
    for glued in (True, False):
        file = cad.write_shapes(folder / f"{glued}.brep", lambda occ, g=glued: boxes(occ, g))
        body = load_body(MeshSource(file, size=1), 3, COMM)
        assert list(body.groups) == ["body_1", "body_2", "body_3", "body"]
        assert parts_of(body, 3)[0].count == (2 if glued else 3)
        found[glued] = [(relation.bodies, relation.kind) for relation in body.relations]
        assert volume(body, "body_2") == pytest.approx(1)
    assert found[True] == [(("body_1", "body_2"), "glued")]
    assert found[False] == [(("body_1", "body_2"), "touching")]


def test_overlap_is_said_with_its_volume(folder, caplog):
    """A shank in two holes that are narrower: π/4 (d² − D²) of the plates' thickness, each."""
    file = cad.write_shapes(folder / "press.step", lambda occ: cad.joint(occ, 5.2), LABELS)
    with caplog.at_level(logging.WARNING, logger="fenics_contact"):
        body = load_body(MeshSource(file, size=5), 3, COMM)
    found = {r.bodies: r for r in body.relations if r.kind == "overlapping"}
    assert list(found) == [("lower_plate", "Bolt"), ("upper_plate", "Bolt")]
    sides = [number for number in body.numbers if number.isdigit()]
    assert sides == [str(number) for number in range(1, 22)]  # nothing is left over
    for relation in found.values():
        exact = math.pi / 4 * (5.2**2 - 5**2) * cad.THICK
        assert relation.overlap == pytest.approx(exact, rel=1e-9)
        bolt = math.pi / 4 * (5.2**2 * 2 * cad.THICK + cad.HEAD**2 * 2 * cad.HIGH)
        assert relation.share == pytest.approx(exact / bolt, rel=1e-9)
    told = [record.getMessage() for record in caplog.records]
    assert len(told) == (2 if COMM.rank == 0 else 0)
    assert all("overlap by 6.409" in line and "press fit" in line for line in told)


@pytest.mark.serial
def test_shapes_that_cannot_be_intersected_are_said_and_leave_nothing(monkeypatch):
    def fails(*shapes, **settings):
        raise Exception("Could not intersect")

    def look(gmsh):
        for level in (0, 1):
            gmsh.model.occ.addBox(0, 0, level, 1, 1, 1)
        gmsh.model.occ.synchronize()
        monkeypatch.setattr(gmsh.model.occ, "intersect", fails)
        found = bodies.Bodies(3)
        job = {"groups": [], "sizes": False}
        for prepare in (bodies.name_bodies, bodies.relate):
            prepare(job, found)
        assert [relation["kind"] for relation in found.relations] == ["unknown"]
        gmsh.model.occ.synchronize()
        assert len(gmsh.model.getEntities(3)) == 2

    with_gmsh(look)
    assert "could not be found out" in Relation(("a", "b"), "unknown").words


def test_body_inside_another_is_refused(folder):
    def build(occ):
        occ.addBox(0, 0, 0, 2, 2, 2)
        occ.addSphere(1, 1, 1, 0.5)

    file = cad.write_shapes(folder / "in.step", build)
    says("body_inside_another", refusal(MeshSource(file), 3))


def test_each_body_has_its_size_also_when_it_is_refined(folder):
    def build(occ):
        for x in (0, 1, 5):
            occ.addBox(x, 0, 0, 1, 1, 1)

    file = cad.write_shapes(folder / "boxes.step", build, ("left", "middle", "right"))
    source = MeshSource(file, size=0.4, sizes={"left": 0.2, "right": 0.6})
    body = load_body(source, 3, COMM)
    left, middle, right = (cells_of(body, name) for name in ("left", "middle", "right"))
    assert left > 3 * middle > 4 * right
    box = np.array([[[-9.0, -9, -9], [99, -9, -9], [-9, 99, -9], [-9, -9, 99]]])
    even = SizeField("tetrahedron", box, np.full((1, 4), 0.3))
    finer = load_body(source, 3, COMM, [even])
    assert cells_of(finer, "middle") > 1.4 * middle
    assert cells_of(finer, "left") > 0.7 * left  # not as coarse as the field allows
    assert cells_of(finer, "right") == pytest.approx(cells_of(finer, "middle"), rel=0.2)
    says("no_body_lefft", refusal(dataclasses.replace(source, sizes={"lefft": 1.0}), 3))


def test_no_radius_has_smaller_cells_than_asked_for(folder):
    """A thin hole through a plate, by the areas of its facets."""

    def build(occ):
        plate, hole = occ.addBox(0, 0, 0, 8, 8, 2), occ.addCylinder(4, 4, 0, 0, 0, 2, 0.2)
        occ.cut([(3, plate)], [(3, hole)])

    file = cad.write_shapes(folder / "plate.step", build)
    source = MeshSource(file, size=2.0, curvature=24, groups={"hole": (7,)})
    facets = []
    for least in (None, 0.5):
        body = load_body(dataclasses.replace(source, least_size=least), 3, COMM)
        facets.append(COMM.allreduce(len(body.entities(body.groups["hole"]))))
    assert facets[0] > 5 * facets[1]
    with refused("least_size_above_largest"):
        dataclasses.replace(source, least_size=3.0)


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("<script>alert('x')</script>", "script_alert_x_script"),
        ('a"""]]>\n[mesh]', "a_mesh"),
        ("Prüfstück №1", "Prufstuck_No1"),
        ("--__", ""),
        ("17", ""),
        ("螺栓", ""),
        ("x" * 99, "x" * 40),
    ],
)
def test_names_have_letters_digits_and_lines_only(text, name):
    assert plain_name(text) == name


def test_hostile_labels_of_solids_and_of_faces(folder):
    labels = ["<b>bolt</b>", "plate", "plate", "body", "7", 'q"]\n[a]']

    def build(occ):
        for x in range(len(labels)):
            occ.addBox(3 * x, 0, 0, 1, 2, 3)

    file = folder / "labels.step"
    cad.write_shapes(file, build, labels)
    if COMM.rank == 0:
        faces = [f"side {n % 6}" if n < 6 else "]]>" for n in range(36)]
        file.write_text(cad.label_faces(file.read_text(), faces))
    COMM.barrier()
    body = load_body(MeshSource(str(file)), 3, COMM)
    found = Counter(group.dimension for group in body.groups.values())
    assert found == {2: 6, 3: 7}
    assert all(re.fullmatch(r"[\w-]+", name, re.ASCII) for name in body.groups)
    called = [name for name, group in body.groups.items() if group.dimension == 3]
    assert called == ["b", "plate_1", "plate_2", "body_1", "body_5", "q_a", "body"]


def test_faces_have_the_labels_of_a_step_file(folder):
    """A box with a hole, and a moved one: the labels say where the faces are."""

    def build(occ):
        for x in (0, 10):
            box = occ.addBox(x, 0, 0, 3, 2, 1)
            occ.cut([(3, box)], [(3, occ.addCylinder(x + 1, 1, 0, 0, 0, 1, 0.5))])

    file = folder / "faces.step"
    cad.write_shapes(file, build, ("one", "two"))
    source = MeshSource(str(file), size=1, curvature=8)
    plain = load_body(source, 3, COMM)
    assert not any(group.dimension == 2 for group in plain.groups.values())
    named = [f"face of {number}" for number in range(1, 15)]
    text = file.read_text() if COMM.rank == 0 else ""
    if COMM.rank == 0:
        file.write_text(cad.label_faces(text, named))
    COMM.barrier()
    body = load_body(source, 3, COMM)
    for number in range(1, 15):
        name = f"{'one' if number < 8 else 'two'}_face_of_{number}"
        assert body.groups[name] == body.numbers[str(number)]
    assert load_body(dataclasses.replace(source, groups={"mine": (3,)}), 3, COMM).groups["mine"]
    if COMM.rank == 0:  # in another order, which need not be that of Gmsh
        turned = re.sub(
            r"(CLOSED_SHELL\('',\()([^)]*)", lambda m: m[1] + cad.turned(m[2]), text, count=1
        )
        file.write_text(cad.label_faces(turned, named))
    COMM.barrier()
    again = load_body(source, 3, COMM)
    for name, group in again.groups.items():
        if group.dimension == 2:
            assert area(again, name) == pytest.approx(area(body, name))


@pytest.mark.parametrize("groups", ["", 'Physical Volume("lower") = {1, 2};\n'])
def test_solids_of_a_script_without_groups(folder, groups):
    text = 'SetFactory("OpenCASCADE");\nBox(1) = {0,0,0,1,1,1};\nBox(2) = {0,0,1,1,1,1};\n'
    source = dataclasses.replace(write(folder, text + groups), size=1.0)
    body = load_body(source, 3, COMM)
    assert list(body.groups) == (["lower"] if groups else ["body_1", "body_2", "body"])
    assert len(body.relations) == (0 if groups else 1)
    if groups:
        finer = load_body(dataclasses.replace(source, sizes={"lower": 0.13}), 3, COMM)
        assert cells_of(finer, "lower") > 3 * cells_of(body, "lower")


def test_faces_in_the_plane_are_bodies(folder):
    def build(occ):
        made = [(2, occ.addRectangle(x, 0, 0, 1, 1)) for x in (0, 0.75, 3)]
        assert made

    file = cad.write_shapes(folder / "plane.brep", build)
    source = MeshSource(file, size=0.5, sizes={"body_3": 0.1}, cell="quadrilateral")
    body = load_body(source, 2, COMM)
    assert [(r.bodies, r.kind) for r in body.relations] == [(("body_1", "body_2"), "overlapping")]
    assert body.relations[0].overlap == pytest.approx(0.25)
    assert cells_of(body, "body_3") > 4 * cells_of(body, "body_1")


def test_bodies_of_several_meshes_have_their_names_before_theirs(folder):
    def build(occ, height):
        for x in (0, 1):
            occ.addBox(x, 0, height, 1, 1, 1)

    sources = []
    for name, height in (("left", 0), ("right", 3)):
        build_there = functools.partial(build, height=height)
        file = cad.write_shapes(folder / f"{name}.step", build_there, ("a", "b"))
        sources.append(MeshSource(file, size=1, name=name))
    body = load_body(sources, 3, COMM)
    cells = [name for name, group in body.groups.items() if group.dimension == 3]
    assert cells == [
        f"{side}{name}" for side in ("left", "right") for name in ("", ".a", ".b", ".body")
    ]
    assert body.relations[1].bodies == ("right.a", "right.b")


SCENE = """
kinematics = "3D"
discretisation.degree = 1
solver.stabilisation = true
mesh = { file = "joint.step", size = 8, sizes = { Bolt = 5 }, groups = { foot = [5] } }
support = [{ on = "foot", displacement = { x = 0, y = 0, z = 0 } }]
material = [
  { on = "Bolt", youngs_modulus = 200e3, poissons_ratio = 0.3 },
  { on = "lower_plate", youngs_modulus = 70e3, poissons_ratio = 0.3 },
  { on = "upper_plate", youngs_modulus = 70e3, poissons_ratio = 0.3 },
]
"""


@pytest.mark.serial
def test_check_says_how_the_bodies_lie(folder, capsys):
    cad.write_shapes(folder / "joint.step", cad.joint, LABELS)
    (folder / "scene.toml").write_text(SCENE)
    assert main(["check", str(folder / "scene.toml")]) == 0
    said = capsys.readouterr().out
    assert "lower_plate, upper_plate, Bolt" in said
    assert "'upper_plate' and 'Bolt' touch, and are apart for the mesh" in said
