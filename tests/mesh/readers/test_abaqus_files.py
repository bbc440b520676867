"""How Abaqus files say the same in other ways, and what becomes of names."""

import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import MeshSource
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.readers.test_formats import of_cells
from tests.mesh.test_loading import area, write
from tests.messages import refused

COMM = MPI.COMM_WORLD
# As Abaqus/CAE writes it: a part, one instance, a reference point with the number of a node, and
# sets of one name in the part and in the assembly.
CAE = """*Heading
*Part, name=Plate
*Node
      1,           0.,           0.
      2,           1.,           0.
      3,           2.,           0.
      4,           0.,           1.
      5,           1.,           1.
      6,           2.,           1.
*Element, type=CPE4R
1, 1, 2, 5, 4
2, 2, 3, 6, 5
*Nset, nset=Set-1, generate
 1,  6,  1
*Elset, elset=Set-1
 1,
*Solid Section, elset=Set-1, material=steel
,
*End Part
*Assembly, name=Assembly
*Instance, name=Plate-1, part=Plate
*End Instance
*Node
      1,           7.,           7.,           0.
*Nset, nset=RP
 1,
*Nset, nset=Set-1, instance=Plate-1
 4, 5, 6
*Elset, elset=_Surf-1_S1, internal, instance=Plate-1, generate
 1, 2, 1
*Surface, type=ELEMENT, name=Surf-1
_Surf-1_S1, S1
*Surface, type=ELEMENT, name=Around
Plate-1.Set-1,
*Surface, type=REVOLUTION, name=rigid
1., 2.
*End Assembly
"""


def test_one_part_with_one_instance(folder):
    body = load_body(write(folder, CAE, "c.inp"), 2, COMM)
    assert body.mesh.topology.index_map(2).size_global == 2
    names = {"body", "Set-1", "Set-1.nodes", "Plate.Set-1", "Surf-1", "Around", "RP"}
    assert set(body.groups) == names
    assert of_cells(body, "body") == 2 and of_cells(body, "Set-1") == 1
    assert area(body, "Surf-1") == pytest.approx(2)
    assert area(body, "Set-1.nodes") == pytest.approx(2)  # the assembly's: the upper side
    assert area(body, "Plate.Set-1") == pytest.approx(6)
    assert area(body, "Around") == pytest.approx(3)  # outer sides of the first cell
    with refused("group_rp_is_empty"):
        body.group("RP", "support[0].on")


def test_same_by_included_files(folder):
    whole = inp(Block("tetrahedron"), "C3D4")
    middle = whole.index("*ELEMENT")
    (folder / "deep").mkdir(exist_ok=True)
    COMM.barrier()
    write(folder / "deep", whole[middle:], "rest.inp")
    nodes = re.search(r"(?s)Nall\n(.*?)\*", whole)[1]
    write(folder, nodes, "nodes.txt")
    text = "*node, nset=Nall, INPUT=nodes.txt\n*Include, input=deep/rest.inp\n"
    body = load_body(write(folder, text, "m.inp"), 3, COMM)
    direct = load_body(write(folder, whole, "w.inp"), 3, COMM)
    assert set(body.groups) == set(direct.groups)
    for name in ("top", "n_left"):
        assert area(body, name) == pytest.approx(area(direct, name))


def test_nastran_includes_and_free_fields(folder):
    text = bdf(Block("hexahedron"), "CHEXA", "CQUAD4")
    cards = text[text.index("CHEXA") :].replace("ENDDATA\n", "")
    free = "".join(
        ",".join(line[at : at + 8].strip() for at in range(0, len(line), 8)) + "\n"
        for line in cards.splitlines()
    )
    write(folder, free, "cells.bdf")
    main = text[: text.index("CHEXA")] + "INCLUDE 'cells.bdf'\nENDDATA\n"
    body = load_body(write(folder, main, "m.bdf"), 3, COMM)
    assert [area(body, name) for name in ("21", "22", "23")] == pytest.approx([2, 2, 1])


