"""A contact line of a flat model, its points in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.report.drawing.style import Mark, marks, neighbourhood
from fenics_contact.results.contact_table import ContactTable
from fenics_contact.results.records.contacts import ContactRecord


@dataclass(frozen=True)
class SurfaceLine:
    """A contact line, its points in order.

    Attributes:
        rows: Its points.
        axis: Number of the axis along which it extends most.
        position: Coordinate on that axis (length).
        view: What of it is shown: the lowest and the highest position.
        marks: How its points look.
    """

    rows: ContactTable
    axis: int
    position: Array
    view: tuple[float, float]
    marks: tuple[Mark, ...]

    @classmethod
    def of(cls, rows: ContactTable, contact: ContactRecord) -> SurfaceLine:
        """The whole line where its pressure is given, else the contact zone's neighbourhood."""
        points = rows.vectors("x", "y")
        axis = int(np.argmax(np.ptp(points, axis=0)))
        order = np.argsort(points[:, axis], kind="stable")
        rows, position = rows.rows(order), points[order, axis]
        low, high = float(position[0]), float(position[-1])
        if not contact.pressure_is_given:
            around = neighbourhood(position[:, None], rows.closed)
            low, high = max(low, float(around[0][0])), min(high, float(around[1][0]))
        return cls(rows, axis, position, (low, high), marks(contact))

    @property
    def tangents(self) -> Array:
        """Unit vectors along the axis of the plot, whichever side the body lies on, (points, 2)."""
        numbers = self.rows.numbers
        tangents = np.stack([numbers["ny"], -numbers["nx"]], axis=1)
        tangents *= np.where(tangents[:, self.axis] < 0, -1.0, 1.0)[:, None]
        return tangents

    @property
    def traction(self) -> Array:
        """Friction traction along the tangents."""
        traction: Array = np.sum(
            self.rows.vectors("traction_x", "traction_y") * self.tangents, axis=1
        )
        return traction

    def runs(self) -> Iterator[tuple[float, float, str]]:
        """Where points of one status follow each other: begin, end, about halfway, and status."""
        status = self.rows.status
        changes = np.flatnonzero(status[1:] != status[:-1]) + 1
        middle = (self.position[1:] + self.position[:-1]) / 2
        bounds = np.concatenate([self.position[:1], middle[changes - 1], self.position[-1:]])
        first = np.concatenate([[0], changes]).astype(int)
        for start, end, number in zip(bounds[:-1], bounds[1:], first, strict=True):
            yield float(start), float(end), str(status[number])
