"""Preparation of a geometry's bodies for meshing: cuts, and sizes of cells.

Bodies that are cut by planes, so that a part of them can be preloaded; for Gmsh's process alone.
The pieces stay glued: the mesh goes through the cuts. What is cut of the boundary keeps its
number.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gmsh
import numpy as np

from fenics_contact.common.wording import question
from fenics_contact.mesh.geometry.bodies import Bodies
from fenics_contact.mesh.geometry.process_room import Job, RefusedError

_CLOSE = 1e-6  # of the body's length: a cut so near to its end is that end
_BEYOND = 1.1  # of half the body's diagonal: how wide the planes are

Entity = tuple[int, int]


def cut_bodies(job: Job, bodies: Bodies) -> None:
    """Cut bodies where preloads say, and name what is between.

    Raises:
        RefusedError: There is no such body, or it does not reach that far.
    """
    for cut in job.get("cuts", ()):
        _cut(job, bodies, cut)
        gmsh.model.occ.synchronize()


def _cut(job: Job, bodies: Bodies, cut: dict[str, Any]) -> None:
    name, (start, end) = cut["on"], cut["between"]
    if name not in bodies.parts:
        raise RefusedError(
            f"{cut['key']}.on = '{name}': {job['name']} has no body of that name"
            f"{question(name, bodies.parts)}; it has: {', '.join(bodies.parts)}"
        )
    axis = np.array([*cut["axis"], 0.0])[:3] / np.linalg.norm(cut["axis"])
    planes = _Planes(bodies.dimension, bodies.parts[name], axis)
    low, high = planes.extent()
    close = _CLOSE * (high - low)
    if start < low - close or end > high + close:
        raise RefusedError(
            f"{cut['key']}.between = [{start:g}, {end:g}]: '{name}' reaches only from {low:.6g} to "
            f"{high:.6g} along the axis"
        )
    for position in (start, end):
        if low + close < position < high - close:
            _cut_at(planes, position, bodies, name)
            planes = _Planes(bodies.dimension, bodies.parts[name], axis)
    middles = {part: _middle(bodies.dimension, part) @ axis for part in bodies.parts[name]}
    bodies.preloaded[cut["group"]] = [p for p, middle in middles.items() if start < middle < end]


def _middle(dimension: int, part: int) -> Any:
    return np.array(gmsh.model.occ.getCenterOfMass(dimension, part))


class _Planes:
    """Planes, or lines in the plane, that are normal to an axis and wider than a body.

    Args:
        dimension: Of the body.
        parts: Of it.
        axis: Unit vector, (3,).
    """

    def __init__(self, dimension: int, parts: Sequence[int], axis: Any) -> None:
        self._dimension, self.parts, self._axis = dimension, [(dimension, p) for p in parts], axis
        boxes = np.array([gmsh.model.occ.getBoundingBox(*part) for part in self.parts])
        corners = np.stack([boxes[:, :3].min(axis=0), boxes[:, 3:].max(axis=0)])
        self._centre = corners.mean(axis=0)
        self._radius = _BEYOND * np.linalg.norm(np.ptp(corners, axis=0)) / 2

    def at(self, position: float) -> list[Entity]:
        """The one at a position along the axis."""
        occ, axis, radius = gmsh.model.occ, self._axis, self._radius
        middle = self._centre + (position - self._centre @ axis) * axis
        if self._dimension == 3:
            return [(2, occ.addDisk(*middle, radius, radius, zAxis=axis.tolist()))]
        aside = radius * np.array([-axis[1], axis[0], 0.0])
        ends = [occ.addPoint(*(middle + sign * aside)) for sign in (-1, 1)]
        return [(1, occ.addLine(*ends))]

    def extent(self) -> tuple[float, float]:
        """Where the body begins and ends along the axis (length)."""
        found = []
        for sign in (-1, 1):
            far = self._centre @ self._axis + sign * self._radius
            plane = self.at(far)
            distance = min(gmsh.model.occ.getDistance(*plane[0], *part)[0] for part in self.parts)
            gmsh.model.occ.remove(plane, recursive=True)
            found.append(float(far - sign * distance))
        return found[0], found[1]


def _cut_at(planes: _Planes, position: float, bodies: Bodies, name: str) -> None:
    """Cut a body at a position, and what it is glued to where they share the boundary."""
    occ, dimension = gmsh.model.occ, bodies.dimension
    whole = _glued_to(dimension, bodies.parts[name])
    sides = sorted(
        {side for part in whole for side in gmsh.model.getAdjacencies(*part)[1].tolist()}
    )
    section, _ = occ.intersect(planes.at(position), planes.parts, removeTool=False)
    given = [*whole, *((dimension - 1, side) for side in sides)]
    # Nothing is removed before it is known what has become of it: so what stays keeps its number.
    _, became = occ.fragment(given, section, removeObject=False, removeTool=False)
    made = {entity: pieces for entity, pieces in zip(given, became, strict=False)}
    occ.remove([part for part in whole if made[part] != [part]], recursive=True)
    occ.synchronize()
    for named in (bodies.parts, bodies.preloaded):
        for key, parts in named.items():
            named[key] = [
                piece
                for part in parts
                for _, piece in made.get((dimension, part), [(dimension, part)])
            ]
    sections = [piece for pieces in became[len(given) :] for _, piece in pieces]
    bodies.cut_sides({side: [p for _, p in made[dimension - 1, side]] for side in sides}, sections)


def _glued_to(dimension: int, parts: Sequence[int]) -> list[Entity]:
    """Some parts and all that hang together with them, from one to the next."""
    corners = {
        part: {point for _, point in gmsh.model.getBoundary([part], recursive=True)}
        for part in gmsh.model.getEntities(dimension)
    }
    found = {(dimension, part) for part in parts}
    while True:
        reached = set().union(*(corners[part] for part in found))
        more = {part for part, points in corners.items() if points & reached} - found
        if not more:
            return sorted(found)
        found |= more


_UNLIMITED = 1e22  # Gmsh's own
_LISTS = {2: "SurfacesList", 3: "VolumesList"}


def limit_sizes(job: Job, bodies: Bodies) -> None:
    """No cell of a body is larger than ``mesh.sizes`` says; where it is silent, ``mesh.size``.

    Raises:
        RefusedError: There is no such body.
    """
    for name in job["body_sizes"]:
        if name not in bodies.parts:
            raise RefusedError(
                f"{job['key']}.sizes.{name}: {job['name']} has no body of that name"
                f"{question(name, bodies.parts)}; it has: {', '.join(bodies.parts)}"
            )
    if job["body_sizes"]:
        set_least(limiting_fields(job, bodies))
        gmsh.option.setNumber("Mesh.MeshSizeMax", largest_size(job, bodies))


def limiting_fields(job: Job, bodies: Bodies, factor: float = 1) -> list[int]:
    """Numbers of Gmsh's fields that limit the cells of the bodies that have a size of their own.

    Args:
        job: With the sizes.
        bodies: Of the model.
        factor: By which all sizes are multiplied.
    """
    field, fields = gmsh.model.mesh.field, []
    for name, size in _sizes(job, bodies).items() if job["body_sizes"] else []:
        if size is not None:
            fields.append(field.add("Constant"))
            field.setNumbers(fields[-1], _LISTS[bodies.dimension], bodies.parts[name])
            field.setNumber(fields[-1], "VIn", factor * size)
            field.setNumber(fields[-1], "VOut", _UNLIMITED)
            field.setNumber(fields[-1], "IncludeBoundary", 1)
    return fields


def largest_size(job: Job, bodies: Bodies) -> float:
    """The largest cell that any body may have (length)."""
    sizes = _sizes(job, bodies).values() if job["body_sizes"] else [job["size"]]
    return max(size or _UNLIMITED for size in sizes)


def set_least(fields: list[int]) -> None:
    """Have Gmsh take the least of some fields, by their numbers."""
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", fields)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)


def _sizes(job: Job, bodies: Bodies) -> dict[str, float | None]:
    return {name: job["body_sizes"].get(name, job["size"]) for name in bodies.parts}
