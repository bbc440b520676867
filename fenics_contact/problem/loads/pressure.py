"""A force over the area of a boundary, against its normal."""

from __future__ import annotations

from typing import ClassVar

import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.problem.curved_sides import CurvedSides
from fenics_contact.problem.loads.acting_load import ActingLoad


class Pressure(ActingLoad):
    """A force over the area of a boundary, against its normal."""

    kind: ClassVar[str] = "pressure"

    @property
    def force(self) -> Expr:
        """Against the normal."""
        return -self.value * ufl.FacetNormal(self.spaces.body.mesh)

    def missed_work(self, displacement: Expr, sides: CurvedSides) -> ufl.Form:
        """On the surface further out, whose normal is turned."""
        turned = sides.widened * sides.normal - sides.slope
        further = ufl.dot(sides.normal, sides.further_motion(displacement))
        more = ufl.dot(turned, displacement) + further
        return -self.spaces.weight * self.value * more * self.missed_measure(sides)
