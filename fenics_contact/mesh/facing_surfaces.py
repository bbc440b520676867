"""Surfaces of bodies that face each other, bodies that look like bolts, and removable pieces.

Pairs for contacts: from points all over a surface a line along its normal looks for the other: it
must be met within the tolerance, by a normal that points back. Boxes that overlap are not enough.

Pieces that can be taken off: contacts open in some rigid motion and close nowhere. With friction
all other motions are resisted. The motion that opens most is found by linear programming: maximise
the sum of the openings, where none may be negative.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np
from scipy.optimize import linprog

from fenics_contact.common.arrays import Array, Flags
from fenics_contact.mesh.surface_shapes import SurfaceShape
from fenics_contact.mesh.survey import FoundSurface, Survey

TOLERANCE = 1e-3  # of a gap, over the diagonal of all
_DEEP = 0.02  # of overlaps as drawn, over the same
_CLEARANCE = 0.2  # of a shaft in its hole, over the radius: what holes for bolts have
_LEAST = 0.01  # share of the smaller surface that has to face the other
_BACK = -0.5  # of the product of two normals that face each other
_SAMPLES = 400  # points on a surface, at the least
_ROUNDS = 4_000_000  # lines times triangles looked at together
_ALIKE = 1e-6  # of shapes and places that are the same, over the diagonal


@dataclass(frozen=True)
class Pair:
    """Surfaces of two bodies that face each other.

    Attributes:
        bodies: Indices of the bodies.
        first: Indices of the surfaces of the first.
        second: And of the second.
        gap: Between them, < 0 where they overlap (length).
        area: That faces the other, of the smaller of both.
        is_exact: Whether the gap is that of the shapes, not of their meshes.
    """

    bodies: tuple[int, int]
    first: tuple[int, ...]
    second: tuple[int, ...]
    gap: float
    area: float
    is_exact: bool


def facing_pairs(found: Survey, tolerance: float | None = None) -> list[Pair]:
    """Pairs of surfaces that a contact could stand between, those of one shape as one.

    Args:
        found: Bodies and surfaces.
        tolerance: Of the gap; by default 1/1000 of the diagonal of all (length).
    """
    limit = TOLERANCE * found.size if tolerance is None else tolerance
    pairs = []
    usable = [i for i, surface in enumerate(found.surfaces) if surface.can_touch]
    for a, b in itertools.combinations(usable, 2):
        if found.surfaces[a].piece != found.surfaces[b].piece:
            pair = _pair(found, a, b, limit)
            if pair is not None:
                pairs.append(pair)
    return _merged(found, pairs) if found.surfaces and found.surfaces[0].number else pairs


def _pair(found: Survey, a: int, b: int, limit: float) -> Pair | None:
    one, other = found.surfaces[a], found.surfaces[b]
    if one.bodies > other.bodies:
        a, b, one, other = b, a, other, one
    exact = _gap_of_shapes(one, other, _ALIKE * found.size)
    if exact is not None and one.shape.kind == "cylinder" and one.shape.radius is not None:
        limit = max(limit, _CLEARANCE * one.shape.radius)
    deep = max(_DEEP * found.size, limit)
    if exact is not None and not -deep <= exact <= limit:
        return None
    slack = _sag(one) + _sag(other)
    reach = max(limit, deep) + slack
    if (one.box[0] > other.box[1] + reach).any() or (other.box[0] > one.box[1] + reach).any():
        return None
    gaps, area = _met(one, other, limit + slack, deep + slack)
    gaps_back, area_back = _met(other, one, limit + slack, deep + slack)
    area = max(area, area_back)
    if area < _LEAST * min(one.measure, other.measure):
        return None
    gap = float(np.median(np.concatenate([gaps, gaps_back]))) if exact is None else exact
    if gap > limit + (slack if exact is None else 0):
        return None
    if exact is None and abs(gap) < slack:
        gap = 0.0
    return Pair((one.bodies[0], other.bodies[0]), (a,), (b,), gap, area, exact is not None)


def _met(
    one: FoundSurface, other: FoundSurface, outwards: float, inwards: float
) -> tuple[Array, float]:
    """Distances along the normals of one surface at which the other is met; the area of these."""
    points, normals, areas = _samples(one)
    reach = max(outwards, inwards)
    near = (points > other.box[0] - reach).all(axis=1) & (points < other.box[1] + reach).all(axis=1)
    points, normals, areas = points[near], normals[near], areas[near]
    step = max(1, _ROUNDS // len(other.triangles))
    found = [
        _distances(points[n : n + step], normals[n : n + step], other, outwards, inwards)
        for n in range(0, len(points), step)
    ]
    distances = np.concatenate([np.zeros(0), *found])
    hit = np.isfinite(distances)
    return distances[hit], float(areas[hit].sum())


def _distances(
    points: Array, normals: Array, other: FoundSurface, outwards: float, inwards: float
) -> Array:
    """Distance along each line to the nearest triangle that faces back; infinite if none does."""
    corner, *_ = other.triangles.transpose(1, 0, 2)
    product = normals @ other.normals.T
    with np.errstate(divide="ignore", invalid="ignore"):
        height = (corner * other.normals).sum(axis=1) - points @ other.normals.T
        along = height / product
    good: Flags = (product < _BACK) & (along <= outwards) & (along >= -inwards)
    found = np.full(len(points), np.inf)
    line, triangle = np.nonzero(good)
    at = points[line] + along[line, triangle][:, None] * normals[line]
    inside = _inside(at, other.triangles[triangle])
    line, distance = line[inside], along[line, triangle][inside]
    order = np.argsort(-np.abs(distance))
    found[line[order]] = distance[order]
    return found


def _inside(points: Array, triangles: Array) -> Flags:
    """Whether points in the planes of triangles lie in them."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    square = (normal**2).sum(axis=1)
    least = -1e-6 * square
    parts = [
        (np.cross(q - p, points - p) * normal).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))
    ]
    return np.asarray(np.min(parts, axis=0) >= least)


