"""A Winkler foundation: springs that the body may leave, of a stiffness that is meant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.energy_law import EnergyLaw
from fenics_contact.contact.laws.normal.law import Parameter
from fenics_contact.contact.laws.normal.spring import positive
from fenics_contact.scene.contact import Contact
from fenics_contact.scene.values import Value


class Foundation(EnergyLaw):
    """ψ = ½ k ⟨d⟩² with the stiffness k of the foundation (E. Winkler, 1867)."""

    kind: ClassVar[str] = "winkler"
    model: ClassVar[str] = "Winkler foundation"
    names_of_power: ClassVar[tuple[str, ...]] = ("stiffness",)

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """The stiffness as the scene gives it (stress/length)."""
        return {"foundation_stiffness": contact.foundation_stiffness}

    def fields(self) -> Mapping[str, Array]:
        """The stiffness k (stress/length)."""
        given = self.site.contact.foundation_stiffness or 0.0
        return {"stiffness": self.site.given(given, "foundation_stiffness")}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the stiffness in that of the scene."""
        return {"stiffness": self.site.given(unit, key)} if key == "foundation_stiffness" else {}

    @property
    def power_of_depth(self) -> tuple[Array, Array]:
        """K and 1."""
        stiffness = self._fields["stiffness"]
        return stiffness, np.ones(len(stiffness))

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """½ k ⟨d⟩²."""
        return 0.5 * fields["stiffness"] * positive(depth) ** 2
