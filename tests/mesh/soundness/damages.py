"""A block damaged as files are: each damage changes its points and cells in place.

Written by ``inp`` and ``bdf`` of ``tests.mesh.readers.blocks``, and by ``msh``.
"""

import numpy as np

from tests.mesh.readers.blocks import CORNERS, EDGES, FACES


def inner_node(block, chance):
    """A corner inside the block that several cells have."""
    inside = np.ones(len(block.flat), dtype=bool)
    for axis in range(block.dimension):
        x = block.flat[:, axis]
        inside &= (x > x.min() + 1e-9) & (x < x.max() - 1e-9)
    corners = np.unique(block.cells[:, : CORNERS[block.cell]])
    return int(chance.choice(corners[inside[corners]].tolist()))


def any_cell(block, chance):
    """The number of a cell."""
    return chance.randrange(len(block.cells))


def add_points(block, points, flat):
    """Add nodes; the number of the first."""
    first = len(block.points)
    block.points = np.concatenate([block.points, points])
    block.flat = np.concatenate([block.flat, flat])
    return first


def doubled(block, nodes):
    """Old numbers → numbers of new nodes in the same places."""
    nodes = np.unique(nodes)
    first = add_points(block, block.points[nodes], block.flat[nodes])
    return dict(zip(nodes.tolist(), range(first, first + len(nodes)), strict=True))


def renamed(block, rows, names):
    """Give cells other nodes."""
    for row in rows:
        block.cells[row] = [names.get(node, node) for node in block.cells[row].tolist()]


def element_twice(block, chance):
    row = any_cell(block, chance)
    block.cells = np.concatenate([block.cells, block.cells[row : row + 1]])


def element_twice_with_nodes_of_its_own(block, chance):
    element_twice(block, chance)
    renamed(block, [-1], doubled(block, block.cells[-1]))


def body_twice(block, chance):
    count = len(block.cells)
    names = doubled(block, np.arange(len(block.points)))
    block.cells = np.concatenate([block.cells, block.cells])
    renamed(block, range(count, 2 * count), names)


def node_doubled_for_one_cell(block, chance):
    node = inner_node(block, chance)
    row = chance.choice(np.flatnonzero((block.cells == node).any(axis=1)).tolist())
    renamed(block, [row], doubled(block, [node]))


def seam_through_the_body(block, chance):
    """Nodes of a plane doubled for the cells on one side."""
    places = np.unique(np.round(block.flat[:, 0], 9))
    at = chance.choice([x for x in places if 0 < x < 2 and is_between_cells(block, x)])
    there = np.flatnonzero(np.isclose(block.flat[:, 0], at))
    right = np.flatnonzero(block.flat[block.cells].mean(axis=1)[:, 0] > at)
    renamed(block, right, doubled(block, there))


def is_between_cells(block, x):
    corners = block.flat[block.cells[:, : CORNERS[block.cell]], 0]
    return not ((corners.min(axis=1) < x - 1e-9) & (corners.max(axis=1) > x + 1e-9)).any()


def every_cell_for_itself(block, chance):
    for row in range(len(block.cells)):
        renamed(block, [row], doubled(block, block.cells[row]))


def turned_inside_out(block, chance):
    row, corners = any_cell(block, chance), CORNERS[block.cell]
    order = list(range(corners))
    if block.cell == "hexahedron":
        order = [4, 5, 6, 7, 0, 1, 2, 3]
    else:
        order[1], order[2] = order[2], order[1]
    block.cells[row, :corners] = block.cells[row, order]


def node_moved_across(block, chance):
    node = inner_node(block, chance)
    block.points[node, 0] += chance.choice([-1.5, 1.5])


def cell_without_volume(block, chance):
    """A corner moved to the middle of a side that it is not of."""
    node = inner_node(block, chance)
    row = chance.choice(np.flatnonzero((block.cells == node).any(axis=1)).tolist())
    cell = block.cells[row].tolist()
    face = next(f for f in FACES[block.cell] if node not in [cell[n] for n in f])
    block.points[node] = block.points[[cell[n] for n in face]].mean(axis=0)


def one_wrong_node(block, chance):
    """Another node that exists, as after a slip of the pen."""
    row, corner = any_cell(block, chance), chance.randrange(CORNERS[block.cell])
    others = np.setdiff1d(block.cells[:, : CORNERS[block.cell]], block.cells[row])
    block.cells[row, corner] = chance.choice(others.tolist())


