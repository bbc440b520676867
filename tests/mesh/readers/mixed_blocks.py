"""A block [0, 2] × [0, 1] × [0, 1] of columns of hexahedra, of wedges and of pyramids, for .inp.

Nodes of each cell are spelled out after the manuals, and numbered at random.
"""

import numpy as np

from tests.mesh.readers.blocks import lines

# Of a unit box: corners of its cells, 8 is its middle.
CELLS = {
    "hexahedra": [(0, 1, 2, 3, 4, 5, 6, 7)],
    "wedges": [(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)],
    "pyramids": [
        *((0, 1, 2, 3, 8), (4, 7, 6, 5, 8), (0, 4, 5, 1, 8)),
        *((1, 5, 6, 2, 8), (2, 6, 7, 3, 8), (3, 7, 4, 0, 8)),
    ],
    "quadrilaterals": [(0, 1, 2, 3)],
    "triangles": [(0, 1, 2), (0, 2, 3)],
}
BOX = np.array(
    [
        *((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)),
        *((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0.5, 0.5, 0.5)),
    ]
)
EDGES = {
    3: ((0, 1), (1, 2), (2, 0)),
    4: ((0, 1), (1, 2), (2, 3), (3, 0)),
    5: ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    6: ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    8: (
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6)),
        *((6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
    ),
}
TYPES = {3: "CPE3", 4: "CPE4", 5: "C3D5", 6: "C3D6", 8: "C3D8"}
TYPES_OF_ORDER_2 = {3: "CPE6", 4: "CPE8", 5: "C3D13", 6: "C3D15", 8: "C3D20"}
# Faces that Abaqus numbers S1, S2, …, as corners from 0.
FACES = {
    3: ((0, 1), (1, 2), (2, 0)),
    4: ((0, 1), (1, 2), (2, 3), (3, 0)),
    5: ((0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    6: ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    8: (
        *((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4)),
        *((1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ),
}


class MixedBlock:
    """Columns along the last axis of four by two boxes, two high (in the plane boxes).

    Attributes:
        flat: Nodes of the straight block, (nodes, 3).
        points: Moved by ``moved``.
        cells: Corners of each cell, then nodes on its edges, as places among the points.
        boxes: Number of the column of each cell.
        counts: Corners of each cell.
    """

    def __init__(self, kinds, order=1, moved=lambda x: x, seed=0, orders=None, along=4):
        """``orders``: of single columns, by number; ``along``: how many boxes along x."""
        is_flat = kinds[0] in ("quadrilaterals", "triangles")
        self._numbers, self.cells, self.boxes, self.counts = {}, [], [], []
        counts = (along, 2, 1 if is_flat else 2)
        size = np.array([2 / along, 0.5, 0.5])
        for box in np.ndindex(*counts):
            column = 2 * box[0] + box[1]
            corners = (BOX + box) * size
            for places in CELLS[kinds[column % len(kinds)]]:
                at = corners[list(places)]
                if (orders or {}).get(column, order) == 2:
                    ends = at[np.array(EDGES[len(places)])]
                    at = np.concatenate([at, ends.mean(axis=1)])
                if is_flat:
                    at = at * [1, 1, 0]
                self.cells.append([self._number(point) for point in at])
                self.boxes.append(column)
                self.counts.append(len(places))
        self.flat = np.array(list(self._numbers))
        self.points = np.array([moved(x) for x in self.flat])
        self.tags = 1 + np.random.default_rng(seed).permutation(len(self.flat))
        self.dimension = 2 if is_flat else 3

    def _number(self, point):
        return self._numbers.setdefault(tuple(np.round(point, 12)), len(self._numbers))

    def inp(self):
        """A file of Abaqus: an ELSET a column; surface ``top``, sets ``n_top`` and ``n_bottom``."""
        text = "*NODE\n"
        for tag, point in zip(self.tags, self.points, strict=True):
            text += f"{tag}, " + ", ".join(f"{x:.17g}" for x in point) + "\n"
        last = self.dimension - 1
        height = self.flat[:, last].max()
        sides = {}
        for number, (cell, column) in enumerate(zip(self.cells, self.boxes, strict=True), 1):
            count = self.counts[number - 1]
            known = TYPES if len(cell) == count else TYPES_OF_ORDER_2
            words = [str(number), *(str(self.tags[node]) for node in cell)]
            text += f"*ELEMENT, TYPE={known[count]}, ELSET=column_{column}\n"
            text += ",\n".join(", ".join(words[at : at + 8]) for at in range(0, len(words), 8))
            text += "\n"
            for face, places in enumerate(FACES[count], 1):
                if all(np.isclose(self.flat[cell[n], last], height) for n in places):
                    sides.setdefault(face, []).append(number)
        for face, numbers in sides.items():
            text += f"*ELSET, ELSET=_S{face}, INTERNAL\n" + lines(numbers)
        text += "*SURFACE, NAME=top\n" + "".join(f"_S{face}, S{face}\n" for face in sides)
        for name, at in (("n_top", height), ("n_bottom", 0.0)):
            there = np.flatnonzero(np.isclose(self.flat[:, last], at))
            text += f"*NSET, NSET={name}\n" + lines(self.tags[there])
        return text
