"""Files of several types of cells are subdivided as a whole: same body, same groups, fitting."""

from itertools import permutations

import numpy as np
import pytest
from dolfinx import mesh as dolfinx_mesh
from mpi4py import MPI

from fenics_contact import MeshSource
from fenics_contact.mesh.loading import load_body
from fenics_contact.mesh.readers.element_kinds import SIDES
from fenics_contact.mesh.subdivision.elements import Elements, Middles, Nodes
from fenics_contact.mesh.subdivision.simplices import subdivided
from tests.mesh.readers.blocks import Block, inp
from tests.mesh.readers.mixed_blocks import MixedBlock
from tests.mesh.readers.test_formats import of_cells, volume
from tests.mesh.test_loading import area, write
from tests.messages import refused, says

COMM = MPI.COMM_WORLD
SOLIDS = ("hexahedra", "wedges", "pyramids")
FLAT = ("quadrilaterals", "triangles")
# By each cell: its corners as Gmsh lists them, its type, and in how many tetrahedra it may be cut.
UNIT = {
    "hexahedron": (
        5,
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        {5, 6},
    ),
    "prism": (6, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], {3}),
    "pyramid": (7, [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)], {2}),
}


def straight(x):
    return x


def bent(x):
    """Keeps volumes, and is of degree 2."""
    return x + np.array([0, 0.2 * x[0] * (2 - x[0]), 0])


def skewed(x):
    """Keeps parallel faces plane."""
    return x + np.array([0.3 * x[2], 0.1 * x[0], 0.2 * x[1]])


@pytest.mark.parametrize("shape", UNIT)
def test_every_numbering_fills_the_cell_and_cuts_by_the_smallest(shape):
    """All numberings (of hexahedra 2,000): the volume, none inverted, each side's diagonal."""
    kind, corners, counts = UNIT[shape]
    points = np.array(corners, dtype=float)
    size = len(points)
    if size == 8:
        chance = np.random.default_rng(1999)
        tags = np.array([1 + chance.permutation(size) for _ in range(2000)])
    else:
        tags = 1 + np.array(list(permutations(range(size))))
    ones = np.ones(len(tags), dtype=np.int64)
    nodes = Nodes({"node_tags": np.arange(1, size + 1), "points": points})
    found = subdivided(
        kind, Elements(tags, ones, np.arange(len(tags)), kind * ones), Middles(nodes)
    )
    place = np.argsort(tags, axis=1)[found.numbers[:, None], found.nodes - 1]
    at = points[place]
    volumes = np.linalg.det(at[:, 1:] - at[:, :1]) / 6
    assert volumes.min() > 0.04
    wanted = {5: 1, 6: 1 / 2, 7: 1 / 3}[kind]
    assert np.bincount(found.numbers, volumes) == pytest.approx(np.full(len(tags), wanted))
    assert set(np.bincount(found.numbers).tolist()) == counts
    for number in (0, 17, len(tags) - 1):  # the boundary is made of the sides' triangles
        mine = found.nodes[found.numbers == number]
        triangles = [frozenset(np.delete(row, n).tolist()) for row in mine for n in range(4)]
        outer = {one for one in triangles if triangles.count(one) == 1}
        expected = set()
        for _, places in SIDES[kind]:
            side = tags[number][list(places)].tolist()
            while side[0] != min(side):
                side = side[1:] + side[:1]
            expected |= {frozenset([side[0], *side[n : n + 2]]) for n in range(1, len(side) - 1)}
        assert outer == expected


def fits(body):
    """As many facets outside as the area of the boundary has, none torn inside."""
    body.mesh.topology.create_connectivity(body.dimension - 1, body.dimension)
    own = dolfinx_mesh.exterior_facet_indices(body.mesh.topology)
    count = body.mesh.topology.index_map(body.dimension - 1).size_local
    return COMM.allreduce(int((own < count).sum()))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kinds", [SOLIDS, ("wedges",), ("pyramids", "hexahedra"), FLAT])
def test_mixed_cells(folder, kinds, order):
    """The block's volume, its surfaces and sets, and each column as a group; at order 2 bent."""
    block = MixedBlock(kinds, order, bent if order == 2 else straight if kinds == FLAT else skewed)
    body = load_body(write(folder, block.inp(), "m.inp"), block.dimension, COMM)
    flat = block.dimension == 2
    size = 2 if flat or order == 2 else 2 * np.linalg.det([[1, 0, 0.3], [0.1, 1, 0], [0, 0.2, 1]])
    assert volume(body) == pytest.approx(size, rel=1e-13)
    assert body.mesh.topology.cell_name() == ("triangle" if flat else "tetrahedron")
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == order
    outside = 12 if flat else 2 * 2 * (4 * 2 + 4 * 2 + 2 * 2)
    assert fits(body) == outside
    assert area(body, "top") == pytest.approx(area(body, "n_top"), rel=1e-12)
    if order == 2 and not flat:
        assert area(body, "n_bottom") == pytest.approx(2, rel=1e-12)
    share = {"hexahedra": (5, 6), "wedges": (6,), "pyramids": (12,)}
    for column in range(8) if not flat else ():
        per_box = of_cells(body, f"column_{column}") / 2
        assert min(share[kinds[column % len(kinds)]]) <= per_box
        assert per_box <= max(share[kinds[column % len(kinds)]])
    (note,) = body.notes
    if order == 1 and kinds in (SOLIDS, FLAT):
        says("subdivided_flat", note) if flat else says("subdivided_solid", note)


