"""Normal compliance: the asperities of rough surfaces give way by a power law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from fenics_contact.common.arrays import Array
from fenics_contact.contact.laws.normal.spring import SpringLaw, positive
from fenics_contact.scene import normal_laws
from fenics_contact.scene.contact import Contact


class NormalCompliance(SpringLaw):
    """p = c ⟨d⟩^m at a depth d = −gap, of which ψ = c ⟨d⟩^(m + 1)/(m + 1) is the energy.

    J. T. Oden, J. A. C. Martins, Models and computational methods for dynamic friction phenomena,
    Computer Methods in Applied Mechanics and Engineering 52 (1985) 527-634, Section 2.
    """

    kind: ClassVar[str] = "normal compliance"
    model: ClassVar[str] = "normal compliance"

    @classmethod
    def parameters(cls, contact: Contact) -> dict[str, Any]:
        """The coefficient c (stress/length^m) and the exponent m."""
        law = contact.normal_law
        assert isinstance(law, normal_laws.NormalCompliance)
        return {"coefficient": law.coefficient, "exponent": law.exponent}

    def fields(self) -> Mapping[str, Array]:
        """Both at the points."""
        given = self.parameters(self.site.contact)
        coefficient = self.site.given(given["coefficient"], "normal_law.coefficient")
        return {
            "coefficient": coefficient,
            "exponent": np.full(len(coefficient), given["exponent"]),
        }

    @staticmethod
    def density(depth: Any, jump: Any, **fields: Any) -> Any:
        """The density c ⟨d⟩^(m + 1)/(m + 1)."""
        power = fields["exponent"] + 1
        return fields["coefficient"] * positive(depth) ** power / power
