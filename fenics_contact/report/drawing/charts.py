"""Flat coordinates of contact surfaces: those of their plane, or of a cylinder unrolled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from fenics_contact.common.arrays import Array, Integers
from fenics_contact.report.drawing.style import labelled, with_unit
from fenics_contact.results.contact_points import ContactTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Mean normals of arcs of more than 60 degrees are shorter than this: these are unrolled.
_BENT = 0.955
# Root mean square of what a cylinder's normals have along its axis: facets of unlike triangles.
_ACROSS = 0.15
_ROUND = 0.03  # scatter of the distances from the axis, over the radius
_ALONG = 0.98  # cosine from which a direction is called by its axis
_GAP = np.deg2rad(20)  # wider ones are no spacing of points
_STEPS = (1, 2, 5, 10, 15, 30, 45, 90)  # of angles on an axis, in degrees


@dataclass(frozen=True)
class Plane:
    """Looked at across a surface.

    Attributes:
        axes: Unit vectors to the right and upwards, (2, 3).
        names: Of these two coordinates.
    """

    axes: Array
    names: tuple[str, str]

    @property
    def words(self) -> str:
        """What a caption has to say of it."""
        return ""

    def flat(self, points: Array) -> Array:
        """Coordinates of points (n, 3), (n, 2) (length)."""
        return np.asarray(points @ self.axes.T)

    def vectors(self, points: Array, vectors: Array) -> Array:
        """Components of vectors at points, both (n, 3), (n, 2)."""
        return np.asarray(vectors @ self.axes.T)

    def pieces(self, points: Array, pieces: Integers) -> Array:
        """Coordinates of the corners of pieces, (pieces, corners, 2) (length)."""
        return self.flat(points)[pieces]

    def label(self, panel: Axes, upwards: bool = True) -> None:
        """Name the axes of a panel."""
        panel.locator_params(nbins=5)
        panel.set_xlabel(labelled(self.names[0], "length"))
        if upwards:
            panel.set_ylabel(labelled(self.names[1], "length"))


@dataclass(frozen=True)
class Cylinder:
    """A cylinder unrolled: the arc's length to the right, the place on its axis upwards.

    Attributes:
        axis: Unit vector, (3,).
        across: Two more at right angles to it; angles begin at the first, (2, 3).
        centre: Coordinates of the axis on these two, (2,) (length).
        radius: Of the cylinder (length).
        middle: Angle that is in the middle of the map; it is cut opposite.
    """

    axis: Array
    across: Array
    centre: Array
    radius: float
    middle: float

    @property
    def words(self) -> str:
        """What a caption has to say of it."""
        start = _name_of(self.across[0], "the first direction across the axis")
        radius = with_unit(self.radius, "length")
        return (
            f"The cylinder of radius {radius} is unrolled to scale: its angle, from {start} on, to "
            "the right, and its axis upwards."
        )

    def flat(self, points: Array) -> Array:
        """Arc length R θ and place on the axis of points (n, 3), (n, 2) (length)."""
        turned = (self._angles(points) - self.middle + np.pi) % (2 * np.pi) - np.pi + self.middle
        return np.column_stack([self.radius * turned, points @ self.axis])

    def vectors(self, points: Array, vectors: Array) -> Array:
        """Components around and along the axis of vectors at points, both (n, 3), (n, 2)."""
        angles = self._angles(points)
        here = vectors @ self.across.T
        around = -np.sin(angles) * here[:, 0] + np.cos(angles) * here[:, 1]
        return np.column_stack([around, vectors @ self.axis])

    def pieces(self, points: Array, pieces: Integers) -> Array:
        """Coordinates of the corners of pieces, each in one piece, (pieces, corners, 2)."""
        found: Array = self.flat(points)[pieces]
        once = 2 * np.pi * self.radius
        found[..., 0] -= once * np.round((found[..., 0] - found[:, :1, 0]) / once)
        return found

    def label(self, panel: Axes, upwards: bool = True) -> None:
        """Name the axes of a panel: angles in degrees, at their arcs' lengths."""
        from matplotlib.ticker import FuncFormatter, MultipleLocator

        panel.locator_params(nbins=5)
        degree = np.deg2rad(1) * self.radius
        low, high = panel.get_xlim()
        step = next((s for s in _STEPS if (high - low) / degree / s <= 5), _STEPS[-1])
        panel.xaxis.set_major_locator(MultipleLocator(step * degree))
        panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: _turn(round(x / degree))))
        panel.set_xlabel("angle around the axis")
        if upwards:
            along = _symbol_of(self.axis, "place along the axis")
            panel.set_ylabel(labelled(along, "length"))

    def _angles(self, points: Array) -> Array:
        x, y = (points @ self.across.T - self.centre).T
        return np.asarray(np.arctan2(y, x))


