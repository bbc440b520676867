"""Blocks of cells of which cost and memory are measured.

Their scenes and meshes are made in ``block_scenes.py``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from mpi4py import MPI

from fenics_contact import Body, Contact, Discretisation, Material, Scene, SolverSettings, Support
from fenics_contact.scene.values import AXES
from fenics_contact.verification.boxes import Box, boxes


@dataclass(frozen=True)
class Seat:
    """A cube in the seat of a floor and a wall: two contacts that share an edge.

    Attributes:
        cells: Along a side of the cube; the seat has three quarters of them.
    """

    cells: int

    @property
    def name(self) -> str:
        """By the cells along a side."""
        return f"3D Q1 hexes, seat of {self.cells} cells, shared edge"


def scene_of_seat(case: Seat, solver: Any) -> Scene:
    """The cube moved into its seat, and along it."""
    clamped = dict.fromkeys(AXES, 0.0)
    return Scene(
        kinematics="3D",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(1),
        support=(
            Support("floor.y0", clamped),
            Support("wall.x0", clamped),
            Support("block.y1", {"x": -0.002, "y": -0.01, "z": 0.0}),
        ),
        contact=(
            Contact("block.y0", against="floor.y1", friction_coefficient=0.3),
            Contact("block.x0", against="wall.x1", friction_coefficient=0.3),
        ),
        solver=SolverSettings(solver=solver),
    )


def body_of_seat(case: Seat, comm: MPI.Comm) -> Body:
    """Three boxes of hexahedra that do not match; collective."""
    few = 3 * case.cells // 4
    parts = [
        Box("block", (0, 0, 0), (1, 1, 1), (case.cells,) * 3),
        Box("floor", (0, -0.5, 0), (1.25, 0, 1), (few, few // 2, few)),
        Box("wall", (-0.5, -0.5, 0), (0, 1.25, 1), (few // 2, few, few)),
    ]
    return boxes(parts, "hexahedron", comm)


ELEMENTS = {
    "Q2": ("quadrilateral", 2),
    "P1 tets": ("tetrahedron", 1),
    "P2 tets": ("tetrahedron", 2),
    "Q1 hexes": ("hexahedron", 1),
    "Q2 hexes": ("hexahedron", 2),
}

COEFFICIENT = 0.3
SLIPPERY = 0.05  # so little friction that a good part of two flat blocks slips
FURTHER = 20  # load steps after the first, in the cases that have them: the pull is reversed


@dataclass(frozen=True)
class Case:
    """A block of cells.

    Attributes:
        element: Of ``ELEMENTS``.
        cells: Along each axis; the block is of width 1, and its cells are squares or cubes.
        all_of_top: Whether contact is possible on all of the top; else in its middle.
        full_contact: Whether all of it touches: what is pressed against it is flat.
        half_space: Whether the block is a piece of a half-space, with larger cells outwards.
        steps: Load steps.
        upper: Cells of a second block, likewise, whose rounded foot takes the obstacle's place.
        coefficient: Of friction.
    """

    element: str
    cells: tuple[int, ...]
    all_of_top: bool = False
    full_contact: bool = False
    half_space: bool = False
    steps: int = 1
    upper: tuple[int, ...] = ()
    coefficient: float = COEFFICIENT

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.cells)

    @property
    def dofs(self) -> int:
        """Number of displacements."""
        degree = ELEMENTS[self.element][1]
        return self.dimension * sum(
            math.prod(degree * count + 1 for count in cells) for cells in self.blocks
        )

    @property
    def blocks(self) -> list[tuple[int, ...]]:
        """Cells of each."""
        return [self.cells, self.upper] if self.upper else [self.cells]

    @property
    def heights(self) -> list[float]:
        """Of the blocks, whose width is 1."""
        return [cells[-1] / cells[0] for cells in self.blocks]

    @property
    def few_cells(self) -> Case:
        """The same on a few cells."""
        few = [(width,) * (self.dimension - 1) + (2,) for width in (8, 6)]
        upper = few[1] if self.upper else ()
        return replace(self, cells=few[0], upper=upper, steps=min(self.steps, 2))

    @property
    def name(self) -> str:
        """Such as: 3D Q1 hexes 39k, two bodies, full contact, slipping."""
        said = {
            "all of the top": self.all_of_top,
            "half-space 3D": self.half_space,
            "two bodies": self.upper,
            "full contact": self.full_contact,
            "slipping": self.coefficient == SLIPPERY,
            "further steps": self.steps > 1,
        }
        start = f"{self.dimension}D {self.element} {self.dofs / 1000:.0f}k"
        return ", ".join([start, *(words for words, holds in said.items() if holds)])


def square(cells: int, steps: int = 1) -> Case:
    """A square of quadratic quadrilaterals."""
    return Case("Q2", (cells, cells), steps=steps)


def slab(element: str, points: int, steps: int = 1) -> Case:
    """A block half as high as wide, with so many intervals between nodes along its width."""
    cells = points // ELEMENTS[element][1]
    return Case(element, (cells, cells, cells // 2), steps=steps)


def pair(element: str, lower: int, upper: int) -> Case:
    """A slab on another, with so many cells along their widths: a square cut into two, in 2D."""
    axes = 2 if element == "Q2" else 3
    blocks = [(width,) * (axes - 1) + (width // 2 ** (axes - 1),) for width in (lower, upper)]
    return Case(element, blocks[0], upper=blocks[1])


def flat(width: int, height: int) -> Case:
    """A block of hexahedra under a plane that touches all of its top, by its cells."""
    return Case("Q1 hexes", (width, width, height), full_contact=True)


def flat_pair(
    lower: tuple[int, int], upper: tuple[int, int], coefficient: float = COEFFICIENT
) -> Case:
    """A flat block on another, by their cells along width and height."""
    wide, narrow = ((width, width, height) for width, height in (lower, upper))
    return Case("Q1 hexes", wide, full_contact=True, upper=narrow, coefficient=coefficient)


# The upper mesh is the coarser one, by about 4:3.
PAIRS = [
    pair("Q2", 65, 50),
    pair("Q2", 143, 110),
    pair("P1 tets", 26, 20),
    pair("P1 tets", 36, 28),
    pair("P2 tets", 15, 12),
    pair("Q1 hexes", 31, 24),
    pair("Q2 hexes", 15, 12),
]
# 1,323, 2,883, 5,043 and 11,163 contact dofs.
FLAT = [flat(20, 10), flat(30, 10), flat(40, 12), flat(60, 17)]
# 2,958, twice 4,758 and 18,366.
SMALL_FLAT_PAIR = flat_pair((24, 5), (18, 5))
FLAT_PAIRS = [
    flat_pair((30, 8), (24, 6)),
    flat_pair((30, 8), (24, 6), SLIPPERY),
    flat_pair((60, 10), (48, 10)),
]
HALF_SPACE = Case("Q1 hexes", (30, 30, 15), half_space=True)
