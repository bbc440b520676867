"""Friction with a coefficient that depends on how fast points slide: stick-slip."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.rules.table import in_table, named
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.scene.laws.friction_laws import SpeedDependentFriction


class BySpeed(FrictionRule):
    """g = μ s(v) p, s a table of shares over the speed v of sliding.

    v is given for each solve: the balance of a step is that of Coulomb's friction.
    """

    kind: ClassVar[str] = "speed dependent"
    follows_speed: ClassVar[bool] = True

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self._speed = np.zeros(len(self.coefficient))
        self._in_forms = site.trace.function(self._speed)

    @property
    def constants(self) -> Mapping[str, float]:
        """The table."""
        return named(self._table.speeds, self._table.shares)

    @property
    def changing(self) -> Mapping[str, Expr]:
        """The speed."""
        return {"speed": self._in_forms.ufl}

    @property
    def _values(self) -> Mapping[str, Array | float]:
        return {**super()._values, "speed": self._speed}

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(v) p."""
        return fields["coefficient"] * in_table(fields["speed"], fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with its largest share."""
        return self.coefficient * max(self._table.shares)

    def follow_speed(self, speed: Array) -> None:
        """Go by it from now on."""
        self._speed = speed
        self._in_forms.set(speed)

    @property
    def _table(self) -> SpeedDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, SpeedDependentFriction)
        return law
