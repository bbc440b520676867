"""The bodies of a geometry: its solids, or faces in the plane, with names, and how they lie.

For the process of Gmsh alone: it works on the model that is open there.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import gmsh
import numpy as np

from fenics_contact.common.wording import label_of, unique_names
from fenics_contact.mesh.geometry.process_room import Arrays, Job, RefusedError
from fenics_contact.mesh.geometry.step_faces import face_labels

_WHOLE = "body"  # the group of all cells, which no single body may be called
_INSIDE = 0.999  # share of the smaller body, from which on it lies in the other
_ROUND_OFF = 1e-9  # share of the smaller body that is no overlap
_TOUCHING = 1e-6  # distance that is none, over the size of the smaller body
_MEASURES = {2: "area", 3: "volume"}


@dataclass
class Bodies:
    """Names of the parts of the open model.

    Attributes:
        dimension: Of the model.
        parts: Name → Gmsh's numbers of the solids, or faces, that are this body. None of them
            shares one, unless the file's physical groups do.
        surfaces: Name → Gmsh's numbers of the surfaces, or curves, that the file calls so.
        relations: How bodies lie that are near each other: ``bodies``, two names; ``kind``,
            ``glued``, ``touching``, ``overlapping`` or ``unknown``; and ``overlap``, a volume or an
            area, with its ``share`` of the smaller.
        are_groups: Whether they are the file's physical groups, which are known anyway.
        preloaded: Name → Gmsh's numbers of the pieces of bodies that are preloaded.
    """

    dimension: int
    parts: dict[str, list[int]] = field(default_factory=dict)
    surfaces: dict[str, list[int]] = field(default_factory=dict)
    relations: list[dict[str, Any]] = field(default_factory=list)
    are_groups: bool = False
    preloaded: dict[str, list[int]] = field(default_factory=dict)
    _pieces: dict[int, int] = field(default_factory=dict)
    _sections: set[int] = field(default_factory=set)

    def cut_sides(self, pieces: Mapping[int, Sequence[int]], sections: Iterable[int]) -> None:
        """Surfaces, or curves, were cut, and sections made.

        Args:
            pieces: What has become of each that there was.
            sections: Gmsh's numbers of the new ones inside the bodies.
        """
        numbers = {side: self.number(self.dimension - 1, side) for side in pieces}
        was_section = {side for side in pieces if side in self._sections}
        for side, found in pieces.items():
            self._pieces.pop(side, None)
            if side in was_section:
                self._sections.discard(side)
                self._sections.update(found)
            else:
                number = numbers[side]
                self._pieces |= {p: number for p in found if number is not None and p != number}
        self._sections.update(sections)

    def number(self, dimension: int, part: int) -> int | None:
        """Return a part's number for users: its own, that of its part before a cut, or none."""
        if dimension != self.dimension - 1:
            return part
        return None if part in self._sections else self._pieces.get(part, part)

    def count_as_groups(self) -> None:
        """The bodies are the file's physical groups: ``groups`` leaves them out."""
        self.are_groups = True

    def groups(self) -> list[dict[str, Any]]:
        """Return groups for ``from_gmsh``, without the numbers, which are the surfaces'."""
        kinds = [] if self.are_groups else [(self.dimension, self.parts)]
        kinds.append((self.dimension, self.preloaded))
        return [
            {"dimension": dimension, "tag": 0, "name": name, "parts": parts}
            for dimension, named in [*kinds, (self.dimension - 1, self.surfaces)]
            for name, parts in named.items()
        ]


def name_bodies(job: Job, bodies: Bodies) -> None:
    """Name each by the file's physical groups, else its labels, else by its number.

    One body without a label needs no name: it is the whole.
    """
    dimension = bodies.dimension
    groups = gmsh.model.getPhysicalGroups(dimension)
    if groups:
        bodies.count_as_groups()
        for group in groups:
            name = gmsh.model.getPhysicalName(*group) or str(group[1])
            found = gmsh.model.getEntitiesForPhysicalGroup(*group).tolist()
            bodies.parts.setdefault(name, []).extend(found)
        return
    parts = [part for _, part in gmsh.model.getEntities(dimension)]
    labels = [label_of(gmsh.model.getEntityName(dimension, part)) for part in parts]
    if len(parts) == 1 and labels[0] in ("", _WHOLE):
        bodies.parts[_WHOLE] = parts
        return
    names = unique_names(labels, _WHOLE, taken={_WHOLE, *job["groups"]})
    bodies.parts.update({name: [part] for name, part in zip(names, parts, strict=True)})


