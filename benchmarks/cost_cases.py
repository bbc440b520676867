"""What is measured: blocks of cells with a rounded obstacle pressed in and pulled sideways.

Or two blocks on each other, whose meshes do not match: the foot of the upper one is rounded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Group,
    Material,
    Obstacle,
    Scene,
    SolverSettings,
    Steps,
    Support,
)
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.scene.values import Path as LoadPath

# isort: split
import dolfinx
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

ELEMENTS = {
    "Q2": ("quadrilateral", 2),
    "P1 tets": ("tetrahedron", 1),
    "P2 tets": ("tetrahedron", 2),
    "Q1 hexes": ("hexahedron", 1),
    "Q2 hexes": ("hexahedron", 2),
}

# The obstacle's radius, indentation and displacement over a block of width 1: the contact's
# radius is about 0.14, and the inner two thirds of it stick.
RADIUS, INDENTATION, SIDEWAYS, COEFFICIENT = 1.0, 0.02, 0.004, 0.3
HALF_WIDTH = 0.25  # of the surface on which contact is possible, where it is not all of the top
# Two blocks: how far the upper one is brought down, and the surfaces that may touch. The contact
# covers .7 to .9 of these.
APPROACH, HALF_WIDTH_OF_PAIR = 0.03, 0.22
APART = 1.0  # the blocks, until their sides are told apart
FURTHER = 20  # load steps after the first, in the cases that have them: the pull is reversed


@dataclass(frozen=True)
class Case:
    """A block of cells.

    Attributes:
        element: Of ``ELEMENTS``.
        cells: Along each axis; the block is of width 1, and its cells are squares or cubes.
        all_of_top: Whether contact is possible on all of the top; else in its middle.
        steps: Load steps.
        upper: Cells of a second block, likewise, whose rounded foot takes the obstacle's place.
    """

    element: str
    cells: tuple[int, ...]
    all_of_top: bool = False
    steps: int = 1
    upper: tuple[int, ...] = ()

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
        """Such as: 3D Q2 hexes 24k, all of the top."""
        parts = [f"{self.dimension}D {self.element} {self.dofs / 1000:.0f}k"]
        if self.all_of_top:
            parts.append("all of the top")
        if self.upper:
            parts.append("two bodies")
        if self.steps > 1:
            parts.append(f"{self.steps} steps")
        return ", ".join(parts)


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


def quick_runs() -> list[tuple[Case, str]]:
    """Cases, each with the name of a solver, that take about a minute in all."""
    return [
        (square(43), "condensed"),
        (square(43), "full"),
        (square(43, 1 + FURTHER), "condensed"),
        (square(90), "condensed"),
        (slab("P1 tets", 24), "condensed"),
        (slab("P2 tets", 24), "condensed"),
        (PAIRS[0], "condensed"),
    ]


def all_runs() -> list[tuple[Case, str]]:
    """Cases, each with the name of a solver."""
    solids = ("P1 tets", "P2 tets", "Q1 hexes", "Q2 hexes")
    condensed = [
        *(square(cells) for cells in (43, 90, 180)),
        *(slab(element, points) for element in solids for points in (24, 32, 40)),
        Case("Q2 hexes", (12, 12, 6), all_of_top=True),
        Case("Q2 hexes", (20, 20, 6), all_of_top=True),
        square(43, 1 + FURTHER),
        square(90, 1 + FURTHER),
        slab("P2 tets", 32, 1 + FURTHER),
        *PAIRS,
    ]
    # A factorisation a Newton step takes long: on the smallest meshes only.
    full = [square(43), slab("P2 tets", 24)]
    iterative = [
        *(slab(element, points) for element in ("P1 tets", "P2 tets") for points in (32, 48, 64)),
        slab("Q2 hexes", 48),
        PAIRS[3],
    ]
    return [
        *((case, "condensed") for case in condensed),
        *((case, "full") for case in full),
        *((case, "iterative") for case in iterative),
    ]


def scene_of(case: Case, solver: str) -> Scene:
    """The block of a case, held at its bottom, and what is pressed against it."""
    several = case.steps > 1
    further = tuple(1 + (step + 1) / (case.steps - 1) for step in range(case.steps - 1))
    held = Support("bottom", dict.fromkeys("xyz"[: case.dimension], 0.0))
    return Scene(
        kinematics="plane strain" if case.dimension == 2 else "3D",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(ELEMENTS[case.element][1]),
        support=(held, _moved_top(case)) if case.upper else (held,),
        contact=(_contact_of_two() if case.upper else _contact_with_obstacle(case),),
        steps=Steps(times=(1.0, *further)) if several else Steps(),
        solver=SolverSettings(solver=solver),
    )


def _moved_top(case: Case) -> Support:
    """The upper block, pressed down and pulled sideways by its top."""
    motion = dict.fromkeys("xyz"[: case.dimension], 0.0)
    motion["x"] = SIDEWAYS
    motion["xyz"[case.dimension - 1]] = -APPROACH
    return Support("top", motion)


def _contact_of_two() -> Contact:
    return Contact("upper", against="lower", friction_coefficient=COEFFICIENT)


def _contact_with_obstacle(case: Case) -> Contact:
    apex = [0.5] * (case.dimension - 1) + case.heights
    several = case.steps > 1
    back = LoadPath(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, -1.0))
    obstacle = Obstacle(
        "parabola" if case.dimension == 2 else "paraboloid",
        radius=RADIUS,
        position=tuple(apex),
        indentation=INDENTATION,
        displacement=(SIDEWAYS, *[0.0] * (case.dimension - 1)),
    )
    return Contact(
        "contact",
        friction_coefficient=COEFFICIENT,
        law="incremental" if several else "static",
        obstacle=replace(obstacle, displacement_path=back) if several else obstacle,
    )


def body_of(case: Case, comm: MPI.Comm) -> Body:
    """The mesh of a case with the boundaries that its scene names; collective."""
    mesh = _two_blocks(case, comm) if case.upper else _block(case.element, case.cells, comm)
    last = case.dimension - 1
    sides = _sides(case)
    found = [_facets_at(mesh, height) for height in sides.values()]
    half = HALF_WIDTH_OF_PAIR if case.upper else HALF_WIDTH
    for number, name in enumerate(sides):
        if name not in ("bottom", "top") and not case.all_of_top:
            aside = np.abs(
                dolfinx.mesh.compute_midpoints(mesh, last, found[number])[:, :last] - 0.5
            )
            found[number] = found[number][(aside < half).all(axis=1)]
    facets = np.concatenate(found)
    tags = np.repeat(np.arange(1, len(sides) + 1, dtype=np.int32), [len(side) for side in found])
    order = np.argsort(facets)
    cell_map = mesh.topology.index_map(case.dimension)
    cells = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    groups = {name: Group(last, (number + 1,)) for number, name in enumerate(sides)}
    if case.upper:
        _round_and_lower(mesh.geometry.x, case)
    return Body(
        mesh,
        dolfinx.mesh.meshtags(mesh, case.dimension, cells, np.ones_like(cells)),
        dolfinx.mesh.meshtags(mesh, last, facets[order], tags[order]),
        groups | {"body": Group(case.dimension, (1,))},
        "two blocks" if case.upper else "a block",
    )


def _sides(case: Case) -> dict[str, float]:
    """Heights of the sides that scenes name, as meshed."""
    if not case.upper:
        return {"bottom": 0.0, "contact": case.heights[0]}
    lower, upper = case.heights
    foot = lower + APART
    return {"bottom": 0.0, "lower": lower, "upper": foot, "top": foot + upper}


def _block(element: str, cells: tuple[int, ...], comm: MPI.Comm) -> Any:
    last = len(cells) - 1
    kind = getattr(dolfinx.mesh.CellType, ELEMENTS[element][0])
    make = dolfinx.mesh.create_box if last == 2 else dolfinx.mesh.create_rectangle
    corner = np.array([*[1.0] * last, cells[-1] / cells[0]])
    return make(comm, [np.zeros(last + 1), corner], list(cells), kind)


def _two_blocks(case: Case, comm: MPI.Comm) -> Any:
    """One mesh of two parts, the upper one still flat and above the lower one; collective."""
    meshes = [_block(case.element, cells, MPI.COMM_SELF) for cells in case.blocks]
    lower, upper = (mesh.geometry.x[:, : case.dimension].copy() for mesh in meshes)
    upper[:, -1] += case.heights[0] + APART
    numbers = [compat.geometry_nodes(mesh).astype(np.int64) for mesh in meshes]
    points, cells = np.vstack([lower, upper]), np.vstack([numbers[0], numbers[1] + len(lower)])
    given = slice(None) if comm.rank == 0 else slice(0)
    return compat.create_mesh(comm, ELEMENTS[case.element][0], 1, points[given], cells[given])


def _round_and_lower(points: NDArray[np.float64], case: Case) -> None:
    """Bring the upper block down, each node higher by r²/2R than where it was flat; in place."""
    last = case.dimension - 1
    above = points[:, last] > case.heights[0] + 0.5 * APART
    squares = ((points[above, :last] - 0.5) ** 2).sum(axis=1)
    points[above, last] += squares / (2 * RADIUS) - APART


def _facets_at(mesh: Any, height: float) -> NDArray[np.int32]:
    last = mesh.topology.dim - 1
    return dolfinx.mesh.locate_entities_boundary(mesh, last, lambda x: np.isclose(x[last], height))
