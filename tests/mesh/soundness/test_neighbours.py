"""Which cells lie against each other by mistake, and which are meant to."""

import random
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact import load_scene, main, run
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, inp, lines
from tests.mesh.readers.test_formats import volume
from tests.mesh.soundness.damages import one_wrong_node, seam_through_the_body
from tests.mesh.test_loading import refusal, write
from tests.messages import says

COMM = MPI.COMM_WORLD


def torn(**options):
    block = Block("quadrilateral", cells=(4, 2))
    seam_through_the_body(block, random.Random(1))
    return block, inp(block, "CPE4", **options)


def halves(block, text):
    """The two sides of the seam as two sets of elements."""
    piece = block.flat[block.cells].mean(axis=1)[:, 0]
    at = np.unique(block.flat[: len(block.points)], axis=0, return_counts=True)
    seam = at[0][at[1] > 1][0, 0]
    for name, chosen in (("LOW", piece < seam), ("HIGH", piece > seam)):
        text += f"*ELSET, ELSET={name}\n{lines(np.flatnonzero(chosen) + 101)}"
    return text, seam


def test_a_seam_between_bodies_is_a_note_and_one_that_is_named_is_meant(folder):
    block, text = torn(surfaces=False)
    says("sides_share_no_nodes", refusal(write(folder, text, "a.inp")))
    apart, seam = halves(block, text)
    body = load_body(write(folder, apart, "b.inp"), 2, COMM)
    (note,) = body.notes
    assert re.search(r"a surface name their facets: they are not connected there", note)
    side = np.isclose(block.flat[:, 0], seam) & (np.arange(len(block.flat)) < 15)
    named = text + f"*NSET, NSET=SEAM\n{lines(np.flatnonzero(side) + 11)}"
    assert load_body(write(folder, named, "c.inp"), 2, COMM).notes == ()


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral", "hexahedron"])
def test_one_wrong_node_is_always_found(folder, cell):
    """Also where all cells keep their volume's sign, and overlap others."""
    kind = {"triangle": "CPE3", "quadrilateral": "CPE4", "hexahedron": "C3D8"}[cell]
    for seed in range(6):
        block = Block(cell, cells=(4, 3, 2))
        one_wrong_node(block, random.Random(seed))
        assert refusal(write(folder, inp(block, kind), f"{seed}.inp"), block.dimension)


# A cell 1 × 1 beside two of half its height; the node between these is on its side.
HANGING = """*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
5, 1, .5
6, 2, 0
7, 2, .5
8, 2, 1
*ELEMENT, TYPE=CPE4
1, 1, 2, 3, 4
2, 2, 6, 7, 5
3, 5, 7, 8, 3
"""


def test_a_node_on_the_side_of_a_cell(folder):
    says("node_on_a_side", refusal(write(folder, HANGING, "a.inp")))


def test_bodies_that_overlap_by_more_than_half_a_cell_are_told(folder):
    """And by less are not: a press fit may be meant."""
    for off, count in ((0.3, 1), (0.7, 0)):
        text = HANGING.split("*ELEMENT")[0]
        text += "".join(
            f"{n + 10}, {x + off}, {y + off / 9}\n"
            for n, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])
        )
        text += "*ELEMENT, TYPE=CPE4\n1, 1, 2, 3, 4\n2, 10, 11, 12, 13\n*NSET, NSET=A\n1, 2\n"
        body = load_body(write(folder, text, "a.inp"), 2, COMM)
        assert len([note for note in body.notes if "of another body (2 such" in note]) == count


@pytest.mark.parametrize("cell", ["quadrilateral", "hexahedron"])
def test_a_hinge_is_told(folder, cell):
    """Of 2 × 2 cells only two remain, corner to corner."""
    block = Block(cell, cells=(2, 2, 1)[: 2 if cell == "quadrilateral" else 3])
    middles = block.flat[block.cells].mean(axis=1)
    block.cells = block.cells[(middles[:, 0] < 1) == (middles[:, 1] < 0.5)]
    body = load_body(
        write(folder, inp(block, "CPE4" if cell == "quadrilateral" else "C3D8"), "a.inp"),
        block.dimension,
        COMM,
    )
    (note,) = body.notes
    what = "a node" if cell == "quadrilateral" else "an edge"
    assert f"cells hang together by {what} alone at (1, 0.5" in note


QUARTER = """
kinematics = "plane strain"
mesh = { file = "FILE" }
material = { youngs_modulus = 1000, poissons_ratio = 0.3 }
solver = { errors = "none" }
support = [{ on = "n_left", displacement = { x = 0, y = 0 } }]
contact = [{ on = "n_bottom", obstacle = { shape = "plane", indentation = 0.01 } }]
"""


def test_nodes_at_a_quarter_of_their_edges_are_used(folder):
    """As at the tip of a crack: the block is the same, and its answer nearly."""
    forces = []
    for name in ("whole", "quarter"):
        block = Block("quadrilateral", 2, cells=(6, 4))
        if name == "quarter":
            tip = np.argmin(np.linalg.norm(block.flat[:, :2] - [1, 0.5], axis=1))
            for row in np.flatnonzero((block.cells[:, :4] == tip).any(axis=1)):
                place = block.cells[row, :4].tolist().index(tip)
                for middle, other in ((place, (place + 1) % 4), ((place - 1) % 4, (place - 1) % 4)):
                    a, b = block.points[tip], block.points[block.cells[row, other]]
                    block.points[block.cells[row, 4 + middle]] = a + (b - a) / 4
        write(folder, inp(block, "CPE8"), "b.inp")
        scene = write(folder, QUARTER.replace("FILE", "b.inp"), f"{name}.toml")
        assert volume(load_body(write(folder, inp(block, "CPE8"), "b.inp"), 2, COMM)) == (
            pytest.approx(2)
        )
        result = run(load_scene(scene.file))
        assert result.passed
        forces.append(result.quantities["normal_force"])
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)


def test_shells_beside_solids_are_said(folder, capfd):
    """They are left out of the model, which is no reason to refuse the file."""
    block = Block("hexahedron")
    shells = "*NODE\n901, 0, 0, 5\n902, 1, 0, 5\n903, 1, 1, 5\n904, 0, 1, 5\n"
    shells += (
        "*ELEMENT, TYPE=S4, ELSET=TOOL\n901, 901, 902, 903, 904\n*ELEMENT, TYPE=B31\n9, 901, 902\n"
    )
    write(folder, inp(block, "C3D8") + shells, "b.inp")
    text = QUARTER.replace("FILE", "b.inp").replace("plane strain", "3D")
    scene = write(folder, text.replace("y = 0", "y = 0, z = 0"), "s.toml")
    assert main(["check", scene.file]) == 0
    said = COMM.bcast(" ".join(capfd.readouterr().out.split()))
    if COMM.rank == 0:
        assert "are left out: 1 of the type Quadrilateral 4 and 1 of the type Line 2" in said
