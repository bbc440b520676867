"""The body's mesh with its named groups, as every later step sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import basix
import basix.ufl
import numpy as np
from numpy.typing import NDArray

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import largest, smallest, total
from fenics_contact.common.wording import one_line, question

# Of a cell's size: middle nodes that lie so little aside leave moments balanced to round-off.
_STRAIGHT = 1e-10
#: Of a mesh's extent: nodes that are so near to a named place are there.
CLOSE = 1e-9


@dataclass(frozen=True)
class Group:
    """A physical group: its topological dimension and the tags of its parts.

    Points, and edges in space, have no tags, but the places of their nodes: all nodes there are
    theirs.

    Attributes:
        dimension: That of the body, or one less; less of points and of edges in space.
        tags: Values of the mesh tags.
        outside: How many of its facets are no sides of the body's cells.
        centre: Where a numbered part is, for messages.
        places: Begin and end of straight pieces, the same of points, (components,) each (length).
    """

    dimension: int
    tags: tuple[int, ...]
    outside: int = 0
    centre: tuple[float, ...] = field(default=(), compare=False)
    places: tuple[tuple[tuple[float, ...], tuple[float, ...]], ...] = ()

    def at(self, points: Array, close: float) -> Flags:
        """Whether points are at its places, (points,).

        Args:
            points: Coordinates, (points, 3) (length).
            close: Distance that is none (length).
        """
        found = np.zeros(len(points), dtype=bool)
        for begin, end in self.places:
            first, way = np.array(begin), np.subtract(end, begin)
            arms = points[:, : len(first)] - first
            share = np.clip(arms @ way / (way @ way or 1.0), 0.0, 1.0)
            found |= np.linalg.norm(arms - share[:, None] * way, axis=1) <= close
        return found


@dataclass(frozen=True)
class Relation:
    """How two bodies of a geometry lie that are near each other, as drawn.

    Attributes:
        bodies: Their names.
        kind: ``glued``: they share a face; ``touching``: they do not, so that they are apart for
            the mesh; ``overlapping``; or ``unknown``, where their shapes could not be intersected.
        overlap: What they share: a volume, in the plane an area.
        share: The same, over that of the smaller.
    """

    bodies: tuple[str, str]
    kind: str
    overlap: float = 0.0
    share: float = 0.0

    @property
    def words(self) -> str:
        """A sentence without its full stop."""
        both = " and ".join(f"'{one_line(name)}'" for name in self.bodies)
        if self.kind == "overlapping":
            return (
                f"{both} overlap by {self.overlap:.4g}, {100 * self.share:.2g} % of the smaller: a "
                "contact between them presses them apart (a press fit), without one they stay so"
            )
        if self.kind == "unknown":
            return f"{both} are near each other; whether they overlap could not be found out"
        if self.kind == "glued":
            return f"{both} are glued: they share a face, and move together there"
        return f"{both} touch, and are apart for the mesh: only a contact holds or presses them"


@dataclass(frozen=True, eq=False)
class Body:
    """A distributed mesh and the names of its parts.

    Attributes:
        mesh: dolfinx mesh of one cell type.
        cell_tags: dolfinx mesh tags of the cells.
        facet_tags: dolfinx mesh tags of the facets.
        groups: Name → group; groups may share parts.
        source: What messages call this mesh, such as the names of its files.
        numbers: Number → group: physical groups by their tags, or, where the boundary
            has none, its geometric parts.
        relations: Of the bodies of each geometry that are near each other.
        kinematics: What its files' types of elements are made for, if they say it, such as
            ``axisymmetric``, and a type that says so, such as ``CAX4``.
        notes: Sentences, without the full stop, on what of its files is not in the model, or
            looks wrong.

    A mesh of your own goes into ``run`` as a body. This square is pressed against the floor,
    without friction, so the pressure there is what presses on it:

    >>> import numpy as np
    >>> from dolfinx import mesh
    >>> from mpi4py import MPI
    >>> from fenics_contact import Contact, Load, Material, Scene, Support, run
    >>> square = mesh.create_unit_square(MPI.COMM_WORLD, 4, 4)
    >>> sides = [
    ...     mesh.locate_entities_boundary(square, 1, lambda x, i=i, at=at: np.isclose(x[i], at))
    ...     for i, at in [(1, 0), (1, 1), (0, 0)]
    ... ]
    >>> facets = np.concatenate(sides)
    >>> tags = np.repeat(np.arange(3, dtype=np.int32), [len(side) for side in sides])
    >>> order = np.argsort(facets)
    >>> cells = np.arange(square.topology.index_map(2).size_local, dtype=np.int32)
    >>> body = Body(
    ...     square,
    ...     mesh.meshtags(square, 2, cells, np.zeros_like(cells)),
    ...     mesh.meshtags(square, 1, facets[order], tags[order]),
    ...     {name: Group(1, (tag,)) for tag, name in enumerate(("bottom", "top", "left"))},
    ... )
    >>> scene = Scene(
    ...     kinematics="plane strain",
    ...     material=Material(youngs_modulus=1000, poissons_ratio=0.3),
    ...     support=(Support("left", {"x": 0}),),
    ...     load=(Load("top", pressure=10),),
    ...     contact=(Contact("bottom"),),
    ... )
    >>> abs(run(scene, body=body).quantities["max_contact_pressure"] - 10) < 1e-6
    True
    """

    mesh: Any
    cell_tags: Any
    facet_tags: Any
    groups: Mapping[str, Group]
    source: str = "the mesh"
    numbers: Mapping[str, Group] = field(default_factory=dict)
    relations: tuple[Relation, ...] = ()
    kinematics: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    @property
    def dimension(self) -> int:
        """Topological dimension of the cells."""
        return int(self.mesh.topology.dim)

    def group(self, name: str, key: str) -> Group:
        """A group by name, or by number; collective.

        Args:
            name: Its name, or its number in words.
            key: The scene's key that names it, for the message.

        Raises:
            InputError: There is none of that name (the message lists those there are), or
                it is empty, or not part of the body.
        """
        group = self.find(name)
        if group is None:
            raise InputError(
                f"{key} = '{name}': there is no such physical group in {self.source}"
                f"{question(name, map(one_line, self.groups))}; there are: "
                f"{self.known_groups(name)}"
            )
        kind = {0: "cells", 1: "facets"}.get(self.dimension - group.dimension, "nodes")
        if group.outside:
            raise InputError(
                f"{key} = '{name}': {group.outside} of its {kind} are no sides of the body's cells"
            )
        if total(self.mesh.comm, len(self._owned(group))) == 0:
            raise InputError(f"{key} = '{name}': the group is empty, it has no {kind}")
        return group

    def find(self, name: str) -> Group | None:
        """A group by name, or by number, if there is one.

        Args:
            name: Its name, or its number in words.
        """
        return self.groups.get(name) or self.numbers.get(name)

    def boundary(self, name: str, key: str) -> Group:
        """A group of facets on the boundary of the body, by name; collective.

        Args:
            name: Its name, or its number in words.
            key: The scene's key that names it, for the message.

        Raises:
            InputError: As for ``group``; or it is one of cells, or lies inside the body.
        """
        group = self.group(name, key)
        if group.dimension != self.dimension - 1:
            if group.places:
                raise InputError(f"{key} = '{name}': must be a boundary, not points or edges")
            raise InputError(f"{key} = '{name}': must be a boundary, not a part of the body")
        facets = self._owned(group)
        inside = np.setdiff1d(facets, compat.exterior_facets(self.mesh))
        count, every = (int(total(self.mesh.comm, len(found))) for found in (inside, facets))
        if count:
            raise InputError(
                f"{key} = '{name}': {count} of its {every} facets lie inside the body; "
                "all must be on its boundary"
            )
        return group

    def require_made_for(self, kinematics: str) -> None:
        """Refuse a mesh whose elements are, by their types, of another kind of model.

        Args:
            kinematics: Of the scene.

        Raises:
            InputError: They are.
        """
        for kind, said in self.kinematics.items():
            if kind != kinematics:
                raise InputError(
                    f"kinematics = '{kinematics}': the elements of {self.source} are {said}, which "
                    f"is {kind}; change the scene's kinematics, or the type of the elements in the "
                    "file"
                )

    def require_radii(self) -> None:
        """Refuse a mesh that reaches over the axis of revolution x = 0; collective.

        Raises:
            InputError: It does.
        """
        radii = self.mesh.geometry.x[:, 0]
        least = smallest(self.mesh.comm, radii)
        if least < -1e-9 * largest(self.mesh.comm, radii):
            raise InputError(
                f"kinematics = 'axisymmetric': x is the radius, but {self.source} reaches down to "
                f"x = {least:g}; it must be ≥ 0"
            )

    def require_straight(self) -> None:
        """Refuse cells that are curved, for displacements of degree 1; collective.

        A rigid rotation ω × x is linear in x. Shape functions of degree 1 hold it where x follows
        from the corners of the cell by the same functions, and nowhere else: then the stiffness
        resists the rotation, as a spring to the ground would, and takes up a part of every moment.

        Raises:
            InputError: Some of the cells are.
        """
        domain = self.mesh.ufl_domain()
        order = int(domain.ufl_coordinate_element().degree)
        cell = self.mesh.topology.cell_name()
        corners = basix.ufl.element("Lagrange", cell, 1)
        nodes = basix.ufl.element("Lagrange", cell, order).basix_element.points
        x = self.mesh.geometry.x[compat.geometry_nodes(self.mesh)]
        straight = np.einsum("nc,kcd->knd", corners.tabulate(0, nodes)[0], x[:, : corners.dim])
        aside = np.linalg.norm(x - straight, axis=2).max(axis=1, initial=0.0)
        round_off = 8 * np.finfo(float).eps * np.abs(x).max(initial=0.0)
        sizes = np.ptp(x, axis=1).max(axis=1, initial=0.0)
        bend = largest(self.mesh.comm, np.where(aside > round_off, aside, 0.0) / sizes)
        if bend > _STRAIGHT:
            raise InputError(
                f"discretisation.degree = 1: cells of {self.source} are curved (their middle nodes "
                f"lie up to {bend:.2g} of a cell's size beside those of straight cells); with "
                "degree 1 these cannot turn without strain, and would take up a part of each "
                "moment; write discretisation.degree = 2, or make cells of order 1 (mesh.order = 1)"
            )

    def part(self, name: str, key: str) -> Group:
        """A group of cells, by name; collective.

        Args:
            name: Its name, or its number in words.
            key: The scene's key that names it, for the message.

        Raises:
            InputError: As for ``group``; or it is one of facets.
        """
        group = self.group(name, key)
        if group.dimension != self.dimension:
            raise InputError(f"{key} = '{name}': must be a part of the body, not a side")
        return group

    def entities(self, group: Group) -> NDArray[np.int32]:
        """Local indices (owned and ghost, sorted) of the cells or facets of a group, if it has any.

        Args:
            group: One of this body.
        """
        tags = self.cell_tags if group.dimension == self.dimension else self.facet_tags
        return np.asarray(tags.indices[np.isin(tags.values, group.tags)])

    def _owned(self, group: Group) -> NDArray[np.int32]:
        if group.places:
            points = self.mesh.geometry.x
            extent = largest(self.mesh.comm, np.abs(points).max(initial=0.0))
            return np.flatnonzero(group.at(points, CLOSE * extent)).astype(np.int32)
        self.mesh.topology.create_entities(group.dimension)
        entities = self.entities(group)
        return np.asarray(
            entities[entities < self.mesh.topology.index_map(group.dimension).size_local]
        )

    def known_groups(self, name: str = "") -> str:
        """Names of the groups, and numbers of the geometric parts with their places.

        Args:
            name: That is not there: points and edges are listed for one that is theirs alone.
        """
        names = sorted(one_line(name) + _place(group) for name, group in self.groups.items())
        placed = [group for group in self.groups.values() if group.centre]
        numbers = sorted(self.numbers.items(), key=lambda item: _in_order(item[0]))
        slender = [(number, group) for number, group in numbers if group.places]
        if slender and _is_slender(name):
            alike = [pair for pair in slender if pair[0].split(" ")[0] == name.split(" ")[0]]
            names = [number + _place(group) for number, group in (alike or slender)[:_MOST_LISTED]]
            more = len(alike or slender) - len(names)
            return ", ".join(names) + (f" and {more} more" if more else "")
        for number, group in numbers:
            if group.centre and number not in self.groups and group not in placed:
                names.append(number + _place(group))
        return ", ".join(names) or "none"


# Points and edges that a message has.
_MOST_LISTED = 40


def _is_slender(name: str) -> bool:
    """Whether a name is that of a numbered point, or edge, such as ``point 3``."""
    return name.rpartition(".")[2].startswith(("point ", "edge "))


def _place(group: Group) -> str:
    """Where a group is, for messages, if that is known."""
    centre = group.centre
    if group.places:
        ends = np.array(group.places).reshape(-1, len(group.places[0][0]))
        centre = tuple((ends.min(axis=0) + ends.max(axis=0)) / 2)
    return f" at ({', '.join(f'{value + 0.0:.4g}' for value in centre)})" if centre else ""


def _in_order(number: str) -> tuple[str, int]:
    """Where a number of a group stands, such as ``3``, or ``upper.3`` of one of several meshes."""
    mesh, _, digits = number.rpartition(".")
    kind, _, digits = digits.rpartition(" ")
    return f"{kind} {mesh}", int(digits)