def _samples(surface: FoundSurface) -> tuple[Array, Array, Array]:
    """Points all over a surface, with normals and the area of each."""
    count = int(np.ceil(np.sqrt(_SAMPLES / len(surface.triangles))))
    # The middles of the small triangles that a triangle is cut into.
    corners = np.array([(x, y) for x in range(count) for y in range(count - x)])
    turned = corners[corners.sum(axis=1) < count - 1]
    places = np.concatenate([corners + 1 / 3, turned + 2 / 3]) / count
    weights = np.column_stack([1 - places.sum(axis=1), places])
    points = np.einsum("pw,twd->tpd", weights, surface.triangles)
    edges = surface.triangles[:, 1:] - surface.triangles[:, :1]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2
    each = np.repeat(areas * surface.measure / areas.sum() / len(weights), len(weights))
    return points.reshape(-1, 3), np.repeat(surface.normals, len(weights), axis=0), each


def _sag(surface: FoundSurface) -> float:
    """How far flat facets may lie off a curved surface (length)."""
    edges = surface.triangles - np.roll(surface.triangles, 1, axis=1)
    longest = float(np.linalg.norm(edges, axis=2).max())
    shape = surface.shape
    if shape.kind in ("plane", "straight line"):
        return 0.0
    if shape.radius:
        return min(longest**2 / (8 * shape.radius), shape.radius) * 1.1
    return 0.1 * longest


def _gap_of_shapes(one: FoundSurface, other: FoundSurface, tolerance: float) -> float | None:
    """The gap between parallel planes and coaxial cylinders, or concentric spheres."""
    a, b = one.shape, other.shape
    if a.kind != b.kind:
        return None
    between = np.array(b.centre) - np.array(a.centre)
    if a.kind in ("plane", "straight line"):
        if abs(np.dot(a.axis, b.axis)) < 1 - 1e-9:
            return None
        return float(between @ one.normals[0])
    if a.radius is None or b.radius is None or a.kind == "torus":
        return None
    if a.axis:
        if abs(np.dot(a.axis, b.axis)) < 1 - 1e-9:
            return None
        between = between - (between @ np.array(a.axis)) * np.array(a.axis)
    if np.linalg.norm(between) > tolerance or one.is_outward == other.is_outward:
        return None
    return float(b.radius - a.radius if one.is_outward else a.radius - b.radius)


def _merged(found: Survey, pairs: Sequence[Pair]) -> list[Pair]:
    """Pairs of the same bodies, whose surfaces are pieces of the same shapes, as one."""
    merged: list[Pair] = []
    for pair in pairs:
        for place, other in enumerate(merged):
            alike = pair.bodies == other.bodies and all(
                _is_same(found, ours[0], theirs[0])
                for ours, theirs in ((pair.first, other.first), (pair.second, other.second))
            )
            if alike:
                merged[place] = replace(
                    other,
                    first=tuple(sorted({*other.first, *pair.first})),
                    second=tuple(sorted({*other.second, *pair.second})),
                    area=other.area + pair.area,
                )
                break
        else:
            merged.append(pair)
    return merged


def _is_same(found: Survey, a: int, b: int) -> bool:
    """Whether two surfaces are pieces of one plane, cylinder or sphere."""
    one, other = found.surfaces[a], found.surfaces[b]
    if a == b:
        return True
    if one.is_outward != other.is_outward and one.shape.radius:
        return False
    return _same_shape(one.shape, other.shape, _ALIKE * found.size) and (
        not one.shape.kind.startswith(("plane", "straight"))
        or float(one.normals[0] @ other.normals[0]) > 0.9
    )


def _same_shape(a: SurfaceShape, b: SurfaceShape, tolerance: float) -> bool:
    if a.kind != b.kind or a.kind in ("free form", "curve", "torus", "cone"):
        return False
    between = np.array(b.centre) - np.array(a.centre)
    if a.axis and abs(np.dot(a.axis, b.axis)) < 1 - 1e-9:
        return False
    if a.kind in ("plane", "straight line"):
        return bool(abs(between @ np.array(a.axis)) < tolerance)
    if a.axis:
        between = between - (between @ np.array(a.axis)) * np.array(a.axis)
    assert a.radius is not None and b.radius is not None
    return bool(np.linalg.norm(between) < tolerance and abs(a.radius - b.radius) < tolerance)


