"""Friction with a coefficient that depends on how far a point has slid: weakening, running-in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from fenics_contact.body.forms import Expr
from fenics_contact.common.arrays import Array, Flags
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.friction.rules.table import in_table, named, names_of
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite
from fenics_contact.results.contact_points import PointArray
from fenics_contact.scene.laws.friction_laws import SlipDependentFriction
from fenics_contact.scene.values import Value


class BySlip(FrictionRule):
    """g = μ s(l) p, s a table of shares over the slip so far l, the length of a point's path.

    l is that at the end of the load step before: within a step the coefficient is known, and the
    error of that is of the order of the step. Points slide only where they touch.
    """

    kind: ClassVar[str] = "slip dependent"
    state: ClassVar[tuple[PointArray, ...]] = (PointArray("slip_so_far", "length"),)

    def __init__(self, site: LawSite, normal: NormalLaw) -> None:
        super().__init__(site, normal)
        self._slid = np.zeros(len(self.coefficient))
        self._in_forms = site.trace.function(self._slid)

    @property
    def constants(self) -> Mapping[str, float]:
        """The table."""
        return named(self._table.slips, self._table.shares)

    @property
    def changing(self) -> Mapping[str, Expr]:
        """The slip so far."""
        return {"slip_so_far": self._in_forms.ufl}

    @property
    def _values(self) -> Mapping[str, Array | float]:
        return {**super()._values, "slip_so_far": self._slid}

    def field_slopes(self, key: str, unit: Value) -> Mapping[str, Array]:
        """Slopes of the coefficient, and of the table's numbers in themselves."""
        return super().field_slopes(key, unit) or names_of(
            key, "slips", np.ones_like(self.coefficient)
        )

    @staticmethod
    def bound(pressure: Expr, **fields: Expr) -> Expr:
        """μ s(l) p."""
        return fields["coefficient"] * in_table(fields["slip_so_far"], fields) * pressure

    @property
    def largest_coefficient(self) -> Array:
        """μ with the share of the slip so far."""
        return self.slope(np.zeros(len(self._slid)))

    def at_step_end(self, slip: Array, closed: Flags) -> dict[str, Array]:
        """The slip so far with that of the step, where points touch."""
        way = np.where(closed, np.linalg.norm(slip, axis=1), 0.0)
        return {"slip_so_far": self._slid + way}

    def vjp_state_update(
        self, slip: Array, closed: Flags, of_end: Mapping[str, Array]
    ) -> tuple[Array, Mapping[str, Array]]:
        """Transposed derivative of ``at_step_end``, in the slip of the step and in that before."""
        of_way = np.where(closed, of_end["slip_so_far"], 0.0)
        size = np.linalg.norm(slip, axis=1)
        direction = slip / np.where(size > 0, size, 1.0)[:, None]
        return of_way[:, None] * direction, of_end

    def take(self, kept: Mapping[str, Array]) -> None:
        """Follow the slip so far."""
        self._slid = kept["slip_so_far"]
        self._in_forms.set(self._slid)

    @property
    def _table(self) -> SlipDependentFriction:
        law = self.site.contact.friction_law
        assert isinstance(law, SlipDependentFriction)
        return law
