"""Hexahedra that name a node several times are read as wedges, pyramids and tetrahedra."""

import numpy as np
import pytest
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.mesh.loading import load_body
from tests.mesh.readers.mixed_blocks import BOX, MixedBlock
from tests.mesh.readers.test_formats import of_cells, volume
from tests.mesh.subdivision.test_any_cells import bent, fits, skewed
from tests.mesh.test_loading import area, write
from tests.messages import refused, says

COMM = MPI.COMM_WORLD
KINDS = ("hexahedra", "wedges", "pyramids")


def collapsed(cell, count):
    """A wedge or a pyramid as a hexahedron, whose edges of no length have their end as middle."""
    if count == 6:
        a, b, c, d, e, f, *middles = cell
        found = [a, b, c, c, d, e, f, f]
        if middles:
            ab, bc, ca, de, ef, fd, ad, be, cf = middles
            found += [ab, bc, c, ca, de, ef, f, fd, ad, be, cf, cf]
        return found
    base, top, middles = cell[:4], cell[4], cell[5:]
    apex = 4 * [top]
    return [*base, *apex, *middles[:4], *(apex if middles else []), *middles[4:]]


@pytest.mark.parametrize(("order", "moved"), [(1, skewed), (2, bent)])
def test_a_deck_of_hexahedra_is_that_of_the_cells_meant(folder, order, moved):
    """The same tetrahedra, surfaces and sets as of elements C3D6 and C3D5."""
    meant, block = (MixedBlock(KINDS, order, moved) for _ in range(2))
    for number, (cell, count) in enumerate(zip(block.cells, block.counts, strict=True)):
        if count < 8:
            block.cells[number], block.counts[number] = collapsed(cell, count), 8
    one, other = (
        load_body(write(folder, each.inp(), f"{name}.inp"), 3, COMM)
        for each, name in ((meant, "meant"), (block, "collapsed"))
    )
    middles = []
    for body in (one, other):
        corners = body.mesh.geometry.x[compat.geometry_nodes(body.mesh)[:, :4]].mean(axis=1)
        own = corners[: body.mesh.topology.index_map(3).size_local]
        every = np.round(np.concatenate(COMM.allgather(own)), 9)
        middles.append(every[np.lexsort(every.T)])
    assert middles[0] == pytest.approx(middles[1], abs=1e-12)
    assert volume(other) == pytest.approx(volume(one), rel=1e-13)
    assert fits(other) == fits(one)
    for name in ("top", "n_top", "n_bottom"):
        assert area(other, name) == pytest.approx(area(one, name), rel=1e-12)
    for column in range(8):
        assert of_cells(other, f"column_{column}") == of_cells(one, f"column_{column}")
    if order == 1:
        says("cells_collapsed", other.notes[0])


def deck(kind, nodes):
    """An element among the corners of the unit box, which are numbered from 0."""
    text = "*NODE\n"
    for node in sorted({*nodes}):
        text += f"{node + 1}, " + ", ".join(map(str, BOX[node])) + "\n"
    return text + f"*ELEMENT, TYPE={kind}, ELSET=all\n1, {', '.join(str(n + 1) for n in nodes)}\n"


@pytest.mark.parametrize(
    ("kind", "nodes", "size"),
    [
        ("C3D8", (0, 1, 2, 2, 4, 4, 4, 4), 1 / 6),
        ("C3D8", (4, 4, 4, 4, 0, 1, 2, 2), 1 / 6),
        ("C3D8", (0, 1, 2, 3, 4, 5, 5, 4), 1 / 2),
        ("C3D8", (0, 1, 2, 3, 0, 5, 6, 3), 1 / 2),
        ("C3D8", (1, 2, 6, 5, 0, 0, 0, 0), 1 / 3),
        ("C3D6", (0, 1, 2, 0, 5, 6), 1 / 3),
        ("C3D6", (0, 1, 2, 4, 4, 4), 1 / 6),
        ("C3D5", (0, 1, 2, 2, 4), 1 / 6),
    ],
)
def test_each_way_to_collapse(folder, kind, nodes, size):
    body = load_body(write(folder, deck(kind, nodes), "c.inp"), 3, COMM)
    assert volume(body) == pytest.approx(size, rel=1e-13)


def test_a_wrong_node_that_leaves_a_hole_is_refused(folder):
    """A wedge of which two corners above each other are one would be a pyramid beside a hole."""
    block = MixedBlock(("wedges",))
    inner = next(
        number
        for number, cell in enumerate(block.cells)
        if np.all(np.abs(block.flat[cell] - [1, 0.5, 0.5]).max(axis=0) <= 0.5)
    )
    block.cells[inner][3] = block.cells[inner][0]
    source = write(folder, block.inp(), "w.inp")
    with refused("wrong_node_of_a_wedge"):
        load_body(source, 3, COMM)


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ((0, 1, 2, 2, 4, 5, 6, 7), "cell_of_seven_corners"),
        ((0, 1, 2, 3, 0, 1, 2, 3), "cell_between_two_faces_that_are_one"),
    ],
)
def test_what_is_no_other_cell(folder, nodes, message):
    source = write(folder, deck("C3D8", nodes), "c.inp")
    with refused(message):
        load_body(source, 3, COMM)