_MOST = 300  # points of a pair that are looked at
_OPEN = 1e-6  # of motions of at most 1


def loose_pieces(found: Survey, pairs: Sequence[Pair], held: Collection[int]) -> set[int]:
    """Pieces that move apart from another at a contact, in the motion that opens most.

    Args:
        found: Bodies and surfaces.
        pairs: The contacts.
        held: Pieces that a support holds.
    """
    count = max((piece for body in found.bodies for piece in body.pieces), default=-1) + 1
    ends = [[found.surfaces[side[0]].piece for side in (p.first, p.second)] for p in pairs]
    rows = [_openings(found, pair, both, count) for pair, both in zip(pairs, ends, strict=True)]
    if not rows:
        return set()
    every = np.concatenate(rows)
    free = [1.0, 1, 1, 1, 1, 1] if found.dimension == 3 else [1.0, 1, 0, 0, 0, 1]
    limits = np.concatenate([np.array(free) * (piece not in held) for piece in range(count)])
    bounds = np.column_stack([-limits, limits])
    best = linprog(-every.mean(axis=0), A_ub=-every, b_ub=np.zeros(len(every)), bounds=bounds)
    opened = [both for row, both in zip(rows, ends, strict=True) if (row @ best.x).max() > _OPEN]
    return {piece for both in opened for piece in both} - set(held)


def _openings(found: Survey, pair: Pair, pieces: Sequence[int], count: int) -> Array:
    """Openings by unit motions of all pieces at points of a pair, (points, 6 pieces)."""
    sides = [[found.surfaces[n] for n in side] for side in (pair.first, pair.second)]
    smaller = int(sum(s.measure for s in sides[1]) < sum(s.measure for s in sides[0]))
    places = np.concatenate([s.triangles.reshape(-1, 3) for s in sides[smaller]])
    normals = np.concatenate([np.repeat(s.normals, 3, axis=0) for s in sides[smaller]])
    step = max(1, len(places) // _MOST)
    places, normals = places[::step] / found.size, normals[::step]
    rows = np.zeros((len(places), 6 * count))
    for side, sign in ((smaller, -1), (1 - smaller, 1)):
        first = 6 * pieces[side]
        rows[:, first : first + 3] = sign * normals
        rows[:, first + 3 : first + 6] = sign * np.cross(places, normals)
    return rows


_PARALLEL = 1 - 1e-9  # cosine
_MIDDLE = 0.3, 0.7  # of the length between the shoulders: where a bolt may be cut


@dataclass(frozen=True)
class Bolt:
    """A body that looks like a bolt.

    Attributes:
        body: Its index.
        axis: Unit vector along it, (3,).
        between: Two places along the axis, from the origin, in the middle of its shank (length).
        area: Of the shank's section.
    """

    body: int
    axis: tuple[float, ...]
    between: tuple[float, float]
    area: float


def bolts(found: Survey, pairs: Sequence[Pair]) -> list[Bolt]:
    """Bodies whose plane shoulders press others together, with a cylinder from one to the other.

    Args:
        found: Bodies and surfaces.
        pairs: Surfaces that face each other.
    """
    touching: dict[int, set[int]] = {}
    for pair in pairs:
        for body, side in zip(pair.bodies, (pair.first, pair.second), strict=True):
            touching.setdefault(body, set()).update(side)
    looked = (_bolt(found, body, sorted(places)) for body, places in sorted(touching.items()))
    return [bolt for bolt in looked if bolt is not None]


def _bolt(found: Survey, body: int, places: Sequence[int]) -> Bolt | None:
    shoulders = [s for s in (found.surfaces[n] for n in places) if s.shape.kind == "plane"]
    near = _ALIKE * found.size
    for shank, axis in _shanks(found, body):
        ends = [(float(s.normals[0] @ axis), float(s.triangles[0, 0] @ axis)) for s in shoulders]
        for (one, start), (other, end) in itertools.permutations(ends, 2):
            reach = shank.triangles.reshape(-1, 3) @ axis
            spans = reach.min() <= start + near and end - near <= reach.max()
            if one >= _PARALLEL and other <= -_PARALLEL and start + near < end and spans:
                first, last = (start + share * (end - start) for share in _MIDDLE)
                radius = shank.shape.radius or 0.0
                return Bolt(body, tuple(axis.tolist()), (first, last), pi * radius**2)
    return None


def _shanks(found: Survey, body: int) -> Iterator[tuple[FoundSurface, Array]]:
    """Round surfaces of a body that bulge outwards, and their axes."""
    for surface in found.surfaces:
        if surface.bodies == (body,) and surface.shape.kind == "cylinder" and surface.is_outward:
            yield surface, np.array(surface.shape.axis)
