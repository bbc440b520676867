"""Directions of the springs of a support at each place: axes, a turned frame, around an axis."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Literal

import numpy as np
import ufl
from dolfinx import fem
from ufl.core.expr import Expr

from fenics_contact.body.spaces import Spaces
from fenics_contact.common import form_cache
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import gather_rows, total
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.scene.loading.support_axes import SupportAxes

# Of the extent of a boundary, by which its nodes may be off a plane or a cylinder.
_OFF = 1e-6


class Directions(ABC):
    """Unit vectors at each place, by their numbers."""

    @abstractmethod
    def vectors(self, position: Expr) -> list[Expr]:
        """Return them in UFL, (components,) each.

        Args:
            position: x, (components,) (length).
        """

    @abstractmethod
    def at(self, points: Array) -> Array:
        """Return them at points, (directions, points, components).

        Args:
            points: Coordinates, (points, 3) (length).
        """


class Frame(Directions):
    """Unit vectors of a frame that is turned alike everywhere.

    Args:
        rows: They, (directions, components).
        spaces: Those of the body.
    """

    def __init__(self, rows: Array, spaces: Spaces) -> None:
        self._rows = rows
        self._constants = [fem.Constant(spaces.body.mesh, row) for row in rows]

    def vectors(self, position: Expr) -> list[Expr]:
        """Return them in UFL."""
        return list(self._constants)

    def at(self, points: Array) -> Array:
        """Return them at points."""
        return np.repeat(self._rows[:, None], len(points), axis=1)


class AroundAxis(Directions):
    """Away from an axis, around it, and along it in space.

    Args:
        axis: Unit vector along it, (3,).
        centre: A point of it, (components,) (length).
        spaces: Those of the body.
    """

    def __init__(self, axis: Array, centre: Array, spaces: Spaces) -> None:
        self._axis, self._centre = axis, centre
        mesh = spaces.body.mesh
        self._along, self._from = fem.Constant(mesh, axis), fem.Constant(mesh, centre)

    def vectors(self, position: Expr) -> list[Expr]:
        """Return them in UFL."""
        arm = position - self._from
        if len(self._centre) == 2:
            away = arm / ufl.sqrt(ufl.dot(arm, arm))
            return [away, ufl.as_vector([-away[1], away[0]])]
        arm = arm - ufl.dot(arm, self._along) * self._along
        away = arm / ufl.sqrt(ufl.dot(arm, arm))
        return [away, ufl.cross(self._along, away), self._along]

    def at(self, points: Array) -> Array:
        """Return them at points; 0 on the axis, but along it."""
        size = len(self._centre)
        arms = np.zeros((len(points), 3))
        arms[:, :size] = points[:, :size] - self._centre
        arms -= np.outer(arms @ self._axis, self._axis)
        lengths = np.linalg.norm(arms, axis=1)[:, None]
        away = np.divide(arms, lengths, out=np.zeros_like(arms), where=lengths > 0)
        along = np.broadcast_to(self._axis, away.shape)
        return np.stack([away, np.cross(self._axis, away), along])[:size, :, :size]


def directions_of(
    axes: SupportAxes | Literal["normal"], group: Group, key: str, spaces: Spaces
) -> Directions:
    """Return the directions of a support's springs; collective.

    Args:
        axes: Of its components, or ``normal`` for that of the boundary.
        group: The boundary.
        key: Of the support, for messages.
        spaces: Those of the body.

    Raises:
        InputError: The normal is asked for of a boundary that is neither plane nor a cylinder.
    """
    size = spaces.components
    if axes == "normal":
        return _outward(_across(group, key, spaces), group, spaces)
    if axes.cylindrical is not None:
        axis = np.array(axes.cylindrical, dtype=np.float64)
        centre = np.zeros(size) if axes.at is None else np.array(axes.at, dtype=np.float64)
        return AroundAxis(axis / np.linalg.norm(axis), centre, spaces)
    assert axes.x is not None
    first = np.array(axes.x, dtype=np.float64) / np.linalg.norm(axes.x)
    if axes.y is None:
        return Frame(np.array([first, [-first[1], first[0]]]), spaces)
    second = np.array(axes.y) - (first @ axes.y) * first
    second /= np.linalg.norm(second)
    return Frame(np.array([first, second, np.cross(first, second)]), spaces)


def _across(group: Group, key: str, spaces: Spaces) -> Directions:
    """Directions of which the first is across a boundary, to one side or the other; collective."""
    size = spaces.components
    nodes = spaces.nodes(group)
    own = nodes[nodes < spaces.owned_nodes]
    places = gather_rows(spaces.comm, spaces.coordinates[own, :size])
    middle, extent = places.mean(axis=0), float(np.linalg.norm(np.ptp(places, axis=0)))
    *_, last = np.linalg.svd(places - middle, full_matrices=False)[2]
    if np.abs((places - middle) @ last).max() <= _OFF * extent:
        return Frame(last[None], spaces)
    axis, centre, off = _cylinder(places, _flattest(group, spaces))
    if off > _OFF * extent:
        raise InputError(
            f"{key}.normal: the boundary is neither plane nor a cylinder; give axes and "
            "displacement in place of it"
        )
    return AroundAxis(axis, centre, spaces)


def _flattest(group: Group, spaces: Spaces) -> Array:
    """The direction that the normals of a boundary have least of, (3,): z in the plane."""
    if spaces.components == 2:
        return np.array([0.0, 0.0, 1.0])
    mesh = spaces.body.mesh
    normal, on = ufl.FacetNormal(mesh), spaces.boundary(group)
    one, other = (fem.Constant(mesh, np.zeros(3)) for _ in range(2))
    form = form_cache.form(ufl.dot(normal, one) * ufl.dot(normal, other) * on)
    shares = np.zeros((3, 3))
    for i, j in np.ndindex(3, 3):
        one.value[:], other.value[:] = np.eye(3)[[i, j]]
        shares[i, j] = fem.assemble_scalar(form)
    return np.asarray(np.linalg.eigh(total(spaces.comm, shares))[1][:, 0])


def _cylinder(places: Array, guess: Array) -> tuple[Array, Array, float]:
    """The cylinder, or the circle, through points by least squares.

    Args:
        places: The points, (points, components) (length).
        guess: The direction of its axis, roughly, (3,).

    Returns:
        Unit vector along its axis, (3,), a point of it, (components,), and the largest distance of
        a point from it (length).
    """
    from scipy.optimize import least_squares  # takes long to load, and few scenes need it

    size, middle = places.shape[1], places.mean(axis=0)
    one, other = np.linalg.svd(guess[None])[2][1:]
    scale = float(np.linalg.norm(np.ptp(places, axis=0)))
    arms = np.zeros((len(places), 3))
    arms[:, :size] = (places - middle) / scale

    def axis_of(tilt: Array) -> Array:
        tilted = guess + tilt[0] * one + tilt[1] * other if size == 3 else guess
        return np.asarray(tilted / np.linalg.norm(tilted))

    def off(numbers: Array) -> Array:
        axis = axis_of(numbers[3:])
        from_axis = arms - numbers[0] * one - numbers[1] * other
        from_axis = from_axis - np.outer(from_axis @ axis, axis)
        return np.asarray(np.linalg.norm(from_axis, axis=1) - numbers[2])

    flat = np.stack([arms @ one, arms @ other], axis=1)  # A circle: |x|² = 2 c·x + r² − |c|²
    rows = np.column_stack([2 * flat, np.ones(len(flat))])
    *centre, rest = np.linalg.lstsq(rows, (flat**2).sum(axis=1), rcond=None)[0]
    radius = np.sqrt(max(rest + centre[0] ** 2 + centre[1] ** 2, 0.0))
    tilts = [0.0, 0.0] if size == 3 else []
    found = least_squares(off, [*centre, radius, *tilts], xtol=1e-15, ftol=1e-15, gtol=1e-15)
    point = scale * (found.x[0] * one + found.x[1] * other)[:size] + middle
    return axis_of(found.x[3:]), point, scale * float(np.abs(found.fun).max())


def _outward(found: Directions, group: Group, spaces: Spaces) -> Directions:
    """The first of directions, out of the body; collective."""
    (first, *_), normal = found.vectors(spaces.position), ufl.FacetNormal(spaces.body.mesh)
    along = fem.assemble_scalar(form_cache.form(ufl.dot(first, normal) * spaces.boundary(group)))
    return Turned(found, 1.0 if total(spaces.comm, float(along)) > 0 else -1.0)


class Turned(Directions):
    """The first of other directions, or its opposite.

    Args:
        others: The directions.
        sign: −1 for the opposite.
    """

    def __init__(self, others: Directions, sign: float) -> None:
        self._others, self._sign = others, sign

    def vectors(self, position: Expr) -> list[Expr]:
        """Return it in UFL."""
        return [self._sign * self._others.vectors(position)[0]]

    def at(self, points: Array) -> Array:
        """Return it at points."""
        return self._sign * self._others.at(points)[:1]
