import dataclasses
import re

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fenics_contact import Group, InputError, MeshSource, Support, run
from fenics_contact.common.dolfinx_versions import boundary_entities
from fenics_contact.mesh.loading import load_body
from tests.messages import refused, says
from tests.scenes import ROOT, SLAB, box_body, slab

COMM = MPI.COMM_WORLD
BRACKET = str(ROOT / "meshes" / "bracket.step")

OVERLAPPING = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1};
Physical Surface("body") = {1};
Physical Curve("all") = {1, 2, 3, 4};
Physical Curve("top") = {3};
Physical Curve(7) = {2};
"""


RECTANGLE = 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 2, 1};\n'


def write(folder, text, name="g.geo"):
    path = folder / name
    if COMM.rank == 0:
        path.write_text(text)
    COMM.barrier()
    return MeshSource(str(path))


def with_gmsh(action):
    """Run an action with Gmsh on rank 0, as the user's own tools would."""
    if COMM.rank == 0:
        import gmsh

        gmsh.initialize(readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        try:
            action(gmsh)
        finally:
            gmsh.finalize()
    COMM.barrier()


def refusal(source, dimension=2):
    """What is said of a mesh that is refused: the same on every rank."""
    with pytest.raises(InputError) as caught:
        load_body(source, dimension, COMM)
    said = str(caught.value)
    assert COMM.allgather(said) == [said] * COMM.size
    assert "\n" not in said
    return said


def area(body, name, groups=None):
    entities = body.entities((groups or body.groups)[name])
    mesh, dimension = body.mesh, body.dimension
    mesh.topology.create_connectivity(dimension - 1, dimension)
    mesh.topology.create_connectivity(dimension, dimension - 1)
    ds = ufl.Measure(
        "ds", domain=mesh, subdomain_data=[(1, boundary_entities(mesh.topology, entities))]
    )
    return COMM.allreduce(fem.assemble_scalar(fem.form(fem.Constant(mesh, 1.0) * ds(1))))


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
@pytest.mark.parametrize("order", [1, 2])
def test_slab_has_the_scenes_cells_and_order(cell, order):
    parameters = {"length": 4, "height": 2, "cells_along": 6, "cells_across": 3}
    body = load_body(MeshSource(SLAB, parameters=parameters, cell=cell, order=order), 2, COMM)
    per_square = 2 if cell == "triangle" else 1
    assert body.mesh.topology.index_map(2).size_global == 18 * per_square
    assert body.mesh.topology.cell_name() == cell
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == order
    assert set(body.groups) == {"slab", "bottom", "right", "top", "left"}
    assert area(body, "top") == pytest.approx(4)
    assert area(body, "left") == pytest.approx(2)


def test_a_geometry_with_macros_has_parameters(folder):
    """It is read for the names of its constants, and once more for the mesh."""
    text = """DefineConstant[ w = 2 ];
Macro Plate
  Point(1) = {0, 0, 0}; Point(2) = {w, 0, 0}; Point(3) = {w, 1, 0}; Point(4) = {0, 1, 0};
  Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
  Curve Loop(1) = {1:4}; Plane Surface(1) = {1};
Return
Call Plate;
Physical Curve("top") = {3}; Physical Surface("block") = {1};
"""
    source = write(folder, text)
    for given, width in (({}, 2), ({"w": 3}, 3)):
        body = load_body(dataclasses.replace(source, parameters=given), 2, COMM)
        assert area(body, "top") == pytest.approx(width)
    wrong = dataclasses.replace(source, parameters={"v": 3})
    says("no_constant_v", refusal(wrong))


def test_parameters_do_not_leak_from_one_mesh_to_the_next():
    load_body(MeshSource(SLAB, parameters={"cells_along": 3}), 2, COMM)
    body = load_body(MeshSource(SLAB), 2, COMM)
    assert body.mesh.topology.index_map(2).size_global == 32


def test_groups_may_share_facets_and_be_numbers(folder):
    body = load_body(write(folder, OVERLAPPING), 2, COMM)
    assert area(body, "all") == pytest.approx(6)
    assert area(body, "top") == pytest.approx(2)
    assert area(body, "7") == pytest.approx(1)


@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.parametrize("binary", [0, 1])
def test_mesh_file_gives_the_same_body(folder, version, binary):
    source = write(folder, OVERLAPPING)
    msh = folder / "g.msh"

    def save(gmsh):
        gmsh.open(source.file)
        gmsh.model.mesh.generate(2)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(str(msh))

    with_gmsh(save)
    direct = load_body(source, 2, COMM)
    body = load_body(MeshSource(str(msh)), 2, COMM)
    assert set(body.groups) == set(direct.groups) == {"body", "all", "top", "7"}
    for name in ("all", "top", "7"):
        assert area(body, name) == pytest.approx(area(direct, name)), name
    cells = body.mesh.topology.index_map(2).size_global
    assert cells == direct.mesh.topology.index_map(2).size_global
    says("size_of_a_mesh", refusal(MeshSource(str(msh), size=0.1)))
    says("order_of_a_mesh", refusal(MeshSource(str(msh), order=2)))


# Two triangles and two lines. All are in part 1: only the physical groups differ, as in
# files of other programs.
TWO_TRIANGLES = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 5 "left"
1 6 "right"
2 7 "plate"
$EndPhysicalNames
$Nodes
5
1 0 0 0
2 1 0 0
3 1 1 0
14 0 1 0
15 9 9 9
$EndNodes
$Elements
4
1 1 2 5 1 14 1
2 1 2 6 1 2 3
3 2 2 7 1 1 2 3
4 2 2 7 1 1 3 14
$EndElements
"""


def test_msh_of_another_program_keeps_its_groups_apart(folder):
    source = write(folder, TWO_TRIANGLES.replace("2 3\n3 2", "2 3\n3 2"), "a.msh")
    body = load_body(source, 2, COMM)
    assert body.mesh.topology.index_map(2).size_global == 2
    assert set(body.groups) == {"left", "right", "plate"}
    assert area(body, "left") == pytest.approx(1)
    assert area(body, "right") == pytest.approx(1)
    assert body.group("5", "load[0].on") == body.groups["left"]
    # a side that carries two groups is listed once for each
    both = TWO_TRIANGLES.replace("Elements\n4\n", "Elements\n5\n9 1 2 5 1 2 3\n", 1)
    body = load_body(write(folder, both, "b.msh"), 2, COMM)
    assert area(body, "left") == pytest.approx(2)
    assert area(body, "right") == pytest.approx(1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("3 1 1 0\n", "3 1 0 0\n", "1 cell is degenerate or inverted .* first at"),
        ("3 1 1 0\n", "3 -.5 .5 0\n", "degenerate or inverted"),
        ("4 2 2 7 1 1 3 14", "4 2 2 7 1 1 14 3", "inverted .* the first at "),
        ("4 2 2 7 1 1 3 14", "4 2 2 7 1 1 3 3", "the same node twice"),
        ("14 0 1 0", "14 0 nan 0", "not finite|Gmsh says|coordinates"),
        ("14 0 1 0", "14 0 1 0.3", "not in the plane z = 0"),
        (
            "4 2 2 7 1 1 3 14",
            "4 3 2 7 1 1 2 3 14",
            "the same corners|mixes cells|does not define|Gmsh says",
        ),
        ("4 2 2 7 1 1 3 14", "4 2 2 7 1 1 3 77", "Gmsh|does not define"),
        ("4 2 2 7 1 1 3 14", "4 4 2 7 1 1 2 3 14", "is 3-dimensional"),
        (
            "4 2 2 7 1 1 3 14",
            "4 2 2 7 1 1 3 14\n4 2 2 7 1 1 3 14",
            "lists 5 elements where it says 4",
        ),
        ("15 9 9 9", "15 9 9 9\n16 1 2 3\n", "lists 6 nodes where it says 5"),
        ("$MeshFormat", "$MeshFormats", "does not start as a Gmsh mesh"),
        ("2.2 0 8", "1.0 0 8", "does not start as a Gmsh mesh of version 2 or 4"),
        ("$MeshFormat", 'SystemCall "touch x";', "does not start as a Gmsh mesh"),
    ],
)
def test_unsound_mesh_is_one_sentence_on_every_rank(folder, old, new, message):
    text = TWO_TRIANGLES.replace(old, new, 1)
    assert text != TWO_TRIANGLES
    source = write(folder, text, "a.msh")
    said = refusal(source)
    assert re.search(message, said), said
    assert "mesh.file = '" in said and "a.msh'" in said


def test_degenerate_cells_are_counted_and_placed(folder):
    text = TWO_TRIANGLES.replace("3 1 1 0\n", "3 2 0 0\n")
    says("cell_is_degenerate", refusal(write(folder, text, "a.msh")))


def test_part_numbered_the_other_way_round_is_no_fault(folder):
    text = TWO_TRIANGLES.replace("1 1 2 3\n", "1 1 3 2\n").replace("1 1 3 14", "1 1 14 3")
    assert text.count("1 1 3 2\n") == 1
    body = load_body(write(folder, text, "a.msh"), 2, COMM)
    assert area(body, "left") == pytest.approx(1)


def test_mesh_of_the_wrong_dimension():
    says("mesh_of_dimension_2", refusal(MeshSource(SLAB), 3))
    says("bracket_in_the_plane", refusal(MeshSource(BRACKET), 2))


INSIDE = (
    RECTANGLE
    + """
Rectangle(2) = {2, 0, 0, 1, 1};
BooleanFragments{ Surface{1}; Delete; }{ Surface{2}; Delete; }
Physical Surface("both") = {1, 2};
Physical Curve("between") = Curve In BoundingBox {1.9, -1, -1, 2.1, 2, 1};
Physical Curve("all") = Curve{:};
Point(50) = {8, 8, 0};
Point(51) = {9, 9, 0};
Line(50) = {50, 51};
Physical Curve("elsewhere") = {50};
"""
)


def test_boundary_inside_the_body_empty_or_elsewhere(folder):
    body = load_body(
        write(folder, INSIDE.replace("Curve{:}", "Curve In BoundingBox {-1, -1, -1, 4, 2, 1}")),
        2,
        COMM,
    )
    assert body.mesh.topology.index_map(2).size_global > 4  # disconnected parts may be, too
    for name, message in (
        ("between", "facets_between_inside"),
        ("all", "some_facets_inside"),
        ("elsewhere", "facets_elsewhere"),
    ):
        with refused(message):
            body.boundary(name, "contact[0].on")
    body.group("between", "support[0].on")  # a support may be anywhere


def test_a_run_says_which_key_is_wrong(folder):
    source = write(folder, INSIDE.replace("Curve{:}", "{1}"))
    scene = slab()
    for on, said in (("between", "facets_between_inside"), ("nowhere", "no_group_nowhere")):
        contact = dataclasses.replace(scene.contact[0], on=on)
        wrong = dataclasses.replace(scene, mesh=source, support=(), load=(), contact=(contact,))
        with refused(said):
            run(wrong, COMM)


def test_axisymmetric_mesh_over_its_axis(folder):
    source = write(folder, RECTANGLE.replace("{0, 0, 0", "{-0.5, 0, 0"))
    scene = dataclasses.replace(
        slab(),
        kinematics="axisymmetric",
        mesh=source,
        support=(Support("body", {"y": 0}),),
        load=(),
        contact=(),
    )
    with refused("radius_is_negative"):
        run(scene, COMM)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("suffix", [".step", ".brep"])
def test_cad_file_in_the_plane(folder, order, suffix):
    def save(gmsh):
        occ = gmsh.model.occ
        plate, hole = occ.addRectangle(0, 0, 0, 4, 2), occ.addDisk(2, 1, 0, 0.5, 0.5)
        occ.cut([(2, plate)], [(2, hole)])
        occ.synchronize()
        gmsh.write(str(folder / f"plate{suffix}"))

    with_gmsh(save)
    file = str(folder / f"plate{suffix}")
    coarse = MeshSource(file, order=order, size=0.5)
    body = load_body(coarse, 2, COMM)
    assert set(body.groups) == {"body"}
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == order
    sides = [number for number in body.numbers if number.isdigit()]
    circle = min(sides, key=lambda n: abs(area(body, n, body.numbers) - np.pi))
    around = area(body, circle, body.numbers)
    named = load_body(dataclasses.replace(coarse, groups={"hole": (int(circle),)}), 2, COMM)
    assert area(named, "hole") == pytest.approx(around)
    # the polygon or the parabolas in the circle, and a finer one by curvature alone
    assert around == pytest.approx(np.pi, rel=0.1 if order == 1 else 3e-3)
    fine = load_body(dataclasses.replace(coarse, curvature=60), 2, COMM)
    assert abs(area(fine, circle, fine.numbers) - np.pi) < 0.1 * abs(around - np.pi)
    smaller = load_body(dataclasses.replace(coarse, size=0.2), 2, COMM)
    cells = [b.mesh.topology.index_map(2).size_global for b in (body, smaller)]
    assert cells[1] > 3 * cells[0]
    quadrilaterals = load_body(dataclasses.replace(coarse, cell="quadrilateral"), 2, COMM)
    assert quadrilaterals.mesh.topology.cell_name() == "quadrilateral"


def test_bracket_has_numbers_and_names():
    source = MeshSource(BRACKET, size=8, groups={"wall": (1,), "pads": (19, 20)})
    body = load_body(source, 3, COMM)
    assert area(body, "wall") == pytest.approx(30 * 40)
    assert area(body, "pads") == pytest.approx(2 * 400)
    assert area(body, "9", body.numbers) == pytest.approx(30 * 8)
    with refused("no_group_end"):
        body.boundary("end", "load[0].on")
    says("no_surface_44", refusal(dataclasses.replace(source, groups={"wall": (1, 44)}), 3))
    says("parameters_of_a_step_file", refusal(dataclasses.replace(source, parameters={"a": 1}), 3))


@pytest.mark.parametrize(("unit", "size"), [("$", 1.0), (".CENTI.", 1.0), (".MILLI.", 1.0)])
def test_numbers_of_a_step_file_are_not_converted(folder, unit, size):
    def save(gmsh):
        gmsh.model.occ.addBox(0, 0, 0, size, size, size)
        gmsh.model.occ.synchronize()
        gmsh.write(str(folder / "box.step"))
        text = (folder / "box.step").read_text()
        assert ".MILLI." in text
        (folder / "box.stp").write_text(text.replace(".MILLI.", unit))

    with_gmsh(save)
    body = load_body(MeshSource(str(folder / "box.stp"), size=0.5), 3, COMM)
    assert area(body, "1", body.numbers) == pytest.approx(1)


@pytest.mark.parametrize("content", ["", "hello", "ISO-10303-21;\nHEADER;\nENDSEC;\n"])
@pytest.mark.parametrize("suffix", [".step", ".brep", ".msh", ".geo"])
def test_files_of_rubbish(folder, content, suffix):
    said = refusal(write(folder, content, f"rubbish{suffix}"), 3)
    assert "rubbish" in said


def test_empty_group_of_ones_own_mesh():
    body = box_body((2, 2))
    empty = dataclasses.replace(body, groups={"empty": Group(1, (77,))})
    with refused("group_empty_is_empty"):
        empty.group("empty", "support[0].on")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Line(1) = {1, 2};\n", "gmsh_says"),
        ("Point(1) = {0, 0, 0};\n", "mesh_of_dimension_0"),
        ('Point(1) = {0, 0, 0};\nPhysical Surface("b") = {4};\n', "mesh_of_dimension_0"),
        ('SetFactory("OpenCASCADE");\nBox(1) = {0, 0, 0, 1, 1, 1};\n', "mesh_of_dimension_3"),
        (RECTANGLE + "Rotate {{1, 0, 0}, {0, 0, 0}, 0.1} { Surface{1}; }\n", "mesh_out_of_plane"),
        (RECTANGLE + "Exit;\n", "statement_exit_refused"),
    ],
)
def test_bad_geometry_is_one_error_on_every_rank(folder, text, message):
    with refused(message):
        load_body(write(folder, text), 2, COMM)


def test_unknown_parameter_lists_those_there_are():
    with refused("no_constant_cells_alon"):
        load_body(MeshSource(SLAB, parameters={"cells_alon": 4}), 2, COMM)


def test_parameter_that_the_geometry_overwrites_is_refused(folder):
    source = write(folder, "n = 3;\n" + OVERLAPPING)
    with refused("constant_is_overwritten"):
        load_body(MeshSource(source.file, parameters={"n": 5}), 2, COMM)


def test_missing_file_and_wrong_kind(folder):
    with refused("no_mesh_file_no"):
        load_body(MeshSource(str(folder / "no.geo")), 2, COMM)
    with refused("no_such_suffix_txt"):
        load_body(write(folder, "x", "g.txt"), 2, COMM)


def test_missing_group_lists_those_there_are():
    body = load_body(MeshSource(SLAB), 2, COMM)
    with refused("no_group_rigt"):
        body.group("rigt", "load[0].on")
    with refused("contact_of_a_part"):
        body.boundary("slab", "contact[0].on")
