"""One contact on three meshes: of hexahedra, of wedges with hexahedra, and of tetrahedra."""

from __future__ import annotations

import dataclasses
import math
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from mpi4py import MPI

from fenics_contact.common.arrays import Array
from fenics_contact.common.parallel import from_root
from fenics_contact.results.result import Result
from fenics_contact.scene.body import Material
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.supports import Support
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.scene import MeshSource, Scene
from fenics_contact.verification.boxes import Box, boxes
from fenics_contact.verification.case import Case, Finding, solved

#: Width and depth of the block, and its height.
WIDTH, HEIGHT = 2.0, 1.0
# Of the corners of a box, those of its two wedges.
_WEDGES = ((0, 1, 3, 4, 5, 7), (1, 2, 3, 5, 6, 7))
_TYPES = {6: "C3D6", 8: "C3D8"}
# Number of the upper face of each, after the manual.
_UPPER = "S2"


def pressed_block() -> Scene:
    """A block on a floor that a ball is pressed into, of which a quarter is modelled; no mesh."""
    ball = Obstacle(
        "sphere", radius=4.0, position=(0, 0, HEIGHT), normal=(0, 0, -1), indentation=0.06
    )
    return Scene(
        kinematics="3D",
        material=(Material(1000.0, 0.3),),
        support=(
            Support("bottom", {"x": 0.0, "y": 0.0, "z": 0.0}),
            Support("left", {"x": 0.0}),
            Support("front", {"y": 0.0}),
        ),
        contact=(Contact("top", obstacle=ball),),
    )


def wedges_with_hexahedra(cells: int) -> str:
    """An Abaqus file of the block: wedges where x is below half of its width, else hexahedra.

    Args:
        cells: Along the width and the depth; half as many along the height.
    """
    counts = np.array([cells, cells, max(cells // 2, 1)])
    size = np.array([WIDTH, WIDTH, HEIGHT]) / counts
    strides = np.cumprod([1, *(counts[:2] + 1)])
    lines = ["*NODE"]
    places: list[Array] = []
    for number, (z, y, x) in enumerate(np.ndindex(*(counts[::-1] + 1)), 1):
        places.append(np.array([x, y, z]) * size)
        lines.append(f"{number}, " + ", ".join(f"{at:.17g}" for at in places[-1]))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    upper, number = list[int](), 0
    for z, y, x in np.ndindex(*counts[::-1]):
        flat = 1 + (np.array([x, y]) + corners) @ strides[:2] + z * strides[2]
        box = np.concatenate([flat, flat + strides[2]])
        parts = _WEDGES if 2 * x < cells else (range(8),)
        for part in parts:
            number += 1
            nodes = box[list(part)]
            words = ", ".join(str(node) for node in (number, *nodes.tolist()))
            lines += [f"*ELEMENT, TYPE={_TYPES[len(nodes)]}, ELSET=block", words]
            upper += [number] * bool(z == counts[2] - 1)
    lines += ["*ELSET, ELSET=upper", *map(str, upper), "*SURFACE, NAME=top", f"upper, {_UPPER}"]
    for name, axis in (("left", 0), ("front", 1), ("bottom", 2)):
        lines.append(f"*NSET, NSET={name}")
        lines += [str(node) for node, at in enumerate(places, 1) if at[axis] == 0]
    return "\n".join(lines) + "\n"


def _of_file(cells: int) -> Result:
    """Solved on wedges with hexahedra, which are read from a file; collective."""
    comm = MPI.COMM_WORLD
    with tempfile.TemporaryDirectory() as folder:
        path = Path(from_root(comm, folder)) / "block.inp"
        if comm.rank == 0:
            path.write_text(wedges_with_hexahedra(cells), encoding="ascii")
        comm.barrier()
        found = solved(dataclasses.replace(pressed_block(), mesh=(MeshSource(str(path)),)))
        comm.barrier()
    return found


def _of_boxes(cells: int, cell: str) -> Result:
    """Solved on hexahedra or tetrahedra alone; collective."""
    counts = cells, cells, max(cells // 2, 1)
    body = boxes([Box("block", (0, 0, 0), (WIDTH, WIDTH, HEIGHT), counts)], cell)
    sides = {"bottom": "z0", "top": "z1", "left": "x0", "front": "y0"}
    groups = {name: body.groups[f"block.{side}"] for name, side in sides.items()}
    named = dataclasses.replace(body, groups={**body.groups, **groups})
    return solved(pressed_block(), named)


def _cells(quick: bool) -> Iterator[Finding]:
    cells = 4 if quick else 8
    exact = _of_boxes(cells, "tetrahedron")
    others = (
        ("hexahedra", _of_boxes(cells, "hexahedron")),
        ("wedges with hexahedra", _of_file(cells)),
    )
    for words, found in others:
        for name in ("normal_force", "strain_energy"):
            own, other = (one.errors[name]["total"] for one in (found, exact))
            value, reference = (one.quantities[name] for one in (found, exact))
            both = math.nan if own is None or other is None else own + other
            tolerance = both / abs(reference)
            yield Finding(f"{name} on {words}", value, reference, tolerance, bar=own)


CELLS_CASES: tuple[Case, ...] = (
    Case(
        "cells",
        "a ball pressed into a block of hexahedra, of wedges with hexahedra, and of tetrahedra",
        "the same on tetrahedra alone; apart by no more than both error bars",
        _cells,
    ),
)
