"""The statuses that points may have, as linear equations and inequalities of the forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array, Flags, Integers
from fenics_contact.solve.exact.natural_map import NaturalMap

# Directions in which the cone of friction in space is replaced by planes around it.
_PLANES = 8


@dataclass(frozen=True, eq=False)
class Status:
    """Equations a · r = b of a point with one status, and the side on which it slips.

    Attributes:
        rows: A, (equations, rows).
        values: b, (equations,).
        slip: +1 or −1 where its slip has this sign, 0 where that is not said.
    """

    rows: Array
    values: Array
    slip: int = 0


class PointStatuses:
    """Statuses of some points of a problem, while all others are open.

    Attributes:
        points: Their numbers, (some,).
        kept: Rows of these points, (rows,).
        compliance: W at them, (rows, rows).
        free: q at them, (rows,).
        inequalities: Rows a of a · r + c ≥ 0, (inequalities, rows): first those of all answers.
        constants: c, (inequalities,).

    Args:
        equations: Of the problem.
        compliance: W of its points, with scalars eliminated, (rows, rows).
        free: q, likewise, (rows,).
        points: Numbers of those that may touch, (some,).
    """

    def __init__(
        self, equations: NaturalMap, compliance: Array, free: Array, points: Integers
    ) -> None:
        self._equations, self.points, size = equations, points, equations.dimension
        self.kept = (points[:, None] * size + np.arange(size)).ravel()
        self.compliance = compliance[np.ix_(self.kept, self.kept)]
        self.free = free[self.kept]
        bound, slope = equations.bounds(equations.given_force)
        self._slope = np.where(equations.given, 0.0, slope)[points]
        self._fixed = (bound - np.where(equations.given, 0.0, slope * equations.given_force))[
            points
        ]
        self._make_inequalities()

    def of(self, number: int) -> Iterator[tuple[Status, Flags]]:
        """Statuses of a point, each with the inequalities that hold then.

        Args:
            number: Place among the points.
        """
        equations, point = self._equations, self.points[number]
        across, *along = self._rows(number)
        units = np.eye(len(self.free))
        size = equations.dimension
        if equations.unilateral[point]:
            yield self._status(number, units[[across, *along]], np.zeros(size))
        first = units[[across]] if equations.given[point] else self.compliance[[across]]
        value = 0.0 if equations.given[point] else -self.free[across]
        if not (equations.rubs[point] or equations.bonded[point]):
            yield self._status(
                number, np.vstack([first, units[along]]), [value] + [0.0] * (size - 1)
            )
            return
        yield self._status(
            number, np.vstack([first, self.compliance[along]]), [value, *-self.free[along]]
        )
        if equations.bonded[point]:
            return
        if size > 2:
            yield self._status(number, first, [value])
            return
        for sign in (1, -1):
            slides = units[along] + sign * self._slope[number] * units[[across]]
            values = [value, -sign * self._fixed[number]]
            yield self._status(number, np.vstack([first, slides]), values, sign)

    def _status(
        self, number: int, rows: Array, values: Array | list[float], slip: int = 0
    ) -> tuple[Status, Flags]:
        holds = self._always.copy()
        if slip:
            holds[self._of_slip[number, (slip + 1) // 2]] = True
        return Status(rows, np.asarray(values, dtype=float), slip), holds

    def _rows(self, number: int) -> list[int]:
        size = self._equations.dimension
        return list(range(number * size, (number + 1) * size))

    def _make_inequalities(self) -> None:
        """Collect r_n ≥ 0, v_n ≥ 0 and the cone of friction; in the plane also signs of slips."""
        equations, size = self._equations, self._equations.dimension
        units, rows, constants = np.eye(len(self.free)), [], []
        angles = 2 * np.pi * np.arange(_PLANES) / _PLANES
        ways = [[1.0], [-1.0]] if size == 2 else np.column_stack([np.cos(angles), np.sin(angles)])
        for number, point in enumerate(self.points):
            across, *along = self._rows(number)
            if equations.unilateral[point]:
                rows += [units[across], self.compliance[across]]
                constants += [0.0, self.free[across]]
            if equations.rubs[point]:
                for way in ways:
                    rows.append(self._slope[number] * units[across] - way @ units[along])
                    constants.append(self._fixed[number])
        always, slips = len(rows), np.zeros((len(self.points), 2), dtype=np.int64)
        if size == 2:
            for number in range(len(self.points)):
                slip = self._rows(number)[1]
                for side, sign in enumerate((-1.0, 1.0)):
                    slips[number, side] = len(rows)
                    rows.append(sign * self.compliance[slip])
                    constants.append(sign * self.free[slip])
        self._of_slip = slips
        self.inequalities, self.constants = np.array(rows), np.array(constants)
        self._always = np.arange(len(rows)) < always