def test_faces_that_are_not_plane_are_told(folder):
    """A top z = 1/2 + x y / 4 of bilinear faces: cut by diagonals it holds another volume."""

    def warped(x):
        return x + np.array([0, 0, 2 * x[2] * x[0] * x[1]])

    block = MixedBlock(("hexahedra", "pyramids"), 1, warped, seed=2)
    body = load_body(write(folder, block.inp(), "w.inp"), 3, COMM)
    (note,) = body.notes
    exact = sum(  # of bilinear faces: the mean height of the four corners of each
        0.25 * np.mean([warped(np.array([x + a, y + b, 1]))[2] for a in (0, 0.5) for b in (0, 0.5)])
        for x in np.arange(0, 2, 0.5)
        for y in (0, 0.5)
    )
    said = float(note.rpartition("by ")[2].removesuffix(" %"))
    assert said == pytest.approx(100 * (volume(body) - exact) / volume(body), rel=0.05)


def test_cells_of_both_orders_in_one_file(folder):
    """Columns of hexahedra of 8 and of 20 nodes beside each other."""
    block = MixedBlock(("hexahedra",), 1, bent, orders={0: 2, 3: 2, 6: 2})
    body = load_body(write(folder, block.inp(), "o.inp"), 3, COMM)
    assert body.mesh.topology.cell_name() == "hexahedron"
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == 2
    assert fits(body) == 40
    (note,) = body.notes
    says("cells_of_both_orders", note)


def test_bodies_of_several_files_with_different_cells(folder):
    """Hexahedra of order 2 beside tetrahedra of order 1; quadrilaterals of orders 1 and 2."""
    blocks = {"a": Block("hexahedron", 2, curved=True), "b": Block("tetrahedron")}
    blocks["b"].points = blocks["b"].points + np.array([5.0, 0, 0])
    types = {"a": "C3D20", "b": "C3D4"}
    sources = [
        MeshSource(write(folder, inp(block, types[name]), f"{name}.inp").file, name=name)
        for name, block in blocks.items()
    ]
    body = load_body(sources, 3, COMM)
    assert body.mesh.topology.cell_name() == "tetrahedron"
    assert body.mesh.ufl_domain().ufl_coordinate_element().degree == 2
    assert volume(body) == pytest.approx(4, rel=1e-13)
    assert area(body, "b.top") == pytest.approx(2)
    assert area(body, "a.bottom") == pytest.approx(area(body, "a.n_bottom"))
    assert of_cells(body, "b") == len(blocks["b"].cells)
    (note,) = body.notes
    assert note.startswith("mesh[0].file")

    low, high = Block("quadrilateral"), Block("quadrilateral", 2, curved=True)
    low.points = low.points + np.array([5.0, 0, 0])
    sources = [
        MeshSource(write(folder, inp(block, kind), f"{kind}.inp").file, name=kind)
        for block, kind in ((low, "CPE4"), (high, "CPE8"))
    ]
    body = load_body(sources, 2, COMM)
    assert body.mesh.topology.cell_name() == "quadrilateral"
    assert volume(body) == pytest.approx(4, rel=1e-13)
    assert body.notes == ()


def test_two_nodes_in_the_middle_of_an_edge_are_refused(folder):
    block = MixedBlock(("hexahedra", "wedges"), 2)
    row = next(n for n, count in enumerate(block.counts) if count == 6)
    block.points = np.vstack([block.points, block.points[block.cells[row][6]] + [0, 0.1, 0]])
    block.tags = np.append(block.tags, 5000)
    block.cells[row][6] = len(block.points) - 1
    with refused("two_middle_nodes"):
        load_body(write(folder, block.inp(), "t.inp"), 3, COMM)


def test_a_face_against_two_triangles(folder):
    """Fits where the diagonal of its smallest node is theirs; else it is refused."""
    nodes = [*UNIT["hexahedron"][1], (2, 0.5, 0.5)]
    for first, second in (((2, 3, 6), (3, 7, 6)), ((2, 3, 7), (2, 7, 6))):
        text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(nodes, 1))
        text += "*ELEMENT, TYPE=C3D8, ELSET=box\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
        text += f"*ELEMENT, TYPE=C3D4\n2, {str(first)[1:-1]}, 9\n3, {str(second)[1:-1]}, 9\n"
        source = write(folder, text, "f.inp")
        if first == (2, 3, 7):
            body = load_body(source, 3, COMM)
            assert volume(body) == pytest.approx(1 + 1 / 3)
            assert fits(body) == 10 + 4
        else:
            with refused("face_against_triangles"):
                load_body(source, 3, COMM)


def test_shells_of_four_nodes_on_tetrahedra_are_sides(folder):
    """Cut along the edges of the cells that they lie on."""
    block = Block("tetrahedron")
    at = {tuple(np.round(block.flat[n, :2], 9)): n + 11 for n in block.nodes(2, 1)}
    quads = [
        [
            at[round(2 / 3 * a, 9), b / 2]
            for a, b in ((x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1))
        ]
        for x in range(3)
        for y in range(2)
    ]
    text = inp(block, "C3D4") + "*ELEMENT, TYPE=S4, ELSET=skin\n"
    text += "".join(f"{900 + n}, {', '.join(map(str, q))}\n" for n, q in enumerate(quads))
    body = load_body(write(folder, text, "s.inp"), 3, COMM)
    assert area(body, "skin") == pytest.approx(2)
    assert body.notes == ()
