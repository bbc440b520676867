"""Coulomb's rule: friction is bounded by a share of the pressure."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule


class Coulomb(FrictionRule):
    """g = μ p (paper, (1.6)); under a pressure that is given, the paper's case (i)."""

    kind: ClassVar[str] = "coulomb"
    is_proportional: ClassVar[bool] = True

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ p."""
        return fields["coefficient"] * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ."""
        return self.coefficient
