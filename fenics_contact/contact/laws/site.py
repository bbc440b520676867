"""The contact as its laws see it: its points, what drives it, scales of its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from fenics_contact.body.elastic_body import ElasticBody
from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import smallest
from fenics_contact.contact.kinematics import ContactKinematics
from fenics_contact.contact.slave_and_master import ContactSides
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.loading.load_paths import KeyedPath
from fenics_contact.scene.obstacle import Obstacle
from fenics_contact.scene.values import Value


@dataclass(frozen=True, eq=False)
class LawSite:
    """A contact as its laws see it.

    Attributes:
        contact: What the scene says.
        key: Where, for messages.
        kinematics: Jump, gap and slip.
        scales: What automatic parameters follow from.
        paths: What drives it at a pseudo-time.
    """

    contact: Contact
    key: str
    kinematics: ContactKinematics
    scales: ContactScales
    paths: ContactPaths

    @property
    def trace(self) -> Trace:
        """The contact points."""
        return self.kinematics.trace

    def given(self, value: Value, key: str, may_vanish: bool = True) -> Array:
        """A value of the scene at the points, (points,); collective.

        Args:
            value: A number, a profile or a function.
            key: Of the contact's table, for messages.
            may_vanish: Whether it may be 0.

        Raises:
            InputError: It is negative somewhere, or 0 where it may not be; on every rank.
        """
        spaces, where = self.trace.spaces, f"{self.key}.{key}"
        values = spaces.evaluate_at(value, self.trace.coordinates.T, where)
        lowest = smallest(spaces.comm, values)
        if lowest < 0 or (lowest == 0 and not may_vanish):
            least = "≥ 0" if may_vanish else "> 0"
            raise InputError(f"{where}: its smallest value is {lowest:g}, but it must be {least}")
        return values


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
        self._rotation = KeyedPath(obstacle.rotation_path, f"{key}.obstacle.rotation_path")

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
        """Overlap of the two sides, besides that of their meshes; < 0 a gap (length)."""
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

    def rotation_factor(self, time: float) -> float:
        """Share of the obstacle's angle, or of the moment that turns it."""
        return self._rotation(time)

    def angle(self, time: float) -> float:
        """By how much the obstacle has turned where no moment turns it (radian)."""
        return self._obstacle.angle * self._rotation(time) if self._obstacle.angle else 0.0

    def moment(self, time: float) -> float | None:
        """That turns the obstacle; None where none does (force × length)."""
        moment = self._obstacle.moment
        return None if moment is None else moment * self._rotation(time)

    @staticmethod
    def _not_negative(path: KeyedPath, time: float, why: str) -> float:
        factor = path(time)
        if factor < 0:
            raise InputError(f"{path.key}: {factor:g} at time {time:g}, but {why}")
        return factor


# ε = this × g h / E, h the shortest edge at the contact: a stuck point creeps by less
# than ε, which changes the stress near it by about E ε / h, so the bias is of this order.
_REGULARISATION_SHARE = 1e-5
# ε₁ = this × h / E: a pressure p then sinks in by this share of the elastic displacement
# p h / E of one cell, so its bias stays below .1 % down to contacts of a single cell.
_PENALTY_SHARE = 3e-4


class ContactScales:
    """Stiffness and size of cells at a contact, also of those opposite.

    Attributes:
        moduli: Stiffnesses of the body, or of the two that touch.
        facet_size: Shortest edge of the cells at the contact (length).
    """

    def __init__(self, sides: ContactSides, elastic: ElasticBody) -> None:
        self.moduli = elastic.moduli_behind(sides.trace.nodes)
        self.facet_size = sides.facet_size
        if sides.opposite is not None:
            self.moduli = self.moduli.against(elastic.moduli_behind(sides.opposite.nodes))

    def penalty_parameter(self, given: float | Literal["auto"]) -> float:
        """The scene's ε₁, or one whose bias in force and peak pressure is below .1 %.

        So it is for 0, too: an exact solver begins with what a penalty would find.
        """
        if given != "auto" and given > 0:
            return float(given)
        return _PENALTY_SHARE * self.facet_size / self.moduli.confined

    def regularisation_parameter(self, bound: float) -> float:
        """An ε whose bias is below .1 % at a friction bound (length).

        Args:
            bound: The largest (stress).
        """
        return _REGULARISATION_SHARE * self.facet_size / self.moduli.combined * bound