def node_that_is_not_there(block, chance):
    block.cells[any_cell(block, chance), 0] = len(block.points) + 7


def coordinate_that_is_none(block, chance):
    block.points[inner_node(block, chance), 0] = chance.choice([np.nan, np.inf])


def node_twice_in_a_cell(block, chance):
    row = any_cell(block, chance)
    block.cells[row, 1] = block.cells[row, 0]


def middle_node_at_the_end(block, chance):
    row, edge = any_cell(block, chance), chance.randrange(len(EDGES[block.cell]))
    first, second = (block.points[block.cells[row, n]] for n in EDGES[block.cell][edge])
    node = block.cells[row, CORNERS[block.cell] + edge]
    block.points[node] = 0.9 * first + 0.1 * second


def middle_nodes_of_another_order(block, chance):
    """All cells list their last nodes in the order of another program."""
    corners = CORNERS[block.cell]
    last = list(range(corners, block.cells.shape[1]))
    last = [*last[4:], *last[:4]] if block.cell == "hexahedron" else [last[-1], *last[:-1]]
    block.cells = block.cells[:, [*range(corners), *last]]


#: Damages of cells of any order, by what is said of them. In space a wrong node need not be found
#: by its message; all are refused.
REFUSED = {
    element_twice: "have the same corners: the same cell is listed twice",
    element_twice_with_nodes_of_its_own: "lie in one place",
    body_twice: "lie in one place",
    node_doubled_for_one_cell: "and share no nodes there",
    seam_through_the_body: "and share no nodes there",
    every_cell_for_itself: "and share no nodes there",
    turned_inside_out: "degenerate or inverted",
    node_moved_across: "degenerate or inverted",
    cell_without_volume: "degenerate or inverted",
    one_wrong_node: "degenerate or inverted|overlap|have the same corners",
    node_that_is_not_there: "use nodes that it does not define: the element|Gmsh",
    coordinate_that_is_none: "not finite|a node wants|must be a number|Gmsh|sound",
    node_twice_in_a_cell: "degenerate|Gmsh",
}
#: Of cells of order 2 alone.
REFUSED_OF_ORDER_2 = {
    middle_node_at_the_end: "degenerate or inverted",
    middle_nodes_of_another_order: "does the file list them in the order that its format has",
}


def unused_nodes(block, chance):
    add_points(block, np.full((3, 3), 0.4) * [1, 1, block.dimension - 2], np.full((3, 3), 9.0))


def other_order_of_cells(block, chance):
    order = list(range(len(block.cells)))
    chance.shuffle(order)
    block.cells = block.cells[order]


def all_turned(block, chance):
    """Of a whole body: it is numbered the other way round, which says nothing of its shape."""
    if block.cell == "triangle" and block.cells.shape[1] == 3:
        block.cells = block.cells[:, [0, 2, 1]]


#: What a file may look like.
HARMLESS = (unused_nodes, other_order_of_cells, all_turned)


def msh(block, elements="BLOCK"):
    """A file of Gmsh's version 2.2, of cells of order 1: the body, bottom, top and left."""
    cell = {"triangle": 2, "quadrilateral": 3, "tetrahedron": 4, "hexahedron": 5}[block.cell]
    facet = {"triangle": 1, "quadrilateral": 1, "tetrahedron": 2, "hexahedron": 3}[block.cell]
    up = block.dimension - 1
    rows = [(cell, 1, nodes) for nodes in block.cells]
    for group, at in ((2, (up, 0)), (3, (up, 1)), (4, (0, 0))):
        rows += [(facet, group, nodes) for nodes in block.facets(*at)]
    names = [(block.dimension, elements), (up, "bottom"), (up, "top"), (up, "left")]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "4"]
    lines += [f'{of} {number} "{name}"' for number, (of, name) in enumerate(names, 1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(block.points))]
    for number, point in enumerate(block.points, 1):
        lines.append(f"{number} " + " ".join(f"{x:.17g}" for x in point))
    lines += ["$EndNodes", "$Elements", str(len(rows))]
    for number, (kind, group, nodes) in enumerate(rows, 1):
        words = [number, kind, 2, group, group, *(int(node) + 1 for node in nodes)]
        lines.append(" ".join(map(str, words)))
    return "\n".join([*lines, "$EndElements", ""])
