"""A block in a seat: two contacts that share an edge."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fenics_contact import (
    Body,
    Contact,
    Discretisation,
    Material,
    Scene,
    SolverSettings,
    Support,
)
from fenics_contact.scene.values import AXES
from fenics_contact.verification.boxes import Box, boxes

# isort: split
from mpi4py import MPI


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
