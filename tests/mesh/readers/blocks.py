"""A block [0, 2] × [0, 1] (× [0, 1]) as the files of other programs write it.

Orders of nodes are spelled out here after the manuals, apart from those of the readers.
"""

import itertools

import numpy as np

# Nodes on edges after the corners, as Abaqus and VTK list them.
EDGES = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron": (
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6)),
        *((6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}
CORNERS = {"triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}
# Faces of Abaqus, S1 first.
FACES = {
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quadrilateral": ((0, 1), (1, 2), (2, 3), (3, 0)),
    "tetrahedron": ((0, 1, 2), (0, 1, 3), (1, 2, 3), (0, 2, 3)),
    "hexahedron": (
        *((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4)),
        *((1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ),
}


class Block:
    """Points and cells; with ``curved`` moved by a map that keeps volumes and is of order 2.

    Attributes:
        points: Shape (nodes, 3), z = 0 in the plane.
        cells: Nodes from 0, in the order of Abaqus.
    """

    def __init__(self, cell, order=1, curved=False, cells=(3, 2, 2)):
        self.cell = cell
        self.dimension = 2 if cell in ("triangle", "quadrilateral") else 3
        counts = cells[: self.dimension]
        self._numbers = {}
        corners = [
            np.array(at) / counts * ([2, 1, 1][: self.dimension])
            for box in np.ndindex(*counts)
            for at in self._in_box(np.array(box))
        ]
        width = CORNERS[cell]
        self.cells = []
        for start in range(0, len(corners), width):
            at = corners[start : start + width]
            if order == 2:
                at = at + [(at[a] + at[b]) / 2 for a, b in EDGES[cell]]
            self.cells.append([self._number(point) for point in at])
        self.cells = np.array(self.cells)
        flat = np.array(list(self._numbers))
        self.flat = np.zeros((len(flat), 3))
        self.flat[:, : self.dimension] = flat
        self.points = self.flat.copy()
        if curved:
            x = self.flat[:, 0]
            self.points[:, 1] += 0.2 * x * (2 - x)

    def _in_box(self, box):
        steps = np.array(list(itertools.product((0, 1), repeat=self.dimension)))
        if self.cell == "quadrilateral":
            return box + steps[[0, 2, 3, 1]]
        if self.cell == "triangle":
            return box + steps[[0, 2, 3, 0, 3, 1]]
        if self.cell == "hexahedron":
            return box + steps[[0, 4, 6, 2, 1, 5, 7, 3]]
        found = []
        for axes in itertools.permutations(range(3)):  # along the edges to the opposite corner
            path = [np.zeros(3, dtype=int)]
            for axis in axes:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            if np.linalg.det(np.diff(path, axis=0)) < 0:
                path[0], path[1] = path[1], path[0]
            found += path
        return box + np.array(found)

    def _number(self, point):
        return self._numbers.setdefault(tuple(np.round(point, 12)), len(self._numbers))

    def nodes(self, axis, value):
        """Nodes with a coordinate, before the block was bent."""
        return np.flatnonzero(np.isclose(self.flat[:, axis], value))

    def sides(self, axis, value):
        """Sides there: cell and number of the face, from 0."""
        there = set(self.nodes(axis, value).tolist())
        return [
            (number, face)
            for number, nodes in enumerate(self.cells.tolist())
            for face, corners in enumerate(FACES[self.cell])
            if {nodes[corner] for corner in corners} <= there
        ]

    def facets(self, axis, value):
        """Corners of the sides there."""
        return [
            [int(self.cells[number][corner]) for corner in FACES[self.cell][face]]
            for number, face in self.sides(axis, value)
        ]


def lines(numbers, per_line=8):
    """Numbers with commas, so many a line."""
    words = [str(int(number)) for number in numbers]
    return "".join(
        ", ".join(words[start : start + per_line]) + "\n"
        for start in range(0, len(words), per_line)
    )


def inp(block, kind, elements="BLOCK", surfaces=True):
    """A file of Abaqus: nodes from 11 on, elements from 101 on; surfaces and sets of nodes."""
    text = "*HEADING\nA block\n** a comment\n*NODE, NSET=Nall\n"
    for number, point in enumerate(block.points, 11):
        text += f"{number}, " + ", ".join(f"{x:.17g}" for x in point) + "\n"
    text += f"*ELEMENT, TYPE={kind}, ELSET={elements}\n"
    for number, nodes in enumerate(block.cells, 101):
        words = [str(number), *(str(node + 11) for node in nodes)]
        text += ",\n".join(", ".join(words[at : at + 10]) for at in range(0, len(words), 10))
        text += "\n"
    up = block.dimension - 1
    for name, axis, value in (("bottom", up, 0), ("top", up, 1), ("left", 0, 0)):
        faces = {}
        for number, face in block.sides(axis, value):
            faces.setdefault(face + 1, []).append(number + 101)
        for face, numbers in faces.items() if surfaces else ():
            text += f"*ELSET, ELSET=_{name}_S{face}, INTERNAL\n" + lines(numbers)
        if surfaces:
            text += f"*SURFACE, NAME={name}, TYPE=ELEMENT\n"
            text += "".join(f"_{name}_S{face}, S{face}\n" for face in faces)
        text += f"*NSET, NSET=n_{name}\n" + lines(block.nodes(axis, value) + 11)
    return (
        text
        + f"*NSET, NSET=n_back\n{lines(block.nodes(up - 1, 0) + 11)}"
        + "*MATERIAL, NAME=steel\n*ELASTIC\n1., .3\n"
    )


def bdf(block, card, facet="", solid=7, skin=None):
    """A file of Nastran with fields of 8; facets at bottom, top and left by property."""
    text = "SOL 101\nCEND\nBEGIN BULK\n$ a comment\n"
    for number, point in enumerate(block.points, 11):
        wide = "".join(f"{x:16.9E}" for x in point)
        text += f"GRID*   {number:<16d}{'':16s}{wide[:32]}*\n*       {wide[32:]}\n"
    number = 100
    for nodes in block.cells:
        number += 1
        if len(nodes) == 20:  # edges between base and top come before those of the top
            nodes = np.concatenate([nodes[:12], nodes[16:], nodes[12:16]])
        text += _card(card, [number, solid, *(nodes + 11)])
    up = block.dimension - 1
    for place, (axis, value) in enumerate(((up, 0), (up, 1), (0, 0)) if facet else ()):
        for corners in block.facets(axis, value):
            number += 1
            text += _card(facet, [number, 21 + place, *(node + 11 for node in corners)])
    return text + "ENDDATA\n"


def _card(word, fields):
    words = [f"{field:<8d}" for field in fields]
    rows = ["".join(words[at : at + 8]) for at in range(0, len(words), 8)]
    return f"{word:<8s}" + "\n+       ".join(rows) + "\n"
