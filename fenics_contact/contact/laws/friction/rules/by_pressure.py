"""Friction with a coefficient that depends on the pressure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.rules.table import in_table, named, names_of
from fenics_contact.scene.laws.friction_laws import PressureDependentFriction
from fenics_contact.scene.values import Value


class ByPressure(FrictionRule):
    """g = μ s(p) p, s a table of shares of the coefficient over the pressure."""

    kind: ClassVar[str] = "pressure dependent"

    @property
    def constants(self) -> Mapping[str, float]:
        """The table."""
        return named(self._table.pressures, self._table.shares)

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the coefficient, and of the table's numbers in themselves."""
        return super().field_slopes(key, unit) or names_of(
            key, "pressures", np.ones_like(self.coefficient)
        )

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(p) p."""
        return fields["coefficient"] * in_table(pressure, fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with its largest share."""
        return self.coefficient * max(self._table.shares)

    @property
    def _table(self) -> PressureDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, PressureDependentFriction)
        return law
