"""Bonded contact: glued, along the surface and across it, in pressure and in tension."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.normal.energy_law import PenaltyLaw


class Bonded(PenaltyLaw):
    """ψ = |w|²/(2ε₁): what stands opposite is glued on as it stands, whatever the gap."""

    kind: ClassVar[str] = "bonded"
    model: ClassVar[str] = "bonded contact (penalty)"
    sticks: ClassVar[bool] = True
    pushes_only: ClassVar[bool] = False
    checks: tuple[str, ...] = ("penetration_depth",)

    def fields(self) -> Mapping[str, Array]:
        """1/ε₁ where something stands opposite."""
        stiffness = np.where(self.site.kinematics.reached, 1 / self._penalty, 0.0)
        return {"stiffness": stiffness}

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k |w|²."""
        return 0.5 * fields["stiffness"] * ufl.dot(jump, jump)

    def depth(self, jump: Array) -> Array:
        """w_n: no gap counts."""
        kinematics = self.site.kinematics
        return np.where(kinematics.reached, kinematics.normal(jump), -np.inf)

    def stiffness(self, depth: Array) -> Array:
        """The stiffness 1/ε₁ at the points (stress/length)."""
        return self._fields["stiffness"] / self.penalty.softness

    def is_closed(self, pressure: Array) -> Flags:
        """All that is glued on."""
        return self.site.kinematics.reached

    def touches_at_rest(self) -> Flags:
        """All that is glued on."""
        return self.site.kinematics.reached
