"""What drives a contact at a pseudo-time: a pressure, a force, or how its obstacle moves."""

from __future__ import annotations

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.obstacle import Obstacle


class ContactPaths:
    """The load paths of a contact.

    Args:
        contact: Of the scene.
        key: Where it is there, for messages.
        is_glued: Whether its obstacle can be pulled.
    """

    def __init__(self, contact: Contact, key: str, is_glued: bool) -> None:
        self._is_glued = is_glued
        self._obstacle = obstacle = contact.obstacle or Obstacle()
        self._pressure = KeyedPath(contact.pressure_path, f"{key}.pressure_path")
        self._drive = KeyedPath(obstacle.path, f"{key}.obstacle.path")
        self._interference = contact.interference
        self._fit = KeyedPath(contact.interference_path, f"{key}.interference_path")
        where = f"{key}.obstacle.displacement_path"
        self._displacement = KeyedPath(obstacle.displacement_path, where)

    def pressure_factor(self, time: float) -> float:
        """Share of a given pressure that acts, ≥ 0."""
        return self._not_negative(self._pressure, time, "it must be ≥ 0")

    def force(self, time: float) -> float | None:
        """On the obstacle, ≥ 0 unless it is glued on; None where no force drives it (force)."""
        force = self._obstacle.force
        if force is None:
            return None
        if self._is_glued:
            return force * self._drive(time)
        why = "a force on an obstacle that the body may leave must be ≥ 0"
        return force * self._not_negative(self._drive, time, why)

    def interference(self, time: float) -> float:
        """By how much the two sides overlap, beside what their meshes do; < 0 a gap (length)."""
        return self._interference * self._fit(time) if self._interference else 0.0

    def interference_factor(self, time: float) -> float:
        """Share of an interference that acts."""
        return self._fit(time)

    def drive_factor(self, time: float) -> float:
        """Share of indentation or force that an obstacle is driven by."""
        return self._drive(time)

    def displacement_factor(self, time: float) -> float:
        """Share of the obstacle's displacement."""
        return self._displacement(time)

    def indentation(self, time: float) -> float:
        """How far the obstacle is driven where no force drives it (length)."""
        return (self._obstacle.indentation or 0.0) * self._drive(time)

    def displacement(self, time: float) -> Array | None:
        """How far the obstacle has moved besides, (components,); None if it does not (length)."""
        if self._obstacle.displacement is None:
            return None
        return self._displacement(time) * np.array(self._obstacle.displacement)

    @staticmethod
    def _not_negative(path: KeyedPath, time: float, why: str) -> float:
        factor = path(time)
        if factor < 0:
            raise InputError(f"{path.key}: {factor:g} at time {time:g}, but {why}")
        return factor