def name_surfaces(job: Job, bodies: Bodies) -> None:
    """Name the surfaces that a STEP file labels, by their body and their label."""
    if job.get("format") != "step" or bodies.dimension != 3:
        return
    labels = face_labels(job["file"], [part for _, part in gmsh.model.getEntities(3)])
    owners = {part: name for name, parts in bodies.parts.items() for part in parts}
    for part, faces in labels.items():
        owner = "" if owners[part] == _WHOLE else f"{owners[part]}_"
        for face, label in faces:
            name = f"{owner}{label}"
            if name not in bodies.parts and name not in job["groups"]:
                bodies.surfaces.setdefault(name, []).append(face)


def relate(job: Job, bodies: Bodies) -> None:
    """Tell bodies apart that are glued, that touch and that overlap.

    Raises:
        RefusedError: A body lies in another.
    """
    if job["sizes"]:  # a further mesh of a geometry that is known
        return
    for pair in itertools.combinations(bodies.parts, 2):
        if set(bodies.parts[pair[0]]) & set(bodies.parts[pair[1]]):
            continue
        kind, overlap, share = _relation(bodies.dimension, *(bodies.parts[name] for name in pair))
        if share > _INSIDE:
            _refuse_inside(job, bodies, pair)
        if kind:
            found = {"bodies": list(pair), "kind": kind, "overlap": overlap, "share": share}
            bodies.relations.append(found)


def _relation(
    dimension: int, first: Sequence[int], second: Sequence[int]
) -> tuple[str, float, float]:
    """How two bodies lie; the measure of their overlap, and its share of the smaller."""
    if _sides(dimension, first) & _sides(dimension, second):
        return "glued", 0.0, 0.0
    pairs = list(_near(dimension, first, second))
    if not pairs:
        return "", 0.0, 0.0
    try:
        return _compared(dimension, first, second, pairs)
    except Exception:  # Gmsh raises plain Exceptions, where OpenCASCADE cannot intersect shapes
        return "unknown", 0.0, 0.0


def _compared(
    dimension: int, first: Sequence[int], second: Sequence[int], pairs: list[tuple[int, int]]
) -> tuple[str, float, float]:
    """The same of bodies that share no face, from the shapes of parts that are near."""
    smaller = min(_measure(dimension, first), _measure(dimension, second))
    overlap = sum(_overlap(dimension, *pair) for pair in pairs)
    if overlap > _ROUND_OFF * smaller:
        return "overlapping", overlap, overlap / smaller
    most = _TOUCHING * smaller ** (1 / dimension)
    distance = gmsh.model.occ.getDistance
    if any(distance(dimension, a, dimension, b)[0] <= most for a, b in pairs):
        return "touching", 0.0, 0.0
    return "", 0.0, 0.0


def _refuse_inside(job: Job, bodies: Bodies, pair: tuple[str, str]) -> None:
    """A body all of which is within another."""
    outer, inner = sorted(pair, key=lambda name: -_measure(bodies.dimension, bodies.parts[name]))
    raise RefusedError(
        f"{job['key']}.file = '{job['name']}': the body '{inner}' lies inside '{outer}', with all "
        f"of its {_MEASURES[bodies.dimension]}; cut its room out of '{outer}' in the CAD program, "
        "or leave one of them out"
    )


def _sides(dimension: int, parts: Sequence[int]) -> set[int]:
    """Surfaces, or curves, around some parts."""
    return {
        side for part in parts for side in gmsh.model.getAdjacencies(dimension, part)[1].tolist()
    }


