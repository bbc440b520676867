"""Strains and rotations inside the cells, and the zones of a body in which they are looked at.

What linear theory takes to be small are the parts of the displacement gradient H = ∇u, from arrays
alone. Nothing is compiled for it, and no form is assembled: runs are short beside that.

Strains of linear theory are unbounded at the edge of a punch, at the end of a support and in
corners. A finer mesh shows larger ones there, in fewer cells. So a value counts that is exceeded in
more than a small share of a zone: what is left out has a fixed volume, whatever the mesh. The zones
are the body's parts and its materials, and what lies near each surface that is touched, loaded or
held, so that the share is one of the size of what strains the body there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from scipy.sparse import csr_matrix
from ufl.core.expr import Expr

from fenics_contact.body.elasticity import Law
from fenics_contact.body.spaces import Spaces
from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.problem import Problem

# Strains below this are far from any limit: their norm, which is no less, stands for them.
_SMALL = 0.01
# No gradient of a norm below 1 turns anything inside out.
_MAY_TURN = 0.5


@dataclass(frozen=True, eq=False)
class Deformation:
    """Deformation by a displacement at points of this rank's own cells.

    Attributes:
        strain: Largest principal strain by size, (points,).
        rotation: Angle by which the material turns, |curl u|/2, (points,) (radian).
        turned: Where it is turned inside out, (points,): det(I + ∇u) ≤ 0, or a line of it is
            shortened to nothing, by a principal strain ≤ −1; also what is not a number.
        displacement: (points, components) (length).
    """

    strain: Array
    rotation: Array
    turned: Flags
    displacement: Array


class CellPoints:
    """Points inside this rank's own cells, a few in each.

    Attributes:
        volumes: That each stands for, of the model's own dimension and undeformed, (points,).
        positions: Undeformed, (points, 3) (length).
        cells: The cell of each.

    Args:
        spaces: Those of the body.
        law: Hooke's law, for the strain across the thickness.
    """

    def __init__(self, spaces: Spaces, law: Law) -> None:
        mesh = spaces.body.mesh
        self._spaces = spaces
        self._count = mesh.topology.index_map(spaces.body.dimension).size_local
        # Where strains are most accurate: the middle, with degree 2 Gauss' points.
        reference, weights = compat.quadrature_rule(mesh, spaces.degree)
        self._nodes = spaces.displacement_space.dofmap.list[: self._count]
        element = spaces.displacement_space.ufl_element().sub_elements[0]
        geometry = mesh.ufl_domain().ufl_coordinate_element().sub_elements[0]
        corners = mesh.geometry.x[compat.geometry_nodes(mesh)[: self._count]]
        positions, slopes = _evaluated(geometry.tabulate(1, reference), corners)
        self.positions = positions.reshape(-1, 3)
        jacobians = slopes[:, :, : spaces.components]
        self._values, self._slopes = self._operators(element.tabulate(1, reference), jacobians)
        self.volumes = (np.abs(np.linalg.det(jacobians)) * weights).reshape(-1)
        self.cells = np.repeat(np.arange(self._count), len(weights))
        self._thickness_law = None
        if spaces.kinematics == "plane stress":
            self._thickness_law = law.with_values(lambda given: self._value_of(given, reference))

    def _operators(self, table: Array, jacobians: Array) -> tuple[csr_matrix, csr_matrix]:
        """Return the matrices from nodal values to those at the points, and to their derivatives.

        Args:
            table: Of shape functions, then of their derivatives, (1 + dimension, points, nodes, 1).
            jacobians: (cells, points, components, dimension).

        Returns:
            (points, nodes), and by components (components × points, nodes).
        """
        _, points, nodes = table.shape[:3]
        table = table.reshape(-1, points, nodes)
        cells, size = self._count, self._spaces.components
        columns = np.broadcast_to(self._nodes[:, None], (cells, points, nodes)).ravel()
        slopes = np.einsum("kpn,cpkj->jcpn", table[1:], np.linalg.inv(jacobians))
        values = np.broadcast_to(table[0], (cells, points, nodes)).ravel()
        count, width = cells * points, len(self._spaces.coordinates)
        first = np.arange(size * count + 1) * nodes
        return (
            csr_matrix((values, columns, first[: count + 1]), shape=(count, width)),
            csr_matrix(
                (slopes.ravel(), np.tile(columns, size), first), shape=(size * count, width)
            ),
        )

    def deformation(self, displacement: Array) -> Deformation:
        """Return the deformation by a displacement at this rank's nodes, (nodes, components)."""
        size = self._spaces.components
        moved = self._values @ displacement
        gradient = (self._slopes @ displacement).reshape(size, -1, size)  # (by, points, of)
        rows = np.array([[gradient[j, :, i] for j in range(size)] for i in range(size)])
        out_of_plane = self._out_of_plane(rows, moved)
        symmetric = 0.5 * (rows + rows.swapaxes(0, 1))
        strains = np.einsum("ijp,ijp->p", symmetric, symmetric) + out_of_plane**2
        rotations = np.einsum("ijp,ijp->p", rows - symmetric, rows - symmetric)
        strain, least = _principal(symmetric, out_of_plane, np.sqrt(strains))
        turned = ~(least > -1)
        may_turn = ~(strains + rotations < _MAY_TURN**2)
        with np.errstate(invalid="ignore"):  # what is not a number counts as turned
            whole = _in_space(rows[:, :, may_turn], out_of_plane[may_turn])
            turned[may_turn] |= ~(np.linalg.det(np.eye(3) + whole) > 0)
        return Deformation(strain, np.sqrt(0.5 * rotations), turned, moved)

    def _out_of_plane(self, gradient: Array, moved: Array) -> Array:
        """u_r/r around the axis of revolution, and what makes plane stress; (points,)."""
        if self._spaces.kinematics == "axisymmetric":
            return np.asarray(moved[:, 0] / self.positions[:, 0])
        if self._thickness_law is not None:
            shear = 0.5 * (gradient[0, 1] + gradient[1, 0])
            law = self._thickness_law
            return np.asarray(law.thickness_strain(gradient[0, 0], gradient[1, 1], shear))
        return np.zeros(len(moved))

    def _value_of(self, coefficient: Expr | float, reference: Array) -> Array | float:
        """Return the values of a material's coefficient at the points."""
        if isinstance(coefficient, fem.Function):
            space = coefficient.function_space
            table = space.ufl_element().tabulate(0, reference)[0]
            nodal = coefficient.x.array[space.dofmap.list[: self._count]]
            return np.asarray(nodal @ table.T).reshape(-1)
        return float(coefficient.value) if isinstance(coefficient, fem.Constant) else coefficient


