"""A contact without friction."""

from __future__ import annotations

from typing import ClassVar

from fenics_contact.contact.laws.friction.law import FrictionLaw
from fenics_contact.contact.laws.friction.rules.rule import FrictionRule
from fenics_contact.contact.laws.normal.law import NormalLaw
from fenics_contact.contact.laws.site import LawSite


class Frictionless(FrictionLaw):
    """σ_T = 0."""

    kind: ClassVar[str] = "none"

    def __init__(self, site: LawSite, normal: NormalLaw, rule: FrictionRule) -> None:
        super().__init__(site, normal, rule)
        # What bounds friction by 0 everywhere; Coulomb's coefficient of 0 means no friction.
        named = site.contact.friction_law
        self.left_out = "" if named is None or named.is_proportional else named.kind
