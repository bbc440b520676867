"""The bodies and surfaces of a mesh: names, measures, kinds, and triangles to draw them.

Plane models are given a height of 1, so that their curves are surfaces as well. Arrays only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import basix
import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.mesh.from_gmsh import MeshArrays
from fenics_contact.mesh.neighbours import connected_pieces
from fenics_contact.mesh.surface_shapes import SurfaceShape, shape_of
from fenics_contact.mesh.tagged_mesh import Group, Relation

_EXACT, _ROUGH = 1e-6, 0.05  # of points and normals of a geometry, and of a mesh's facets
# Triangles of a facet by dolfinx's order of its corners.
_TRIANGLES = {2: ((0, 1, 2), (0, 2, 3)), 3: ((0, 1, 2),), 4: ((0, 1, 3), (0, 3, 2))}


@dataclass(frozen=True)
class FoundBody:
    """A body.

    Attributes:
        name: What scenes call it; empty if they have no name for it.
        label: What people read.
        measure: Its volume, in the plane its area.
        pieces: Numbers of the connected pieces that it is of.
    """

    name: str
    label: str
    measure: float
    pieces: frozenset[int]


@dataclass(frozen=True, eq=False)
class FoundSurface:
    """A surface, in the plane a curve.

    Attributes:
        number: Gmsh's number, for ``mesh.groups``; None where there is none.
        name: Of the group that is just this surface; empty if there is none.
        names: Of all groups that hold it.
        bodies: Indices of the bodies that it bounds.
        piece: The connected piece that it is of; −1 if it is of several.
        is_inside: Whether it lies inside a body, or between bodies that are glued.
        measure: Its area, in the plane its length.
        triangles: Corners, (triangles, 3, 3) (length).
        normals: Outward unit normals of the triangles, (triangles, 3).
        shape: What it is.
        is_outward: Whether it bulges outwards as a shaft does, and not inwards as a hole.
        tags: Of its facets.
        is_repeated: Whether it shares facets with smaller ones.
    """

    number: int | None
    name: str
    names: tuple[str, ...]
    bodies: tuple[int, ...]
    piece: int
    is_inside: bool
    measure: float
    triangles: Array
    normals: Array
    shape: SurfaceShape
    is_outward: bool
    tags: frozenset[int]
    is_repeated: bool = False

    @cached_property
    def box(self) -> Array:
        """Least and largest coordinates, (2, 3) (length)."""
        points = self.triangles.reshape(-1, 3)
        return np.array([points.min(axis=0), points.max(axis=0)])

    @property
    def can_touch(self) -> bool:
        """Whether a scene can name it as a side of a contact."""
        usable = self.number is not None or bool(self.name)
        return usable and not self.is_inside and not self.is_repeated and self.piece >= 0


@dataclass(frozen=True)
class FoundPlace:
    """Points, or edges in space, that supports may hold.

    Attributes:
        name: What scenes call them, such as ``point 3``.
        pieces: As the places of ``Group``.
    """

    name: str
    pieces: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...]

    @property
    def length(self) -> float:
        """Length of the edges; 0 for points (length)."""
        return float(sum(np.linalg.norm(np.subtract(*piece)) for piece in self.pieces))

    @property
    def ends(self) -> list[tuple[float, ...]]:
        """Where edges end; of points all (length)."""
        if self.length == 0:
            return [begin for begin, _ in self.pieces]
        counts = Counter(end for piece in self.pieces for end in piece)
        return [end for end, count in counts.items() if count == 1]

    @property
    def centre(self) -> tuple[float, ...]:
        """The middle of the box around them (length)."""
        corners = np.array(self.pieces).reshape(2 * len(self.pieces), -1)
        return tuple(((corners.min(axis=0) + corners.max(axis=0)) / 2).tolist())


@dataclass(frozen=True)
class Survey:
    """Bodies and surfaces of a file.

    Attributes:
        dimension: 2 or 3.
        bodies: In the file's order.
        surfaces: Those that scenes can name, by number.
        relations: Of the bodies, as drawn.
        cells: Of the mesh.
        rest: Triangles of the boundary that no surface holds, (triangles, 3, 3) (length).
        are_named: Whether the bodies' names are groups that share no cell and leave none out.
        places: Points, and edges in space, those with names first.
    """

    dimension: int
    bodies: tuple[FoundBody, ...]
    surfaces: tuple[FoundSurface, ...]
    relations: tuple[Relation, ...]
    cells: int
    are_named: bool
    rest: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    places: tuple[FoundPlace, ...] = ()

    @property
    def size(self) -> float:
        """Diagonal of the box around all (length)."""
        boxes = np.concatenate([surface.box for surface in self.surfaces] or [np.eye(2, 3)])
        return float(np.linalg.norm(np.ptp(boxes[:, : self.dimension], axis=0)))


def survey(mesh: MeshArrays, exact: Mapping[str, Array]) -> Survey:
    """Look through a mesh.

    Args:
        mesh: As it was read.
        exact: Arrays of ``exact_surfaces``, if there are any.
    """
    return _Look(mesh, exact).survey()


class _Look:
    def __init__(self, mesh: MeshArrays, exact: Mapping[str, Array]) -> None:
        self._mesh, self._exact = mesh, exact
        self._dimension = mesh.points.shape[1]
        self._points = np.zeros((len(mesh.points), 3))
        self._points[:, : self._dimension] = mesh.points
        kind = getattr(basix.CellType, mesh.cell)
        sides = np.array(basix.topology(kind)[self._dimension - 1])
        self._corners = mesh.cells[:, : len(basix.topology(kind)[0])]
        self._middles = self._points[self._corners].mean(axis=1)
        self._pieces = connected_pieces(self._corners, len(self._points))
        of_cells = self._corners[:, sides].reshape(-1, sides.shape[1])
        self._owner = np.repeat(np.arange(len(self._corners)), len(sides))
        self._match(of_cells, mesh.facets[:, : sides.shape[1]])

    def _match(self, of_cells: Integers, facets: Integers) -> None:
        """Find the cells that facets are sides of, and the sides of cells that are no facets."""
        both = np.sort(np.concatenate([of_cells, facets]), axis=1)
        _, key = np.unique(both, axis=0, return_inverse=True)
        key = key.reshape(-1)
        sides, tagged = key[: len(of_cells)], key[len(of_cells) :]
        counts = np.bincount(sides, minlength=int(key.max()) + 1)
        order = np.argsort(sides, kind="stable")
        place = np.searchsorted(sides[order], tagged)
        self._facet_owner = self._owner[order[place]]
        last = np.minimum(place + 1, len(order) - 1)
        is_inner = counts[tagged] > 1
        self._facet_second = np.where(is_inner, self._owner[order[last]], self._facet_owner)
        is_left = (counts[sides] == 1) & ~np.isin(sides, tagged)
        self._rest = of_cells[is_left]

    def survey(self) -> Survey:
        bodies, of_cell, are_named = self._bodies()
        found = [self._surface(number, group, of_cell) for number, group in self._named_surfaces()]
        surfaces = _without_repeats([surface for surface in found if surface is not None])
        return Survey(
            self._dimension,
            tuple(bodies),
            tuple(surfaces),
            self._mesh.relations,
            len(self._corners),
            are_named,
            self._triangles(self._rest),
            tuple(
                FoundPlace(name, group.places)
                for groups in (self._mesh.groups, self._mesh.numbers)
                for name, group in groups.items()
                if group.places
            ),
        )

    def _bodies(self) -> tuple[list[FoundBody], Integers, bool]:
        """Groups of cells that make up the whole, else its connected pieces; that of each cell."""
        measures, exact = self._measures(), self._known("measured_bodies", "body_measures")
        groups = {
            name: np.isin(self._mesh.cell_tags, group.tags)
            for name, group in self._mesh.groups.items()
            if group.dimension == self._dimension
        }
        chosen = self._partition(groups)
        of_cell = np.zeros(len(self._corners), dtype=np.int64)
        found = []
        count = int(self._pieces.max(initial=-1)) + 1
        named = chosen if len(chosen) > 1 or count == 1 else {}
        every = named or {f"part {n + 1}": self._pieces == n for n in range(count)}
        for number, (name, cells) in enumerate(every.items()):
            of_cell[cells] = number
            pieces = frozenset(np.unique(self._pieces[cells]).tolist())
            tags = np.unique(self._mesh.cell_tags[cells]).tolist()
            known = exact.keys() >= set(tags) and bool(named)
            volume = sum(exact[tag] for tag in tags) if known else measures[cells].sum()
            found.append(FoundBody(name if named else "", name, float(volume), pieces))
        return found, of_cell, bool(named)

    def _known(self, parts: str, measures: str) -> dict[int, float]:
        """Measures that OpenCASCADE knows, by number."""
        found = (self._exact.get(key, np.zeros(0)).tolist() for key in (parts, measures))
        return dict(zip(*found, strict=True))

    def _partition(self, groups: Mapping[str, Flags]) -> dict[str, Flags]:
        """Groups that hold every cell once, the first of several ways; else that of the whole."""
        chosen: dict[str, Flags] = {}
        left = np.ones(len(self._corners), dtype=bool)
        for name, cells in groups.items():
            if cells.any() and left[cells].all() and not cells.all():
                chosen[name] = cells
                left &= ~cells
        if not left.any():
            return chosen
        return dict([item for item in groups.items() if item[1].all()][:1])

    def _measures(self) -> Array:
        """Volume, or area, of each cell with straight edges."""
        kind = getattr(basix.CellType, self._mesh.cell)
        points, weights = basix.make_quadrature(kind, 3)
        element = basix.create_element(basix.ElementFamily.P, kind, 1)
        gradients = element.tabulate(1, points)[1:, :, :, 0]
        places = self._points[self._corners][:, :, : self._dimension]
        jacobians = np.einsum("cnd,jqn->cqdj", places, gradients)
        return np.asarray(np.abs(np.linalg.det(jacobians)) @ weights)

    def _named_surfaces(self) -> list[tuple[int | None, Group]]:
        """Gmsh's surfaces by number, else the groups of facets."""
        if self._mesh.sides:
            return [(int(number), group) for number, group in self._mesh.sides.items()]
        groups = self._mesh.groups.values()
        return [(None, group) for group in groups if group.dimension == self._dimension - 1]

    def _surface(self, number: int | None, group: Group, of_cell: Integers) -> FoundSurface | None:
        chosen = np.flatnonzero(np.isin(self._mesh.facet_tags, group.tags))
        if len(chosen) == 0:
            return None
        first, second = self._facet_owner[chosen], self._facet_second[chosen]
        bodies = np.unique(of_cell[[first, second]])
        pieces = np.unique(self._pieces[first])
        triangles = self._triangles(self._mesh.facets[chosen])
        per_facet = len(triangles) // len(chosen)
        normals, areas = _normals(triangles, np.repeat(self._middles[first], per_facet, axis=0))
        shape = self._shape(number, triangles, normals)
        exact = self._known("measured_parts", "measures")
        names = [
            name
            for name, other in self._mesh.groups.items()
            if other.dimension == group.dimension and set(group.tags) <= set(other.tags)
        ]
        own = [name for name in names if self._mesh.groups[name].tags == group.tags]
        return FoundSurface(
            number,
            own[0] if own else "",
            tuple(names),
            tuple(bodies.tolist()),
            int(pieces[0]) if len(pieces) == 1 else -1,
            bool((first != second).any()),
            float(areas.sum() if number is None else exact.get(number, areas.sum())),
            triangles,
            normals,
            shape,
            _is_outward(shape, triangles, normals),
            frozenset(group.tags),
        )

    def _shape(self, number: int | None, triangles: Array, normals: Array) -> SurfaceShape:
        """From the geometry, else from the middles of the facets."""
        flat = self._dimension == 2
        if number is not None and "exact_parts" in self._exact:
            mine = self._exact["exact_parts"] == number
            if mine.any():
                points = self._exact["exact_points"][mine]
                return shape_of(points, self._exact["exact_normals"][mine], _EXACT, flat)
        points = triangles.mean(axis=1)
        if flat:
            points[:, 2] = 0
        found = shape_of(points, normals, _ROUGH, flat)
        smooth = found.kind in ("plane", "straight line") or len(points) >= 8
        return found if smooth else shape_of(points, normals, _EXACT, flat)

    def _triangles(self, facets: Integers) -> Array:
        """Corners of the triangles that facets are cut into."""
        if len(facets) == 0:
            return np.zeros((0, 3, 3))
        kind = getattr(basix.CellType, self._mesh.cell)
        count = len(basix.topology(kind)[self._dimension - 1][0])
        corners = self._points[facets[:, :count]]
        if self._dimension == 2:
            top = corners[:, ::-1] + np.array([0.0, 0.0, 1.0])
            corners = np.concatenate([corners, top], axis=1)
        return np.asarray(corners[:, np.array(_TRIANGLES[count])].reshape(-1, 3, 3))


