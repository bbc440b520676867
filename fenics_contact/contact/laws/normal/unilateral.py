"""Unilateral contact: an obstacle that the body may leave but not enter, by a penalty."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.body.forms import Expr
from fenics_contact.contact.laws.normal.energy_law import PenaltyLaw
from fenics_contact.contact.laws.normal.spring import positive


class Unilateral(PenaltyLaw):
    """ψ = ⟨d⟩²/(2ε₁): the pressure is the penetration over ε₁ (paper, (4.1))."""

    kind: ClassVar[str] = "unilateral"
    model: ClassVar[str] = "unilateral contact (penalty)"

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k ⟨d⟩², k = 1/ε₁."""
        return 0.5 * fields["stiffness"] * positive(depth) ** 2