def _near(dimension: int, first: Sequence[int], second: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Parts whose boxes meet, of those that OpenCASCADE knows: it compares no others."""
    known = {part for _, part in gmsh.model.occ.getEntities(dimension)}
    for pair in itertools.product(first, second):
        if known.issuperset(pair):
            a, b = (np.array(gmsh.model.getBoundingBox(dimension, p)).reshape(2, 3) for p in pair)
            play = _TOUCHING * max(np.ptp(a), np.ptp(b))
            if (a[0] <= b[1] + play).all() and (b[0] <= a[1] + play).all():
                yield pair


def _measure(dimension: int, parts: Sequence[int]) -> float:
    """Volume, or area, of some parts; only of those that OpenCASCADE knows."""
    known = {part for _, part in gmsh.model.occ.getEntities(dimension)}
    return float(sum(gmsh.model.occ.getMass(dimension, p) for p in parts if p in known))


def _overlap(dimension: int, first: int, second: int) -> float:
    """Volume, or area, that two parts share; the model stays as it is."""
    occ = gmsh.model.occ
    copies = [occ.copy([(dimension, part)]) for part in (first, second)]
    try:
        shared, _ = occ.intersect(*copies, removeObject=False, removeTool=False)
        copies.append(shared)
        return float(sum(occ.getMass(*part) for part in shared if part[0] == dimension))
    finally:
        for made in copies:
            occ.remove(made, recursive=True)


_ALONG = 6  # points along each parameter


def exact_surfaces(dimension: int) -> Arrays:
    """Return points with normals, and the measure, of every surface; in the plane of curves.

    Returns:
        ``exact_points`` and ``exact_normals`` (points, 3), ``exact_parts`` (points,); and
        ``measured_parts``, ``measures`` of the surfaces that OpenCASCADE knows, and
        ``measured_bodies``, ``body_measures`` of its solids, or faces.
    """
    occ = gmsh.model.occ
    bodies = {part: occ.getMass(dimension, part) for _, part in occ.getEntities(dimension)}
    known = set(gmsh.model.occ.getEntities(dimension - 1))
    points, normals, parts, measures = [], [], [], {}
    for _, part in gmsh.model.getEntities(dimension - 1):
        if (dimension - 1, part) in known:
            measures[part] = gmsh.model.occ.getMass(dimension - 1, part)
        try:
            places, directions = _sampled(dimension - 1, part)
        except Exception:  # Gmsh raises plain Exceptions: discrete parts have no parameters
            continue
        sound = np.isfinite(directions).all(axis=1) & np.isfinite(places).all(axis=1)
        sound &= np.abs(np.linalg.norm(directions, axis=1) - 1) < 1e-6
        points.append(places[sound])
        normals.append(directions[sound])
        parts.append(np.full(int(sound.sum()), part))
    empty = np.zeros((0, 3))
    return {
        "exact_points": np.concatenate([empty, *points]),
        "exact_normals": np.concatenate([empty, *normals]),
        "exact_parts": np.concatenate([np.zeros(0, dtype=np.int64), *parts]),
        "measured_parts": np.array(list(measures), dtype=np.int64),
        "measures": np.array(list(measures.values()), dtype=float),
        "measured_bodies": np.array(list(bodies), dtype=np.int64),
        "body_measures": np.array(list(bodies.values()), dtype=float),
    }


def _sampled(dimension: int, part: int) -> tuple[np.ndarray, np.ndarray]:
    """Points all over the parameters of a surface or a curve, and unit normals there."""
    low, high = gmsh.model.getParametrizationBounds(dimension, part)
    # Not at the ends: poles and apexes have no normals.
    shares = (np.arange(_ALONG) + 0.5) / _ALONG
    sides = [a + (b - a) * shares for a, b in zip(low, high, strict=True)]
    parameters = np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1)
    points = np.array(gmsh.model.getValue(dimension, part, parameters)).reshape(-1, 3)
    if dimension == 2:
        return points, np.array(gmsh.model.getNormal(part, parameters)).reshape(-1, 3)
    along = np.array(gmsh.model.getDerivative(1, part, parameters)).reshape(-1, 3)
    normals = np.column_stack([along[:, 1], -along[:, 0], np.zeros(len(along))])
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)