def _evaluated(table: Array, nodal: Array) -> tuple[Array, Array]:
    """Functions and their derivatives by reference coordinates, at the points of each cell.

    Args:
        table: Of shape functions, then of their derivatives, (1 + dimension, points, nodes, 1).
        nodal: (cells, nodes, components).

    Returns:
        (cells, points, components), and (cells, points, components, dimension).
    """
    derivatives, points, nodes = table.shape[:3]
    cells, _, components = nodal.shape
    columns = table.reshape(-1, nodes).T
    found = nodal.swapaxes(1, 2).reshape(-1, nodes) @ columns  # one product for all cells
    found = found.reshape(cells, components, derivatives, points).transpose(0, 3, 1, 2)
    return found[..., 0], found[..., 1:]


def _principal(strain: Array, out_of_plane: Array, norms: Array) -> tuple[Array, Array]:
    """Largest principal strain by size, and the least, (points,) each.

    Args:
        strain: In the plane or in space, (components, components, points).
        out_of_plane: Across a plane, (points,).
        norms: Of all of it, (points,).
    """
    largest, least = norms, -norms
    counts = largest > _SMALL
    values = np.linalg.eigvalsh(_in_space(strain[:, :, counts], out_of_plane[counts]))
    largest[counts] = np.abs(values).max(axis=1)
    least[counts] = values[:, 0]
    return largest, least


def _in_space(rows: Array, out_of_plane: Array) -> Array:
    """(components, components, points) with what is out of plane as (points, 3, 3)."""
    size = len(rows)
    found = np.zeros((rows.shape[2], 3, 3))
    found[:, :size, :size] = rows.transpose(2, 0, 1)
    if size == 2:
        found[:, 2, 2] = out_of_plane
    return found


@dataclass(frozen=True, eq=False)
class Zone:
    """A piece of the body.

    Attributes:
        name: Of a part or material, or of a group that it is near to.
        is_near: Whether it is near a group.
        points: Numbers of this rank's cell points in it.
        volumes: That these stand for, (points,).
        volume: Of the zone on all ranks, > 0.
    """

    name: str
    is_near: bool
    points: Integers
    volumes: Array
    volume: float


