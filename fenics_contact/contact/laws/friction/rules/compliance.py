"""Friction of surfaces that give way: it follows their depth by a power of its own."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np
import ufl

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.laws.friction_laws import ComplianceFriction
from fenics_contact.scene.values import Value

# Depths over the size of the surface, between which the ratio of bound and pressure is looked at.
_DEPTHS = np.array([1e-6, 1.0])


class Compliance(FrictionRule):
    """g = c_t ⟨d⟩^m_t at a depth d, which the pressure p = c ⟨d⟩^m says: d = (p/c)^(1/m).

    J. T. Oden, J. A. C. Martins, Models and computational methods for dynamic friction phenomena,
    Computer Methods in Applied Mechanics and Engineering 52 (1985) 527-634, Section 2. With
    m_t = m it is Coulomb's law, μ = c_t/c; else μ varies as p^(m_t/m − 1).
    """

    kind: ClassVar[str] = "compliance"
    is_proportional: ClassVar[bool] = False

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self.coefficient = site.given(self._table.coefficient, "friction_law.coefficient")

    @cached_property
    def fields(self) -> Mapping[str, Array]:
        """c_t and c at the points, and the exponents."""
        stiffness, exponent = self.normal.power_of_depth
        return {"coefficient": self.coefficient, "stiffness": stiffness, "exponent": exponent}

    @property
    def constants(self) -> Mapping[str, float]:
        """m_t."""
        return {"own_exponent": self._table.exponent}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of its own numbers, and of those of the law across the contact."""
        own = {"friction_law.coefficient": "coefficient", "friction_law.exponent": "own_exponent"}
        if key in own:
            return {own[key]: self.site.given(unit, key)}
        across = self.normal.field_slopes(key, unit)
        names = zip(self.normal.names_of_power, ("stiffness", "exponent"), strict=False)
        return {mine: across[theirs] for theirs, mine in names if theirs in across}

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """c_t (p/c)^(m_t/m)."""
        # Powers are kept away from 0, where their derivatives are not numbers.
        pressed = ufl.conditional(ufl.gt(pressure, 0), pressure, 1.0)
        power = fields["own_exponent"] / fields["exponent"]
        found = fields["coefficient"] * (pressed / fields["stiffness"]) ** power
        return ufl.conditional(ufl.gt(pressure, 0), found, 0.0)

    @property
    def largest_coefficient(self) -> Array:
        """Largest ratio at depths between a millionth of the surface's size and the size."""
        stiffness, exponent = self.normal.power_of_depth
        depths = _DEPTHS[:, None] * self.site.trace.extent()
        powers = depths ** (self._table.exponent - exponent)
        rigid = np.where(stiffness > 0, stiffness, np.inf)
        return np.asarray(self.coefficient * powers.max(axis=0) / rigid)

    @property
    def _table(self) -> ComplianceFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, ComplianceFriction)
        return law
