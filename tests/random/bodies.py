"""Bodies at random: boxes of cells that are graded, distorted, bulged, turned and scaled."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fenics_contact.verification.boxes import Box
from tests.random.dice import Dice

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """How boxes of meshes become bodies: a map of all points, in this order.

    Attributes:
        low: Lowest corner of all boxes.
        high: Highest corner.
        towards: Share by which cells are drawn to the middle (in axisymmetric models: to the axis).
        upwards: Power by which they are drawn to the top.
        unrest: How far inner points are moved, over the cells' size.
        cells: Along each axis.
        bulge: Height of the top's middle over its edges, over the width.
        turn: About the last axis but one, of the whole (radian).
        length: Scale of all.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    cells: tuple[int, ...]
    towards: float = 0.0
    upwards: float = 1.0
    unrest: float = 0.0
    bulge: float = 0.0
    turn: float = 0.0
    length: float = 1.0
    axial: bool = False

    def __call__(self, points: Array) -> Array:
        """Where points of the boxes go, shape (points, axes)."""
        low, size = np.array(self.low), np.subtract(self.high, self.low)
        share = (points - low) / size
        inside = np.prod(np.clip(8 * share * (1 - share), 0, 1), axis=1)
        inside *= np.clip(8 * np.abs(points[:, -1]) / size[-1], 0, 1)  # two boxes stay flat there
        waves = np.sin(37 * share @ np.arange(1, len(size) + 1) + np.arange(len(size))[:, None]).T
        share = share + (self.unrest * inside)[:, None] * waves / np.array(self.cells)
        if self.axial:
            share[:, 0] = (1 - self.towards) * share[:, 0] + self.towards * share[:, 0] ** 2
        else:
            for axis in range(len(size) - 1):
                share[:, axis] += self.towards * np.sin(2 * np.pi * share[:, axis]) / (2 * np.pi)
        share[:, -1] = 1 - np.maximum(1 - share[:, -1], 0) ** self.upwards
        middle = np.prod(4 * share[:, :-1] * (1 - share[:, :-1]), axis=1)
        if self.axial:
            middle = 1 - share[:, 0] ** 2
        found = low + share * size
        found[:, -1] += self.bulge * middle * share[:, -1]
        return self.length * found @ self.rotation().T

    def rotation(self) -> Array:
        """Of vectors: their components before to those after."""
        matrix = np.eye(len(self.low))
        cosine, sine = np.cos(self.turn), np.sin(self.turn)
        matrix[np.ix_([0, -1], [0, -1])] = [[cosine, -sine], [sine, cosine]]
        return matrix

    def turned(self, *vector: float) -> tuple[float, ...]:
        """A vector of the boxes in the mesh's axes."""
        return tuple(float(value) for value in self.rotation() @ vector)

    def place(self, *point: float) -> tuple[float, ...]:
        """Where a point of the boxes goes."""
        return tuple(float(value) for value in self(np.array([point]))[0])


def parts_of(dice: Dice, dimension: int, degree: int, pair: bool, axial: bool) -> tuple[Box, ...]:
    """One box of width 1, or two on top of each other."""
    depth, height = dice.between(0.5, 1.5), dice.between(0.4, 1.6)
    start = dice.of(0.0, 0.0, 0.4) if axial else 0.0
    if dimension == 2:
        most = (16, 9) if degree == 2 else (24, 14)
        cells = tuple(dice.whole(most[k] // 2 - 1, most[k]) for k in range(2))
        low, high = (start, -height), (start + 1.0, 0.0)
    else:
        most = (5, 4, 3) if degree == 2 else (9, 8, 6)
        cells = tuple(dice.whole((most[k] + 1) // 2, most[k]) for k in range(3))
        low, high = (0.0, 0.0, -height), (1.0, depth, 0.0)
    if not pair:
        return (Box("body", low, high, cells),)
    share = (0.5, 0.5) if dimension == 2 else (0.7, 0.6)
    fewer = tuple(max(2, int(share[k == dimension - 1] * c)) for k, c in enumerate(cells))
    # Not wider than the one below, so that they touch all over.
    inset = 0.0 if axial else dice.of(0.0, 0.1, 0.2)
    above = Box(
        "upper",
        (*(value + inset for value in low[:-1]), 0.0),
        (*(value - inset for value in high[:-1]), dice.between(0.3, 0.8)),
        tuple(max(2, c + dice.whole(-1, 1)) for c in fewer),
    )
    return (Box("body", low, high, fewer), above)


def shape_of(dice, parts, order, kinematics, kind, flat) -> Shape:
    """Half of the bodies are boxes; what is mapped is graded, distorted, bulged, turned."""
    low = tuple(np.min([part.low for part in parts], axis=0).tolist())
    high = tuple(np.max([part.high for part in parts], axis=0).tolist())
    length = dice.logarithmic(1e-6, 1e3) if dice.chance(40) else 1.0
    shape = Shape(low, high, parts[0].cells, length=length, axial=kinematics == "axisymmetric")
    if not flat and dice.chance(40):
        shape = dataclasses.replace(shape, unrest=dice.between(0, 0.25 if order == 1 else 0.05))
    if len(parts) == 1 and dice.chance(50):
        # The middle nodes of cells of order 2 must stay away from their quarters.
        towards, upwards = (0.8, 2.5) if order == 1 else (0.4, 1.4)
        shape = dataclasses.replace(
            shape, towards=dice.between(0, towards), upwards=dice.between(1, upwards)
        )
    if flat:
        return shape
    if len(parts) == 1 and dice.chance(25):
        shape = dataclasses.replace(shape, bulge=dice.between(-0.1, 0.15))
    if kind != "impossible" and kinematics != "axisymmetric" and dice.chance(20):
        shape = dataclasses.replace(shape, turn=dice.between(-1.5, 1.5))
    return shape
