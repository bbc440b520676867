"""Files that are damaged, of every format, are refused by a sentence that says how."""

import random
import re

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.blocks import Block, bdf, inp
from tests.mesh.readers.test_formats import volume, with_meshio
from tests.mesh.soundness.damages import HARMLESS, REFUSED, REFUSED_OF_ORDER_2, msh
from tests.mesh.test_loading import refusal, write
from tests.messages import says

COMM = MPI.COMM_WORLD
KINDS = {
    ("triangle", 1): ("CPE3", "CTRIA3"),
    ("quadrilateral", 1): ("CPE4", "CQUAD4"),
    ("tetrahedron", 1): ("C3D4", "CTETRA"),
    ("hexahedron", 1): ("C3D8", "CHEXA"),
    ("triangle", 2): ("CPE6", "CTRIA6"),
    ("quadrilateral", 2): ("CPE8", "CQUAD8"),
    ("tetrahedron", 2): ("C3D10", "CTETRA"),
    ("hexahedron", 2): ("C3D20", "CHEXA"),
}
CELLS = list(KINDS)
FORMATS = ("inp", "bdf", "msh", "vtu")


def written(folder, block, suffix):
    """A file of the block, and the order of its cells."""
    order = 1 if block.cells.shape[1] == Block(block.cell).cells.shape[1] else 2
    inp_kind, card = KINDS[block.cell, order]
    if suffix == "vtu":
        return with_meshio(folder, "b.vtu", block, order)
    if suffix == "msh":
        return write(folder, msh(block), "b.msh")
    text = inp(block, inp_kind) if suffix == "inp" else bdf(block, card)
    return write(folder, text, f"b.{suffix}")


def damaged(cell, order, damage, seed):
    block = Block(cell, order, cells=(4, 3, 2) if cell != "triangle" else (3, 3, 2))
    damage(block, random.Random(seed))
    return block


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("damage", REFUSED, ids=lambda damage: damage.__name__)
def test_damaged_files_are_refused(folder, damage, turn):
    """Each format sees each damage, each of another kind of cells."""
    number = list(REFUSED).index(damage) + turn
    suffix = FORMATS[turn]
    order = 1 if suffix == "msh" else 1 + number // 4 % 2
    cell = CELLS[number % 4][0]
    block = damaged(cell, order, damage, 45 + number)
    if suffix == "vtu" and damage.__name__ == "node_that_is_not_there":
        pytest.skip("meshio itself writes no such file")
    said = refusal(written(folder, block, suffix), block.dimension)
    assert re.search(REFUSED[damage], said), said
    assert f"b.{suffix}" in said


@pytest.mark.parametrize("suffix", ["inp", "bdf", "vtu"])
@pytest.mark.parametrize("damage", REFUSED_OF_ORDER_2, ids=lambda damage: damage.__name__)
def test_damaged_files_of_order_2_are_refused(folder, damage, suffix):
    for cell, order in CELLS[4:]:
        block = damaged(cell, order, damage, 45)
        said = refusal(written(folder, block, suffix), block.dimension)
        assert re.search(REFUSED_OF_ORDER_2[damage], said), said


@pytest.mark.parametrize("change", HARMLESS, ids=lambda change: change.__name__)
def test_what_files_may_look_like(folder, change):
    for number, (cell, order) in enumerate(CELLS):
        block = damaged(cell, order, change, 45 + number)
        body = load_body(written(folder, block, ("inp", "bdf")[number % 2]), block.dimension, COMM)
        assert volume(body) == pytest.approx(2, rel=1e-8)
        assert body.notes == () or "names no surface" in body.notes[0]


def test_an_element_twice_is_named_by_both_numbers(folder):
    block = Block("quadrilateral")
    block.cells = np.concatenate([block.cells, block.cells[2:3, [1, 2, 3, 0]]])
    said = refusal(written(folder, block, "inp"))
    says("two_elements_of_the_same_corners", said, other=100 + len(block.cells))


def test_an_element_in_two_groups_of_gmsh_is_one(folder):
    """Version 2 of the format lists it once for each of its groups."""
    text = msh(Block("quadrilateral"))
    cell = re.search(r"(?m)^1 3 2 1 1 (.*)$", text)[1]
    count = int(re.search(r"Elements\n(\d+)", text)[1])
    text = text.replace(f"$Elements\n{count}", f"$Elements\n{count + 1}").replace(
        "$EndElements", f"{count + 1} 3 2 9 1 {cell}\n$EndElements"
    )
    body = load_body(write(folder, text, "b.msh"), 2, COMM)
    assert volume(body) == pytest.approx(2)
