"""Where a law acts: what it may ask of its contact when it is made."""

from __future__ import annotations

from dataclasses import dataclass

from fenics_contact.common.arrays import Array
from fenics_contact.common.errors import InputError
from fenics_contact.common.parallel import smallest
from fenics_contact.contact.driving import ContactPaths
from fenics_contact.contact.kinematics.jump import ContactKinematics
from fenics_contact.contact.parameters import ContactScales
from fenics_contact.contact.surface.trace import Trace
from fenics_contact.scene.contact import Contact
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