class Zones:
    """The zones of a model; collective.

    Args:
        problem: The model.
        points: Those inside its cells.
    """

    def __init__(self, problem: Problem, points: CellPoints) -> None:
        self._problem, self._points = problem, points
        self._along_axes = np.ascontiguousarray(points.positions.T)
        self._fixed = [zone for zone in self._of_bodies() if zone is not None]
        self._fixed += [zone for zone in self._near_groups() if zone is not None]

    def at(self, states: list[ContactState]) -> list[Zone]:
        """All zones, with those near what touches at present; collective."""
        near = [
            self._near(contact.label, *_touching(contact, state))
            for contact, state in zip(self._problem.contacts, states, strict=True)
        ]
        return [*(zone for zone in near if zone is not None), *self._fixed]

    def _of_bodies(self) -> Iterator[Zone | None]:
        spaces = self._problem.spaces
        first_nodes = spaces.displacement_space.dofmap.list[self._points.cells, 0]
        of_point = spaces.parts.of_node[first_nodes]
        for number, name in enumerate(spaces.parts.names):
            yield self._zone(name, of_point == number)
        for material in self._problem.scene.material:
            if material.on and material.on not in spaces.parts.names:
                cells = spaces.body.entities(spaces.body.group(material.on, "material"))
                yield self._zone(material.on, np.isin(self._points.cells, cells))

    def _near_groups(self) -> Iterator[Zone | None]:
        scene, body = self._problem.scene, self._problem.body
        names = [load.on for load in scene.load] + [support.on for support in scene.support]
        for name in dict.fromkeys(names):
            group = body.group(name, "on")
            if group.dimension == body.dimension - 1:
                yield self._near(name, *self._middles(group))

    def _middles(self, group: Group) -> tuple[Array, float]:
        """Middles of this rank's own facets of a group, (facets, 3), and their area."""
        mesh, dimension = self._problem.body.mesh, self._problem.body.dimension - 1
        facets = self._problem.body.entities(group)
        owned = facets[facets < mesh.topology.index_map(dimension).size_local]
        corners = mesh.geometry.x[compat.nodes_of_entities(mesh, dimension, owned)]
        if len(owned) == 0:
            return np.zeros((0, 3)), 0.0
        return corners.mean(axis=1), float(_areas(corners, dimension).sum())

    def _near(self, name: str, places: Array, area: float) -> Zone | None:
        """Return the zone no farther from places than the size of their area; collective.

        Args:
            name: Of the zone.
            places: Of this rank, (places, 3) (length).
            area: That they stand for on this rank, in the plane of a plane or axisymmetric model.
        """
        comm, dimension = self._problem.comm, self._problem.body.dimension
        reach = float(total(comm, area)) ** (1 / (dimension - 1))
        every = gather_rows(comm, places)
        if len(every) == 0:
            return None
        least, most = every.min(axis=0) - reach, every.max(axis=0) + reach
        inside = np.ones(len(self._points.volumes), dtype=bool)
        for along, low, high in zip(self._along_axes, least, most, strict=True):
            inside &= (along >= low) & (along <= high)
        candidates = np.flatnonzero(inside)
        from scipy.spatial import cKDTree  # a tenth of a second to load, and seldom needed

        distances, _ = cKDTree(every).query(
            self._points.positions[candidates], distance_upper_bound=reach
        )
        return self._zone(name, candidates[np.isfinite(distances)], is_near=True)

    def _zone(self, name: str, chosen: Flags | Integers, is_near: bool = False) -> Zone | None:
        """Return the zone of points; None if no rank has any; collective."""
        numbers = np.arange(len(self._points.volumes))[chosen]
        volumes = self._points.volumes[numbers]
        volume = float(total(self._problem.comm, volumes.sum()))
        return Zone(name, is_near, numbers, volumes, volume) if volume > 0 else None


def _areas(corners: Array, dimension: int) -> Array:
    """Length or area of facets from their nodes, of which corners come first."""
    if dimension == 1:
        return np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    if corners.shape[1] in (3, 6):
        first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    else:  # a quadrilateral by its diagonals
        first, second = corners[:, 3] - corners[:, 0], corners[:, 2] - corners[:, 1]
    return np.asarray(0.5 * np.linalg.norm(np.cross(first, second), axis=1))


def _touching(contact: ContactSurface, state: ContactState) -> tuple[Array, float]:
    """This rank's own points that touch, and what they have of the area of its facets."""
    pieces, closed = contact.trace.pieces, state.status != OPEN
    share = closed[pieces.points].mean(axis=1) if len(pieces.points) else np.zeros(0)
    covered = (
        2
        if contact.spaces.components == 3 and compat.is_tensor_cell(contact.trace.surface.mesh)
        else 1
    )
    area = float((pieces.areas * share).sum()) / covered
    return contact.trace.coordinates[closed & contact.trace.owned], area