def test_sets_of_shells_are_facets(folder):
    block = Block("hexahedron")
    skin = "".join(
        f"{number}, {', '.join(str(node + 11) for node in nodes)}\n"
        for number, nodes in enumerate(block.facets(2, 0), 901)
    )
    more = f"*ELEMENT, TYPE=M3D4R, ELSET=Block\n{skin}*ELSET, ELSET=skin\n901\n*MATERIAL"
    text = inp(block, "C3D8").replace("*MATERIAL", more)
    text = text.replace("*MATERIAL", "*SURFACE, NAME=Under\nskin, SNEG\n*MATERIAL")
    body = load_body(write(folder, text, "s.inp"), 3, COMM)
    assert of_cells(body, "BLOCK") == len(block.cells)
    assert area(body, "BLOCK.facets") == pytest.approx(2)
    assert [area(body, name) for name in ("skin", "Under")] == pytest.approx([1 / 3, 1 / 3])


def test_faces_of_shells_have_the_names_of_both_programs(folder):
    """CalculiX calls them S1 and S2; both are the side of the solid that the shell covers."""
    block = Block("hexahedron")
    skin = "".join(
        f"{number}, {', '.join(str(node + 11) for node in nodes)}\n"
        for number, nodes in enumerate(block.facets(2, 0), 901)
    )
    more = f"*ELEMENT, TYPE=S4, ELSET=skin\n{skin}"
    more += "".join(f"*SURFACE, NAME={name}\nskin, {name}\n" for name in ("S1", "S2", "SPOS"))
    body = load_body(write(folder, inp(block, "C3D8") + more, "s.inp"), 3, COMM)
    assert [area(body, name) for name in ("S1", "S2", "SPOS")] == pytest.approx([2, 2, 2])
    assert body.notes == ()


def test_gmsh_calls_all_plane_elements_by_one_name(folder):
    """Its .inp files have CPS cells whatever the model: that says nothing."""
    text = inp(Block("quadrilateral"), "CPS4")
    assert load_body(write(folder, text, "a.inp"), 2, COMM).kinematics == {"plane stress": "CPS4"}
    text = text.replace("*ELEMENT", "******* E L E M E N T S *************\n*ELEMENT", 1)
    assert load_body(write(folder, text, "b.inp"), 2, COMM).kinematics == {}


def test_contact_surfaces_of_nastran(folder):
    """Sides of solids by three of their corners, with and without lines that go on."""
    for order in (1, 2):
        block = Block("hexahedron", order)
        text = bdf(block, "CHEXA")
        sides = [
            ",".join(str(int(n)) for n in (cell + 101, *(block.cells[cell][[4, 5, 6]] + 11)))
            for cell, face in block.sides(2, 1)
        ]
        card = "BSURFS,7,,,,"
        card += sides[0] + "".join(f"\n+,{one}" for one in sides[1:])
        body = load_body(
            write(folder, text.replace("ENDDATA", f"{card}\nENDDATA"), "n.bdf"), 3, COMM
        )
        assert area(body, "BSURFS.7") == pytest.approx(2)
        assert body.notes == ()
        (note,) = load_body(write(folder, text, "m.bdf"), 3, COMM).notes
        assert "names no surface" in note and note.endswith("on the sides of solids")


def test_meshes_of_several_formats_in_one_body(folder):
    block, beside = Block("hexahedron"), Block("hexahedron")
    beside.points = beside.points + np.array([5.0, 0.0, 0.0])
    files = {
        "a": write(folder, inp(block, "C3D8"), "a.inp").file,
        "n": write(folder, bdf(beside, "CHEXA", "CQUAD4"), "n.bdf").file,
    }
    sources = [MeshSource(file, name=name) for name, file in files.items()]
    body = load_body(sources, 3, COMM)
    assert body.mesh.topology.index_map(3).size_global == 2 * len(block.cells)
    assert [area(body, name) for name in ("a.top", "n.22")] == pytest.approx([2, 2])
