"""The view of a picture of bodies, and where rigid obstacles stand at the end of a run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.quantities.names import CLOSED_GAP
from fenics_contact.report.drawing.cells import contact_pieces
from fenics_contact.report.drawing.style import Mark, marks, neighbourhood
from fenics_contact.results.contact_points import ContactTable
from fenics_contact.results.records.contacts import ContactRecord
from fenics_contact.results.records.run import Outcome

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

_MOVE = 0.06  # of what is shown: the largest displacement, where it is magnified
_READABLE = (0.02, 0.2)  # displacements of this size, over what is shown, are drawn as they are
_MISFIT = 0.01  # of what is shown: false gaps and overlaps that magnification may make
_AROUND = 0.15  # of a view from near by: cells so far outside of it are taken along
_NEAR = 0.4  # neighbourhoods smaller than this share of the body are looked at from near by


@dataclass(frozen=True)
class View:
    """The shown part of the body, and the direction of view.

    Attributes:
        body: The cells shown, with all fields.
        low: Lowest coordinates shown, (3,).
        high: Highest coordinates shown, (3,).
        is_near: Whether only the neighbourhood of the contact is shown.
        flat: Whether the model is plane or axisymmetric.
        towards: From the body to the camera, a unit vector, (3,).
        marks: How contact points look.
        factor: Magnification of the displacements.
        hides: Whether a body may stand before contact points.
        axisymmetric: Whether x is the radius.
        field: What colours the body.
    """

    body: UnstructuredGrid
    low: Array
    high: Array
    is_near: bool
    flat: bool
    towards: Array
    marks: tuple[Mark, ...]
    factor: float
    hides: bool
    axisymmetric: bool
    field: str = "von Mises stress"

    @property
    def size(self) -> float:
        """Diagonal of what is shown (length)."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def screen(self) -> tuple[Array, Array]:
        """Unit vectors to the right and upwards on the screen, (3,) each."""
        upright = np.array([0.0, 1.0, 0.0] if self.flat else [0.0, 0.0, 1.0])
        right = np.cross(upright, self.towards)
        right /= np.linalg.norm(right)
        return right, np.cross(self.towards, right)


def choose_view(body: UnstructuredGrid, result: Outcome, table: ContactTable) -> View:
    """The whole body, or the neighbourhood of a contact zone that is small in it.

    Args:
        body: A pyvista grid with the fields of a run.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
    """
    low, high = np.array(body.bounds).reshape(3, 2).T
    kinematics = result.model.kinematics
    flat, axial = kinematics != "3D", kinematics == "axisymmetric"
    looks = marks(*result.contacts)
    pairs = [contact for contact in result.contacts if contact.master is not None]
    gap = max((contact.quantities[CLOSED_GAP] for contact in pairs), default=0.0)
    hides = bool(pairs) and not flat
    front = np.zeros(3) if hides else _front(table)
    on_contact = body["status"] >= 0
    if on_contact.any():
        closed = body["status"][on_contact] > 0
        first, last = neighbourhood(body.points[on_contact], closed)
        if (last - first).max() < _NEAR * (high - low).max():
            near = np.maximum(low, first), np.minimum(high, last)
            aside = (near[0] + near[1] - low - high) / (high - low).max()
            body = _cells_around(body, *near)
            sight, factor = _towards(flat, front, aside), _factor(body, *near, gap)
            return View(body, *near, True, flat, sight, looks, factor, hides, axial)
    sight, factor = _towards(flat, front, np.zeros(3)), _factor(body, low, high, gap)
    return View(body, low, high, False, flat, sight, looks, factor, hides, axial)


def whole_view(body: UnstructuredGrid, kinematics: str, field: str) -> View:
    """All of a body, coloured by a field, with displacements to scale.

    Args:
        body: A pyvista grid with the fields of a run.
        kinematics: Of the model.
        field: Name of one of these.
    """
    low, high = np.array(body.bounds).reshape(3, 2).T
    flat, axial = kinematics != "3D", kinematics == "axisymmetric"
    towards = np.array([0.0, 0.0, 1.0] if flat else [1.0, 1.0, 1.0]) / np.sqrt(1 if flat else 3)
    return View(body, low, high, False, flat, towards, (), 1.0, False, axial, field)


def cells_inside(body: UnstructuredGrid, view: View) -> UnstructuredGrid:
    """Return the cells of the body at another time that a close view shows."""
    if not view.is_near:
        return body
    return _cells_around(body, view.low, view.high)


def _cells_around(body: UnstructuredGrid, low: Array, high: Array) -> UnstructuredGrid:
    """The cells in a box and somewhat around, so that it stays full where they move."""
    aside = _AROUND * (high - low).max()
    inside = ((body.points >= low - aside) & (body.points <= high + aside)).all(axis=1)
    return _cells_at(body, inside)


def _factor(body: UnstructuredGrid, low: Array, high: Array, closed_gap: float) -> float:
    """Magnification of the displacements.

    Gaps between bodies are not magnified: where they have closed, bodies that are drawn with
    other displacements than theirs overlap, or seem apart.

    Args:
        body: The cells shown.
        low: Lowest coordinates shown, (3,).
        high: Highest coordinates shown, (3,).
        closed_gap: The widest gap between bodies, as meshed, that has closed (length).
    """
    size = float(np.linalg.norm(high - low))
    largest = np.linalg.norm(body["displacement"], axis=1).max()
    if largest == 0 or _READABLE[0] <= largest / size <= _READABLE[1]:
        return 1.0
    factor = _round_factor(_MOVE * size / largest)
    fits = abs(factor - 1) * closed_gap <= _MISFIT * size
    return factor if fits else 1.0


