"""What the picture of the deformed body shows, and from where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fenics_contact.contact_table import ContactTable
from fenics_contact.picture_style import Mark, marks, neighbourhood

Array = NDArray[np.float64]

_MOVE = 0.06  # of what is shown: the largest displacement, where it is magnified
_READABLE = (0.02, 0.2)  # displacements of this size, over what is shown, are drawn as they are
_MISFIT = 0.01  # of what is shown: false gaps and overlaps that magnification may make
_NEAR = 0.4  # neighbourhoods smaller than this share of the body are looked at from near by
_WIDTH, _HEIGHTS = 1400, (560, 1000)  # of the window, in pixels
MARGINS = (0.24, 0.14)  # share of the window below the body, for the colour bar, and above


@dataclass(frozen=True)
class View:
    """What is shown of the body, and from where.

    Attributes:
        body: The cells shown, with all fields.
        low: Lowest coordinates shown, (3,).
        high: Highest coordinates shown, (3,).
        is_near: Whether only the neighbourhood of the contact is shown.
        flat: Whether the model is plane or axisymmetric.
        towards: From the body to the camera, a unit vector, (3,).
        marks: How contact points look.
        closed_gap: The widest gap between bodies, as meshed, that has closed (length).
        hides: Whether a body may stand before contact points.
    """

    body: Any
    low: Array
    high: Array
    is_near: bool
    flat: bool
    towards: Array
    marks: tuple[Mark, ...]
    closed_gap: float
    hides: bool

    @property
    def size(self) -> float:
        """Diagonal of what is shown (length)."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def factor(self) -> float:
        """Magnification of the displacements.

        Gaps between bodies are not magnified: where they have closed, bodies that are drawn with
        other displacements than theirs overlap, or seem apart.
        """
        largest = np.linalg.norm(self.body["displacement"], axis=1).max()
        if largest == 0 or _READABLE[0] <= largest / self.size <= _READABLE[1]:
            return 1.0
        factor = _round_factor(_MOVE * self.size / largest)
        fits = abs(factor - 1) * self.closed_gap <= _MISFIT * self.size
        return factor if fits else 1.0

    @property
    def window(self) -> tuple[int, int]:
        """Width and height of the window in pixels."""
        if not self.flat:
            return _WIDTH, _HEIGHTS[1]
        across, up = self._extent
        return _WIDTH, int(np.clip(_WIDTH * up / across / (1 - sum(MARGINS)), *_HEIGHTS))

    @property
    def scale(self) -> float:
        """Half of what a flat model's window shows from top to bottom (length)."""
        across, up = self._extent
        width, height = self.window
        return 0.5 * float(max(across * height / width, up / (1 - sum(MARGINS))))

    @property
    def _extent(self) -> tuple[float, float]:
        across, up = (self.high - self.low)[:2]
        return float(1.15 * across), float(up)


def choose_view(body: Any, result: dict[str, Any], table: ContactTable) -> View:
    """The whole body, or the neighbourhood of a contact zone that is small in it.

    Args:
        body: A pyvista grid with the fields of a run.
        result: The content of its ``result.json``.
        table: The content of its ``contact.csv``.
    """
    low, high = np.array(body.bounds).reshape(3, 2).T
    flat = result["model"]["kinematics"] != "3D"
    laws = {contact["law"] for contact in result["contacts"]}
    looks = marks("none" if laws <= {"none"} else "static")
    pairs = [contact for contact in result["contacts"] if "master" in contact]
    gap = max((contact["quantities"]["closed_gap"] for contact in pairs), default=0.0)
    hides = bool(pairs) and not flat
    front = np.zeros(3) if hides else _front(table)
    on_contact = body["status"] >= 0
    if on_contact.any():
        closed = body["status"][on_contact] > 0
        first, last = neighbourhood(body.points[on_contact], closed)
        if (last - first).max() < _NEAR * (high - low).max():
            near = np.maximum(low, first), np.minimum(high, last)
            aside = (near[0] + near[1] - low - high) / (high - low).max()
            inside = ((body.points >= near[0]) & (body.points <= near[1])).all(axis=1)
            body = _cells_at(body, inside)
            return View(body, *near, True, flat, _towards(flat, front, aside), looks, gap, hides)
    return View(body, low, high, False, flat, _towards(flat, front, np.zeros(3)), looks, gap, hides)


def _cells_at(body: Any, points: Any) -> Any:
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
