"""Where in a body strains are looked at, and what of them a finer mesh does not change.

Strains of linear theory are unbounded at the edge of a punch, at the end of a support and in
corners. A finer mesh shows larger ones there, in fewer cells. So a value counts that is exceeded
in more than a small share of a zone: what is left out has a fixed volume, whatever the mesh. The
zones are the body's parts and its materials, and what lies near each surface that is touched,
loaded or held, so that the share is one of the size of what strains the body there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from fenics_contact.common import dolfinx_versions as compat
from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.contact.contact_surface import ContactSurface
from fenics_contact.contact.state import OPEN, ContactState
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.problem import Problem
from fenics_contact.trust.displacement_gradient import CellPoints

# Share of a zone's volume that is left out of strains and rotations. A surface of length L in the
# plane has a zone of 2.6 L², so that what is within .09 L of both its ends is left out: under a
# punch the pressure E* d/(π √(a² − x²)) is there 1.75 times that of the middle.
LEFT_OUT = 1e-2
# Share of it that may be turned inside out, for strains without bound reach 1: in this pressure
# within (d/a)²/20 of the edge, over a. A layer under a contact has more.
TURNED = 1e-3


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


_LARGEST = int(np.float64(np.inf).view(np.int64))


def exceeded(comm: MPI.Comm, zone: Zone, values: Array) -> float:
    """The largest value that more than the share of a zone exceeds or has; collective.

    Args:
        comm: Communicator.
        zone: On whose points.
        values: At all cell points of this rank, ≥ 0, (points,).

    Returns:
        It, the same on any number of ranks; infinite where values are not numbers.
    """
    left_out = LEFT_OUT * zone.volume
    found = np.nan_to_num(values[zone.points], nan=np.inf, posinf=np.inf)
    order = np.argsort(found)
    ordered = found[order]
    # Of what begins at each place: the volume up to the end.
    volumes = np.append(np.cumsum(zone.volumes[order][::-1])[::-1], 0.0)
    low, high = 0, _LARGEST  # as integers, floating-point numbers >= 0 have the same order
    while low < high:
        middle = (low + high + 1) // 2
        at_least = volumes[np.searchsorted(ordered, np.int64(middle).view(np.float64))]
        if total(comm, at_least) > left_out:
            low = middle
        else:
            high = middle - 1
    return float(np.int64(low).view(np.float64))


def share(comm: MPI.Comm, zone: Zone, flags: Flags) -> float:
    """Return the share of a zone's volume at points with a flag; collective."""
    return float(total(comm, zone.volumes[flags[zone.points]].sum())) / zone.volume
