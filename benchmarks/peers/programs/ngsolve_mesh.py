"""Meshes of quadrilaterals for NGSolve."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

Sides = dict[str, list[str]]


def rectangle(along: list[float], up: list[float], sides: Sides) -> Any:
    """A mesh between lines.

    Args:
        along: Places of the lines along x.
        up: Along y.
        sides: Top, bottom, right and left: a name, or one for each of their cells.
    """
    import netgen.meshing as netgen

    mesh = netgen.Mesh(dim=2)
    add_rectangle(mesh, "body", along, up, sides, {})
    return mesh


def add_rectangle(
    mesh: Any, body: str, along: list[float], up: list[float], sides: Sides, known: dict[str, int]
) -> None:
    """A body more for a mesh, with points of its own.

    Args:
        mesh: Of netgen.
        body: Its name.
        along: As of ``rectangle``.
        up: Likewise.
        sides: Likewise.
        known: Numbers of sides by their names, to which its own are added.
    """
    import netgen.meshing as netgen

    points = [[mesh.Add(netgen.MeshPoint(netgen.Pnt(x, y, 0.0))) for x in along] for y in up]
    number = mesh.AddRegion(body, dim=2)
    for below, above in pairwise(points):
        for i in range(len(along) - 1):
            corners = [below[i], below[i + 1], above[i + 1], above[i]]
            mesh.Add(netgen.Element2D(number, corners))
    lines = {
        "top": points[-1][::-1],
        "bottom": points[0],
        "right": [row[-1] for row in points],
        "left": [row[0] for row in points][::-1],
    }
    for side, line in lines.items():
        names = sides[side] * (1 if len(sides[side]) > 1 else len(line) - 1)
        names = names[::-1] if side == "top" else names
        for (here, there), name in zip(pairwise(line), names, strict=True):
            if name not in known:
                known[name] = mesh.AddRegion(name, dim=1)
            mesh.Add(netgen.Element1D([here, there], index=known[name]))
