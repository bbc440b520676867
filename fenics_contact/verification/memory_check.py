"""Whether estimates of memory are near what runs of blocks take, each in its own process.

Whether estimates of memory are near what runs take, each in a process of its own. Measured is the
peak of resident memory above that before there is a mesh, of all ranks together. The estimate is
that of ``fenics-contact check``.

Blocks of cells of which cost and memory are measured. Their scenes and meshes are made in
``memory_worker.py``.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mpi4py import MPI

from fenics_contact import Body, Contact, Discretisation, Material, Scene, SolverSettings, Support
from fenics_contact.common.errors import FenicsContactError
from fenics_contact.common.parallel import environment_alone, on_root
from fenics_contact.scene.loading.support_axes import ComponentName
from fenics_contact.scene.values import AXES
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding


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
    clamped: dict[ComponentName, float] = dict.fromkeys(AXES, 0.0)
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
class BlockCase:
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
    def few_cells(self) -> BlockCase:
        """A case of the same kind on a few cells."""
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


def square(cells: int, steps: int = 1) -> BlockCase:
    """A square of quadratic quadrilaterals."""
    return BlockCase("Q2", (cells, cells), steps=steps)


def slab(element: str, points: int, steps: int = 1) -> BlockCase:
    """A block half as high as wide, with so many intervals between nodes along its width."""
    cells = points // ELEMENTS[element][1]
    return BlockCase(element, (cells, cells, cells // 2), steps=steps)


def pair(element: str, lower: int, upper: int) -> BlockCase:
    """A slab on another, with so many cells along their widths: a square cut into two, in 2D."""
    axes = 2 if element == "Q2" else 3
    blocks = [(width,) * (axes - 1) + (width // 2 ** (axes - 1),) for width in (lower, upper)]
    return BlockCase(element, blocks[0], upper=blocks[1])


def flat(width: int, height: int) -> BlockCase:
    """A block of hexahedra under a plane that touches all of its top, by its cells."""
    return BlockCase("Q1 hexes", (width, width, height), full_contact=True)


def flat_pair(
    lower: tuple[int, int], upper: tuple[int, int], coefficient: float = COEFFICIENT
) -> BlockCase:
    """A flat block on another, by their cells along width and height."""
    wide, narrow = ((width, width, height) for width, height in (lower, upper))
    return BlockCase("Q1 hexes", wide, full_contact=True, upper=narrow, coefficient=coefficient)


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
HALF_SPACE = BlockCase("Q1 hexes", (30, 30, 15), half_space=True)


MemoryRun = tuple[BlockCase | Seat, str, int]

# One body, a pair, full contact and contacts that share an edge, every solver: about a minute.
FEW: tuple[MemoryRun, ...] = (
    (square(90), "condensed", 1),
    (slab("P2 tets", 24), "condensed", 1),
    (FLAT[0], "condensed", 1),
    (FLAT[2], "iterative", 1),
    (Seat(10), "full", 1),
)
ALL: tuple[MemoryRun, ...] = (
    *FEW,
    (square(180), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 1),
    (slab("P1 tets", 32), "condensed", 2),
    (slab("P2 tets", 32), "condensed", 1),
    (slab("Q2 hexes", 24), "condensed", 1),
    (FLAT[1], "condensed", 1),
    (PAIRS[1], "condensed", 1),
    (PAIRS[3], "condensed", 1),
    (PAIRS[3], "condensed", 2),
    (PAIRS[4], "condensed", 1),
    (SMALL_FLAT_PAIR, "condensed", 1),
    (Seat(10), "condensed", 1),
    (Seat(16), "condensed", 1),
    (square(90), "full", 1),
    (slab("P2 tets", 24), "full", 1),
    (FLAT[0], "full", 1),
    (PAIRS[4], "full", 1),
    (SMALL_FLAT_PAIR, "full", 1),
    (Seat(16), "full", 1),
    (slab("P1 tets", 32), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 1),
    (slab("P1 tets", 48), "iterative", 2),
    (slab("P2 tets", 32), "iterative", 1),
    (HALF_SPACE, "iterative", 1),
    (FLAT[1], "iterative", 1),
    (Seat(10), "iterative", 1),
    (SMALL_FLAT_PAIR, "iterative", 1),
)
SCENES: dict[str, BlockCase | Seat] = {case.name: case for case, _, _ in ALL}


LEAST, MOST = 0.7, 1.5  # of the estimate over what was measured
COUNTS_FROM = 200e6  # bytes
_WORKER = "fenics_contact.verification.memory_worker"


class UnmeasuredError(FenicsContactError):
    """A run whose memory was to be measured failed."""


def measured(
    case: str, solver: str, errors: str = "auto", start: Sequence[str] = (sys.executable,)
) -> dict[str, Any]:
    """Estimate and measurement of a run in a process of its own, and what it is of.

    Args:
        case: Of the table, by its name.
        solver: As a scene names it.
        errors: Which error bars are made.
        start: What starts Python.

    Raises:
        UnmeasuredError: The run failed.
    """
    command = [*start, "-m", _WORKER, case, solver, errors]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=environment_alone()
    )
    if done.returncode:
        raise UnmeasuredError(f"{case} by {solver} failed:\n{done.stderr}")
    row: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return row


def compared(row: dict[str, Any]) -> Finding | None:
    """An estimate over what was measured; None where so little was that it does not count."""
    if row["measured"] < COUNTS_FROM:
        return None
    ratio = row["estimate"] / row["measured"]
    said = f"{row['case']}: {row['solver']}"
    middle = (LEAST + MOST) / 2
    note = "" if row["converged"] else f"{said} did not converge"
    return Finding(
        said, ratio if row["converged"] else float("nan"), middle, MOST - middle, True, note
    )


def findings_of(runs: Sequence[MemoryRun]) -> Iterator[Finding]:
    """Findings of memory runs on one rank; collective, rank 0 starts them."""
    for case, solver, ranks in runs:
        if ranks > 1:  # a program that runs already is not to start others under mpirun
            continue
        row = on_root(MPI.COMM_WORLD, lambda: measured(case.name, solver))  # noqa: B023
        finding = compared(row)
        if finding is not None:
            yield finding


def _check(quick: bool) -> Iterator[Finding]:
    return findings_of(FEW if quick else ALL)


MEMORY_CASES = (
    Case(
        "memory",
        "estimates of memory by each solver, over measured",
        "peak of resident memory of a process of its own, above that before the mesh; .7 to 1.5",
        _check,
    ),
)