def _without_repeats(surfaces: list[FoundSurface]) -> list[FoundSurface]:
    """Mark surfaces that share facets with smaller ones: groups may overlap."""
    seen: set[int] = set()
    repeated = set()
    for surface in sorted(surfaces, key=lambda surface: surface.measure):
        if surface.tags & seen:
            repeated.add(id(surface))
        seen |= surface.tags
    return [replace(surface, is_repeated=id(surface) in repeated) for surface in surfaces]


def _normals(triangles: Array, inside: Array) -> tuple[Array, Array]:
    """Unit normals away from points inside, and areas."""
    crossed = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    twice = np.linalg.norm(crossed, axis=1)
    normals = crossed / np.where(twice > 0, twice, 1)[:, None]
    outward = triangles.mean(axis=1) - inside
    signs = np.where((normals * outward).sum(axis=1) < 0, -1.0, 1.0)
    return normals * signs[:, None], twice / 2


def _is_outward(shape: SurfaceShape, triangles: Array, normals: Array) -> bool:
    """Whether normals point away from the centre or the axis, in the mean."""
    arms = triangles.mean(axis=1) - np.array(shape.centre)
    if shape.axis:
        axis = np.array(shape.axis)
        arms = arms - np.outer(arms @ axis, axis)
    return bool((arms * normals).sum() >= 0)
