"""Normal compliance: the asperities of rough surfaces give way by a power law."""

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
from fenics_contact.scene.laws import normal_laws


class NormalCompliance(EnergyLaw):
    """p = c ⟨d⟩^m at a depth d = −gap, of which ψ = c ⟨d⟩^(m + 1)/(m + 1) is the energy.

    J. T. Oden, J. A. C. Martins, Models and computational methods for dynamic friction phenomena,
    Computer Methods in Applied Mechanics and Engineering 52 (1985) 527-634, Section 2.
    """

    kind: ClassVar[str] = "normal compliance"
    model: ClassVar[str] = "normal compliance"
    names_of_power: ClassVar[tuple[str, ...]] = ("coefficient", "exponent")

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Parameter]:
        """The coefficient c (stress/length^m) and the exponent m."""
        given = _table(contact)
        return {"coefficient": given.coefficient, "exponent": given.exponent}

    def fields(self) -> Mapping[str, Array]:
        """Both at the points."""
        given = _table(self.site.contact)
        coefficient = self.site.given(given.coefficient, "normal_law.coefficient")
        return {"coefficient": coefficient, "exponent": np.full(len(coefficient), given.exponent)}

    @property
    def power_of_depth(self) -> tuple[Array, Array]:
        """Both at the points."""
        return self._fields["coefficient"], self._fields["exponent"]

    @staticmethod
    def density(depth: Expr, jump: Expr, **fields: Expr) -> Expr:
        """The density c ⟨d⟩^(m + 1)/(m + 1)."""
        power = fields["exponent"] + 1
        return fields["coefficient"] * positive(depth) ** power / power


def _table(contact: Contact) -> normal_laws.NormalCompliance:
    law = contact.normal_law
    assert isinstance(law, normal_laws.NormalCompliance)
    return law