Chart: TypeAlias = Plane | Cylinder


def chart_of(rows: ContactTable) -> Chart:
    """Return the chart of a surface: more than 60° of a cylinder is unrolled.

    Args:
        rows: Points of a contact in space.
    """
    own = np.isfinite(rows.numbers["gap"])  # others face nothing, and have another's normal
    faced = rows.rows(own) if own.sum() > 3 else rows
    points, normals = faced.vectors("x", "y", "z"), faced.vectors("nx", "ny", "nz")
    mean = normals.mean(axis=0)
    if np.linalg.norm(mean) < _BENT:
        found = _cylinder(points, normals, rows)
        if found is not None:
            return found
    return _plane(points, mean)


def _plane(points: Array, mean: Array) -> Plane:
    """Across the mean normal; of a surface around a body, across its least extent."""
    size = float(np.linalg.norm(mean))
    if size < 0.5:
        mean, size = np.eye(3)[np.argmin(np.ptp(points, axis=0))], 1.0
    normal = mean / size
    across = int(np.argmax(np.abs(normal)))
    if abs(normal[across]) > _ALONG:
        axes = np.delete(np.eye(3), across, axis=0)
    else:  # the first one as level as can be, the second one upwards
        level = np.cross(np.eye(3)[2 if across != 2 else 1], normal)
        axes = np.array([level, np.cross(normal, level)]) / np.linalg.norm(level)
    names = [_symbol_of(axis, f"along {_components(axis)}") for axis in axes]
    return Plane(axes, (names[0], names[1]))


def _cylinder(points: Array, normals: Array, rows: ContactTable) -> Cylinder | None:
    """The axis is where no normal points to, and all points are as far from it."""
    _, vectors = np.linalg.eigh(normals.T @ normals)
    axis = vectors[:, 0] * np.sign(vectors[np.argmax(np.abs(vectors[:, 0])), 0])
    if np.sqrt(np.mean((normals @ axis) ** 2)) > _ACROSS:
        return None
    number = int(np.argmax(np.abs(axis)))
    if abs(axis[number]) > _ALONG:
        axis = np.eye(3)[number]
    first = np.eye(3)[(number + 1) % 3]
    first = first - (first @ axis) * axis
    first /= np.linalg.norm(first)
    across = np.array([first, np.cross(axis, first)])
    circle = circle_through(points @ across.T)
    if circle is None:
        return None
    centre, radius = circle
    x, y = (points @ across.T - centre).T
    pressure = rows.numbers["contact_pressure"]
    pressed = rows.vectors("x", "y", "z") @ across.T - centre
    middle = _middle(np.arctan2(y, x), pressure @ pressed)
    return Cylinder(axis, across, centre, radius, middle)


def circle_through(points: Array) -> tuple[Array, float] | None:
    """Centre and radius of the circle that points (n, 2) lie on; None where they do not."""
    origin = points.mean(axis=0)
    moved = points - origin
    columns = np.column_stack([2 * moved, np.ones(len(moved))])
    (x, y, rest), *_ = np.linalg.lstsq(columns, (moved**2).sum(axis=1), rcond=None)
    radius = float(np.sqrt(max(rest + x * x + y * y, 0.0)))
    distances = np.hypot(*(moved - [x, y]).T)
    if radius == 0 or np.std(distances) > _ROUND * radius:
        return None
    return origin + np.array([x, y]), radius


def _middle(angles: Array, pressed: Array) -> float:
    """Return the angle in the map's middle: that of an arc, or of the pressed part of a turn."""
    ordered = np.sort(angles)
    gaps = np.diff(np.append(ordered, ordered[0] + 2 * np.pi))
    widest = int(np.argmax(gaps))
    if gaps[widest] > _GAP:
        opposite = ordered[widest] + gaps[widest] / 2 + np.pi
        return float((opposite + np.pi) % (2 * np.pi) - np.pi)
    if not pressed.any():
        return 0.0
    quarter = np.pi / 2  # a round angle: another load step is seen as this one
    return float(quarter * np.round(np.arctan2(pressed[1], pressed[0]) / quarter))


def _turn(degrees: int) -> str:
    """An angle of at most half a turn either way."""
    return f"{degrees if abs(degrees) <= 180 else (degrees + 180) % 360 - 180}°"


def _symbol_of(direction: Array, words: str) -> str:
    """The letter of an axis for matplotlib, or other words."""
    number = int(np.argmax(np.abs(direction)))
    return f"${'xyz'[number]}$" if direction[number] > _ALONG else words


def _name_of(direction: Array, words: str) -> str:
    return _symbol_of(direction, words).strip("$")


def _components(direction: Array) -> str:
    return "(" + ", ".join(f"{x + 0.0:.2f}" for x in direction) + ")"
