"""A force over the area of a boundary."""

from __future__ import annotations

from typing import ClassVar

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad


class Traction(ActingLoad):
    """A force over the area of a boundary."""

    kind: ClassVar[str] = "traction"

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """On the surface further out, which is longer."""
        more = sides.stretch * displacement + sides.further_motion(displacement)
        return self.spaces.weight * ufl.dot(self.force, more) * self.missed_measure(sides)
