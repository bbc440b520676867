"""Preparation of a geometry for meshing: cuts of bodies, sizes of cells, constraints lifted.

It is for Gmsh's process alone. Bodies are cut by planes, so that a part of them can be preloaded.
The pieces stay glued: the mesh goes through the cuts. What is cut of the boundary keeps its number.
"""

from __future__ import annotations

import re
import resource
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import gmsh
import numpy as np

from fenics_contact.common.wording import question
from fenics_contact.mesh.geometry.bodies import Bodies
from fenics_contact.mesh.geometry.process_room import Job, RefusedError

# A statement of such a geometry, and nothing else: names of groups are the script's, which could
# make a command of one.
_NUMBERS = r"\s*=?\s*\{[-+.,\s\w]*\}"
_PLAIN = re.compile(
    rf"cl__\d+ = [-+.\w]+;|[A-Z][A-Za-z ]*\(\d+\){_NUMBERS}"
    rf"(?: (?:In|Using|Knots|Order|Plane)[ \w]*(?:{_NUMBERS})?(?: Order \d+)?)?;"
    rf"|(?:Point|Line|Curve|Surface) ?{_NUMBERS} In (?:Curve|Line|Surface|Volume) ?{_NUMBERS};"
)
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


_AROUND = 8  # curved cells around a full circle
_UNLIMITED = 1e22  # Gmsh's own
# What Gmsh calls the list of parts that a field is of.
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


def least_curvature(job: Job) -> float:
    """Cells around a full circle, at the least, where sizes are given as well.

    Curved cells follow their surface with a few; where more are needed the sizes say so, and small
    radii of parts that carry nothing are not to have the smallest cells of all.
    """
    wanted = float(job["curvature"] or 0)
    if gmsh.option.getNumber("Mesh.ElementOrder") == 1:
        return wanted
    return 0.0 if job["least_size"] else min(wanted, _AROUND)


def fields_of_bodies(kind: str, rows: np.ndarray, parts: np.ndarray, dimension: int) -> list[int]:
    """Numbers of Gmsh's fields of the sizes of bodies, each from the cells of its own alone.

    Where two bodies touch, either may have the cell around a point, or the nearest one.

    Args:
        kind: Gmsh's name of elements with sizes at the vertices.
        rows: Coordinates and sizes of each, as Gmsh takes them.
        parts: Of each the body, none where all are of every body.
        dimension: Of the model.
    """
    field, fields = gmsh.model.mesh.field, []
    separate = _separate_parts(dimension)
    if len(parts) == 0 or len(separate) == 1:
        return [_size_field(kind, rows)]
    for together in separate:
        every = _size_field(kind, rows[np.isin(parts, together)])
        fields.append(field.add("Restrict"))
        field.setNumber(fields[-1], "InField", every)
        field.setNumbers(fields[-1], _LISTS[dimension], together)
        field.setNumber(fields[-1], "IncludeBoundary", 1)
    return fields


def _size_field(kind: str, rows: np.ndarray) -> int:
    """Number of Gmsh's field of sizes on elements."""
    view = gmsh.view.add("sizes")
    gmsh.view.addListData(view, kind, len(rows), rows.reshape(-1))
    field = gmsh.model.mesh.field.add("PostView")
    gmsh.model.mesh.field.setNumber(field, "ViewTag", view)
    return int(field)


def _separate_parts(dimension: int) -> list[list[int]]:
    """Gmsh's numbers of the parts of the open model; of each list all hang together."""
    left, found = {part for _, part in gmsh.model.getEntities(dimension)}, []
    while left:
        found.append([part for _, part in _glued_to(dimension, [min(left)])])
        left.difference_update(found[-1])
    return found


def lift_constraints(job: Job) -> None:
    """Forget how many cells the file wants, and where.

    Gmsh can drop the constraints of OpenCASCADE's parts. Those of its own kernel come back with
    the geometry, so that is written out as plain statements and read again without them.
    """
    gmsh.model.mesh.clear()
    if gmsh.model.occ.getEntities():
        gmsh.model.mesh.removeConstraints()
        return
    parts = [entity for entity in gmsh.model.getEntities() if entity[0] >= 1]
    groups = [
        (
            *group,
            gmsh.model.getEntitiesForPhysicalGroup(*group),
            gmsh.model.getPhysicalName(*group),
        )
        for group in gmsh.model.getPhysicalGroups()
    ]
    _, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    with tempfile.TemporaryDirectory(dir=job["folder"]) as folder:
        unrolled, plain = Path(folder) / "all.geo_unrolled", Path(folder) / "plain.geo"
        gmsh.write(str(unrolled))
        lines = unrolled.read_text(encoding="latin-1").splitlines()
        kept = (line for line in lines if _PLAIN.fullmatch(line.strip()))
        plain.write_text("\n".join(kept), encoding="latin-1")
        gmsh.model.remove()
        gmsh.model.add("plain")
        gmsh.merge(str(plain))
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
    if [entity for entity in gmsh.model.getEntities() if entity[0] >= 1] != parts:
        raise RefusedError(
            f"{job['key']}.file = '{job['name']}': holds more than a geometry, which cannot be "
            "meshed with other sizes; leave out accuracy"
        )
    gmsh.model.removePhysicalGroups()
    for dimension, tag, members, name in groups:
        gmsh.model.addPhysicalGroup(dimension, members, tag, name)