def _cells_at(body: UnstructuredGrid, points: Flags) -> UnstructuredGrid:
    """The cells that have one of the points; VTK 9.3's own extraction crashes now and then."""
    corners = body.cell_connectivity.reshape(body.n_cells, -1)  # all cells are of one type
    kept = points[corners].any(axis=1)
    used, renumbered = np.unique(corners[kept], return_inverse=True)
    cells = renumbered.reshape(-1, corners.shape[1])
    sizes = np.full((len(cells), 1), corners.shape[1])
    part = type(body)(np.hstack([sizes, cells]).ravel(), body.celltypes[kept], body.points[used])
    for name in body.point_data:
        part.point_data[name] = body.point_data[name][used]
    return part


def _front(table: ContactTable) -> Array:
    """Mean normal of the contact surfaces, 0 without any."""
    if len(table.status) == 0:
        return np.zeros(3)
    return np.asarray(table.vectors("nx", "ny", "nz").mean(axis=0))


def _towards(flat: bool, front: Array, aside: Array) -> Array:
    """Before the contact surface, and on that side of the body to which the zone is shifted."""
    if flat:
        return np.array([0.0, 0.0, 1.0])
    side = np.where(aside < -0.05, -1.0, 1.0)
    side = np.where(np.abs(front) > 0.1, np.sign(front), side)
    return np.asarray(side / np.sqrt(3))


def _round_factor(factor: float) -> float:
    """A magnification people can read: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(factor))
    return float(power * max(step for step in (1, 2, 5) if step * power <= factor * 1.000001))


_FACING = 0.5  # surfaces that curve more have a mean normal shorter than this


@dataclass(frozen=True)
class ObstacleSurface:
    """A rigid obstacle's surface opposite a contact surface.

    It lies at X + k (u_n + gap) n for points X of the undeformed surface with normals n: gaps are
    magnified as the displacements are, or the body would enter the obstacle, or seem apart.

    Attributes:
        points: Undeformed points of the body's surface, (points, 3) (length).
        offsets: u_n + gap along the normals, (points,) (length).
        normals: Of the body, outward, (points, 3).
        nodes: Numbers of the body's nodes there, (points,).
        pieces: Points of the segments or triangles that it is made of, (pieces, 2 or 3).
    """

    points: Array
    offsets: Array
    normals: Array
    nodes: Integers
    pieces: Integers

    def then(self, body: UnstructuredGrid) -> ObstacleSurface | None:
        """Where it stood at another time, from the points that touched it; None without any.

        Obstacles move without turning, so that all their offsets change by the same.

        Args:
            body: The grid with its fields at that time.
        """
        closed = np.asarray(body["status"])[self.nodes] > 0
        if not closed.any():
            return None
        moved = np.asarray(body["displacement"])[self.nodes][closed]
        normal = self.normals.mean(axis=0)
        share = self.normals[closed] @ normal / (normal @ normal)
        apart = np.einsum("ij,ij->i", moved, self.normals[closed]) - self.offsets[closed]
        shift = float(np.median(apart / np.where(np.abs(share) > 0.1, share, 1.0)))
        offsets = self.offsets + shift * (self.normals @ normal) / (normal @ normal)
        return replace(self, offsets=offsets)

    def at(self, factor: float) -> Array:
        """Points of the obstacle with displacements magnified, (points, 3) (length)."""
        return self.points + factor * self.offsets[:, None] * self.normals


def obstacles_of(
    body: UnstructuredGrid, contacts: list[tuple[ContactTable, ContactRecord]]
) -> list[ObstacleSurface]:
    """The obstacles of a run in its end.

    Args:
        body: A pyvista grid with its fields.
        contacts: Points and entries in ``result.json`` of its contacts.
    """
    found = (obstacle_surface(body, rows, contact) for rows, contact in contacts)
    return [obstacle for obstacle in found if obstacle is not None]


def obstacle_surface(
    body: UnstructuredGrid, rows: ContactTable, contact: ContactRecord
) -> ObstacleSurface | None:
    """The obstacle of a contact; None for springs, given pressures and bodies opposite.

    Args:
        body: A pyvista grid with the fields ``displacement`` and ``status``.
        rows: Points of the contact.
        contact: Its entry in ``result.json``.
    """
    if not contact.is_rigid or contact.master is not None:
        return None
    surface = contact_pieces(body, rows, contact)
    surface = surface.only(np.isfinite(surface.rows.numbers["gap"]))
    found, nodes = surface.rows, surface.nodes
    normals = found.vectors("nx", "ny", "nz")
    if len(nodes) < 2 or np.linalg.norm(normals.mean(axis=0)) < _FACING:
        return None
    moved = np.einsum("ij,ij->i", np.asarray(body["displacement"])[nodes], normals)
    points, offsets = found.vectors("x", "y", "z"), moved + found.numbers["gap"]
    return ObstacleSurface(points, offsets, normals, nodes, surface.pieces)
