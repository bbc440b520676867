"""What is measured: blocks of cells with a rounded obstacle pressed in and pulled sideways."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

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
from fenics_contact.scene_values import Path as LoadPath

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
FURTHER = 20  # load steps after the first, in the cases that have them: the pull is reversed


@dataclass(frozen=True)
class Case:
    """A block of cells.

    Attributes:
        element: Of ``ELEMENTS``.
        cells: Along each axis; the block is of width 1, and its cells are squares or cubes.
        all_of_top: Whether contact is possible on all of the top; else in its middle.
        steps: Load steps.
    """

    element: str
    cells: tuple[int, ...]
    all_of_top: bool = False
    steps: int = 1

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.cells)

    @property
    def dofs(self) -> int:
        """Number of displacements."""
        degree = ELEMENTS[self.element][1]
        return math.prod(degree * count + 1 for count in self.cells) * self.dimension

    @property
    def height(self) -> float:
        """Of the block, whose width is 1."""
        return self.cells[-1] / self.cells[0]

    @property
    def name(self) -> str:
        """Such as: 3D Q2 hexes 24k, all of the top."""
        parts = [f"{self.dimension}D {self.element} {self.dofs / 1000:.0f}k"]
        if self.all_of_top:
            parts.append("all of the top")
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


def quick_runs() -> list[tuple[Case, str]]:
    """Cases, each with the name of a solver, that take about a minute in all."""
    return [
        (square(43), "condensed"),
        (square(43), "full"),
        (square(43, 1 + FURTHER), "condensed"),
        (square(90), "condensed"),
        (slab("P1 tets", 24), "condensed"),
        (slab("P2 tets", 24), "condensed"),
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
    ]
    # A factorisation a Newton step takes long: on the smallest meshes only.
    full = [square(43), slab("P2 tets", 24)]
    iterative = [
        *(slab(element, points) for element in ("P1 tets", "P2 tets") for points in (32, 48, 64)),
        slab("Q2 hexes", 48),
    ]
    return [
        *((case, "condensed") for case in condensed),
        *((case, "full") for case in full),
        *((case, "iterative") for case in iterative),
    ]


def scene_of(case: Case, solver: str) -> Scene:
    """The block of a case, held at its bottom."""
    up = "xyz"[case.dimension - 1]
    axes = "xyz"[: case.dimension]
    apex = [0.5] * (case.dimension - 1) + [case.height]
    several = case.steps > 1
    back = LoadPath(time=(0.0, 1.0, 2.0), factor=(0.0, 1.0, -1.0))
    obstacle = Obstacle(
        "parabola" if case.dimension == 2 else "paraboloid",
        radius=RADIUS,
        position=tuple(apex),
        indentation=INDENTATION,
        displacement=(SIDEWAYS, *[0.0] * (case.dimension - 1)),
    )
    further = tuple(1 + (step + 1) / (case.steps - 1) for step in range(case.steps - 1))
    contact = Contact(
        "contact",
        friction_coefficient=COEFFICIENT,
        law="incremental" if several else "static",
        obstacle=replace(obstacle, displacement_path=back) if several else obstacle,
    )
    return Scene(
        kinematics="plane strain" if case.dimension == 2 else "3D",
        material=(Material(1000.0, 0.3),),
        discretisation=Discretisation(ELEMENTS[case.element][1]),
        support=(Support(f"{up}0", dict.fromkeys(axes, 0.0)),),
        contact=(contact,),
        steps=Steps(times=(1.0, *further)) if several else Steps(),
        solver=SolverSettings(solver=solver),
    )


def body_of(case: Case, comm: MPI.Comm) -> Body:
    """The mesh of a case with the boundaries that its scene names; collective."""
    last = case.dimension - 1
    kind = getattr(dolfinx.mesh.CellType, ELEMENTS[case.element][0])
    make = dolfinx.mesh.create_box if last == 2 else dolfinx.mesh.create_rectangle
    corner = np.array([*[1.0] * last, case.height])
    mesh = make(comm, [np.zeros(case.dimension), corner], list(case.cells), kind)

    def facets_at(height: float) -> NDArray[np.int32]:
        return dolfinx.mesh.locate_entities_boundary(
            mesh, last, lambda x: np.isclose(x[last], height)
        )

    bottom, top = facets_at(0.0), facets_at(case.height)
    aside = np.abs(dolfinx.mesh.compute_midpoints(mesh, last, top)[:, :last] - 0.5)
    middle = top if case.all_of_top else top[(aside < HALF_WIDTH).all(axis=1)]
    facets = np.concatenate([bottom, middle])
    tags = np.repeat(np.array([1, 2], dtype=np.int32), [len(bottom), len(middle)])
    order = np.argsort(facets)
    cell_map = mesh.topology.index_map(case.dimension)
    cells = np.arange(cell_map.size_local + cell_map.num_ghosts, dtype=np.int32)
    return Body(
        mesh,
        dolfinx.mesh.meshtags(mesh, case.dimension, cells, np.ones_like(cells)),
        dolfinx.mesh.meshtags(mesh, last, facets[order], tags[order]),
        {
            f"{'xyz'[last]}0": Group(last, (1,)),
            "contact": Group(last, (2,)),
            "body": Group(case.dimension, (1,)),
        },
        "a block",
    )
