"""Systems of coordinates of Nastran, in which grid points may be given.

A system is defined by three points: its origin A, B on its z-axis, and C in the half of its x-z
plane where x > 0. CORD2R, CORD2C and CORD2S list them in another system, CORD1R, CORD1C and CORD1S
name three grid points. R is rectangular, C cylindrical (r, θ, z), and S spherical (r, θ from the
z-axis, φ about it); angles are in degrees (MSC Nastran, Quick Reference Guide).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.mesh.readers.nastran_cards import Card

_CARDS = re.compile(r"CORD([12])([RCS])")
_BASIC = 0
# Of the distance of two of its points: a third one that is no farther from the line through them
# gives no plane.
_ON_A_LINE = 1e-9


@dataclass(frozen=True, eq=False)
class _Frame:
    """A system whose place is known.

    Attributes:
        kind: ``R``, ``C`` or ``S``.
        origin: In the basic system, (3,) (length).
        axes: Its unit vectors x, y, z as rows, (3, 3).
    """

    kind: str
    origin: Array
    axes: Array

    def basic(self, coordinates: Array) -> Array:
        """Points in the basic system.

        Args:
            coordinates: In this one, (points, 3) (length; angles in degrees).
        """
        first, second, third = coordinates.T
        local = coordinates
        if self.kind == "C":
            turn = np.radians(second)
            local = np.stack([first * np.cos(turn), first * np.sin(turn), third], axis=1)
        elif self.kind == "S":
            tilt, turn = np.radians(second), np.radians(third)
            across = first * np.sin(tilt)
            parts = [across * np.cos(turn), across * np.sin(turn), first * np.cos(tilt)]
            local = np.stack(parts, axis=1)
        return np.asarray(self.origin + local @ self.axes)


class GridPoints:
    """Grid points and the systems of coordinates that they are given in, as they come in."""

    def __init__(self) -> None:
        self._given: dict[int, tuple[int | None, tuple[float, ...], Card]] = {}
        self._systems: dict[int, tuple[str, Card, int]] = {}
        self._frames = {_BASIC: _Frame("R", np.zeros(3), np.eye(3))}
        self._default = _BASIC

    def take(self, card: Card) -> bool:
        """Take a grid point or a system, and return whether the card is one.

        Raises:
            RefusedError: It is defined again, otherwise, or a field is no number.
        """
        if card.word == "GRID":
            self._take_point(card)
        elif card.word == "GRDSET":
            self._default = _system(card) or _BASIC
        elif (found := _CARDS.fullmatch(card.word)) is not None:
            width = {"1": 4, "2": 11}[found[1]]
            starts = [0, 4] if width == 4 and any(card.fields[4:8]) else [0]
            for start in starts:
                number = card.whole(start)
                if number in self._systems:
                    raise card.line.error(f"the coordinate system {number} is defined twice")
                self._systems[number] = found[2], card, start
        else:
            return False
        return True

    def _take_point(self, card: Card) -> None:
        number = card.whole(0)
        given = _system(card), (card.real(2), card.real(3), card.real(4))
        before = self._given.setdefault(number, (*given, card))
        if before[:2] != given:
            raise card.line.error(f"defines the grid point {number} again, elsewhere")

    def numbers(self) -> list[int]:
        """Numbers of all grid points, in the order of the file."""
        return list(self._given)

    def places(self) -> Array:
        """Coordinates of all grid points in the basic system, (points, 3) (length).

        Raises:
            RefusedError: A system is not defined, or no three points define it.
        """
        rows = list(self._given.values())
        found = np.array([row[1] for row in rows], dtype=np.float64).reshape(-1, 3)
        systems = np.array([self._default if row[0] is None else row[0] for row in rows])
        for number in np.unique(systems) if len(rows) else ():
            mine = systems == number
            frame = self._frame(int(number), rows[int(np.argmax(mine))][2], ())
            found[mine] = frame.basic(found[mine])
        return found

    def _frame(self, number: int, asked_by: Card, open_ones: tuple[int, ...]) -> _Frame:
        """The system of a number.

        Args:
            number: Of it.
            asked_by: Card that names it.
            open_ones: Systems whose definition leads to it.
        """
        if number in self._frames:
            return self._frames[number]
        if number not in self._systems:
            raise asked_by.line.error(
                f"{asked_by.word} names the coordinate system {number}, which the file does not "
                "define by a CORD1R, CORD1C, CORD1S, CORD2R, CORD2C or CORD2S"
            )
        if number in open_ones:
            raise asked_by.line.error(f"the coordinate system {number} is defined by itself")
        kind, card, start = self._systems[number]
        points = np.stack(list(self._points_of(card, start, (*open_ones, number))))
        axes = _axes(points)
        if axes is None:
            raise card.line.error(
                f"the three points of the coordinate system {number} lie on a line, or at one place"
            )
        self._frames[number] = _Frame(kind, points[0], axes)
        return self._frames[number]

    def _points_of(self, card: Card, start: int, open_ones: tuple[int, ...]) -> Iterator[Array]:
        """The points A, B and C of a system in the basic one."""
        if card.word.startswith("CORD2"):
            reference = self._frame(_system(card) or _BASIC, card, open_ones)
            numbers = np.array([card.real(place) for place in range(2, 11)])
            yield from reference.basic(numbers.reshape(3, 3))
            return
        for place in range(start + 1, start + 4):
            number = card.whole(place)
            if number not in self._given:
                raise card.line.error(f"{card.word} names the grid point {number}: there is none")
            system, coordinates, point = self._given[number]
            frame = self._frame(self._default if system is None else system, point, open_ones)
            yield frame.basic(np.array([coordinates]))[0]


def _system(card: Card) -> int | None:
    """The number of the system that the second field of a card names; None where it is blank."""
    word = card.fields[1] if len(card.fields) > 1 else ""
    if word == "":
        return None
    return 0 if word == "0" else card.whole(1)


def _axes(points: Array) -> Array | None:
    """Unit vectors of a system by its three points, (3, 3); None where these give no plane."""
    along, across = points[1] - points[0], points[2] - points[0]
    length = float(np.linalg.norm(along))
    if length == 0:
        return None
    z = along / length
    x = across - (across @ z) * z
    width = float(np.linalg.norm(x))
    if width <= _ON_A_LINE * float(np.linalg.norm(across)):
        return None
    return np.stack([x / width, np.cross(z, x / width), z])
