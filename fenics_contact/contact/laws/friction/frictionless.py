"""A contact without friction."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.contact.laws.friction.law import FrictionLaw


class Frictionless(FrictionLaw):
    """σ_T = 0."""

    kind: ClassVar[str] = "none"

    @property
    def left_out(self) -> str:
        """What bounds friction by 0 everywhere; Coulomb's coefficient of 0 means no friction."""
        named = self.site.contact.friction_law
        return "" if named is None or named.is_proportional else named.kind
