"""Rays from points to facets: the point of another surface that faces each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from fenics_contact.common.arrays import AnyIntegers, Array, Flags, Integers
from fenics_contact.contact.mortar.facet_mesh import FacetMesh, normalised, reference_nodes

# Entries of the tables of all lines against all facets that are held at a time: they stay in
# the processor's cache.
_TABLE = 2**18
_BLOCK = 64  # lines beside each other, for which facets are chosen together
_NEWTON_STEPS = 20
_CONVERGED = 1e-8  # reference coordinates; the next step would be its square
_INSIDE = 1e-6  # reference coordinates: a point opposite an edge faces the facet
_GRAZING = 1e-6  # cosine of lines along a facet, which have no point in common with it
_SAME_DISTANCE = 1e-9  # of the facet's radius
_MEAN_STEPS = 10
_SAME_DIRECTION = 1e-12
_MARGIN = 1.001  # of spheres: a line at a corner of a facet touches that of its corners


@dataclass(frozen=True, eq=False)
class Hits:
    """Where lines from points meet a surface.

    Attributes:
        facet: Facet of the surface, −1 where nothing is hit, (points,).
        reference: Place on it, (points, dimension − 1).
        distance: Along the line, negative behind the point, infinite where nothing is hit,
            (points,) (length).
    """

    facet: AnyIntegers
    reference: Array
    distance: Array


@dataclass(frozen=True, eq=False)
class _Crossings:
    """Where lines cross facets of a surface, in any direction.

    Attributes:
        line: The line of each crossing, (crossings,).
        facet: The facet, (crossings,).
        reference: Place on it, (crossings, dimension − 1).
        distance: Along the line, negative behind its beginning, (crossings,) (length).
        opposed: Whether the facet's outward normal opposes the line, (crossings,).
    """

    line: AnyIntegers
    facet: AnyIntegers
    reference: Array
    distance: Array
    opposed: Flags

    def entries_behind(self, master: FacetMesh, lines: int) -> Array:
        """Entries behind each line, as ``entries_behind`` of the module, (lines,) (length).

        A line that begins on a facet does not enter there.
        """
        found = np.full(lines, np.inf)
        behind = self.distance < -_SAME_DISTANCE * master.radii[self.facet]
        enters = ~self.opposed & behind
        np.minimum.at(found, self.line[enters], -self.distance[enters])
        return found


def hits(master: FacetMesh, points: Array, directions: Array) -> Hits:
    """The nearest facets, before or behind, whose outward normals oppose the lines.

    Behind a point that lies in the master, a line first leaves the master. Where it first enters
    the master, the point lies outside, and nothing farther behind is an overlap: so a roller does
    not overlap with the far side of the ring on which it stands. Between facets at the same
    distance (at a common edge) the first one counts.

    Args:
        master: The surface to be hit.
        points: Where lines begin, (points, dimension) (length).
        directions: Unit vectors along them, (points, dimension).
    """
    found = _crossings(master, points, directions)
    counts = found.opposed & (
        found.distance > -found.entries_behind(master, len(points))[found.line]
    )
    line, facet, reference = found.line[counts], found.facet[counts], found.reference[counts]
    distance = found.distance[counts]

    least = np.full(len(points), np.inf)
    np.minimum.at(least, line, np.abs(distance))
    nearest = np.abs(distance) <= least[line] + _SAME_DISTANCE * master.radii[facet]
    chosen, first = np.unique(line[nearest], return_index=True)
    first = np.flatnonzero(nearest)[first]
    hit = Hits(
        np.full(len(points), -1),
        np.zeros((len(points), master.dimension - 1)),
        np.full(len(points), np.inf),
    )
    hit.facet[chosen] = facet[first]
    hit.reference[chosen] = reference[first]
    hit.distance[chosen] = distance[first]
    return hit


def entries_behind(master: FacetMesh, points: Array, directions: Array) -> Array:
    """How far behind points lines first enter the body of a surface, (points,) (length).

    Infinite where they do not. That a line leaves the body before is not asked.

    Args:
        master: The body's surface.
        points: Where lines begin, (points, dimension) (length).
        directions: Unit vectors along them, (points, dimension).
    """
    return _crossings(master, points, directions).entries_behind(master, len(points))


def _crossings(master: FacetMesh, points: Array, directions: Array) -> _Crossings:
    """All crossings of lines with the facets of a surface."""
    line, facet = _near_facets(master, points, directions)
    reference, met = meet(master, facet, points[line], directions[line])
    inside = met & _is_inside(master.shape, reference)
    line, facet, reference = line[inside], facet[inside], reference[inside]
    normals = normalised(master.area_normals(facet, reference))
    cosines = np.einsum("pd,pd->p", normals, directions[line])
    cuts = np.abs(cosines) > _GRAZING
    line, facet, reference, cosines = line[cuts], facet[cuts], reference[cuts], cosines[cuts]
    reach = master.positions(facet, reference) - points[line]
    distance = np.einsum("pd,pd->p", reach, directions[line])
    return _Crossings(line, facet, reference, distance, cosines < 0)


def _near_facets(
    master: FacetMesh, points: Array, directions: Array
) -> tuple[AnyIntegers, AnyIntegers]:
    """Pairs (line, facet) in whose spheres lines pass, ordered by line, then facet.

    Many lines are taken in blocks of neighbours, each of which sees few of many facets.
    """
    none = np.zeros(len(points))
    spheres = master.centres, master.radii
    if len(points) * len(master.radii) <= _TABLE:
        return next(near_lines(points, directions, none, none, *spheres))
    order = cKDTree(points, leafsize=_BLOCK).indices
    lines, facets = [none[:0].astype(np.int64)], [none[:0].astype(np.int64)]
    for first in range(0, len(points), _BLOCK):
        block = np.sort(order[first : first + _BLOCK])
        seen = _seen_from(points[block], directions[block], *spheres)
        zeros = none[block]
        for line, facet in near_lines(
            *(points[block], directions[block], zeros, zeros), *(of[seen] for of in spheres)
        ):
            lines.append(block[line])
            facets.append(seen[facet])
    line, facet = np.concatenate(lines), np.concatenate(facets)
    by_line = np.argsort(line, kind="stable")
    return line[by_line], facet[by_line]


def _seen_from(points: Array, directions: Array, centres: Array, radii: Array) -> Integers:
    """Spheres that a line of a block may touch.

    Lines begin within r of their mean c and within w of the axis c + t m; their directions are
    within δ of m. Where one is nearest to the middle e of a sphere, it is no farther from the axis
    than w + δ (|e − c| + r).
    """
    middle, axis = points.mean(axis=0), directions.mean(axis=0)
    axis = axis / max(float(np.linalg.norm(axis)), np.finfo(float).tiny)
    starts, away = points - middle, centres - middle
    farthest = np.linalg.norm(starts, axis=1).max()
    width = np.linalg.norm(starts - np.outer(starts @ axis, axis), axis=1).max()
    spread = np.linalg.norm(directions - axis, axis=1).max()
    squares = np.einsum("sd,sd->s", away, away)
    aside = squares - (away @ axis) ** 2
    reach = _MARGIN * (radii + width + spread * (np.sqrt(squares) + farthest))
    return np.flatnonzero(aside <= reach**2)


def face(slave_points: Array, slave_normals: Array, master: FacetMesh) -> tuple[Array, Hits]:
    """Mean normals n̄ ∝ n_slave − n_master(y), where the ray along n̄ hits the master at y.

    A point whose ray along a better direction passes by the master keeps the last one that
    hit, and the slave's normal if none did.

    Args:
        slave_points: Points of the slave, (points, dimension) (length).
        slave_normals: Its outward unit normals there, (points, dimension).
        master: The other surface.

    Returns:
        Mean normals, (points, dimension), and what they hit.
    """
    directions = slave_normals.copy()
    found = hits(master, slave_points, directions)
    moving = np.flatnonzero(found.facet >= 0)
    for _ in range(_MEAN_STEPS):
        opposite = master.interpolate(master.normals, found.facet[moving], found.reference[moving])
        mean = normalised(slave_normals[moving] - normalised(opposite))
        again = hits(master, slave_points[moving], mean)
        kept = again.facet >= 0
        change = np.abs(mean - directions[moving]).max(axis=1, initial=0)
        updated = moving[kept]
        directions[updated] = mean[kept]
        found.facet[updated] = again.facet[kept]
        found.reference[updated] = again.reference[kept]
        found.distance[updated] = again.distance[kept]
        moving = moving[kept & (change > _SAME_DIRECTION)]
        if len(moving) == 0:
            break
    return directions, found


def near_lines(
    points: Array, directions: Array, widths: Array, spreads: Array, centres: Array, radii: Array
) -> Iterator[tuple[AnyIntegers, AnyIntegers]]:
    """Pairs (line, sphere) that touch, ordered by line, then sphere; some lines at a time.

    Args:
        points: Where lines begin, (lines, dimension) (length).
        directions: Unit vectors along them, (lines, dimension).
        widths: Radii of the lines, (lines,) (length).
        spreads: By how much these grow with the distance from the beginning, (lines,).
        centres: Of the spheres, (spheres, dimension) (length).
        radii: Of the spheres, (spheres,) (length).
    """
    origin = centres.mean(axis=0)
    starts, ends = points - origin, centres - origin
    squares = np.einsum("sd,sd->s", ends, ends)
    step = max(_TABLE // max(len(ends), 1), 1)
    for first in range(0, max(len(points), 1), step):
        part = slice(first, first + step)
        x, d = starts[part], directions[part]
        along = d @ ends.T - np.einsum("pd,pd->p", x, d)[:, None]
        lateral = -2 * (x @ ends.T) + squares + np.einsum("pd,pd->p", x, x)[:, None] - along**2
        reach = widths[part, None] + _MARGIN * radii
        if spreads[part].any():
            reach = reach + spreads[part, None] * np.abs(along)
        line, sphere = np.nonzero(lateral <= reach**2)
        yield line + first, sphere


def meet(
    mesh: FacetMesh,
    facets: AnyIntegers,
    points: Array,
    directions: Array,
    start: Array | None = None,
) -> tuple[Array, Flags]:
    """Where lines through points meet given facets or their continuation nearby.

    Args:
        mesh: The surface.
        facets: A facet of it for every line, (lines,).
        points: On the lines, (lines, dimension) (length).
        directions: Unit vectors along them, (lines, dimension).
        start: Reference coordinates to begin with, (lines, dimension − 1); midpoints if None.

    Returns:
        Reference coordinates, (lines, dimension − 1), the start where there is no solution;
        and whether there is one, (lines,).
    """
    if start is None:
        midpoint = reference_nodes(mesh.shape, 1).mean(axis=0)
        start = np.repeat(midpoint[None], len(points), axis=0)
    reference = start.copy()
    # Seen along the line, the facet's nodes lie in a plane: the line is its origin.
    seen = (mesh.geometry[facets] - points[:, None]) @ across(directions)
    open_lines = np.arange(len(points))
    for _ in range(_NEWTON_STEPS):
        values, gradients = mesh.geometry_functions(reference[open_lines])
        place = np.einsum("pn,pnk->pk", values, seen[open_lines])
        jacobian = np.einsum("jpn,pnk->pkj", gradients, seen[open_lines])
        step = _solve(jacobian, place)
        # A solution far outside is of no use, and a facet's continuation may fold there.
        reference[open_lines] = np.clip(reference[open_lines] - step, -1.0, 2.0)
        open_lines = open_lines[~(np.abs(step).max(axis=1) <= _CONVERGED)]
        if len(open_lines) == 0:
            break
    met = np.ones(len(points), dtype=bool)
    met[open_lines] = False
    reference[open_lines] = start[open_lines]
    return reference, met


def across(directions: Array) -> Array:
    """Orthonormal vectors perpendicular to unit vectors, (vectors, dimension, dimension − 1)."""
    if directions.shape[1] == 2:
        return np.stack([-directions[:, 1], directions[:, 0]], axis=1)[:, :, None]
    axes = np.eye(3)[np.abs(directions).argmin(axis=1)]
    first = normalised(np.cross(directions, axes))
    return np.stack([first, np.cross(directions, first)], axis=2)


def _solve(matrices: Array, vectors: Array) -> Array:
    """Solutions of systems of one or two equations; not finite where they are singular."""
    with np.errstate(divide="ignore", invalid="ignore"):
        if vectors.shape[1] == 1:
            return vectors / matrices[:, 0]
        (a, b), (c, d) = matrices.transpose(1, 2, 0)
        x, y = vectors.T
        return np.asarray(
            np.stack([d * x - b * y, a * y - c * x], axis=1) / (a * d - b * c)[:, None]
        )


def _is_inside(shape: str, reference: Array) -> Flags:
    inside = (reference > -_INSIDE).all(axis=1)
    if shape == "triangle":
        return inside & (reference.sum(axis=1) < 1 + _INSIDE)
    return inside & (reference < 1 + _INSIDE).all(axis=1)
