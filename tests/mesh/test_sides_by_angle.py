"""Sides of files that name none: which there are, and that runs can use them.

That what lies against itself in such a file is refused, as before, `soundness` has.
"""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import Contact, Load, Material, MeshSource, Scene, Support, run
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.readers.test_formats import of_cells, volume
from tests.mesh.test_loading import area, write
from tests.messages import refused, says

COMM = MPI.COMM_WORLD


def test_sides_of_a_block_that_runs_can_use(folder):
    """Six, whatever the order of the cells; by name, by number, and put together by the scene."""
    block = Block("hexahedron", 2)
    first = load_body(write(folder, bdf(block, "CHEXA"), "a.bdf"), 3, COMM)
    names = [f"side_{number}" for number in range(1, 7)]
    assert [name for name in first.groups if name.startswith("side")] == names
    block.cells = block.cells[np.random.default_rng(1).permutation(len(block.cells))]
    source = MeshSource(write(folder, bdf(block, "CHEXA"), "b.bdf").file, groups={"both": (1, 4)})
    body = load_body(source, 3, COMM)
    for name in names:
        assert first.groups[name].centre == body.groups[name].centre
        at_ends = name in ("side_3", "side_6")
        assert area(body, name) == pytest.approx(1 if at_ends else 2)
    assert area(body, "both") == pytest.approx(4)
    assert body.find("3") == body.groups["side_3"]
    says("sides_by_angle", body.notes[-1])
    assert "side_1 at (1, 0.5, 0)" in body.known_groups()
    scene = Scene(
        kinematics="3D",
        mesh=source,
        material=Material(1000.0, 0.0),
        support=(Support("side_3", {"x": 0}), Support("side_2", {"y": 0})),
        load=(Load("side_4", pressure=10),),
        contact=(Contact("side_1", contact="unilateral"),),
    )
    assert run(scene, COMM).quantities["normal_force"] == pytest.approx(20, rel=1e-6)


def test_a_mantle_is_one_side(folder):
    """Half of a ring, which turns by 15° from cell to cell; a set of all nodes names no side."""
    block = Block("hexahedron", 1, cells=(12, 2, 2))
    angle, radius = np.pi / 2 * block.flat[:, 0], 1 + block.flat[:, 1]
    block.points = np.column_stack(
        [radius * np.cos(angle), radius * np.sin(angle), block.flat[:, 2]]
    )
    text = inp(block, "C3D8", surfaces=False)
    text = text[: text.index("*NSET")] + "*NSET, NSET=Nall, GENERATE\n1, 9999\n"
    body = load_body(write(folder, text, "c.inp"), 3, COMM)
    sides = [name for name in body.groups if name.startswith("side")]
    assert len(sides) == 6
    chord = 12 * 2 * np.sin(np.pi / 24)
    found = sorted(area(body, name) for name in sides)
    assert found[:3] == pytest.approx([1, 1, chord])
    assert found[-1] == pytest.approx(2 * chord)
    assert area(body, "Nall") == pytest.approx(sum(found))


def test_files_that_name_a_surface_keep_to_it(folder):
    text = inp(Block("quadrilateral"), "CPE4")
    body = load_body(write(folder, text, "n.inp"), 2, COMM)
    assert body.notes == () and "side_1" not in body.groups


def test_contact_regions_of_nastran_by_elements(folder):
    """BSURF of shells names the sides that they lie on, of solids these, also by ranges."""
    block = Block("hexahedron")
    text = bdf(block, "CHEXA", "CQUAD4")
    first = 101 + len(block.cells)  # the first shell; 6 lie on the bottom, 6 on the top
    for card, name, wanted in (
        (f"BSURF,4,{first},THRU,{first + 5}", "BSURF.4", 2),
        (f"BSURF,5,{first + 6},THRU,{first + 11},BY,2,{first}", "BSURF.5", 4 / 3),
    ):
        whole = text.replace("ENDDATA", f"{card}\nENDDATA")
        body = load_body(write(folder, whole, "s.bdf"), 3, COMM)
        assert area(body, name) == pytest.approx(wanted)
    whole = text.replace("ENDDATA", "BSURF,6,101,THRU,104\nENDDATA")
    assert of_cells(load_body(write(folder, whole, "b.bdf"), 3, COMM), "BSURF.6") == 4
    for card, message in (("BSURF,6,7", "bsurf_of_nothing"), ("BSURF,6,101,THRU", "bsurf_no_end")):
        with refused(message):
            load_body(write(folder, text.replace("ENDDATA", f"{card}\nENDDATA"), "r.bdf"), 3, COMM)


def test_nodes_on_edges_that_nastran_leaves_out(folder):
    """Fields of some elements are blank or zero: edges are straight, or their neighbours'."""
    block = Block("hexahedron", 2, curved=True)
    row = 3
    text = bdf(block, "CHEXA")
    on_edges = [str(node + 11) for node in block.cells[row][8:]]
    at = text.index(f"CHEXA   {101 + row} ")
    card = text[at : text.index("CHEXA", at + 5)]
    fewer = card
    for word in on_edges:
        fewer = fewer.replace(f"{word:<8s}", f"{'0':<8s}" if int(word) % 2 else 8 * " ")
    assert fewer != card
    body = load_body(write(folder, text.replace(card, fewer), "m.bdf"), 3, COMM)
    assert body.mesh.topology.cell_name() == "hexahedron"
    assert volume(body) == pytest.approx(2, rel=0.02)
