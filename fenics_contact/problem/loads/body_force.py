"""A force over the volume of a part of the body."""

from __future__ import annotations

from typing import ClassVar

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.body.spaces import Spaces
from fenics_contact.common.errors import InputError
from fenics_contact.mesh.tagged_mesh import Group
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad


class BodyForce(ActingLoad):
    """A force over the volume of a part of the body."""

    kind: ClassVar[str] = "body_force"
    is_of_volume: ClassVar[bool] = True

    @property
    def measure(self) -> ufl.Measure:
        """Measure of the cells of a part."""
        return self.spaces.part(self.group)

    @staticmethod
    def place(group: str, key: str, spaces: Spaces) -> Group:
        """A part of the body."""
        found = spaces.body.group(group, key)
        if found.dimension != spaces.body.dimension:
            raise InputError(f"{key} = '{group}': a body_force needs a part of the body")
        return found

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """In what lies between facets and curves."""
        force = self.spaces.weight * sides.offset * self.value
        return ufl.dot(force, displacement) * self.missed_measure(sides)
